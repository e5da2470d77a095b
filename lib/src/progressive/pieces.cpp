// SPDX-License-Identifier: MIT
#include "progressive/pieces.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone::progressive {
namespace {

constexpr double off_m = 0.002;          // a cut may take in points so far beside the triangle
constexpr double sliver_m = 0.004;       // a flatter piece has no direction
constexpr float same_attribute = 0.01F;  // interpolated in float along the side

struct Triangle {
  std::array<VertexId, 3> vertex{};
  std::array<glm::dvec3, 3> at{};
  glm::dvec3 normal{0.0};  // twice the area long

  Triangle(const Mesh& mesh, FaceId f) {
    for (std::size_t k = 0; k < 3; ++k) {
      vertex[k] = mesh.indices[3 * std::size_t{f} + k];
      at[k] = glm::dvec3{mesh.vertices.positions[vertex[k]]};
    }
    normal = glm::cross(at[1] - at[0], at[2] - at[0]);
  }
  [[nodiscard]] double longest() const {
    return std::max({glm::length(at[1] - at[0]), glm::length(at[2] - at[1]), glm::length(at[0] - at[2])});
  }
};

// Of p along the triangle's plane; they add up to 1.
glm::dvec3 weights(const Triangle& t, const glm::dvec3& p) {
  const double n2 = glm::dot(t.normal, t.normal);
  const double b = glm::dot(glm::cross(p - t.at[0], t.at[2] - t.at[0]), t.normal) / n2;
  const double c = glm::dot(glm::cross(t.at[1] - t.at[0], p - t.at[0]), t.normal) / n2;
  return {1.0 - b - c, b, c};
}

bool lies_inside(const Triangle& whole, const glm::dvec3& p) {
  const double length = glm::length(whole.normal);
  if (std::abs(glm::dot(whole.normal, p - whole.at[0])) > off_m * length) return false;
  const glm::dvec3 w = weights(whole, p);
  for (int k = 0; k < 3; ++k) {
    // The height over the side that faces corner k.
    const double side =
        glm::length(whole.at[static_cast<std::size_t>((k + 1) % 3)] - whole.at[static_cast<std::size_t>((k + 2) % 3)]);
    if (w[k] * length < -off_m * side) return false;
  }
  return true;
}

template <class Array>
bool same_bits(const Array& a, VertexId i, const Array& b, VertexId j) {
  return a.empty() || a[i] == b[j];
}

bool has_attributes(const Mesh& source, const Triangle& whole, const Mesh& cut, const Triangle& piece, std::size_t k) {
  const VertexArrays& theirs = source.vertices;
  const VertexArrays& ours = cut.vertices;
  const VertexId v = piece.vertex[k];
  for (const VertexId w : whole.vertex) {
    if (theirs.positions[w] != ours.positions[v]) continue;
    return same_bits(theirs.normals, w, ours.normals, v) && same_bits(theirs.uvs, w, ours.uvs, v) &&
           same_bits(theirs.colors, w, ours.colors, v);
  }
  if (theirs.uvs.empty()) return true;
  const glm::vec3 share{weights(whole, piece.at[k])};
  glm::vec2 uv{0.0F};
  float size = 1.0F;
  for (int c = 0; c < 3; ++c) {
    const glm::vec2 at = theirs.uvs[whole.vertex[static_cast<std::size_t>(c)]];
    uv += share[c] * at;
    size = std::max(size, glm::length(at));
  }
  return glm::length(uv - ours.uvs[v]) <= same_attribute * size;
}

bool is_piece(const Mesh& source, const Triangle& whole, const Mesh& cut, const Triangle& piece) {
  const double length = glm::length(piece.normal);
  if (length > sliver_m * piece.longest() && glm::dot(piece.normal, whole.normal) <= 0.0) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!lies_inside(whole, piece.at[k]) || !has_attributes(source, whole, cut, piece, k)) return false;
  }
  return true;
}

struct Place {
  double low = 0.0, high = 0.0;  // along x
  FaceId face = none;
  double left_m2 = 0.0;  // of its area, without a piece so far
  std::array<bool, 3> has_corner{};
};

Place place_of(const Triangle& t, FaceId f) {
  const auto [low, high] = std::minmax({t.at[0].x, t.at[1].x, t.at[2].x});
  return {low, high, f, 0.5 * glm::length(t.normal), {}};
}

// Whether the face is a thin one that lies along a side of a triangle of the source that is still whole.
bool closes_crack(const Mesh& source, const Mesh& cut, FaceId f) {
  const Triangle piece{cut, f};
  if (glm::length(piece.normal) > off_m * piece.longest()) return false;
  for (FaceId whole = 0; whole < source.triangle_count(); ++whole) {
    if (source.face_material(whole) != cut.face_material(f) || source.face_feature(whole) != cut.face_feature(f))
      continue;
    const Triangle triangle{source, whole};
    if (glm::length(triangle.normal) > 0.0 && is_piece(source, triangle, cut, piece)) return true;
  }
  return false;
}

// Whether all corners of the triangle are used: a needle at one of them may have been counted to a neighbour.
bool corners_used(const Triangle& whole, const Mesh& cut, const std::vector<FaceId>& pieces) {
  return std::all_of(whole.at.begin(), whole.at.end(), [&](const glm::dvec3& corner) {
    return std::any_of(pieces.begin(), pieces.end(), [&](FaceId f) {
      const Triangle piece{cut, f};
      return std::find(piece.at.begin(), piece.at.end(), corner) != piece.at.end();
    });
  });
}

}  // namespace

Uncovered find_uncovered(const Mesh& source, const std::vector<FaceId>& wholes, const Mesh& cut,
                         const std::vector<FaceId>& pieces) {
  std::vector<Place> places;
  for (const FaceId f : wholes) places.push_back(place_of(Triangle{source, f}, f));
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.low != b.low ? a.low < b.low : a.face < b.face; });
  for (const FaceId f : pieces) {
    const Triangle piece{cut, f};
    const Place at = place_of(piece, f);
    const double area = at.left_m2;
    Place* best = nullptr;
    for (Place& place : places) {
      if (place.low > at.low + off_m) break;
      // Of several, that with most left: where triangles lie on each other all get their share.
      if (place.high < at.high - off_m || (best != nullptr && place.left_m2 <= best->left_m2)) continue;
      if (source.face_material(place.face) != cut.face_material(f) ||
          source.face_feature(place.face) != cut.face_feature(f))
        continue;
      const Triangle whole{source, place.face};
      if (glm::length(whole.normal) > 0.0 && is_piece(source, whole, cut, piece)) best = &place;
    }
    // A needle that fills the crack between a side and the points beside it belongs to no triangle.
    const bool needle = 2.0 * area < std::min(off_m, 0.01 * piece.longest()) * piece.longest();
    if (best == nullptr && (needle || closes_crack(source, cut, f))) continue;
    if (best == nullptr) return {none, f};
    best->left_m2 -= area;
    const Triangle whole{source, best->face};
    for (std::size_t k = 0; k < 3; ++k) {
      best->has_corner[k] =
          best->has_corner[k] || std::find(piece.at.begin(), piece.at.end(), whole.at[k]) != piece.at.end();
    }
  }
  for (const Place& place : places) {
    const auto& corners = place.has_corner;
    if ((!corners[0] || !corners[1] || !corners[2]) && !corners_used(Triangle{source, place.face}, cut, pieces)) {
      return {place.face, none};
    }
    if (std::abs(place.left_m2) > 2.0 * off_m * Triangle{source, place.face}.longest()) return {place.face, none};
  }
  return {};
}

}  // namespace lodestone::progressive

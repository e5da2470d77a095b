// SPDX-License-Identifier: MIT
#include "facets/kinds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone::facets {
namespace {

constexpr std::size_t most_faces = 500;  // of a part; then it has less than 1,024 points
constexpr double tolerance_m = 1e-5;     // of places, and of areas in m^2
constexpr float normal_tolerance = 1e-4F;
constexpr double frame_share = 0.37;  // of the largest face has the one that tells the frame
constexpr double cell_m = 0.01;       // of sizes

std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
  return (hash ^ word) * 0x9E3779B97F4A7C15U ^ (hash >> 29U);
}

}  // namespace

Kinds::Kinds(const FacetMesh& mesh)
    : mesh_(mesh),
      follows_(mesh.point_count(), 0),
      kind_(mesh.point_count(), none),
      local_(mesh.point_count(), 0),
      seen_(mesh.point_count(), 0),
      order_(mesh.point_count(), 0) {}

// The first face that is large: its first edge and its normal.
void Kinds::find_frame(std::span<const FaceId> faces) {
  double largest = 0.0;
  for (const FaceId f : faces) largest = std::max(largest, glm::length(mesh_.area_vector(mesh_.faces[f])));
  for (const FaceId f : faces) {
    const Face& face = mesh_.faces[f];
    const glm::dvec3 across = mesh_.area_vector(face);
    if (glm::length(across) < frame_share * largest) continue;
    const glm::dvec3 x = glm::normalize(mesh_.at(face.point[1]) - mesh_.at(face.point[0]));
    const glm::dvec3 z = glm::normalize(across);
    shape_.turn = {x, glm::cross(z, x), z};
    return;
  }
}

// False if it is too large, has no area, or some of it is gone.
bool Kinds::describe(std::span<const FaceId> faces) {
  if (faces.size() > most_faces) return false;
  ++look_;
  shape_.points.clear();
  shape_.words.clear();
  shape_.vectors.clear();
  shape_.numbers.clear();
  shape_.turn = glm::dmat3{0.0};
  find_frame(faces);
  if (shape_.turn[2] == glm::dvec3{0.0}) return false;
  std::vector<std::uint32_t> surfaces;
  shape_.hash = faces.size();
  for (const FaceId f : faces) {
    const Face& face = mesh_.faces[f];
    if (!face.live) return false;
    std::uint32_t corners = 0;
    for (const std::uint32_t p : face.point) {
      if (seen_[p] != look_) {
        seen_[p] = look_;
        order_[p] = static_cast<std::uint32_t>(shape_.points.size());
        shape_.points.push_back(p);
      }
      corners = corners << 10U | order_[p];
    }
    const auto at = std::find(surfaces.rbegin(), surfaces.rend(), face.surface);
    const auto surface = static_cast<std::uint32_t>(at == surfaces.rend() ? surfaces.size() : surfaces.rend() - at - 1);
    if (at == surfaces.rend()) surfaces.push_back(face.surface);
    for (const std::uint32_t word : {corners, mesh_.source->face_material(f), surface}) {
      shape_.words.push_back(word);
      shape_.hash = mix(shape_.hash, word);
    }
  }
  const glm::dmat3 back = glm::transpose(shape_.turn);
  const glm::dvec3 first = mesh_.at(shape_.points[0]);
  shape_.size_m = 0.0;
  for (const std::uint32_t p : shape_.points) {
    const glm::dvec3 at = back * (mesh_.at(p) - first);
    shape_.vectors.push_back(glm::vec3{at});
    shape_.numbers.push_back(mesh_.deviation_m[p]);
    shape_.size_m += glm::length(at);
  }
  for (const FaceId f : faces) shape_.vectors.push_back(glm::vec3{back * mesh_.faces[f].normal});
  for (const std::uint32_t s : surfaces)
    shape_.numbers.push_back(static_cast<float>(mesh_.surfaces.surfaces[s].area_m2));
  return true;
}

// Infinite if the part is of another kind.
double Kinds::apart_m(const Shape& a) const {
  const double differs = std::numeric_limits<double>::infinity();
  if (a.words != shape_.words || a.numbers.size() != shape_.numbers.size()) return differs;
  double most = 0.0;
  for (std::size_t i = 0; i < a.numbers.size(); ++i) {
    most = std::max(most, std::abs(double{a.numbers[i]} - double{shape_.numbers[i]}));
  }
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    most = std::max(most, glm::length(glm::dvec3{a.vectors[i]} - glm::dvec3{shape_.vectors[i]}));
  }
  if (!(most <= tolerance_m)) return differs;
  for (std::size_t i = a.points.size(); i < a.vectors.size(); ++i) {
    if (glm::length(a.vectors[i] - shape_.vectors[i]) > normal_tolerance) return differs;
  }
  return most;
}

std::uint32_t Kinds::find_kind(double& apart) const {
  const double margin = tolerance_m * static_cast<double>(shape_.points.size());
  const auto low = static_cast<std::uint64_t>(std::max(shape_.size_m - margin, 0.0) / cell_m);
  const auto high = static_cast<std::uint64_t>((shape_.size_m + margin) / cell_m);
  for (std::uint64_t cell = low; cell <= high; ++cell) {
    const auto at = by_hash_.find(mix(shape_.hash, cell));
    if (at == by_hash_.end()) continue;
    for (const std::uint32_t kind : at->second) {
      apart = apart_m(kinds_[kind].shape);
      if (std::isfinite(apart)) return kind;
    }
  }
  return none;
}

void Kinds::update(const FaceGroups& parts) {
  std::fill(follows_.begin(), follows_.end(), 0);
  std::fill(kind_.begin(), kind_.end(), none);
  kinds_.clear();
  points_.clear();
  by_hash_.clear();
  for (std::uint32_t id = 0; id < parts.size(); ++id) {
    if (!describe(parts[id])) continue;
    Member member{static_cast<std::uint32_t>(points_.size()), shape_.turn, 0.0};
    points_.insert(points_.end(), shape_.points.begin(), shape_.points.end());
    const std::uint32_t kind = find_kind(member.apart_m);
    if (kind == none) {
      const auto cell = static_cast<std::uint64_t>(shape_.size_m / cell_m);
      by_hash_[mix(shape_.hash, cell)].push_back(static_cast<std::uint32_t>(kinds_.size()));
      kinds_.push_back({shape_, {member}});
      continue;
    }
    kinds_[kind].members.push_back(member);
    for (const std::uint32_t p : shape_.points) follows_[p] = 1;
  }
  for (std::uint32_t k = 0; k < kinds_.size(); ++k) {
    if (kinds_[k].members.size() == 1) continue;
    const std::vector<std::uint32_t>& points = kinds_[k].shape.points;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      kind_[points[i]] = k;
      local_[points[i]] = i;
    }
  }
}

void Kinds::prepare(std::span<const Move> moves, Errand& errand) const {
  errand.kinds_ = this;
  errand.kind_ = kind_[moves.front().point];
  errand.count_ = 0;
  if (errand.kind_ == none) return;
  const Kind& kind = kinds_[errand.kind_];
  errand.count_ = static_cast<std::uint32_t>(kind.members.size()) - 1;
  errand.local_.clear();
  const glm::dmat3 back = glm::transpose(kind.members[0].turn);
  for (const Move& m : moves) {
    const std::uint32_t end = m.onto == none ? m.point : m.onto;
    const glm::dvec3 way = back * (glm::dvec3{m.to} - mesh_.at(end));
    errand.local_.push_back({local_[m.point], m.onto == none ? none : local_[m.onto], glm::vec3{way}});
  }
}

std::span<const Move> Kinds::Errand::moves(std::uint32_t follower) {
  const Member& member = kinds_->kinds_[kind_].members[follower + 1];
  const std::uint32_t* points = kinds_->points_.data() + member.first_point;
  moves_.clear();
  for (const Move& m : local_) {
    const std::uint32_t onto = m.onto == none ? none : points[m.onto];
    const std::uint32_t end = onto == none ? points[m.point] : onto;
    moves_.push_back({points[m.point], onto, glm::vec3{kinds_->mesh_.at(end) + member.turn * glm::dvec3{m.to}}});
  }
  return moves_;
}

double Kinds::Errand::apart_m(std::uint32_t follower) const noexcept {
  return kinds_->kinds_[kind_].members[follower + 1].apart_m;
}

}  // namespace lodestone::facets

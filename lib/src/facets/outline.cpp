// SPDX-License-Identifier: MIT
#include "facets/outline.h"

#include <algorithm>
#include <cmath>

#include <lodestone/polygon.h>

namespace lodestone::facets {
namespace {

constexpr double parallel_cosine = 0.99;  // small faces turn far by a few millimetres
constexpr double plane_m = 0.006;
constexpr double sliver_m = 1e-3;

// Counter-clockwise from direction a to b, 0..4, grows with the angle.
double turn(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& normal) {
  const double along = glm::dot(a, b);
  const double across = glm::dot(glm::cross(a, b), normal);
  const double length = std::abs(along) + std::abs(across);
  if (!(length > 0.0)) return 4.0;
  const double t = across / length;
  return along >= 0.0 ? (across >= 0.0 ? t : 4.0 + t) : 2.0 - t;
}

}  // namespace

bool is_sliver(const FacetMesh& mesh, const Face& face) {
  const glm::dvec3 a = mesh.at(face.point[0]);
  const glm::dvec3 b = mesh.at(face.point[1]);
  const glm::dvec3 c = mesh.at(face.point[2]);
  const double longest2 = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  const glm::dvec3 across = glm::cross(b - a, c - a);
  return longest2 == 0.0 || glm::dot(across, across) < sliver_m * sliver_m * longest2;
}

bool is_parallel(const Face& face, const glm::dvec3& normal) { return glm::dot(face.normal, normal) > parallel_cosine; }

bool is_near(const FacetMesh& mesh, const Face& face, const glm::dvec3& normal, double offset_m) {
  return std::all_of(face.point.begin(), face.point.end(),
                     [&](std::uint32_t p) { return std::abs(glm::dot(normal, mesh.at(p)) - offset_m) < plane_m; });
}

bool lies_in(const FacetMesh& mesh, const Face& face, const glm::dvec3& normal, double offset_m) {
  return (is_parallel(face, normal) || is_sliver(mesh, face)) && is_near(mesh, face, normal, offset_m);
}

std::vector<Edge> outline(const FacetMesh& mesh, const std::vector<FaceId>& faces) {
  std::vector<Edge> edges;
  edges.reserve(3 * faces.size());
  for (const FaceId f : faces) {
    const auto& p = mesh.faces[f].point;
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(p[k], p[k == 2 ? 0 : k + 1]);
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> open;
  for (const Edge& e : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), Edge{e.second, e.first})) open.push_back(e);
  }
  return open;
}

bool is_closed(const FacetMesh& mesh) {
  const auto has_back = [&](std::uint32_t a, std::uint32_t b) {
    return std::any_of(mesh.faces_of[a].begin(), mesh.faces_of[a].end(), [&](FaceId g) {
      const auto& q = mesh.faces[g].point;
      return (q[0] == b && q[1] == a) || (q[1] == b && q[2] == a) || (q[2] == b && q[0] == a);
    });
  };
  return std::all_of(mesh.faces.begin(), mesh.faces.end(), [&](const Face& face) {
    const auto& p = face.point;
    return !face.live || (has_back(p[0], p[1]) && has_back(p[1], p[2]) && has_back(p[2], p[0]));
  });
}

std::vector<std::vector<std::uint32_t>> chain(const FacetMesh& mesh, std::vector<Edge> edges,
                                              const glm::dvec3& normal) {
  std::vector<std::vector<std::uint32_t>> loops;
  std::vector<std::uint8_t> used(edges.size(), 0);
  for (std::size_t start = 0; start < edges.size(); ++start) {
    if (used[start] != 0) continue;
    std::vector<std::uint32_t> loop;
    std::size_t at = start;
    while (used[at] == 0) {
      used[at] = 1;
      const auto [from, to] = edges[at];
      loop.push_back(from);
      // The next edge around what lies outside.
      double least = 5.0;
      for (auto e = std::lower_bound(edges.begin(), edges.end(), Edge{to, 0}); e != edges.end() && e->first == to;
           ++e) {
        const auto index = static_cast<std::size_t>(e - edges.begin());
        if (used[index] != 0 && index != start) continue;
        double angle = turn(mesh.at(from) - mesh.at(to), mesh.at(e->second) - mesh.at(to), normal);
        if (angle < 1e-9) angle = 4.0;
        if (angle < least) {
          least = angle;
          at = index;
        }
      }
      if (least == 5.0) break;
    }
    if (at == start && loop.size() > 2) loops.push_back(std::move(loop));
  }
  return loops;
}

double signed_area(const FacetMesh& mesh, const std::vector<std::uint32_t>& loop, const glm::dvec3& normal) {
  glm::dvec3 sum{0.0};
  const glm::dvec3 a = mesh.at(loop[0]);
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += glm::cross(mesh.at(loop[i]) - a, mesh.at(loop[i + 1]) - a);
  return 0.5 * glm::dot(sum, normal);
}

std::optional<std::vector<std::array<std::uint32_t, 3>>> triangulate(const std::vector<std::vector<Corner>>& rings,
                                                                     const glm::dvec3& normal, double area_m2) {
  std::vector<glm::dvec3> places;
  std::vector<std::uint32_t> points, ends;
  for (const auto& ring : rings) {
    for (const Corner& corner : ring) {
      places.push_back(corner.at);
      points.push_back(corner.point);
    }
    ends.push_back(static_cast<std::uint32_t>(places.size()));
  }
  auto triangles = triangulate_polygon(places, ends);
  double sum = 0.0;
  for (auto& t : triangles) {
    const double a = 0.5 * glm::dot(glm::cross(places[t[1]] - places[t[0]], places[t[2]] - places[t[0]]), normal);
    if (a < -1e-9) return std::nullopt;
    sum += a;
    t = {points[t[0]], points[t[1]], points[t[2]]};
  }
  if (!(std::abs(sum - area_m2) < 1e-4 * area_m2 + 1e-7)) return std::nullopt;
  return triangles;
}

}  // namespace lodestone::facets

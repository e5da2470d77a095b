// SPDX-License-Identifier: MIT
#include "facets/parts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/disjoint_sets.h"
#include "geometry/bvh.h"

namespace lodestone::facets {
namespace {

constexpr std::size_t most_part_faces = 256;  // larger ones lose facets first
constexpr double first_radius_m = 0.02;

struct Rest {
  const FacetMesh& mesh;
  const std::vector<std::uint32_t>& part_of;  // per face
  std::vector<FaceId> face_of;                // of the tree's faces
  TriangleBvh tree;

  // Distance from p to the nearest face of another part, infinite beyond the limit.
  [[nodiscard]] double distance(const glm::dvec3& p, std::uint32_t part, double limit_m, FaceId& nearest) const {
    const auto other = [&](FaceId f) { return part_of[face_of[f]] != part; };
    for (double radius = std::min(first_radius_m, limit_m);; radius = std::min(3.0 * radius, limit_m)) {
      double best = std::numeric_limits<double>::infinity();
      tree.within(p, radius, other, [&](FaceId f) {
        const Face& face = mesh.faces[face_of[f]];
        const double d =
            squared_distance_to_triangle(p, mesh.at(face.point[0]), mesh.at(face.point[1]), mesh.at(face.point[2]));
        if (d < best) {
          best = d;
          nearest = face_of[f];
        }
        return true;
      });
      if (std::isfinite(best)) return std::sqrt(best);
      if (radius >= limit_m) return best;
    }
  }

  // Whether a face of another part, before or behind, covers p when one looks along `across`.
  [[nodiscard]] bool lies_behind(const glm::dvec3& p, const glm::dvec3& across, std::uint32_t part,
                                 double limit_m) const {
    bool found = false;
    const auto across_it = [&](FaceId f) {
      return part_of[face_of[f]] != part && std::abs(glm::dot(mesh.faces[face_of[f]].normal, across)) > 0.7;
    };
    tree.within(p, limit_m, across_it, [&](FaceId f) {
      const Face& face = mesh.faces[face_of[f]];
      const glm::dvec3 a = mesh.at(face.point[0]);
      const double d = std::sqrt(squared_distance_to_triangle(p, a, mesh.at(face.point[1]), mesh.at(face.point[2])));
      found = d <= std::abs(glm::dot(p - a, face.normal)) + 1e-3;
      return !found;
    });
    return found;
  }
};

constexpr double held_m = 0.03;  // an outline nearer to the rest than this lies on it

// A pane that closes an opening: its outline lies on the rest all around, and nothing is behind it. Without it one
// would look through the wall.
bool closes_opening(const FacetMesh& mesh, const Rest& rest, std::uint32_t id, double limit_m, const Part& part) {
  const auto area = [&](FaceId f) { return glm::length(mesh.area_vector(mesh.faces[f])); };
  const FaceId largest =
      *std::max_element(part.faces.begin(), part.faces.end(), [&](FaceId a, FaceId b) { return area(a) < area(b); });
  const glm::dvec3 across = mesh.faces[largest].normal;
  double open = 0.0;
  double whole = 0.0;
  std::uint32_t corners = 0;
  std::uint32_t held = 0;
  for (const FaceId f : part.faces) {
    const Face& face = mesh.faces[f];
    if (std::abs(glm::dot(face.normal, across)) < 0.9) continue;
    whole += area(f);
    FaceId nearest = none;
    const glm::dvec3 middle = (mesh.at(face.point[0]) + mesh.at(face.point[1]) + mesh.at(face.point[2])) / 3.0;
    if (!rest.lies_behind(middle, across, id, limit_m)) open += area(f);
    for (const std::uint32_t p : face.point) {
      ++corners;
      held += std::isfinite(rest.distance(mesh.at(p), id, held_m + double{mesh.deviation_m[p]}, nearest)) ? 1 : 0;
    }
  }
  return 2.0 * open > whole && 10 * held >= 9 * corners;
}

// Looks from corners, middles of edges and of faces.
void measure(const FacetMesh& mesh, const Rest& rest, std::uint32_t id, double limit_m, Part& part) {
  constexpr std::array<std::array<double, 3>, 7> samples{
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {1.0 / 3, 1.0 / 3, 1.0 / 3}}};
  double deviation = 0.0;
  for (const FaceId f : part.faces) {
    const Face& face = mesh.faces[f];
    double sum = 0.0;
    for (const auto& w : samples) {
      const glm::dvec3 p =
          w[0] * mesh.at(face.point[0]) + w[1] * mesh.at(face.point[1]) + w[2] * mesh.at(face.point[2]);
      FaceId nearest = none;
      const double d = rest.distance(p, id, limit_m, nearest);
      part.error_m = std::max(part.error_m, d);
      if (!std::isfinite(d)) return;
      sum += d * d;
      for (const std::uint32_t q : mesh.faces[nearest].point) part.support.push_back(q);
    }
    for (const std::uint32_t q : face.point) deviation = std::max(deviation, double{mesh.deviation_m[q]});
    part.cost += 0.5 * glm::length(mesh.area_vector(face)) * sum / static_cast<double>(samples.size());
  }
  part.error_m = std::hypot(part.error_m, deviation);
}

}  // namespace

std::vector<Part> find_parts(const FacetMesh& mesh, double limit_m) {
  DisjointSets sets{mesh.point_count()};
  for (const Face& f : mesh.faces) {
    if (!f.live) continue;
    sets.join(f.point[0], f.point[1]);
    sets.join(f.point[0], f.point[2]);
  }
  std::vector<std::uint32_t> part_of(mesh.faces.size(), none);
  std::map<std::uint32_t, Part> by_root;
  std::vector<FaceId> live;
  std::vector<VertexId> indices;
  std::size_t most = 0;
  for (FaceId f = 0; f < mesh.faces.size(); ++f) {
    if (!mesh.faces[f].live) continue;
    part_of[f] = sets.find(mesh.faces[f].point[0]);
    auto& part = by_root[part_of[f]];
    part.faces.push_back(f);
    most = std::max(most, part.faces.size());
    live.push_back(f);
    indices.insert(indices.end(), mesh.faces[f].point.begin(), mesh.faces[f].point.end());
  }
  std::vector<Part> parts;
  if (by_root.size() < 2) return parts;
  const Rest rest{mesh, part_of, live, TriangleBvh{mesh.place, indices}};
  for (auto& [root, part] : by_root) {
    if (part.faces.size() == most || part.faces.size() > most_part_faces) continue;
    measure(mesh, rest, root, limit_m, part);
    if (std::isfinite(part.error_m) && !closes_opening(mesh, rest, root, limit_m, part))
      parts.push_back(std::move(part));
  }
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return a.cost * static_cast<double>(b.faces.size()) < b.cost * static_cast<double>(a.faces.size());
  });
  return parts;
}

}  // namespace lodestone::facets

// SPDX-License-Identifier: MIT
// Based on: the remark of Garland 1999 that contraction alone cannot simplify below the number of parts.
// Differs: a part goes by its distance from what stays, so that the error of its record is that of any other.
#include "collapse/parts.h"

#include <algorithm>
#include <cmath>

#include "geometry/bvh.h"

namespace lodestone::collapse {
namespace {

constexpr std::uint32_t most_part_faces = 64;  // larger parts collapse first
constexpr std::uint32_t least_share = 64;      // one in so many faces must be in small parts to make a search worth it

struct Part {
  std::uint32_t id = none;
  double error_m = 0.0;
  std::vector<std::uint32_t> faces;    // positions in WorkingMesh::faces
  std::vector<std::uint32_t> nearest;  // faces of other parts that it lies upon
};

class Search {
 public:
  explicit Search(const WorkingMesh& mesh) : mesh_(mesh), bvh_(mesh.position, indices_of(mesh)) {
    std::vector<std::uint32_t> part_of(mesh.faces.size());
    std::transform(mesh.faces.begin(), mesh.faces.end(), part_of.begin(),
                   [&](const Face& f) { return mesh.part[f.point[0]]; });
    bvh_.set_labels(part_of);
  }

  // The distance of the part from the faces of other parts, at its corners and the middles of its faces.
  void measure(Part& part, double limit_m) const {
    double distance = 0.0;
    double deviation = 0.0;
    std::uint32_t hint = none;
    const auto look = [&](const glm::dvec3& at) {
      // Only the farthest place counts, and what is nearest to one place is mostly near enough to the next.
      if (hint != none && bvh_.near(at, hint, distance)) return;
      const auto found = bvh_.nearest_unlike(at, limit_m, part.id);
      hint = found.slot;
      distance = std::max(
          distance, found.face == none ? std::numeric_limits<double>::infinity() : std::sqrt(found.squared_distance));
      if (found.face != none) part.nearest.push_back(found.face);
    };
    std::vector<std::uint32_t> points;
    for (const std::uint32_t i : part.faces) {
      points.insert(points.end(), mesh_.faces[i].point.begin(), mesh_.faces[i].point.end());
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (auto p = points.begin(); p != points.end() && distance <= limit_m; ++p) {
      deviation = std::max(deviation, double{mesh_.deviation_m[*p]});
      look(glm::dvec3{mesh_.position[*p]});
    }
    for (auto i = part.faces.begin(); i != part.faces.end() && distance <= limit_m; ++i) {
      const auto& p = mesh_.faces[*i].point;
      const auto at = [&](std::size_t k) { return glm::dvec3{mesh_.position[p[k]]}; };
      look((at(0) + at(1) + at(2)) / 3.0);
    }
    part.error_m = distance + deviation;
  }

 private:
  static std::vector<VertexId> indices_of(const WorkingMesh& mesh) {
    std::vector<VertexId> indices;
    indices.reserve(3 * mesh.faces.size());
    for (const Face& f : mesh.faces) indices.insert(indices.end(), f.point.begin(), f.point.end());
    return indices;
  }
  const WorkingMesh& mesh_;
  TriangleBvh bvh_;
};

// Parts of few faces, the part with most faces never among them.
std::vector<Part> small_parts(const WorkingMesh& mesh) {
  std::vector<std::uint32_t> counts(mesh.part_count, 0);
  for (const Face& f : mesh.faces) ++counts[mesh.part[f.point[0]]];
  const auto largest = static_cast<std::uint32_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
  std::vector<std::uint32_t> place(mesh.part_count, none);
  std::vector<Part> parts;
  for (std::uint32_t i = 0; i < mesh.faces.size(); ++i) {
    const std::uint32_t id = mesh.part[mesh.faces[i].point[0]];
    if (id == largest || counts[id] > most_part_faces) continue;
    if (place[id] == none) {
      place[id] = static_cast<std::uint32_t>(parts.size());
      parts.push_back({.id = id});
    }
    parts[place[id]].faces.push_back(i);
  }
  return parts;
}

bool holds_frozen(const WorkingMesh& mesh, const Part& part) {
  return std::any_of(part.faces.begin(), part.faces.end(), [&](std::uint32_t i) {
    const auto& p = mesh.faces[i].point;
    return ((mesh.flags[p[0]] | mesh.flags[p[1]] | mesh.flags[p[2]]) & point_frozen) != 0;
  });
}

// All vertices shrink into the first one, which goes too.
void log_part(WorkingMesh& mesh, const Part& part, PassLog& log) {
  std::vector<VertexId> vertices;
  for (const std::uint32_t i : part.faces) {
    Face& f = mesh.faces[i];
    for (std::uint32_t k = 0; k < 3; ++k) vertices.push_back(mesh.vertex_of(f, k));
    log.faces.push_back(f.id);
    f.id = none;
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const VertexId v : vertices) log.vertices.push_back({v, vertices.front()});
  log.end(0, static_cast<float>(part.error_m));
}

}  // namespace

float prune_parts(WorkingMesh& mesh, double limit_m, std::uint32_t most_faces, PassLog& log) {
  if (mesh.part.empty() || mesh.faces.empty()) return 0.0F;
  std::erase_if(mesh.faces, [](const Face& f) { return f.id == none; });
  std::vector<Part> parts = small_parts(mesh);
  std::size_t faces_in_parts = 0;
  for (const Part& part : parts) faces_in_parts += part.faces.size();
  if (faces_in_parts * least_share < mesh.faces.size()) return 0.0F;
  Search search{mesh};
  for (Part& part : parts) {
    search.measure(part, limit_m);
    if (holds_frozen(mesh, part)) part.error_m = std::numeric_limits<double>::infinity();
  }
  std::sort(parts.begin(), parts.end(),
            [](const Part& a, const Part& b) { return a.error_m != b.error_m ? a.error_m < b.error_m : a.id < b.id; });
  // A part that another one vanished upon stays in this round, and carries its error from then on.
  std::vector<std::uint8_t> leant_upon(mesh.part_count, 0);
  float largest = 0.0F;
  std::uint32_t gone = 0;
  for (const Part& part : parts) {
    if (!(part.error_m <= limit_m) || part.error_m == std::numeric_limits<double>::infinity() || gone >= most_faces)
      break;
    const bool support_gone = std::any_of(part.nearest.begin(), part.nearest.end(),
                                          [&](std::uint32_t i) { return mesh.faces[i].id == none; });
    if (leant_upon[part.id] != 0 || support_gone) continue;
    for (const std::uint32_t i : part.nearest) {
      leant_upon[mesh.part[mesh.faces[i].point[0]]] = 1;
      for (const std::uint32_t p : mesh.faces[i].point) {
        mesh.deviation_m[p] = std::max(mesh.deviation_m[p], static_cast<float>(part.error_m));
      }
    }
    log_part(mesh, part, log);
    gone += static_cast<std::uint32_t>(part.faces.size());
    largest = std::max(largest, static_cast<float>(part.error_m));
  }
  return largest;
}

}  // namespace lodestone::collapse

// SPDX-License-Identifier: MIT
// Based on: the remark of Garland 1999 that contraction alone cannot simplify below the number of parts.
// Differs: a part goes by its distance from what stays, so that the error of its record is that of any other.
#include "collapse/parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "geometry/bvh.h"

namespace lodestone::collapse {
namespace {

constexpr std::uint32_t most_part_faces = 64;  // larger parts collapse first
constexpr std::uint32_t least_share = 64;      // one in so many faces must be in small parts to make a search worth it
constexpr std::uint32_t most_share = 4;        // one in so many must not be, to make one for what leans on large parts

struct Part {
  std::uint32_t id = none;
  double error_m = 0.0;
  std::vector<std::uint32_t> faces;    // positions in WorkingMesh::faces
  std::vector<std::uint32_t> nearest;  // faces of other parts that it lies upon
};

// Faces that parts may lean upon.
class Supports {
 public:
  // `faces`: positions in WorkingMesh::faces.
  Supports(const WorkingMesh& mesh, std::vector<std::uint32_t> faces)
      : faces_(std::move(faces)), bvh_(mesh.position, indices_of(mesh, faces_)) {
    std::vector<std::uint32_t> part_of(faces_.size());
    std::transform(faces_.begin(), faces_.end(), part_of.begin(),
                   [&](std::uint32_t i) { return mesh.part[mesh.faces[i].point[0]]; });
    bvh_.set_labels(part_of);
  }
  // The nearest of another part.
  [[nodiscard]] TriangleBvh::Nearest nearest(const glm::dvec3& at, double limit_m, std::uint32_t part) const {
    return bvh_.nearest_unlike(at, limit_m, part);
  }
  [[nodiscard]] bool near(const glm::dvec3& at, std::uint32_t slot, double distance_m) const {
    return bvh_.near(at, slot, distance_m);
  }
  [[nodiscard]] std::uint32_t face(const TriangleBvh::Nearest& found) const { return faces_[found.face]; }

 private:
  static std::vector<VertexId> indices_of(const WorkingMesh& mesh, const std::vector<std::uint32_t>& faces) {
    std::vector<VertexId> indices;
    indices.reserve(3 * faces.size());
    for (const std::uint32_t i : faces) {
      indices.insert(indices.end(), mesh.faces[i].point.begin(), mesh.faces[i].point.end());
    }
    return indices;
  }
  std::vector<std::uint32_t> faces_;
  TriangleBvh bvh_;
};

// Measures one part.
class Ruler {
 public:
  // `more` may be null.
  Ruler(const WorkingMesh& mesh, double limit_m, const Supports& supports, const Supports* more)
      : mesh_(mesh), limit_m_(limit_m), supports_{&supports, more} {}

  // The distance of the part from its supports, at its corners and the middles of its faces.
  void measure(Part& part) {
    part.nearest.clear();
    double deviation = 0.0;
    std::vector<std::uint32_t> points;
    for (const std::uint32_t i : part.faces) {
      points.insert(points.end(), mesh_.faces[i].point.begin(), mesh_.faces[i].point.end());
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (auto p = points.begin(); p != points.end() && distance_ <= limit_m_; ++p) {
      deviation = std::max(deviation, double{mesh_.deviation_m[*p]});
      look(glm::dvec3{mesh_.position[*p]}, part);
    }
    for (auto i = part.faces.begin(); i != part.faces.end() && distance_ <= limit_m_; ++i) {
      const auto& p = mesh_.faces[*i].point;
      const auto at = [&](std::size_t k) { return glm::dvec3{mesh_.position[p[k]]}; };
      look((at(0) + at(1) + at(2)) / 3.0, part);
    }
    part.error_m = distance_ + deviation;
  }

 private:
  void look(const glm::dvec3& at, Part& part) {
    // Only the farthest place counts, and what is nearest to one place is mostly near enough to the next.
    if (hint_ != none && hinted_->near(at, hint_, distance_)) return;
    double away = std::numeric_limits<double>::infinity();
    std::uint32_t face = none;
    for (const Supports* supports : supports_) {
      if (supports == nullptr) continue;
      const auto found = supports->nearest(at, std::min(limit_m_, away), part.id);
      if (found.face == none) continue;
      away = std::sqrt(found.squared_distance);
      face = supports->face(found);
      hint_ = found.slot;
      hinted_ = supports;
    }
    distance_ = std::max(distance_, away);
    if (face != none) part.nearest.push_back(face);
  }

  const WorkingMesh& mesh_;
  double limit_m_;
  std::array<const Supports*, 2> supports_;
  const Supports* hinted_ = nullptr;  // the one that `hint_` is of
  std::uint32_t hint_ = none;
  double distance_ = 0.0;
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

class Pruning {
 public:
  Pruning(WorkingMesh& mesh, double limit_m, std::uint32_t most_faces, LastFaces& last_faces, const Context& context,
          PassLog& log)
      : mesh_(mesh),
        limit_m_(limit_m),
        most_faces_(most_faces),
        last_faces_(last_faces),
        context_(context),
        log_(log) {}

  // Parts side by side, like tiles, would each lean upon the next, which then had to stay: so what is near enough to
  // large parts goes first.
  void run() {
    std::vector<Part> parts = small_parts(mesh_);
    std::vector<std::uint8_t> is_small(mesh_.part_count, 0);
    std::size_t small = 0;
    for (const Part& part : parts) {
      is_small[part.id] = 1;
      small += part.faces.size();
    }
    const std::size_t all = mesh_.faces.size();
    if (small * least_share < all) return;
    const auto faces_of = [&](std::uint8_t wanted) {
      std::vector<std::uint32_t> faces;
      for (std::uint32_t i = 0; i < all; ++i) {
        const Face& f = mesh_.faces[i];
        if (f.id != none && is_small[mesh_.part[f.point[0]]] == wanted) faces.push_back(i);
      }
      return faces;
    };
    const Supports large_parts{mesh_, faces_of(0)};
    if ((all - small) * most_share >= all) drop(parts, large_parts, nullptr);
    std::erase_if(parts, [&](const Part& part) { return mesh_.faces[part.faces.front()].id == none; });
    if (parts.empty() || gone_ >= most_faces_) return;
    const Supports small_parts{mesh_, faces_of(1)};
    drop(parts, large_parts, &small_parts);
  }

  [[nodiscard]] Pruned result() const noexcept { return {largest_m_, some_wait_}; }

 private:
  // The nearest first. A part that another one vanished upon stays, and carries its error from then on.
  void drop(std::vector<Part>& parts, const Supports& supports, const Supports* more) {
    parallel_for_each(parts.size(), 16, context_, [&](std::size_t i) {
      Ruler{mesh_, limit_m_, supports, more}.measure(parts[i]);
      if (holds_frozen(mesh_, parts[i])) parts[i].error_m = std::numeric_limits<double>::infinity();
    });
    if (context_.cancelled()) return;
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
      return a.error_m != b.error_m ? a.error_m < b.error_m : a.id < b.id;
    });
    std::vector<std::uint8_t> leant_upon(mesh_.part_count, 0);
    for (const Part& part : parts) {
      if (!(part.error_m <= limit_m_) || part.error_m == std::numeric_limits<double>::infinity()) return;
      if (gone_ >= most_faces_) return;
      const bool support_gone = std::any_of(part.nearest.begin(), part.nearest.end(),
                                            [&](std::uint32_t i) { return mesh_.faces[i].id == none; });
      if (leant_upon[part.id] != 0 || support_gone) {
        some_wait_ = true;
        continue;
      }
      if (!groups_stay(part)) continue;
      for (const std::uint32_t i : part.nearest) {
        leant_upon[mesh_.part[mesh_.faces[i].point[0]]] = 1;
        for (const std::uint32_t p : mesh_.faces[i].point) {
          mesh_.deviation_m[p] = std::max(mesh_.deviation_m[p], static_cast<float>(part.error_m));
        }
      }
      log_part(mesh_, part, log_);
      gone_ += static_cast<std::uint32_t>(part.faces.size());
      largest_m_ = std::max(largest_m_, static_cast<float>(part.error_m));
    }
  }

  // Takes the part's faces out of the count if they may go.
  bool groups_stay(const Part& part) {
    std::vector<FaceId> ids;
    for (const std::uint32_t i : part.faces) ids.push_back(mesh_.faces[i].id);
    if (!last_faces_.may_go(ids, 0)) return false;
    last_faces_.take(ids, 0);
    return true;
  }

  WorkingMesh& mesh_;
  double limit_m_;
  std::uint32_t most_faces_;
  LastFaces& last_faces_;
  const Context& context_;
  PassLog& log_;
  std::uint32_t gone_ = 0;
  float largest_m_ = 0.0F;
  bool some_wait_ = false;
};

}  // namespace

Pruned prune_parts(WorkingMesh& mesh, double limit_m, std::uint32_t most_faces, LastFaces& last_faces,
                   const Context& context, PassLog& log) {
  if (mesh.part.empty() || mesh.faces.empty()) return {};
  std::erase_if(mesh.faces, [](const Face& f) { return f.id == none; });
  const Range all{0, mesh.point_count()};
  last_faces.count(mesh, {&all, 1});
  Pruning pruning{mesh, limit_m, most_faces, last_faces, context, log};
  pruning.run();
  return pruning.result();
}

}  // namespace lodestone::collapse

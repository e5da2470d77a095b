// SPDX-License-Identifier: MIT
// What becomes of the vertices (wedges) of a collapse: which merge, which move along, and their attributes.
#pragma once

#include <cstdint>
#include <vector>

#include "collapse/pass_log.h"
#include "collapse/star.h"
#include "collapse/working_mesh.h"

namespace lodestone::collapse {

// A collapse that may be done: `gone` merges into `kept`, which moves to `place`.
struct Choice {
  std::uint32_t gone = 0, kept = 0;
  glm::vec3 place{0.0F};          // as stored
  glm::dvec3 relative{0.0};       // the same relative to u
  double cost = 0.0;              // of the geometry
  double squared_distance = 0.0;  // see Fit
  bool moves = false;             // kept does not stay where it was
};

// True if two vertices of one point have the same uv and colour. Normals do not make seams.
[[nodiscard]] bool same_look(const WorkingMesh& mesh, VertexId a, VertexId b);

// True if two faces on the edge between points p and q differ in material, or in looks at either end.
[[nodiscard]] bool seam_between(const WorkingMesh& mesh, const Mesh& source, const Face& f, const Face& g,
                                std::uint32_t p, std::uint32_t q);

class Wedges {
 public:
  Wedges(WorkingMesh& mesh, const EdgeCollapseOptions& options, double diagonal_m);

  // Pairs the vertices for the choice, finds new values and returns what the change of looks costs, in the unit of the
  // geometric cost.
  double plan(const Star& star, const Choice& choice);

  // Logs the planned edit, without begin and end, and changes the working mesh's vertices.
  void commit(const Star& star, const Choice& choice, PassLog& log);

 private:
  struct Group {
    VertexId vertex = none;  // survivor
    bool moves = false;
    glm::dvec3 normal{0.0};
    glm::dvec2 uv{0.0};
    glm::dvec4 color{0.0};
    glm::dvec3 face_normals{0.0};
    double weight = 0.0;
    bool of_gone = false;  // a vertex of the point that goes, without a partner
    bool flat = true;      // carried the normal of each of its faces
  };
  struct Pair {
    VertexId from = none, to = none;
  };

  // The nearest of what was offered, the smallest id among equals.
  struct Nearest {
    VertexId vertex = none;
    double distance = 0.0;
    void offer(VertexId v, double away) noexcept {
      if (vertex != none && (away > distance || (away == distance && v >= vertex))) return;
      vertex = v;
      distance = away;
    }
  };

  struct Dead {
    VertexId vertex = none;
    std::uint32_t point = none;  // where it was
  };

  [[nodiscard]] bool has_looks() const noexcept;
  [[nodiscard]] bool steered() const noexcept;
  [[nodiscard]] VertexId target_of(VertexId vertex) const;
  Group& group_of(VertexId vertex);
  void make_pairs(const Star& star, const Choice& choice);
  void pair_the_rest(const Star& star, const Choice& choice);
  void predict(const Star& star, const Choice& choice);
  [[nodiscard]] double residual(const Star& star, const Choice& choice);
  void log_move(VertexId vertex, const glm::vec3& position, PassLog& log);
  void finish(Group& group, const Choice& choice);
  void store(const Group& group);
  void commit_single(const Star& star, const Choice& choice, PassLog& log);
  [[nodiscard]] VertexId heir(const Star& star, const Choice& choice, const Dead& dead) const;
  void turn_flat_normals(const Star& star, const Choice& choice, PassLog& log);
  [[nodiscard]] double look_distance(VertexId a, VertexId b) const;
  [[nodiscard]] VertexId nearest_look_at(std::uint32_t point, VertexId to) const;

  WorkingMesh& mesh_;
  const EdgeCollapseOptions& options_;
  double uv_scale_, color_scale_;
  std::vector<Pair> pairs_;
  std::vector<Group> groups_;
  std::vector<Dead> dead_;
};

}  // namespace lodestone::collapse

// SPDX-License-Identifier: MIT
// Tries one edge collapse after another, changes the working mesh and logs what it did.
#pragma once

#include <cstdint>
#include <vector>

#include "collapse/held_planes.h"
#include "collapse/last_faces.h"
#include "collapse/pass_log.h"
#include "collapse/placement.h"
#include "collapse/star.h"
#include "collapse/wedges.h"
#include "collapse/working_mesh.h"

namespace lodestone::collapse {

// Why an edge did not collapse.
enum class Refusal : std::uint8_t { None, Busy, Border, Flip, Link, Frozen, Cost, Crowded, Plane };
inline constexpr std::size_t refusal_count = 9;

// What all regions of a pass share.
struct PassState {
  WorkingMesh& mesh;
  const Mesh& source;
  const EdgeCollapseOptions& options;
  LastFaces& last_faces;
  double diagonal_m = 0.0;
  double line_weight = 1.0;
  double share = 0.0;                   // of the points that may go in this pass
  bool looks_matter = false;            // there are seams or several materials
  bool loose = false;                   // the link condition is waived
  bool keeps_twins = false;             // both of two equal faces stay
  bool last_resort = false;             // a corner may lose its last face
  std::vector<std::uint32_t> stamps;    // per point
  std::vector<std::uint32_t> last_key;  // per point: key of the last record that touched it
};

// Works on the points of one region only, as long as no edge has an outer end; regions are disjoint, so several may
// run at once.
class Collapser {
 public:
  // `region` is the number of that region.
  Collapser(PassState& state, PassLog& log, std::uint32_t region)
      : state_(state), log_(log), region_(region), wedges_(state.mesh, state.options, state.diagonal_m) {}

  // `key` orders the record in the log; a later record that depends on it gets at least the same key.
  Refusal attempt(std::uint32_t u, std::uint32_t v, std::uint32_t key, double cost_limit);

  // Of the last edge that was refused for its cost; infinite if it will never do.
  [[nodiscard]] double cost() const noexcept { return cost_; }

 private:
  [[nodiscard]] Refusal check_topology();
  [[nodiscard]] bool link_holds();
  [[nodiscard]] bool apexes_stay();
  void find_twins();
  [[nodiscard]] bool groups_stay();
  // An edge at u or v with the first two of its faces.
  struct Spoke {
    std::uint32_t from, to, faces;
    glm::dvec3 direction;
    const StarFace* first;
    const StarFace* second;
  };
  // A point that loses its last face, and the square of twice that face's area.
  struct Lost {
    std::uint32_t point;
    glm::dvec3 at;
    double weight;
  };
  void find_lines();
  void add_spoke(std::uint32_t from, std::uint32_t to, const glm::dvec3& direction, const StarFace& face);
  [[nodiscard]] bool looks_differ(const Spoke& spoke) const;
  [[nodiscard]] bool edge_is_sharp() const;
  [[nodiscard]] Refusal choose_ends();
  [[nodiscard]] Refusal choose_place();
  [[nodiscard]] bool try_place(const glm::dvec3& y);
  void commit(std::uint32_t key);
  [[nodiscard]] float error_m(double cost) const;

  PassState& state_;
  PassLog& log_;
  std::uint32_t region_;
  Wedges wedges_;
  Star star_;
  std::vector<Spoke> spokes_;
  std::vector<Lost> lost_;
  std::vector<FaceId> going_;  // faces, if groups are to keep some
  StarQuadric quadric_;
  StarQuadric turns_;  // steer and set the price, but are no distance
  HeldPlanes held_;
  bool u_fixed_ = false, v_fixed_ = false;  // may neither go nor move
  bool u_may_go_ = false, v_may_go_ = false;
  Choice choice_;
  double cost_limit_ = 0.0;
  float error_m_ = 0.0F;
  double cost_ = 0.0;
  std::uint32_t stamp_ = 0;
};

}  // namespace lodestone::collapse

// SPDX-License-Identifier: MIT
// What a set of moves costs, and whether it may be done.
#pragma once

#include <utility>

#include "facets/facet_mesh.h"
#include "facets/pieces.h"

namespace lodestone::facets {

// Costs are integrals of squared distance over area, m^4: what adds up to the mean square error.
struct Verdict {
  bool allowed = false;
  bool tilts = false;  // some face leaves its direction
  double cost = 0.0;
  double error_m = 0.0;
  std::uint32_t faces_gone = 0;

  // The price per face, by which everything is ordered.
  [[nodiscard]] double key() const noexcept { return cost / (faces_gone == 0 ? 1 : faces_gone); }
};

// Judges slides of a point onto its neighbours. Looks at borders and at the outlines of materials as well.
class SlideJudge {
 public:
  SlideJudge(const FacetMesh& mesh, const Pieces& pieces) : mesh_(mesh), pieces_(pieces) {}

  // An edge at the point.
  struct Spoke {
    std::uint32_t to = none;
    std::uint32_t faces = 0;
    MaterialId material = none;
    MaterialId other = none;  // where two materials meet
    bool mixed = false;
    bool border = true;    // all faces lie on one side of it: one face, or sheets that lie on each other
    glm::dvec3 side{0.0};  // from the edge into the first face, unit
  };

  void look_at(std::uint32_t point);
  // Of the point that was looked at last, ascending by `to`; until the mesh changes.
  [[nodiscard]] const std::vector<Spoke>& spokes() const noexcept { return spokes_; }
  // Not allowed if it costs more than `most_cost`.
  [[nodiscard]] Verdict judge(std::uint32_t onto, double most_cost);

 private:
  // A face around the point with what does not depend on where that goes.
  struct SlidingFace {
    const Face* face = nullptr;
    std::uint32_t a = none, b = none;  // the next two corners
    glm::dvec3 at_a{0.0}, at_b{0.0};
    glm::dvec3 before{0.0};  // twice the area long
    double length_before = 0.0, length_after = 0.0;
    MaterialId material = none;
    std::size_t outline = 0;   // which of outlines_ it is of
    bool tall_before = false;  // has a direction worth keeping
    bool detail = false;
  };
  void join_spokes();
  [[nodiscard]] bool judge_face(SlidingFace& s, const glm::dvec3& to, double deviation_m, Verdict& verdict);
  [[nodiscard]] std::size_t outline_of(const SlidingFace& s);
  void judge_lines(std::uint32_t v, Verdict& verdict) const;
  [[nodiscard]] bool pinches(std::uint32_t v) const;
  [[nodiscard]] bool goes_the_wrong_way(bool border) const;
  [[nodiscard]] bool link_holds(std::uint32_t v);

  const FacetMesh& mesh_;
  const Pieces& pieces_;
  double ratio_ = 1.0;  // of the piece around the point
  std::uint32_t point_ = none;
  glm::dvec3 from_{0.0};
  std::vector<SlidingFace> faces_;
  std::vector<Spoke> spokes_;
  std::vector<std::pair<std::uint32_t, MaterialId>> outlines_;  // surfaces and materials around the point
  std::vector<double> shown_m2_;                                // of each, gained by the slide
  std::vector<std::uint32_t> others_;                           // neighbours of the other end
  bool lines_ = false;                                          // some spoke is a border or mixed
  bool complex_ = false;                                        // some spoke has three faces or more
};

// Planes move: whatever stands between them and their new place shrinks.
[[nodiscard]] Verdict judge_shift(const FacetMesh& mesh, Moved& moved, std::span<const Move> moves);

}  // namespace lodestone::facets

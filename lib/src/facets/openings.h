// SPDX-License-Identifier: MIT
// Windows and doors: holes in a wall with what stands in them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "facets/patch.h"
#include "facets/point_cells.h"
#include "facets/walls.h"

namespace lodestone::facets {

// What is done with an opening, and its price.
struct OpeningJob {
  enum class Kind : std::uint8_t { Recess, Flatten, Fill };
  Kind kind = Kind::Fill;
  Patch patch;
  double cost = 0.0;  // integral of squared distance
  double error_m = 0.0;

  [[nodiscard]] double key() const noexcept {
    return cost / static_cast<double>(std::max<std::size_t>(patch.gone.size(), 1));
  }
};

// Remembers what each opening cost when it was looked at last, and looks again only where something has changed.
class Openings {
 public:
  // A closed model is to stay closed.
  Openings(const FacetMesh& mesh, bool closed);

  // To be called when the mesh has changed.
  void update();
  // Small ones first.
  [[nodiscard]] std::vector<Opening> all() const { return walls_.openings(); }
  // What stands in it comes forward as a pane, or the wall closes over what is flush; empty if neither can be done at
  // that price.
  [[nodiscard]] std::optional<OpeningJob> job(const Opening& opening, double price, double most_error_m);

 private:
  struct Known {
    std::uint64_t state = 0;  // of the outline and of what is near
    double key = 0.0;
    std::uint64_t content = 0;  // state of what stands in it
    double pane_key = 0.0;      // of a pane made of that
    bool has_come = false;      // a pane, into its plane, though that saved no face
  };
  [[nodiscard]] std::optional<OpeningJob> flatten(const Opening& opening, double price, Known& known);
  [[nodiscard]] std::optional<OpeningJob> pane_of(const Opening& opening, const glm::dvec3& normal,
                                                  const std::vector<FaceId>& content, double depth_m, double price,
                                                  double& least_key) const;
  [[nodiscard]] std::optional<OpeningJob> recess(const Opening& opening, const glm::dvec3& normal,
                                                 const std::vector<FaceId>& content, double price,
                                                 double& least_key) const;
  [[nodiscard]] FloatBox box_of(const Opening& opening) const;

  const FacetMesh& mesh_;
  bool closed_;
  Walls walls_;
  PointCells cells_;
  std::map<std::vector<std::uint32_t>, Known> known_;  // by outline
  std::vector<std::uint32_t> looked_at_;               // per face
  std::vector<std::uint32_t> stood_in_;                // per face: the last opening looked at that it stood in
  struct Asked {
    std::uint32_t look = 0;
    bool stands_in = false;
  };
  std::vector<Asked> asked_;  // per point
  std::uint32_t look_ = 0;
};

}  // namespace lodestone::facets

// SPDX-License-Identifier: MIT
// Windows and doors: holes in a wall with what stands in them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "facets/patch.h"
#include "geometry/bvh.h"

namespace lodestone::facets {

// A hole in the faces of one plane and one material.
struct Opening {
  std::vector<std::uint32_t> loop;  // points, the wall to the left
  FaceId wall = none;               // one of the faces around
  double area_m2 = 0.0;
  double perimeter_m = 0.0;
};

[[nodiscard]] std::vector<Opening> find_openings(const FacetMesh& mesh);

// What is done with an opening, and its price.
struct OpeningJob {
  Patch patch;
  double cost = 0.0;  // integral of squared distance
  double error_m = 0.0;

  [[nodiscard]] double key() const noexcept {
    return cost / static_cast<double>(std::max<std::size_t>(patch.gone.size(), 1));
  }
};

// What stands in the opening becomes one pane in the plane of the wall, drawn between the corners of the hole: the pane
// comes forward and hides the rest. Empty if the opening is not covered, if something holds it from outside, or if it
// is flush.
class Niches {
 public:
  // A closed model is to stay closed.
  Niches(const FacetMesh& mesh, bool closed);
  [[nodiscard]] std::optional<OpeningJob> flatten(const Opening& opening) const;

 private:
  const FacetMesh& mesh_;
  bool closed_;
  std::vector<FaceId> face_of_;  // of the tree's faces
  TriangleBvh tree_;
};

// The wall closes over an opening that is flush or has nothing in it. Empty if something hangs on its outline.
[[nodiscard]] std::optional<OpeningJob> fill(const FacetMesh& mesh, const Opening& opening);

}  // namespace lodestone::facets

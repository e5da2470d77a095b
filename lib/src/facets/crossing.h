// SPDX-License-Identifier: MIT
// Whether surfaces would pass through each other.
#pragma once

#include <vector>

#include "facets/face_index.h"
#include "facets/facet_mesh.h"
#include "facets/parts.h"

namespace lodestone::facets {

// Finds moves that make two faces of one part pass through each other that do not do so now. Parts may: bars run
// through sills.
class CrossingFinder {
 public:
  CrossingFinder(const FacetMesh& mesh, const PartFinder& parts);

  // To be called when the parts were found anew, and for faces that moved or went since.
  void start();
  void update(const std::vector<FaceId>& faces);
  [[nodiscard]] bool makes_crossing(const Moved& moved) const;

 private:
  const FacetMesh& mesh_;
  const PartFinder& parts_;
  FaceIndex index_;  // of the faces of large parts; small ones are walked through
};

}  // namespace lodestone::facets

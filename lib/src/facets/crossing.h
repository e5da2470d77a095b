// SPDX-License-Identifier: MIT
// Whether surfaces would pass through each other.
#pragma once

#include <optional>
#include <vector>

#include "facets/face_index.h"
#include "facets/facet_mesh.h"
#include "facets/float_box.h"
#include "facets/parts.h"

namespace lodestone::facets {

// Finds moves that make two faces of one part pass through each other that do not do so now. Parts may: bars run
// through sills.
class CrossingFinder {
 public:
  CrossingFinder(const FacetMesh& mesh, const PartFinder& parts);

  // To be called for faces that moved or went, and when the parts were found anew.
  void update(const std::vector<FaceId>& faces);
  void start();
  [[nodiscard]] bool makes_crossing(const Moved& moved) const;

 private:
  const FacetMesh& mesh_;
  const PartFinder& parts_;
  FaceIndex index_;                     // of the faces of large parts; small ones are walked through
  std::optional<std::uint64_t> edits_;  // there had been at the last start
  void measure(FaceId f);
  std::vector<FloatBox> boxes_;  // per face; of dead ones empty
};

}  // namespace lodestone::facets

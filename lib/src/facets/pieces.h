// SPDX-License-Identifier: MIT
// What hung together in the source, and how much is left of it.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

// Slides take of a lamp or a railing bit by bit, each for little; what is left stands for all of it. So it costs as
// much to go as if it were whole, and more and more to take of it.
class Pieces {
 public:
  explicit Pieces(const FacetMesh& mesh);

  // To be called before each price.
  void weigh();
  // What of the source a face stands for, beside its own area; at least 1.
  [[nodiscard]] double ratio(FaceId f) const {
    const std::uint32_t piece = piece_of_[f];
    return left_m2_[piece] > 0.0 ? std::max(1.0, whole_m2_[piece] / left_m2_[piece]) : 1.0;
  }
  // To be called for faces that go as a whole: what they lie upon stands for them from now on.
  void hand_on(std::span<const FaceId> faces, std::span<const std::uint32_t> support);

 private:
  const FacetMesh& mesh_;
  std::vector<std::uint32_t> piece_of_;  // per face
  std::vector<double> whole_m2_;         // per piece: that it stands for
  std::vector<double> left_m2_;
};

}  // namespace lodestone::facets

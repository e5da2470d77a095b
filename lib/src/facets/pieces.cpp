// SPDX-License-Identifier: MIT
#include "facets/pieces.h"

#include "facets/parts.h"

namespace lodestone::facets {

Pieces::Pieces(const FacetMesh& mesh) : mesh_(mesh) {
  left_m2_.resize(split_by_points(mesh, piece_of_));
  weigh();
  whole_m2_ = left_m2_;
}

void Pieces::weigh() {
  std::fill(left_m2_.begin(), left_m2_.end(), 0.0);
  for (FaceId f = 0; f < piece_of_.size(); ++f) {
    if (mesh_.faces[f].live) left_m2_[piece_of_[f]] += mesh_.area_m2(mesh_.faces[f]);
  }
}

void Pieces::hand_on(std::span<const FaceId> faces, std::span<const std::uint32_t> support) {
  double gone_m2 = 0.0;
  for (const FaceId f : faces) {
    const std::uint32_t piece = piece_of_[f];
    if (left_m2_[piece] <= 0.0) continue;
    const double own_m2 = std::min(mesh_.area_m2(mesh_.faces[f]), left_m2_[piece]);
    const double share_m2 = whole_m2_[piece] * own_m2 / left_m2_[piece];
    gone_m2 += share_m2;
    whole_m2_[piece] -= share_m2;
    left_m2_[piece] -= own_m2;
  }
  for (const std::uint32_t p : support) {
    whole_m2_[piece_of_[mesh_.faces_of[p].front()]] += gone_m2 / static_cast<double>(support.size());
  }
}

}  // namespace lodestone::facets

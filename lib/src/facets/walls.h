// SPDX-License-Identifier: MIT
// Walls: faces of one plane and material that hang together by edges, and the holes in them. Kept up to date while the
// mesh changes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

// A hole in a wall, or a notch in its lower side.
struct Opening {
  std::vector<std::uint32_t> loop;  // points, the wall to the left; but beside a notch's last side there is none
  bool is_notch = false;
  FaceId wall = none;  // one of the faces around
  double area_m2 = 0.0;
  double perimeter_m = 0.0;

  // As wide as a square of its area and outline.
  [[nodiscard]] double size_m() const noexcept { return 2.0 * area_m2 / perimeter_m; }
};

class Walls {
 public:
  explicit Walls(const FacetMesh& mesh);

  // Finds the walls anew where faces have changed since the last call; returns these faces, dead ones too.
  const std::vector<FaceId>& update();
  // Small ones first.
  [[nodiscard]] std::vector<Opening> openings() const;

 private:
  struct Wall {
    std::vector<FaceId> faces;
    std::vector<Opening> openings;
  };
  void dissolve(std::uint32_t wall, std::vector<FaceId>& loose);
  [[nodiscard]] bool joined(FaceId f, FaceId g) const;
  void grow(FaceId seed, std::vector<FaceId>& loose);
  void find_openings(Wall& wall) const;

  const FacetMesh& mesh_;
  std::vector<Wall> walls_;              // dissolved ones are empty
  std::vector<std::uint32_t> wall_of_;   // per face
  std::vector<std::uint64_t> state_;     // per face at the last update, 0 if dead
  std::vector<std::uint8_t> is_sliver_;  // the same
  std::vector<FaceId> changed_;
  std::optional<std::uint64_t> edits_;  // there had been at the last update
};

}  // namespace lodestone::facets

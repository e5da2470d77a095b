// SPDX-License-Identifier: MIT
// Planes that no picture of the building shows: backs of bars before their glass, reveals behind a pane that came
// forward, what stands behind a wall that closed.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "facets/face_groups.h"
#include "facets/scraps.h"
#include "facets/surroundings.h"

namespace lodestone::facets {

// What is seen belongs to what is judged elsewhere; what is not has no look, only a distance, and may go although it
// shares its edges with what stays. Not for closed models, which it would open.
class HiddenFinder {
 public:
  explicit HiddenFinder(const FacetMesh& mesh) : mesh_(mesh), around_(mesh), group_of_(mesh.faces.size(), none) {}

  // Single faces that cost at most `price`, the cheapest first; their support is seen. Looks only where two fifths of
  // the faces has gone since it looked last, and only at what is small enough for its pictures. Never where most of it
  // is hidden: then rooms lie behind the walls, and what closes the windows of a wall hangs on its inner side.
  [[nodiscard]] std::vector<Scrap> find(double price);

 private:
  [[nodiscard]] bool look();
  void spread(std::vector<std::uint8_t>& seen) const;
  [[nodiscard]] std::optional<Scrap> measure(FaceId f, double price) const;

  const FacetMesh& mesh_;
  Surroundings around_;
  std::vector<std::uint32_t> group_of_;  // per face; none if it is gone
  FaceGroups groups_;                    // seen and hidden
  std::vector<FaceId> live_;
  bool furnished_ = false;
  double looked_at_ = std::numeric_limits<double>::infinity();  // so many faces, the last time
};

}  // namespace lodestone::facets

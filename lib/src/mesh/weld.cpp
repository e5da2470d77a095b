// SPDX-License-Identifier: MIT
#include "mesh/weld.h"

#include <utility>

#include "base/hash.h"

namespace lodestone {

Weld weld_by_position(std::span<const glm::vec3> positions) {
  UniqueIds unique = unique_ids(
      static_cast<std::uint32_t>(positions.size()), [&](std::uint32_t i) { return position_hash(positions[i]); },
      [&](std::uint32_t i, std::uint32_t j) { return same_position(positions[i], positions[j]); });
  return {.point_of = std::move(unique.id_of), .first_vertex = std::move(unique.first)};
}

}  // namespace lodestone

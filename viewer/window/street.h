// SPDX-License-Identifier: MIT
// A street of generated houses, every house a model by facet shift. No GL here.
#pragma once

#include <memory>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/progressive_model.h>
#include <lodestone/view.h>

namespace lodestone::render {

/// Runs north from the origin; metres, Z up.
struct Street {
  struct House {
    std::shared_ptr<const ProgressiveModel> model;  ///< shared by houses that are alike
    glm::dvec3 offset_m{0.0};                       ///< where its origin lies in the street
  };
  std::vector<House> houses;  ///< from near to far
  Mesh ground;                ///< roadway, pavements and lawns
  Box bounds;
};

struct StreetOptions {
  unsigned house_count = 24;
  std::uint32_t house_triangles = 12'000;  ///< of each
};

/// Houses of every roof in two rows, their fronts to the roadway. Eight models at most are built, about 0.5 s each.
[[nodiscard]] Result<std::shared_ptr<const Street>> make_street(const StreetOptions& options = {},
                                                                const Context& context = {});

/// Where one stands who sees the street coarsen: before its near end, looking along it.
struct Standpoint {
  glm::dvec3 eye{0.0};
  glm::dvec3 target{0.0};
};
[[nodiscard]] Standpoint near_end(const Street& street);

/// A camera that flies along the roadway as far as there are houses to see ahead and, looking ahead all the while,
/// back: there at 0.5 turns, back at 1.
[[nodiscard]] View along_street(const Street& street, double turns, std::uint32_t width_px, std::uint32_t height_px);

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
// How different the materials of a building look, and what it costs to show one in place of another.
#pragma once

#include <vector>

#include <lodestone/mesh.h>

namespace lodestone::facets {

class Looks {
 public:
  Looks() = default;
  // `texture_colors`: sRGB, may be empty.
  Looks(const Surroundings& source, const std::vector<glm::vec3>& texture_colors);

  // Mean squared difference of the colours, 0..1.
  [[nodiscard]] double contrast(MaterialId a, MaterialId b) const noexcept;
  // Of an area that shows what is not known instead of a.
  [[nodiscard]] double cost_of_hole(double area_m2) const noexcept;
  // Of an area that shows b where it showed a, m^4: comparable with integrals of squared distance.
  [[nodiscard]] double cost(MaterialId a, MaterialId b, double area_m2) const noexcept;

 private:
  std::vector<glm::dvec3> color_;  // sRGB, 0..1; of glass, before a dark room
};

}  // namespace lodestone::facets

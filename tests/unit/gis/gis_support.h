// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "reader.h"

namespace lodestone::test {

inline Input input_of(std::string_view text, std::string name) {
  return Input::from_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, std::move(name));
}

inline const Feature* feature_of(const Mesh& mesh, std::string_view semantic_class) {
  const auto found = std::find_if(mesh.features.begin(), mesh.features.end(),
                                  [&](const Feature& f) { return f.semantic_class == semantic_class; });
  return found == mesh.features.end() ? nullptr : &*found;
}

inline double area_m2(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto& p = mesh.vertices.positions;
    const glm::dvec3 a{p[mesh.indices[i]]};
    const glm::dvec3 b{p[mesh.indices[i + 1]]};
    const glm::dvec3 c{p[mesh.indices[i + 2]]};
    sum += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return sum;
}

inline bool warned(const std::vector<Warning>& warnings, std::string_view text) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const Warning& w) { return w.message.find(text) != std::string::npos; });
}

}  // namespace lodestone::test

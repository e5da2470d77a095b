// SPDX-License-Identifier: MIT
// Reading meshes from text that stands in the test.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <string>
#include <string_view>

#include "reader.h"

namespace lodestone::test {

inline Result<LoadedMesh> read_text(std::string_view text, const std::string& name, const ReadOptions& options = {},
                                    const std::filesystem::path& folder = {}) {
  const std::span bytes{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  return read_input(Input::from_bytes(bytes, name, folder), options, {});
}

inline bool warned(const Result<LoadedMesh>& result, std::string_view words) {
  return std::any_of(result.warnings().begin(), result.warnings().end(),
                     [&](const Warning& w) { return w.message.find(words) != std::string::npos; });
}

inline void write_text(const std::filesystem::path& file, std::string_view text) {
  std::ofstream{file, std::ios::binary}.write(text.data(), static_cast<std::streamsize>(text.size()));
}

// The triangle's corners in the world.
inline glm::dvec3 corner(const Mesh& mesh, std::size_t face, std::size_t c) {
  return mesh.origin + glm::dvec3{mesh.vertices.positions[mesh.indices[3 * face + c]]};
}

inline double area(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t f = 0; f < mesh.triangle_count(); ++f) {
    sum +=
        0.5 * glm::length(glm::cross(corner(mesh, f, 1) - corner(mesh, f, 0), corner(mesh, f, 2) - corner(mesh, f, 0)));
  }
  return sum;
}

}  // namespace lodestone::test

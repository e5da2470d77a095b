// SPDX-License-Identifier: MIT
// What the comments at the head of an OBJ or PLY file say about axes and place.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "reader.h"

namespace lodestone {

struct HeaderComments {
  std::optional<glm::dvec3> offset;  // "offset subtracted: X Y Z": add it to get the world
  std::optional<glm::dvec3> origin;  // "origin: X Y Z": coordinates are the world's; keep floats relative to this
  std::string crs;                   // "EPSG:25832"
  UpAxis up = UpAxis::Z;             // "Y up", "Z-up"

  void read(std::string_view comment);
  // Puts a mesh whose vertices are relative to `at` in the file's coordinates where it stands in the world.
  void place(Mesh& mesh, const glm::dvec3& at) const;
};

// The comments that make HeaderComments::read find a mesh's place again, one a line, each after `prefix`.
[[nodiscard]] std::string place_comments(const Mesh& mesh, std::string_view prefix);

}  // namespace lodestone

// SPDX-License-Identifier: MIT
// The one place where axes, units and the place of the origin are converted. Inside, Z is up and a unit is a metre.
#pragma once

#include <glm/glm.hpp>

#include <lodestone/formats.h>

namespace lodestone {

// What a reader returns: `mesh`, which still has the file's axes and units, turned and scaled, and what they were.
// `file_up` and `file_unit_m` are what the format or the file states; `options` may overrule them.
[[nodiscard]] LoadedMesh to_lodestone_axes(Mesh mesh, std::string format, UpAxis file_up, double file_unit_m,
                                           const ReadOptions& options);

// Y up to Z up and back: a quarter turn about X, exact in every bit.
template <class Vector>
[[nodiscard]] constexpr Vector y_up_to_z_up(const Vector& v) noexcept {
  return Vector{v.x, -v.z, v.y};
}
template <class Vector>
[[nodiscard]] constexpr Vector z_up_to_y_up(const Vector& v) noexcept {
  return Vector{v.x, v.z, -v.y};
}

// uv origin top-left (glTF, 3D Tiles) to bottom-left and back.
[[nodiscard]] constexpr glm::vec2 flip_v(const glm::vec2& uv) noexcept { return {uv.x, 1.0F - uv.y}; }

// The origin for a mesh in `bounds` so that floats relative to it keep 0.1 mm: zero while coordinates stay within 10
// km, else the centre rounded to whole hundreds (per axis).
[[nodiscard]] glm::dvec3 choose_origin(const Box& bounds) noexcept;

}  // namespace lodestone

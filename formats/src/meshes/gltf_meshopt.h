// SPDX-License-Identifier: MIT
// Vertex and index data as EXT_meshopt_compression has them, both ways. gltf_meshopt.cpp is the only file that names
// libmeshoptimizer.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include <lodestone/mesh.h>
#include <lodestone/result.h>

namespace lodestone {

// A GLB without EXT_meshopt_compression: views that were packed lie unpacked in its binary chunk, and the extension is
// named no more. One that has none, or is no GLB, comes back as it is. Errors: BadData, Unsupported for views packed in
// other files, TooLarge; `name` is where. The file's JSON must not nest too deeply.
[[nodiscard]] Result<std::vector<std::uint8_t>> without_meshopt(std::vector<std::uint8_t> file,
                                                                const std::string& name);

namespace packing {

using Bytes = std::vector<std::uint8_t>;

// A value on the grid of whole multiples of 2^exponent, no farther than half a step away if it is below 2^23 steps.
// Every client decodes it to just this float: places that are equal stay equal.
[[nodiscard]] float on_grid(float value, int exponent) noexcept;

// Each value on_grid(); `components` values make a vertex.
[[nodiscard]] Bytes pack_floats(std::span<const float> values, std::size_t components, int exponent);
// Unit vectors, 4 bytes each before they are packed: glTF's normalised BYTE in steps of four.
[[nodiscard]] Bytes pack_normals(std::span<const glm::vec3> normals);
// As they are. Precondition: `stride` is a multiple of 4, at most 256.
[[nodiscard]] Bytes pack_raw(std::span<const std::uint8_t> raw, std::size_t stride);
// A triangle may come out beginning with another of its corners.
[[nodiscard]] Bytes pack_triangles(std::span<const std::uint32_t> indices);

// The same mesh with its faces, material by material, and its vertices in an order that packs well and draws fast.
// `of_vertex`, if it is not empty, follows the vertices. Vertices of no face go.
[[nodiscard]] Mesh in_packing_order(const Mesh& mesh, std::vector<std::uint32_t>& of_vertex);

// What the extension says of a buffer view.
struct View {
  std::uint64_t count = 0;
  std::uint64_t stride = 0;
  std::string mode;
  std::string filter;
};
// Empty if the view or its data make no sense. The caller sees to it that count x stride is no unheard-of size.
[[nodiscard]] Bytes unpack(std::span<const std::uint8_t> packed, const View& view);

}  // namespace packing
}  // namespace lodestone

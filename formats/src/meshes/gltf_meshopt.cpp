// SPDX-License-Identifier: MIT
// Based on: EXT_meshopt_compression, a vendor extension of glTF 2.0.
// Differs: the exponent of the exponential filter is the caller's, one for all vertices of all files, so that what two
// tiles share decodes to the same bits in both.
#include "gltf_meshopt.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

namespace lodestone::packing {
namespace {

constexpr double most_steps = 8'388'607.0;  // a mantissa has 24 bits

double steps_of(float value, int exponent) noexcept {
  return std::clamp(std::round(std::ldexp(static_cast<double>(value), -exponent)), -most_steps, most_steps);
}

Bytes encode_vertices(const void* data, std::size_t count, std::size_t stride) {
  Bytes out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), data, count, stride));
  return out;
}

// glTF knows indices of the second version only; the setting is the library's, for all threads.
void choose_index_version() {
  static const bool chosen = [] {
    meshopt_encodeIndexVersion(1);
    return true;
  }();
  static_cast<void>(chosen);
}

bool decode(std::span<const std::uint8_t> packed, const View& view, Bytes& out) {
  if (view.mode == "ATTRIBUTES") {
    if (view.stride % 4 != 0 || view.stride == 0 || view.stride > 256) return false;
    return meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, packed.data(), packed.size()) == 0;
  }
  if (view.stride != 2 && view.stride != 4) return false;
  if (view.mode == "TRIANGLES") {
    return view.count % 3 == 0 &&
           meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, packed.data(), packed.size()) == 0;
  }
  return view.mode == "INDICES" &&
         meshopt_decodeIndexSequence(out.data(), view.count, view.stride, packed.data(), packed.size()) == 0;
}

bool unfilter(const View& view, Bytes& out) {
  if (view.filter.empty() || view.filter == "NONE") return true;
  if (view.mode != "ATTRIBUTES") return false;
  if (view.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(out.data(), view.count, view.stride);
  } else if (view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) {
    meshopt_decodeFilterOct(out.data(), view.count, view.stride);
  } else if (view.filter == "QUATERNION" && view.stride == 8) {
    meshopt_decodeFilterQuat(out.data(), view.count, view.stride);
  } else {
    return false;
  }
  return true;
}

}  // namespace

float on_grid(float value, int exponent) noexcept {
  return static_cast<float>(std::ldexp(steps_of(value, exponent), exponent) + 0.0);  // no -0
}

Bytes pack_floats(std::span<const float> values, std::size_t components, int exponent) {
  std::vector<std::uint32_t> words;
  words.reserve(values.size());
  const std::uint32_t head = (static_cast<std::uint32_t>(exponent) & 0xFFU) << 24U;
  for (const float value : values) {
    words.push_back(head |
                    (static_cast<std::uint32_t>(static_cast<std::int32_t>(steps_of(value, exponent))) & 0xFFFFFFU));
  }
  return encode_vertices(words.data(), values.size() / components, components * sizeof(std::uint32_t));
}

Bytes pack_normals(std::span<const glm::vec3> normals) {
  std::vector<float> wide;
  wide.reserve(4 * normals.size());
  for (const glm::vec3& n : normals) wide.insert(wide.end(), {n.x, n.y, n.z, 1.0F});
  constexpr std::size_t stride = 4;
  Bytes octahedral(stride * normals.size());
  meshopt_encodeFilterOct(octahedral.data(), normals.size(), stride, 8, wide.data());
  return encode_vertices(octahedral.data(), normals.size(), stride);
}

Bytes pack_raw(std::span<const std::uint8_t> raw, std::size_t stride) {
  return encode_vertices(raw.data(), raw.size() / stride, stride);
}

Bytes pack_triangles(std::span<const std::uint32_t> indices) {
  choose_index_version();
  const std::uint32_t most = *std::max_element(indices.begin(), indices.end());
  Bytes out(meshopt_encodeIndexBufferBound(indices.size(), std::size_t{most} + 1));
  out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

Mesh in_packing_order(const Mesh& mesh, std::vector<std::uint32_t>& of_vertex) {
  std::vector<std::vector<VertexId>> corners(mesh.materials.size());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const VertexId* v = &mesh.indices[3 * std::size_t{f}];
    corners[mesh.face_material(f)].insert(corners[mesh.face_material(f)].end(), v, v + 3);
  }
  Mesh out;
  static_cast<Surroundings&>(out) = mesh;
  for (std::size_t m = 0; m < corners.size(); ++m) {
    std::vector<VertexId>& own = corners[m];
    if (own.empty()) continue;
    meshopt_optimizeVertexCacheStrip(own.data(), own.data(), own.size(), mesh.vertex_count());
    out.indices.insert(out.indices.end(), own.begin(), own.end());
    out.face_materials.insert(out.face_materials.end(), own.size() / 3, static_cast<MaterialId>(m));
  }
  std::vector<VertexId> new_of_old(mesh.vertex_count());
  const std::size_t used =
      meshopt_optimizeVertexFetchRemap(new_of_old.data(), out.indices.data(), out.indices.size(), mesh.vertex_count());
  for (VertexId& v : out.indices) v = new_of_old[v];
  const auto reorder = [&](auto& to, const auto& from) {
    if (from.empty()) return;
    to.resize(used);
    for (std::size_t v = 0; v < from.size(); ++v) {
      if (new_of_old[v] != none) to[new_of_old[v]] = from[v];
    }
  };
  reorder(out.vertices.positions, mesh.vertices.positions);
  reorder(out.vertices.normals, mesh.vertices.normals);
  reorder(out.vertices.uvs, mesh.vertices.uvs);
  reorder(out.vertices.colors, mesh.vertices.colors);
  const std::vector<std::uint32_t> before = std::move(of_vertex);
  of_vertex.clear();
  reorder(of_vertex, before);
  return out;
}

Bytes unpack(std::span<const std::uint8_t> packed, const View& view) {
  if (view.count == 0) return {};
  Bytes out(view.count * view.stride);
  if (!decode(packed, view, out) || !unfilter(view, out)) return {};
  return out;
}

}  // namespace lodestone::packing

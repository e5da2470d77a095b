// SPDX-License-Identifier: MIT
#include "meshes/writers.h"
#include "terrain_pyramid/outputs.h"

namespace lodestone {
namespace {

// A strip that hangs down from a border; each quad turned outwards.
void add_skirt(Mesh& mesh, const std::vector<std::uint32_t>& border, bool reversed, double depth_m) {
  const auto first = mesh.vertex_count();
  for (const std::uint32_t i : border) {
    const glm::dvec3 up = glm::normalize(mesh.origin + glm::dvec3{mesh.vertices.positions[i]});
    mesh.vertices.positions.push_back(mesh.vertices.positions[i] - glm::vec3{up * depth_m});
    mesh.vertices.normals.push_back(mesh.vertices.normals[i]);
  }
  for (std::uint32_t k = 0; k + 1 < border.size(); ++k) {
    std::uint32_t a = border[k], b = border[k + 1], c = first + k + 1, d = first + k;
    if (reversed) {
      std::swap(a, b);
      std::swap(c, d);
    }
    mesh.indices.insert(mesh.indices.end(), {a, d, c, a, c, b});
  }
}

// The border's vertices may have gaps where there is no data; a skirt only where all of it is there.
bool whole(const std::vector<std::uint32_t>& border, const std::vector<std::uint16_t>& along) {
  return border.size() >= 2 && along[border.front()] == 0 && along[border.back()] == quantized_max;
}

}  // namespace

double skirt_depth_m(const TerrainPyramid& pyramid, std::uint32_t zoom) {
  return 3.0 * pyramid.tolerance_m(zoom) + pyramid.height_step_m(zoom);
}

Status write_tile_glb(const TerrainTile& tile, double skirt_m, const std::filesystem::path& file,
                      const Context& context) {
  const std::vector<glm::dvec3> places_m = ecef_positions_m(tile);
  Mesh mesh;
  Box box;
  for (const glm::dvec3& place_m : places_m) box.add(place_m);
  mesh.origin = box.center();
  for (const glm::dvec3& place_m : places_m) mesh.vertices.positions.emplace_back(place_m - mesh.origin);
  mesh.vertices.normals = tile.normals;
  mesh.indices = tile.triangles;
  mesh.materials.push_back({.name = "terrain", .base_color = {0.72F, 0.70F, 0.64F, 1.0F}, .double_sided = false});
  if (whole(tile.west, tile.v)) add_skirt(mesh, tile.west, true, skirt_m);
  if (whole(tile.south, tile.u)) add_skirt(mesh, tile.south, false, skirt_m);
  if (whole(tile.east, tile.v)) add_skirt(mesh, tile.east, false, skirt_m);
  if (whole(tile.north, tile.u)) add_skirt(mesh, tile.north, true, skirt_m);
  return write_glb(mesh, file, context);
}

}  // namespace lodestone

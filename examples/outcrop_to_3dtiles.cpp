// SPDX-License-Identifier: MIT
// An outcrop becomes a folder of 3D Tiles that CesiumJS and 3DTilesRendererJS open.
//
//     outcrop_to_3dtiles cliff_tiles                 a generated cliff
//     outcrop_to_3dtiles cliff_tiles cliff.obj       one of your own
#include <cstdio>
#include <string>

#include <lodestone/formats.h>
#include <lodestone/generate.h>
#include <lodestone/tileset_writer.h>

namespace {

lodestone::Result<lodestone::Mesh> read_or_generate(const char* file) {
  if (file == nullptr) {
    return lodestone::generate_outcrop({.triangles = 20'000, .textures = 3, .texture_size_px = 512, .charts = 6});
  }
  // Paths only: photographs are decoded one at a time, when their tiles are made.
  auto loaded = lodestone::read_mesh(file, {.textures = lodestone::LoadTextures::Reference});
  if (!loaded) return loaded.error();
  return std::move(loaded->mesh);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: outcrop_to_3dtiles FOLDER [MESH]\n");
    return 1;
  }
  auto mesh = read_or_generate(argc > 2 ? argv[2] : nullptr);
  if (!mesh) {
    std::fprintf(stderr, "%s\n", lodestone::to_line(mesh.error()).c_str());
    return 2;
  }
  std::printf("%u triangles in the source\n", mesh->triangle_count());
  const auto written = lodestone::write_outcrop(std::move(*mesh), argv[1], {.pyramid = {.tile_bytes = 60'000}});
  if (!written) {
    std::fprintf(stderr, "%s\n", lodestone::to_line(written.error()).c_str());
    return 2;
  }
  for (const lodestone::OutcropLevel& level : written->levels) {
    std::printf("%4u tiles, %7u triangles, up to %.3f m from the source\n", level.tiles, level.triangles,
                level.geometric_error_m);
  }
  std::printf("%s/tileset.json: %.1f MB\n", argv[1], 1e-6 * static_cast<double>(written->bytes));
  return 0;
}

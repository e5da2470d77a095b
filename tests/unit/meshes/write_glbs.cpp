// SPDX-License-Identifier: MIT
// Writes a GLB of every kind into a folder, for gltf-validator (gltf_validator.sh).
#include <cstdio>

#include <lodestone/discrete_levels.h>
#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>

#include "shapes.h"

using namespace lodestone;

namespace {

// Three levels of a textured model: a GLB each, and all in one with MSFT_lod.
Status write_plan(const Mesh& mesh, const std::filesystem::path& folder) {
  const auto built = build_by_edge_collapse(mesh);
  if (!built) return built.error();
  const ProgressiveModel& model = *built->model;
  LevelPlan plan{.last_m = 9000.0, .radius_m = 5.0, .focal_px = 1000.0, .height_px = 1024.0, .width_px = 1280.0};
  for (const Level level : {model.record_count(), model.record_count() / 2, Level{0}}) {
    const double from_m = 20.0 * static_cast<double>(plan.levels.size());
    plan.levels.push_back({from_m, level, model.info(level).triangles, model.error_m(level)});
  }
  return write_levels(model, plan, folder);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const std::filesystem::path folder{argv[1]};
  auto all = test::mesh_families();
  Mesh rich = test::seamed_grid(8, 8);
  compute_normals(rich);
  rich.origin = {678116.123, 5403773.5, 416.25};
  rich.crs = "EPSG:25832";
  for (std::uint32_t i = 0; i < rich.vertex_count(); ++i) rich.vertices.colors.emplace_back(i, 255 - i, 2 * i, 200);
  rich.materials[0].base_color = {0.25F, 0.5F, 1.0F, 0.5F};
  rich.materials[1].texture = 0;
  rich.materials[1].alpha_cutoff = 0.25F;
  Texture texture;
  texture.name = "stone";
  texture.image = std::make_shared<const Image>(Image{4, 4, 3, std::vector<std::uint8_t>(48, 99)});
  rich.textures.push_back(texture);
  all.push_back({"rich", rich});
  all.push_back({"large", test::grid(300, 300)});  // needs 32-bit indices
  rich.features = {{"house", "Building", none}, {"wall", "WallSurface", 0}, {"unused", {}, none}, {"", "Window", 1}};
  for (FaceId f = 0; f < rich.triangle_count(); ++f) rich.face_features.push_back(f % 4 == 2 ? none : f % 4);
  all.push_back({"features", rich});
  if (auto done = write_plan(rich, folder); !done) {
    std::fprintf(stderr, "levels: %s\n", to_line(done.error()).c_str());
    return 1;
  }
  int number = 0;
  for (const auto& [name, mesh] : all) {
    const auto file = folder / ("mesh" + std::to_string(number++) + ".glb");
    if (auto done = write_mesh(mesh, file); !done) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), to_line(done.error()).c_str());
      return 1;
    }
  }
  return 0;
}

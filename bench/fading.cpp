// SPDX-License-Identifier: MIT
// Figure 12 of Li et al. 2019: memory and time of loading and transforming at four stages, a continuous model beside
// the fading of two fixed levels.
//
//     bench_fading MODEL.lode FOLDER
//
// Ours loads the model once and moves a cursor from stage to stage. Fading loads the level of the next stage, a GLB
// written into FOLDER before, and holds and draws both levels while it blends. Geometry only on both sides; best of
// five. Prints one JSON object.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <lodestone/cursor.h>
#include <lodestone/formats.h>

namespace {

using namespace lodestone;

constexpr double stages[] = {1.0, 0.3, 0.1, 0.03};  // of the triangles: the original state and stages I to III
constexpr int runs = 5;

template <class Work>
double best_seconds(Work work) {
  double best = 1e30;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

std::size_t bytes_of(const Mesh& mesh) {
  const VertexArrays& v = mesh.vertices;
  return 12 * v.positions.size() + 12 * v.normals.size() + 8 * v.uvs.size() + 4 * v.colors.size() +
         4 * mesh.indices.size();
}

std::filesystem::path file_of(const char* folder, std::size_t stage) {
  return std::filesystem::path{folder} / ("stage_" + std::to_string(stage) + ".glb");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: bench_fading MODEL.lode FOLDER\n", stderr);
    return 1;
  }
  std::shared_ptr<const ProgressiveModel> model;
  const double load_s = best_seconds([&] {
    if (auto read = read_model(argv[1])) model = std::move(read).value();
  });
  if (!model) return 2;
  Cursor cursor{model};
  const auto level_of = [&](std::size_t stage) {
    return model->level_of_triangles(static_cast<std::uint32_t>(stages[stage] * model->triangle_count()));
  };
  for (std::size_t i = 0; i < std::size(stages); ++i) {
    Mesh mesh = model->extract(level_of(i));
    mesh.textures.clear();
    for (Material& material : mesh.materials) material.texture = none;
    if (!write_mesh(mesh, file_of(argv[2], i)).ok()) return 2;
  }
  std::printf("{\"model_load_s\": %.5f, \"stages\": [", load_s);
  std::size_t bytes_before = 0;
  std::uint32_t triangles_before = 0;
  for (std::size_t i = 0; i < std::size(stages); ++i) {
    const Level from = level_of(i == 0 ? 0 : i - 1);
    const double ours_s = best_seconds([&] {
                            cursor.jump(from);
                            cursor.jump(level_of(i));
                          }) -
                          best_seconds([&] { cursor.jump(from); });
    Mesh next;
    const double fading_s = best_seconds([&] {
      if (auto read = read_mesh(file_of(argv[2], i))) next = std::move(read->mesh);
    });
    const std::size_t bytes = bytes_of(next);
    std::printf("%s\n {\"ratio\": %.2f, \"ours\": {\"triangles\": %u, \"bytes\": %zu, \"seconds\": %.6f}, ",
                i == 0 ? "" : ",", stages[i], model->info(level_of(i)).triangles,
                model->memory_bytes() + cursor.memory_bytes(), i == 0 ? load_s : std::max(ours_s, 0.0));
    std::printf("\"fading\": {\"triangles\": %u, \"bytes\": %zu, \"seconds\": %.6f}}",
                triangles_before + next.triangle_count(), bytes_before + bytes, fading_s);
    bytes_before = bytes;
    triangles_before = next.triangle_count();
  }
  std::printf("]}\n");
  return 0;
}

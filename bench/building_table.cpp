// SPDX-License-Identifier: MIT
// Table 1 of Li et al. 2019 (docs/DECISIONS.md names it) with a generated building of the same size: time to simplify
// to three stages, time to restore from each, memory.
//
//     bench_building_table [TRIANGLES=499128]
//
// Prints one JSON object. Subset placement, as the paper's vertices do not move either. Stages are 1/4, 1/16 and 1/64
// of the triangles (the paper does not tell its own). Simplifying is the whole build, records included, on one thread;
// restoring is a cursor going from the stage to the source.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <lodestone/cursor.h>
#include <lodestone/edge_collapse.h>
#include <lodestone/generate.h>

#include "processor_clock.h"

namespace {

using namespace lodestone;

struct PaperStage {
  double simplify_s, restore_s;
};
constexpr PaperStage paper[] = {{0.51, 0.11}, {0.59, 0.13}, {0.64, 0.15}};
constexpr double paper_bytes = 22.68 * 1024 * 1024;

}  // namespace

int main(int argc, char** argv) {
  HouseOptions house;
  house.triangles = argc > 1 ? static_cast<std::uint32_t>(std::atoi(argv[1])) : 499'128;
  house.texture_size_px = 16;
  auto mesh = generate_house(house);
  if (!mesh) return std::fprintf(stderr, "%s\n", to_line(mesh.error()).c_str()), 2;
  Context one_thread;
  one_thread.max_workers = 1;
  std::printf("{\"triangles\": %u, \"vertices\": %u, \"stages\": [", mesh->triangle_count(), mesh->vertex_count());
  std::size_t bytes = 0;
  for (int stage = 1; stage <= 3; ++stage) {
    EdgeCollapseOptions options;
    options.target_triangles = mesh->triangle_count() >> (2 * stage);
    options.placement = Placement::Subset;
    double begin = thread_seconds();
    const auto built = build_by_edge_collapse(*mesh, options, one_thread);
    const double simplify_s = thread_seconds() - begin;
    if (!built) return std::fprintf(stderr, "%s\n", to_line(built.error()).c_str()), 2;
    CursorOptions hard;
    hard.motion = Motion::Hard;
    Cursor cursor{built->model, hard};
    double restore_s = 1e9;
    double coarsen_s = 1e9;
    for (int i = 0; i < 9; ++i) {
      begin = thread_seconds();
      cursor.jump(built->model->record_count());
      restore_s = std::min(restore_s, thread_seconds() - begin);
      begin = thread_seconds();
      cursor.jump(0);
      coarsen_s = std::min(coarsen_s, thread_seconds() - begin);
    }
    bytes = built->model->memory_bytes() + cursor.memory_bytes();
    const PaperStage& theirs = paper[stage - 1];
    std::printf(
        "%s{\"stage\": %d, \"triangles\": %u, \"simplify_seconds\": %.4f, \"paper_simplify_seconds\": %.2f, "
        "\"restore_seconds\": %.5f, \"coarsen_seconds\": %.5f, \"paper_restore_seconds\": %.2f, "
        "\"restore_ratio\": %.1f, \"bytes\": %zu}",
        stage > 1 ? ", " : "", stage, built->model->info(0).triangles, simplify_s, theirs.simplify_s, restore_s,
        coarsen_s, theirs.restore_s, theirs.restore_s / restore_s, bytes);
  }
  std::printf("], \"paper_bytes\": %.0f}\n", paper_bytes);
  return 0;
}

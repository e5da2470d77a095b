// SPDX-License-Identifier: MIT
// How fast a cursor plays a progressive model, and what it holds in memory.
//
//     bench_playback MESH [--ratio 0.1]
//
// Builds the stack of MESH down to the ratio twice, with subset and with optimal placement, and prints one JSON object:
// records/s of whole sweeps both ways, times of random seeks over 1 % of the stack, bytes per source vertex of model
// and cursor, and the time of one step of a morphing sweep (full to coarse in 300 frames). Rates are the best of the
// sweeps, in processor time of the thread, which a busy machine disturbs least.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <lodestone/cursor.h>
#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>

#include "processor_clock.h"

namespace {

using namespace lodestone;

template <class Work>
double seconds_of(Work&& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

struct Sweeps {
  double refine_per_second = 0.0;
  double coarsen_per_second = 0.0;
};

Sweeps time_sweeps(Cursor& cursor) {
  constexpr int sweeps = 15;
  const Level records = cursor.model().record_count();
  double refine_s = 1e9;
  double coarsen_s = 1e9;
  cursor.jump(0);
  for (int i = 0; i < sweeps; ++i) {
    refine_s = std::min(refine_s, seconds_of([&] { cursor.jump(records); }));
    coarsen_s = std::min(coarsen_s, seconds_of([&] { cursor.jump(0); }));
  }
  return {records / refine_s, records / coarsen_s};
}

// Random seeks of 1 % of the stack, up and down in turn, from random places.
std::vector<double> time_seeks(Cursor& cursor) {
  constexpr int seeks = 1000;
  const Level records = cursor.model().record_count();
  const Level stretch = std::max<Level>(records / 100, 1);
  std::mt19937 random{1};
  std::vector<double> times;
  for (int i = 0; i < seeks; ++i) {
    const auto low = static_cast<Level>(random() % (records - stretch + 1));
    const bool up = i % 2 == 0;
    cursor.jump(up ? low : low + stretch);
    times.push_back(seconds_of([&] { cursor.jump(up ? low + stretch : low); }));
  }
  return times;
}

std::vector<double> time_morph(Cursor& cursor) {
  constexpr Level frames = 300;
  constexpr double dt_s = 1.0 / 60.0;
  const Level records = cursor.model().record_count();
  cursor.jump(records);
  std::vector<double> times;
  for (Level frame = 0; frame <= frames; ++frame) {
    cursor.set_target(Target::level(static_cast<Level>(records - std::uint64_t{records} * frame / frames)));
    times.push_back(seconds_of([&] { cursor.step({}, dt_s); }));
    cursor.clear_dirty();
  }
  return times;
}

// One placement's figures as a JSON object.
void report(const std::shared_ptr<const ProgressiveModel>& model, const char* name) {
  const double vertices = model->vertex_slot_count();
  Cursor hard{model, {.motion = Motion::Hard}};
  const Sweeps sweeps = time_sweeps(hard);
  const std::vector<double> seeks = time_seeks(hard);
  Cursor gliding{model, {.motion = Motion::Morph}};
  const std::vector<double> steps = time_morph(gliding);
  const double model_bytes = static_cast<double>(model->memory_bytes()) / vertices;
  const double hard_bytes = static_cast<double>(hard.memory_bytes()) / vertices;
  const double morph_bytes = static_cast<double>(gliding.memory_bytes()) / vertices;
  std::size_t edits = 0;
  for (const std::uint8_t shape : model->data().shapes) {
    edits += static_cast<RecordKind>(shape >> RecordShape::kind_shift & 3) == RecordKind::Edit ? 1 : 0;
  }
  std::printf("  \"%s\": {\"records\": %u, \"edit_records\": %zu, \"base_triangles\": %u,\n", name,
              model->record_count(), edits, model->info(0).triangles);
  std::printf("    \"refine_records_per_second\": %.4g, \"coarsen_records_per_second\": %.4g,\n",
              sweeps.refine_per_second, sweeps.coarsen_per_second);
  std::printf("    \"seek_seconds_p50\": %.3g, \"seek_seconds_p99\": %.3g,\n", percentile(seeks, 0.5),
              percentile(seeks, 0.99));
  std::printf("    \"model_bytes_per_vertex\": %.2f, \"hard_cursor_bytes_per_vertex\": %.2f,\n", model_bytes,
              hard_bytes);
  std::printf("    \"in_all_bytes_per_vertex\": %.2f, \"morph_cursor_bytes_per_vertex\": %.2f,\n",
              model_bytes + hard_bytes, morph_bytes);
  std::printf("    \"morph_step_seconds_p50\": %.3g, \"morph_step_seconds_max\": %.3g}", percentile(steps, 0.5),
              percentile(steps, 1.0));
}

// One normal per vertex, area weighted: unlike compute_normals() it never splits a vertex, as scans are used.
void give_normals(Mesh& mesh) {
  std::vector<glm::dvec3> sums(mesh.vertex_count(), glm::dvec3{0.0});
  for (std::size_t f = 0; f < mesh.indices.size(); f += 3) {
    const auto at = [&](std::size_t c) { return glm::dvec3{mesh.vertices.positions[mesh.indices[f + c]]}; };
    const glm::dvec3 normal = glm::cross(at(1) - at(0), at(2) - at(0));
    for (std::size_t c = 0; c < 3; ++c) sums[mesh.indices[f + c]] += normal;
  }
  for (const glm::dvec3& sum : sums) {
    const double length = glm::length(sum);
    mesh.vertices.normals.push_back(length > 0.0 ? glm::vec3{sum / length} : glm::vec3{0.0F, 0.0F, 1.0F});
  }
}

int run(const std::string& file, double ratio) {
  auto loaded = read_mesh(file);
  if (!loaded) {
    std::fprintf(stderr, "bench_playback: %s\n", to_line(loaded.error()).c_str());
    return 2;
  }
  Mesh& mesh = loaded->mesh;
  merge_identical_vertices(mesh);
  if (mesh.vertices.normals.empty()) give_normals(mesh);
  std::printf("{\"mesh\": \"%s\", \"vertices\": %u, \"triangles\": %u,\n", file.c_str(), mesh.vertex_count(),
              mesh.triangle_count());
  const std::pair<Placement, const char*> placements[] = {{Placement::Subset, "subset"},
                                                          {Placement::Optimal, "optimal"}};
  for (const auto& [placement, name] : placements) {
    EdgeCollapseOptions options;
    options.placement = placement;
    options.target_triangles = static_cast<std::uint32_t>(ratio * mesh.triangle_count());
    const auto built = build_by_edge_collapse(mesh, options);
    if (!built) {
      std::fprintf(stderr, "bench_playback: %s\n", to_line(built.error()).c_str());
      return 2;
    }
    report(built->model, name);
    std::printf(placement == Placement::Subset ? ",\n" : "\n}\n");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  double ratio = 0.1;
  if (argc != 2 && !(argc == 4 && std::strcmp(argv[2], "--ratio") == 0)) {
    std::fprintf(stderr, "bench_playback: usage: bench_playback MESH [--ratio 0.1]\n");
    return 1;
  }
  if (argc == 4) ratio = std::strtod(argv[3], nullptr);
  return run(argv[1], ratio);
}

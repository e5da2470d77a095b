// SPDX-License-Identifier: MIT
// A cluster graph from a mesh: how long, how full, how honest, and how fast cuts are found.
//
//     bench_clusters MESH [--threads N] [--errors] [--fly FRAMES]
//
// Prints one JSON object. --fly: the cut follows a camera that flies in, at 4 pixels, while pictures are taken from one
// place, so that what changes between two of them is the model alone; `pop` is the largest block difference (0 to 255)
// with the morph and without.
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <lodestone/clusters.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>

#include "viewer/headless/headless.h"

namespace {

using namespace lodestone;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Cuts from cameras around the model, at one pixel.
void print_selection(const ClusterGraph& graph) {
  const Sphere& all = graph.graph.groups[0].bounds;
  CutScratch scratch;
  scratch.reserve(graph.graph);
  std::vector<NodeId> cut;
  for (const double distance : {0.6, 1.0, 2.0, 5.0, 20.0}) {
    View view;
    view.eye = all.center - glm::dvec3{0.0, distance * all.radius_m, 0.0};
    constexpr int repeats = 200;
    CutSummary summary;
    const double start = processor_seconds();
    for (int i = 0; i < repeats; ++i) {
      summary = select_cut(graph.graph, view, {.culling = Culling::None}, scratch, cut);
    }
    const double seconds = (processor_seconds() - start) / repeats;
    std::printf("%s{\"distance_radii\": %g, \"us\": %.2f, \"clusters\": %zu, \"triangles\": %llu, \"tested\": %u}",
                distance == 0.6 ? "" : ", ", distance, 1e6 * seconds, cut.size(),
                static_cast<unsigned long long>(summary.triangle_count), summary.groups_tested);
  }
}

// Claimed error of whole levels against what sampling finds.
void print_errors(const ClusterGraph& graph, const Mesh& source) {
  CutScratch scratch;
  std::vector<NodeId> cut;
  bool first = true;
  for (const ClusterLevel& level : graph.levels) {
    if (level.error_m <= 0.0) continue;
    View far;  // from far away everything has one scale
    far.eye = graph.graph.groups[0].bounds.center - glm::dvec3{0.0, 1e9, 0.0};
    const double limit = level.error_m * focal_px(far) / 1e9;
    select_cut(graph.graph, far, {.error_px = limit * (1.0 + 1e-5), .culling = Culling::None}, scratch, cut);
    const auto found = compare(source, extract(graph, cut), {.samples = 100'000});
    if (!found.ok()) continue;
    std::printf("%s{\"triangles\": %llu, \"claimed_m\": %g, \"p999_m\": %g, \"max_m\": %g, \"rms_m\": %g}",
                first ? "" : ", ", static_cast<unsigned long long>(extract(graph, cut).triangle_count()), level.error_m,
                found->p999_m, found->hausdorff_m, found->rms_m);
    first = false;
  }
}

// The largest and the mean jump between pictures, groups morphed or exchanged at once.
void print_fly(const ClusterGraph& graph, int frames, bool morphed) {
  const Sphere& all = graph.graph.groups[0].bounds;
  render::RenderOptions options{.width_px = 640, .height_px = 360};
  options.look.coloring = render::Coloring::Untextured;
  options.camera.eye_m = graph.origin + all.center - glm::dvec3{0.0, 1.6 * all.radius_m, -0.5 * all.radius_m};
  options.camera.target_m = graph.origin + all.center;
  CutScratch scratch;
  std::vector<NodeId> cut;
  std::vector<double> weights(graph.graph.groups.size(), 0.0);
  Image before;
  double most = 0.0;
  double sum = 0.0;
  for (int i = 0; i < frames; ++i) {
    View view;
    view.eye = all.center - glm::dvec3{0.0, (8.0 - 7.0 * i / frames) * all.radius_m, 0.0};
    select_cut(graph.graph, view, {.error_px = 4.0, .culling = Culling::None}, scratch, cut);
    std::fill(weights.begin(), weights.end(), 0.0);
    for (const GroupId g : scratch.refined()) weights[g] = morphed ? morph_weight(graph.graph, view, 4.0, g) : 0.0;
    auto picture = render::render_mesh(extract_morphed(graph, cut, weights), options);
    if (!picture.ok()) return;
    if (i > 0) {
      const double pop = block_pop(before, picture->image);
      most = std::max(most, pop);
      sum += pop;
    }
    before = std::move(picture->image);
  }
  std::printf("\"pop_max_%s\": %.2f, \"pop_mean_%s\": %.3f, ", morphed ? "morph" : "hard", most,
              morphed ? "morph" : "hard", sum / (frames - 1));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("bench_clusters MESH [--threads N] [--errors] [--fly FRAMES]\n", stderr);
    return 1;
  }
  Context context;
  context.max_workers = 1;
  bool errors = false;
  int frames = 0;
  for (int i = 2; i < argc; ++i) {
    if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc)
      context.max_workers = static_cast<unsigned>(std::atoi(argv[++i]));
    if (std::strcmp(argv[i], "--errors") == 0) errors = true;
    if (std::strcmp(argv[i], "--fly") == 0 && i + 1 < argc) frames = std::atoi(argv[++i]);
  }
  const auto loaded = read_mesh(argv[1], {.textures = LoadTextures::Reference});
  if (!loaded.ok()) {
    std::fprintf(stderr, "%s\n", to_line(loaded.error()).c_str());
    return 2;
  }
  const Mesh& mesh = loaded->mesh;
  const auto wall = std::chrono::steady_clock::now();
  const double start = processor_seconds();
  const auto graph = build_cluster_graph(mesh, {}, context);
  const double seconds = processor_seconds() - start;
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  if (!graph.ok()) {
    std::fprintf(stderr, "%s\n", to_line(graph.error()).c_str());
    return 2;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("{\"triangles\": %u, \"cpu_s\": %.2f, \"wall_s\": %.2f, \"peak_mb\": %ld, \"roots\": %zu, ",
              mesh.triangle_count(), seconds, wall_s, usage.ru_maxrss / 1024, graph->roots.size());
  if (frames > 1) {
    print_fly(*graph, frames, false);
    print_fly(*graph, frames, true);
  }
  std::printf("\"changed_border_edges\": %llu, \"levels\": [",
              static_cast<unsigned long long>(changed_border_edges(*graph)));
  for (const ClusterLevel& level : graph->levels) {
    std::printf("%s{\"clusters\": %u, \"groups\": %u, \"triangles\": %llu, \"mean_fill\": %.1f, \"error_m\": %g}",
                &level == graph->levels.data() ? "" : ", ", level.clusters, level.groups,
                static_cast<unsigned long long>(level.triangles), level.mean_fill, level.error_m);
  }
  std::printf("], \"selection\": [");
  print_selection(*graph);
  std::printf("], \"errors\": [");
  if (errors) print_errors(*graph, mesh);
  std::printf("]}\n");
  return 0;
}

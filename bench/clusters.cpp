// SPDX-License-Identifier: MIT
// A cluster graph from a mesh: how long, how full, how honest, and how fast cuts are found.
//
//     bench_clusters MESH [--threads N] [--errors] [--fly FRAMES] [--cut-loose] [--write FILE.lodg]
//
// Prints one JSON object. --fly: the cut follows a camera that flies in, at 4 pixels, while pictures are taken from one
// place, so that what changes between two of them is the model alone; `pop` is the largest block difference (0 to 255)
// with the morph and without. --cut-loose gives every third face vertices and uvs of its own, the mesh on which other
// builders crack.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <string>

#include <lodestone/cluster_file.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>

#include "processor_clock.h"
#include "viewer/headless/headless_clusters.h"

namespace {

using namespace lodestone;

// As exporters write meshes that give each face its own uv.
void cut_loose(Mesh& mesh) {
  for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
    if (corner / 3 % 3 != 0) continue;
    const VertexId v = mesh.indices[corner];
    VertexArrays& of = mesh.vertices;
    mesh.indices[corner] = of.size();
    of.positions.push_back(glm::vec3{of.positions[v]});
    if (!of.normals.empty()) of.normals.push_back(glm::vec3{of.normals[v]});
    const float shift = 0.01F * static_cast<float>(corner / 3 % 7);
    if (!of.uvs.empty()) of.uvs.push_back(of.uvs[v] + glm::vec2{shift, 0.0F});
    if (!of.colors.empty()) of.colors.push_back(glm::u8vec4{of.colors[v]});
  }
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

// How many points each round could not move because two groups use them, and how many of those could not the round
// before either.
void print_locked(const ClusterGraph& graph) {
  const std::vector<GroupId> group_of = groups_of_nodes(graph.graph);
  using Use = std::pair<std::array<float, 3>, GroupId>;
  std::vector<std::array<float, 3>> before;
  for (std::uint32_t level = 0; level < graph.levels.size(); ++level) {
    std::vector<Use> uses;
    for (NodeId n = 0; n < graph.clusters.size(); ++n) {
      if (graph.clusters[n].level != level) continue;
      for (std::uint32_t v = graph.clusters[n].vertices.begin; v != graph.clusters[n].vertices.end; ++v) {
        const glm::vec3& p = graph.vertices.positions[v];
        uses.push_back({{p.x, p.y, p.z}, group_of[n]});
      }
    }
    std::sort(uses.begin(), uses.end());
    uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
    std::size_t points = 0;
    std::vector<std::array<float, 3>> locked;
    for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
      while (end < uses.size() && uses[end].first == uses[i].first) ++end;
      ++points;
      if (end > i + 1) locked.push_back(uses[i].first);
    }
    std::size_t again = 0;
    for (const auto& p : locked) again += std::binary_search(before.begin(), before.end(), p) ? 1 : 0;
    std::printf("%s{\"points\": %zu, \"locked\": %zu, \"locked_before\": %zu}", level == 0 ? "" : ", ", points,
                locked.size(), again);
    before = std::move(locked);
  }
}

// The largest and the mean jump between pictures while a camera flies in, groups morphed or exchanged at once.
void print_fly(const ClusterGraph& graph, std::uint32_t frames) {
  const auto file = std::filesystem::temp_directory_path() / ("bench_clusters_" + std::to_string(getpid()) + ".lodg");
  const auto written = write_cluster_graph(graph, file);
  const auto opened = ClusterFile::open(file);
  std::filesystem::remove(file);
  if (!written.ok() || !opened.ok()) return;
  const Sphere& all = graph.graph.groups[0].bounds;
  render::FlightOptions options{.frames = frames};
  options.render.look.coloring = render::Coloring::Untextured;
  options.path = [&](const Box&, double share) {
    View view;
    view.eye = all.center - glm::dvec3{0.0, (8.0 - 7.0 * share) * all.radius_m, 0.0};
    return view;
  };
  options.watch = [&](const Box&) {
    View view;
    view.width_px = 640;
    view.height_px = 360;
    view.eye = all.center - glm::dvec3{0.0, 1.6 * all.radius_m, -0.5 * all.radius_m};
    view.forward = glm::normalize(all.center - view.eye);
    return view;
  };
  for (const double seconds : {0.0, 0.3, 0.5, 1.0}) {
    options.morph_seconds = seconds;
    const auto flight = render::fly_clusters(*opened, options);
    if (!flight.ok()) return;
    const double sum = std::accumulate(flight->pops.begin(), flight->pops.end(), 0.0);
    std::printf("%s{\"morph_s\": %g, \"pop_max\": %.2f, \"pop_mean\": %.3f, \"triangles\": %.0f}",
                seconds == 0.0 ? "" : ", ", seconds, *std::max_element(flight->pops.begin(), flight->pops.end()),
                sum / static_cast<double>(flight->pops.size()), flight->mean_triangles);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("bench_clusters MESH [--threads N] [--errors] [--fly FRAMES] [--cut-loose] [--write FILE.lodg]\n",
               stderr);
    return 1;
  }
  Context context;
  context.max_workers = 1;
  bool errors = false;
  bool loose = false;
  int frames = 0;
  std::filesystem::path file;
  for (int i = 2; i < argc; ++i) {
    if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc)
      context.max_workers = static_cast<unsigned>(std::atoi(argv[++i]));
    if (std::strcmp(argv[i], "--write") == 0 && i + 1 < argc) file = argv[++i];
    if (std::strcmp(argv[i], "--errors") == 0) errors = true;
    if (std::strcmp(argv[i], "--cut-loose") == 0) loose = true;
    if (std::strcmp(argv[i], "--fly") == 0 && i + 1 < argc) frames = std::atoi(argv[++i]);
  }
  auto loaded = read_mesh(argv[1], {.textures = LoadTextures::Reference});
  if (!loaded.ok()) {
    std::fprintf(stderr, "%s\n", to_line(loaded.error()).c_str());
    return 2;
  }
  if (loose) cut_loose(loaded->mesh);
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
  if (!file.empty() && !write_cluster_graph(*graph, file).ok()) return 2;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("{\"triangles\": %u, \"cpu_s\": %.2f, \"wall_s\": %.2f, \"peak_mb\": %ld, \"roots\": %zu, ",
              mesh.triangle_count(), seconds, wall_s, usage.ru_maxrss / 1024, graph->roots.size());
  std::printf("\"fly\": [");
  if (frames > 1) print_fly(*graph, static_cast<std::uint32_t>(frames));
  std::printf("], \"changed_border_edges\": %llu, \"levels\": [",
              static_cast<unsigned long long>(changed_border_edges(*graph)));
  for (const ClusterLevel& level : graph->levels) {
    std::printf("%s{\"clusters\": %u, \"groups\": %u, \"triangles\": %llu, \"mean_fill\": %.1f, \"error_m\": %g}",
                &level == graph->levels.data() ? "" : ", ", level.clusters, level.groups,
                static_cast<unsigned long long>(level.triangles), level.mean_fill, level.error_m);
  }
  std::printf("], \"locked\": [");
  print_locked(*graph);
  std::printf("], \"selection\": [");
  print_selection(*graph);
  std::printf("], \"errors\": [");
  if (errors) print_errors(*graph, mesh);
  std::printf("]}\n");
  return 0;
}

// SPDX-License-Identifier: MIT
// Tiles of 257 x 257 posts cut from an SRTM file, one thread, all methods (or one) at 1, 5, 10 and 40 m:
// samples per second of processor time, triangles, true error. bench/terrain_delatin.mjs does the same with npm's
// delatin.
//
//   bench_terrain N30E079.hgt [greedy|edge-collapse|random|grid|hierarchy|wlop|table]
//
// `table`: Table 2 of Campos et al. 2020 on the first tile: all methods at about as many triangles as there.
#include <lodestone/metrics.h>
#include <lodestone/terrain.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "processor_clock.h"
#include "terrain/chains.h"
#include "terrain/edge_collapse.h"
#include "terrain/error.h"
#include "terrain/greedy.h"
#include "terrain/point_set.h"

namespace {

using namespace lodestone;
using namespace lodestone::terrain;

// Big-endian 16-bit heights, north first; voids become the post before them.
std::vector<TileLattice> read_tiles(const std::string& file) {
  std::ifstream stream{file, std::ios::binary};
  const std::vector<char> bytes{std::istreambuf_iterator<char>{stream}, {}};
  const auto side = static_cast<int>(std::sqrt(static_cast<double>(bytes.size()) / 2.0));
  std::vector<float> heights(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  float last = 0.0F;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const auto value = static_cast<std::int16_t>(static_cast<unsigned char>(bytes[2 * i]) << 8U |
                                                 static_cast<unsigned char>(bytes[2 * i + 1]));
    heights[i] = last = value == -32768 ? last : static_cast<float>(value);
  }
  std::vector<TileLattice> tiles;
  for (int row = 0; row + size < side; row += size) {
    for (int column = 0; column + size < side; column += size) {
      TileLattice& lattice = tiles.emplace_back();
      for (int y = -1; y <= size + 1; ++y) {
        for (int x = -1; x <= size + 1; ++x) {
          const int i = std::clamp(row + size - y, 0, side - 1), j = std::clamp(column + x, 0, side - 1);
          lattice.set(
              x, y,
              heights[static_cast<std::size_t>(i) * static_cast<std::size_t>(side) + static_cast<std::size_t>(j)]);
        }
      }
    }
  }
  return tiles;
}

constexpr std::pair<TerrainMethod, const char*> methods[] = {{TerrainMethod::Greedy, "greedy"},
                                                             {TerrainMethod::EdgeCollapse, "edge-collapse"},
                                                             {TerrainMethod::PointsRandom, "random"},
                                                             {TerrainMethod::PointsGrid, "grid"},
                                                             {TerrainMethod::PointsHierarchy, "hierarchy"},
                                                             {TerrainMethod::PointsWlop, "wlop"}};

Tin make(const TileLattice& lattice, double tolerance_m, double step_m, TerrainMethod method) {
  std::vector<Tin::Vertex> chain;
  for (const Side side : all_sides) {
    for (const Tin::Vertex& vertex : border_vertices(lattice, side, {tolerance_m, step_m, 1})) chain.push_back(vertex);
  }
  if (is_point_set(method)) {
    const PointSetTask task{
        .method = method, .samples = {.spacing_m = {80.0, 92.0}}, .tolerance_m = tolerance_m, .step_m = step_m};
    return point_set_tin(lattice, chain, task).tin;
  }
  if (method == TerrainMethod::Greedy) {
    return greedy_insertion(lattice, chain, {.tolerance_m = tolerance_m, .step_m = step_m}).tin;
  }
  const Tin fine = greedy_insertion(lattice, chain, {.tolerance_m = 0.9 * tolerance_m, .step_m = step_m}).tin;
  return collapse_edges(fine, lattice, {.limit_m = tolerance_m + 0.5 * step_m, .step_m = step_m});
}

void bench(const std::vector<TileLattice>& tiles, double tolerance_m, TerrainMethod method, const char* name) {
  const double step_m = std::max(0.25, std::exp2(std::floor(std::log2(tolerance_m / 32.0))));
  std::size_t triangles = 0;
  double seconds = 0.0, worst_m = 0.0;
  for (const TileLattice& lattice : tiles) {
    const double start = thread_seconds();
    const Tin tin = make(lattice, tolerance_m, step_m, method);
    seconds += thread_seconds() - start;
    worst_m = std::max(worst_m, measure(tin, lattice, tolerance_m).max_m);
    triangles += tin.triangles.size() / 3;
  }
  const double samples = static_cast<double>(tiles.size()) * size * size;
  std::printf(
      "{\"method\": \"%s\", \"tolerance_m\": %g, \"tiles\": %zu, \"triangles\": %zu, \"true_error_m\": %.4f, "
      "\"samples_per_second\": %.0f}\n",
      name, tolerance_m, tiles.size(), triangles, worst_m, samples / seconds);
  std::fflush(stdout);
}

// In metres, as a plane: what is beside it on the globe is the same for all methods.
double hausdorff_m(const Tin& tin, const TileLattice& lattice) {
  constexpr glm::dvec2 spacing_m{80.0, 92.0};
  const auto place = [&](double x, double y, double height_m) {
    return glm::vec3{glm::dvec3{x * spacing_m.x, y * spacing_m.y, height_m}};
  };
  Mesh ours, posts;
  for (const Tin::Vertex& v : tin.vertices) {
    constexpr double unit = static_cast<double>(size) / quantized_max;
    ours.vertices.positions.push_back(place(v.u * unit, v.v * unit, v.height_m));
  }
  ours.indices = tin.triangles;
  constexpr std::uint32_t side = size + 1;
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x)
      posts.vertices.positions.push_back(place(x, y, static_cast<double>(lattice.at(x, y))));
  }
  for (std::uint32_t y = 0; y + 1 < side; ++y) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = y * side + x;
      for (const std::uint32_t v : {a, a + 1, a + side + 1, a, a + side + 1, a + side}) posts.indices.push_back(v);
    }
  }
  const auto distance = compare(posts, ours, {.samples = 1000});
  return distance ? distance->hausdorff_m : -1.0;
}

void table(const TileLattice& lattice) {
  constexpr double step_m = 0.25, tolerance_m = 180.0;
  std::vector<Tin::Vertex> chain;
  for (const Side side : all_sides) {
    for (const auto& vertex : border_vertices(lattice, side, {tolerance_m, step_m, 1})) chain.push_back(vertex);
  }
  const auto row = [&](const char* name, auto make_tin) {
    const double start = thread_seconds();
    const Tin tin = make_tin();
    const double seconds = thread_seconds() - start;
    std::printf(
        "{\"method\": \"%s\", \"seconds\": %.4f, \"vertices\": %zu, \"triangles\": %zu, \"true_error_m\": %.1f, "
        "\"hausdorff_m\": %.1f}\n",
        name, seconds, tin.vertices.size(), tin.triangles.size() / 3, measure(tin, lattice, tolerance_m).max_m,
        hausdorff_m(tin, lattice));
  };
  const auto greedy = [&](double share) {
    return greedy_insertion(lattice, chain, {.tolerance_m = share * tolerance_m, .step_m = step_m}).tin;
  };
  row("greedy", [&] { return greedy(1.0); });
  row("edge collapse by error",
      [&] { return collapse_edges(greedy(0.9), lattice, {.limit_m = tolerance_m + 0.5 * step_m, .step_m = step_m}); });
  row("edge collapse to 2000 edges",
      [&] { return collapse_edges(greedy(0.125), lattice, {.target_edges = 2000, .step_m = step_m}); });
  for (const auto& [method, name] : methods) {
    if (!is_point_set(method)) continue;
    row(name, [&, chosen = method] {
      const SampleOptions samples{.keep_ratio = 0.006,
                                  .cell_posts = 12,
                                  .cluster_posts = 300,
                                  .surface_variation = 0.05,
                                  .radius_posts = 26.0,
                                  .iterations = 15,
                                  .spacing_m = {80.0, 92.0}};
      return point_set_tin(lattice, chain,
                           {.method = chosen, .samples = samples, .tolerance_m = tolerance_m, .step_m = step_m})
          .tin;
    });
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: bench_terrain FILE.hgt [METHOD]\n");
    return 1;
  }
  const std::vector<TileLattice> tiles = read_tiles(argv[1]);
  if (argc == 3 && std::string{argv[2]} == "table") {
    table(tiles.front());
    return 0;
  }
  for (const auto& [method, name] : methods) {
    if (argc == 3 && std::string{argv[2]} != name) continue;
    for (const double tolerance_m : {1.0, 5.0, 10.0, 40.0}) bench(tiles, tolerance_m, method, name);
  }
  return 0;
}

// SPDX-License-Identifier: MIT
// Edge collapse on a folder of real buildings: do they reach every target, and how near do they stay.
//
//     bench_simplify_buildings FOLDER [--largest 30]
//
// FOLDER holds <id>/<id>.obj. Prints one JSON object per share of triangles kept: mean RMS, mean normal deviation and
// median of the maximum over the largest buildings (welded by position, geometry only), how often the target was not
// reached over all, and the largest ratio of the measured 99.9th percentile to the claimed error.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <vector>

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>

#include "positions_only.h"

namespace {

using namespace lodestone;

std::vector<Mesh> read_buildings(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto name = entry.path().filename();
    const auto file = entry.path() / (name.string() + ".obj");
    if (name != "street_all" && std::filesystem::exists(file)) files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  std::vector<Mesh> meshes;
  for (const auto& file : files) {
    const auto loaded = read_mesh(file);
    if (!loaded.ok()) continue;
    meshes.push_back(test::positions_only(loaded->mesh));
  }
  std::stable_sort(meshes.begin(), meshes.end(),
                   [](const Mesh& a, const Mesh& b) { return a.triangle_count() > b.triangle_count(); });
  return meshes;
}

void measure(const std::vector<Mesh>& meshes, std::size_t largest, double ratio) {
  double rms = 0.0;
  double deviation = 0.0;
  double worst_claim = 0.0;
  int missed = 0;
  std::vector<double> maxima;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    EdgeCollapseOptions options;
    options.attributes = Attributes::None;
    options.target_triangles = std::max(1U, static_cast<std::uint32_t>(ratio * meshes[i].triangle_count()));
    const auto result = simplify(meshes[i], options);
    if (!result.ok() || !result->report.target_reached) ++missed;
    if (!result.ok() || i >= largest) continue;
    const auto distance = compare(meshes[i], result->mesh);
    if (!distance.ok()) continue;
    rms += 1e6 * distance->rms_m / distance->diagonal_m / static_cast<double>(largest);
    deviation += distance->normal_deviation_rad * 180.0 / std::numbers::pi / static_cast<double>(largest);
    maxima.push_back(1e6 * distance->hausdorff_m / distance->diagonal_m);
    if (result->error_m > 0.0) worst_claim = std::max(worst_claim, distance->p999_m / result->error_m);
  }
  std::sort(maxima.begin(), maxima.end());
  std::printf(
      "{\"kept\": %.2f, \"rms_ppm\": %.0f, \"normal_deviation_deg\": %.2f, \"max_ppm_median\": %.0f, "
      "\"p999_over_claim_max\": %.2f, \"targets_missed\": %d, \"buildings\": %zu}\n",
      ratio, rms, deviation, maxima.empty() ? 0.0 : maxima[maxima.size() / 2], worst_claim, missed, meshes.size());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_simplify_buildings FOLDER [--largest N]\n");
    return 2;
  }
  std::size_t largest = 30;
  if (argc > 3 && std::strcmp(argv[2], "--largest") == 0) largest = static_cast<std::size_t>(std::atol(argv[3]));
  const std::vector<Mesh> meshes = read_buildings(argv[1]);
  for (const double ratio : {0.5, 0.2, 0.1, 0.05, 0.02}) measure(meshes, std::min(largest, meshes.size()), ratio);
}

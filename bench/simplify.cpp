// SPDX-License-Identifier: MIT
// How fast and how near edge collapse is, beside libmeshoptimizer in the same run.
//
//     bench_simplify MESH [--samples 1000000] [--no-error] [--runs 3]
//
// For 50, 20, 10, 2 and 1 % of the triangles of MESH prints one JSON object each: processor seconds of one thread with
// full records, of the same without records, wall seconds with records of one and of two threads, those of
// meshopt_simplify, and the two-sided errors in ppm of the diagonal (geometry only, all attributes kept,
// meshoptimizer). Best of the runs; all kinds take turns, so that a busy moment strikes none alone.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>

#include "meshoptimizer_peer.h"
#include "positions_only.h"
#include "processor_clock.h"

namespace {

using namespace lodestone;

struct Seconds {
  double processor = 1e9;
  double wall = 1e9;
};

struct Settings {
  std::uint32_t samples = 1'000'000;
  int runs = 3;
};

template <class Work>
void keep_best(Seconds& best, Work&& work) {
  const double start = processor_seconds();
  const auto wall = std::chrono::steady_clock::now();
  work();
  best.processor = std::min(best.processor, processor_seconds() - start);
  best.wall = std::min(best.wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count());
}

EdgeCollapseOptions options_for(std::uint32_t target, Attributes attributes) {
  EdgeCollapseOptions options;
  options.attributes = attributes;
  options.target_triangles = target;
  return options;
}

void print_error(const char* name, const Mesh& source, const Mesh& result, std::uint32_t samples) {
  DistanceOptions options;
  options.samples = samples;
  const auto distance = compare(source, result, options);
  if (!distance.ok()) return;
  const double ppm = 1e6 / distance->diagonal_m;
  std::printf(", \"%s\": {\"triangles\": %u, \"rms_ppm\": %.1f, \"p999_ppm\": %.0f, \"max_ppm\": %.0f}", name,
              result.triangle_count(), distance->rms_m * ppm, distance->p999_m * ppm, distance->hausdorff_m * ppm);
}

void measure(const Mesh& source, const Mesh& bare, double ratio, const Settings& settings) {
  const auto target = static_cast<std::uint32_t>(ratio * source.triangle_count());
  Context one;
  one.max_workers = 1;
  Context two;
  two.max_workers = 2;
  const EdgeCollapseOptions geometry = options_for(target, Attributes::None);
  Seconds records, parallel, plain, peer;
  for (int i = 0; i < settings.runs; ++i) {
    keep_best(records, [&] { static_cast<void>(build_by_edge_collapse(bare, geometry, one)); });
    keep_best(parallel, [&] { static_cast<void>(build_by_edge_collapse(bare, geometry, two)); });
    keep_best(plain, [&] { static_cast<void>(simplify(bare, geometry, one)); });
    keep_best(peer, [&] { static_cast<void>(by_meshoptimizer(bare, target)); });
  }
  std::printf(
      "{\"kept\": %.2f, \"records_s\": %.3f, \"no_records_s\": %.3f, \"meshoptimizer_s\": %.3f, "
      "\"speed_ratio\": %.2f, \"two_threads\": %.2f",
      ratio, records.processor, plain.processor, peer.processor, peer.processor / records.processor,
      records.wall / parallel.wall);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf(", \"peak_mb\": %.0f", static_cast<double>(usage.ru_maxrss) / 1024.0);
  if (const std::uint32_t samples = settings.samples; samples != 0) {
    const auto result = simplify(bare, geometry, two);
    if (result.ok()) {
      print_error("geometry_only", bare, result->mesh, samples);
      std::printf(", \"claimed_ppm\": %.0f", result->error_m * 1e6 / bounds(bare).diagonal_m());
    }
    if (source.vertices.uvs.empty() && source.vertices.normals.empty()) {
      // nothing to keep
    } else if (const auto kept = simplify(source, options_for(target, Attributes::All), two); kept.ok()) {
      print_error("looks_kept", source, kept->mesh, samples);
    }
    print_error("meshoptimizer", bare, by_meshoptimizer(bare, target), samples);
  }
  std::printf("}\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_simplify MESH [--samples N] [--no-error] [--runs N]\n");
    return 2;
  }
  Settings settings;
  for (int i = 2; i < argc; ++i) {
    if (std::strcmp(argv[i], "--no-error") == 0) settings.samples = 0;
    if (i + 1 == argc) continue;
    if (std::strcmp(argv[i], "--samples") == 0) settings.samples = static_cast<std::uint32_t>(std::atol(argv[i + 1]));
    if (std::strcmp(argv[i], "--runs") == 0) settings.runs = std::atoi(argv[i + 1]);
  }
  auto loaded = read_mesh(argv[1]);
  if (!loaded.ok()) {
    std::fprintf(stderr, "%s\n", to_line(loaded.error()).c_str());
    return 1;
  }
  const Mesh source = std::move(loaded->mesh);
  const Mesh bare = test::positions_only(source);
  for (const double ratio : {0.5, 0.2, 0.1, 0.02, 0.01}) measure(source, bare, ratio, settings);
}

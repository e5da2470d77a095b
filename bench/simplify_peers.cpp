// SPDX-License-Identifier: MIT
// Edge collapse beside the accurate simplifiers: OpenMesh's decimater and, where it is installed, CGAL under both of
// its costs. (The fast one, libmeshoptimizer, stands in bench_simplify.)
//
//     bench_simplify_peers MESH [--samples 200000]
//
// For 50, 10 and 1 % of the triangles of MESH, positions only, prints one JSON object each: processor seconds of one
// thread without reading and conversions, triangles reached and refused, RMS and largest distance in ppm of the
// diagonal. One run each; the peers take minutes on a million triangles.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>

#include "peers.h"
#include "positions_only.h"
#include "processor_clock.h"

namespace {

using namespace lodestone;

peers::Outcome by_us(const Mesh& mesh, std::uint32_t target) {
  Context one;
  one.max_workers = 1;
  peers::Outcome outcome;
  const double start = thread_seconds();
  auto result = simplify(mesh, {.attributes = Attributes::None, .target_triangles = target}, one);
  outcome.seconds = thread_seconds() - start;
  if (result) outcome.mesh = std::move(result->mesh);
  return outcome;
}

void print(const char* name, const Mesh& source, const peers::Outcome& outcome, std::uint32_t samples) {
  std::printf(", \"%s\": {\"seconds\": %.2f, \"triangles\": %u, \"refused\": %u", name, outcome.seconds,
              outcome.mesh.triangle_count(), outcome.refused_triangles);
  DistanceOptions options;
  options.samples = samples;
  if (const auto distance = compare(source, outcome.mesh, options)) {
    const double ppm = 1e6 / distance->diagonal_m;
    std::printf(", \"rms_ppm\": %.1f, \"max_ppm\": %.0f", distance->rms_m * ppm, distance->hausdorff_m * ppm);
  }
  std::printf("}");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && !(argc == 4 && std::strcmp(argv[2], "--samples") == 0)) {
    std::fprintf(stderr, "usage: bench_simplify_peers MESH [--samples N]\n");
    return 1;
  }
  const auto samples = argc == 4 ? static_cast<std::uint32_t>(std::atol(argv[3])) : 200'000U;
  auto loaded = read_mesh(argv[1]);
  if (!loaded) {
    std::fprintf(stderr, "bench_simplify_peers: %s\n", to_line(loaded.error()).c_str());
    return 2;
  }
  const Mesh mesh = test::positions_only(loaded->mesh);
  for (const double kept : {0.5, 0.1, 0.01}) {
    const auto target = static_cast<std::uint32_t>(kept * mesh.triangle_count());
    std::printf("{\"kept\": %.2f", kept);
    print("lodestone", mesh, by_us(mesh, target), samples);
    print("openmesh", mesh, peers::by_openmesh(mesh, target), samples);
#ifdef LODESTONE_PEER_CGAL
    print("cgal_garland_heckbert", mesh, peers::by_garland_heckbert(mesh, target), samples);
    print("cgal_lindstrom_turk", mesh, peers::by_lindstrom_turk(mesh, target), samples);
#endif
    std::printf("}\n");
  }
  return 0;
}

// SPDX-License-Identifier: MIT
// Facet shift beside edge collapse on real buildings: normal deviation, RMS and maximum distance at equal triangle
// counts, and the time both take. One JSON object on stdout. Usage: bench_facets [--alone] FILE...
// --alone leaves edge collapse out.
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include <lodestone/edge_collapse.h>
#include <lodestone/facet_shift.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>
#include <lodestone/texture_colors.h>

namespace {

using namespace lodestone;
constexpr double ratios[] = {0.5, 0.2, 0.1, 0.05, 0.02};
constexpr std::size_t ratio_count = std::size(ratios);

struct Row {
  double triangles = 0.0, deviation_deg = 0.0, rms_ppm = 0.0, max_ppm = 0.0;
};

Row measure(const Mesh& source, const ProgressiveModel& model, double ratio) {
  const Level level = model.level_of_triangles(static_cast<std::uint32_t>(ratio * source.triangle_count()));
  const Mesh mesh = model.extract(level);
  const auto found = compare(source, mesh, {.samples = 50'000});
  if (!found) return {};
  const double ppm = 1e6 / found->diagonal_m;
  return {static_cast<double>(mesh.triangle_count()), found->normal_deviation_rad * 57.29577951308232,
          found->rms_m * ppm, found->hausdorff_m * ppm};
}

template <class Build>
void bench(const char* method, const Mesh& source, Row* sums, Build build) {
  const auto start = std::chrono::steady_clock::now();
  const auto built = build(source);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!built) {
    std::printf("\"%s\": null", method);
    std::fprintf(stderr, "%s: %s\n", method, to_line(built.error()).c_str());
    return;
  }
  const ProgressiveModel& model = *built->model;
  std::printf("\"%s\": {\"seconds\": %.3f, \"records\": %u, \"base_triangles\": %u, \"levels\": [", method, seconds,
              model.record_count(), model.info(0).triangles);
  for (std::size_t i = 0; i < ratio_count; ++i) {
    const Row row = measure(source, model, ratios[i]);
    std::printf("%s{\"triangles\": %.0f, \"normal_deviation_deg\": %.3f, \"rms_ppm\": %.1f, \"max_ppm\": %.0f}",
                i == 0 ? "" : ", ", row.triangles, row.deviation_deg, row.rms_ppm, row.max_ppm);
    sums[i].deviation_deg += row.deviation_deg;
    sums[i].rms_ppm += row.rms_ppm;
    sums[i].max_ppm += row.max_ppm;
  }
  std::printf("]}");
}

void print_means(const char* method, const Row* sums, int count) {
  std::printf("\"%s\": [", method);
  for (std::size_t i = 0; i < ratio_count; ++i) {
    std::printf("%s{\"ratio\": %.2f, \"normal_deviation_deg\": %.3f, \"rms_ppm\": %.1f, \"max_ppm\": %.0f}",
                i == 0 ? "" : ", ", ratios[i], sums[i].deviation_deg / count, sums[i].rms_ppm / count,
                sums[i].max_ppm / count);
  }
  std::printf("]");
}

}  // namespace

int main(int argc, char** argv) {
  Row facet_sums[ratio_count], edge_sums[ratio_count];
  int count = 0;
  std::printf("{\"buildings\": [\n");
  const bool alone = argc > 1 && std::string{argv[1]} == "--alone";
  for (int i = alone ? 2 : 1; i < argc; ++i) {
    const auto loaded = read_mesh(argv[i]);
    if (!loaded) continue;
    const Mesh& source = loaded->mesh;
    std::printf("%s{\"file\": \"%s\", \"triangles\": %u,\n ", count == 0 ? "" : ",\n", argv[i],
                source.triangle_count());
    bench("facet_shift", source, facet_sums,
          [](const Mesh& m) { return build_by_facet_shift(m, {.texture_colors = mean_texture_colors(m)}); });
    if (!alone) {
      std::printf(",\n ");
      bench("edge_collapse", source, edge_sums, [](const Mesh& m) { return build_by_edge_collapse(m); });
    }
    std::printf("}");
    std::fflush(stdout);
    ++count;
  }
  std::printf("],\n\"means\": {");
  print_means("facet_shift", facet_sums, count);
  if (!alone) {
    std::printf(",\n ");
    print_means("edge_collapse", edge_sums, count);
  }
  std::printf("}}\n");
  return count > 0 ? 0 : 1;
}

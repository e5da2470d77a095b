// SPDX-License-Identifier: MIT
// What is seen of facet shift beside edge collapse: the difference of pictures from six directions, textured, at 20,
// 10, 5 and 2 % of the triangles. One JSON object on stdout.
//
//     bench_facet_pictures [--alone] [--sheets FOLDER] FILE...
//
// --alone leaves edge collapse out. --sheets writes a picture of each building: the source, then facet shift above,
// edge collapse below and libmeshoptimizer, which sees geometry only and keeps no materials, at the bottom, at each
// share.
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <lodestone/edge_collapse.h>
#include <lodestone/facet_shift.h>
#include <lodestone/formats.h>
#include <lodestone/texture_colors.h>

#include "meshoptimizer_peer.h"
#include "picture_grid.h"
#include "viewer/headless/headless.h"

namespace {

using namespace lodestone;
constexpr double ratios[] = {0.2, 0.1, 0.05, 0.02};
constexpr std::size_t ratio_count = std::size(ratios);
using Levels = std::vector<Mesh>;
using Differences = std::vector<double>;

Levels levels_of(const ProgressiveModel& model, std::uint32_t triangles) {
  Levels levels;
  for (const double ratio : ratios) {
    levels.push_back(model.extract(model.level_of_triangles(static_cast<std::uint32_t>(ratio * triangles))));
  }
  return levels;
}

template <class Build>
Levels build(const Mesh& source, Build builder) {
  const auto built = builder(source);
  if (built) return levels_of(*built->model, source.triangle_count());
  std::fprintf(stderr, "%s\n", to_line(built.error()).c_str());
  return {};
}

// The peer sticks at seams: it gets the mesh with one vertex a place.
Mesh welded(Mesh mesh) {
  std::map<std::array<float, 3>, VertexId> first;
  for (VertexId& v : mesh.indices) {
    const glm::vec3 p = mesh.vertices.positions[v];
    v = first.try_emplace({p.x, p.y, p.z}, v).first->second;
  }
  mesh.vertices.normals.clear();
  return mesh;
}

Levels by_peer(const Mesh& source) {
  const Mesh bare = welded(source);
  Levels levels;
  for (const double ratio : ratios) {
    levels.push_back(by_meshoptimizer(bare, static_cast<std::uint32_t>(ratio * source.triangle_count())));
  }
  return levels;
}

Differences differences(const char* method, const Mesh& source, const Levels& levels) {
  Differences found;
  std::printf(", \"%s\": [", method);
  for (const Mesh& level : levels) {
    const auto rms = render::six_direction_rms(source, level);
    found.push_back(rms ? *rms : 0.0);
    std::printf("%s%.2f", found.size() == 1 ? "" : ", ", found.back());
  }
  std::printf("]");
  return found;
}

void write_sheet(const std::string& name, const Mesh& source, const std::vector<Levels>& methods) {
  const render::RenderOptions options{.width_px = 480, .height_px = 400};
  bench::PictureGrid grid{ratio_count + 1, methods.size(), options};
  for (std::size_t row = 0; row < methods.size(); ++row) {
    grid.draw(0, row, source, source);
    for (std::size_t i = 0; i < methods[row].size(); ++i) grid.draw(i + 1, row, methods[row][i], source);
  }
  if (const auto written = write_image(grid.image(), name); !written)
    std::fprintf(stderr, "%s not written\n", name.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  bool alone = false;
  std::string folder;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--alone") {
      alone = true;
    } else if (word == "--sheets" && i + 1 < argc) {
      folder = argv[++i];
    } else {
      files.push_back(word);
    }
  }
  std::vector<double> shift_sum(ratio_count), edge_sum(ratio_count);
  std::vector<int> better(ratio_count);
  int count = 0;
  std::printf("{\"buildings\": [");
  for (const std::string& file : files) {
    const auto loaded = read_mesh(file);
    if (!loaded) continue;
    const Mesh& source = loaded->mesh;
    std::vector<Levels> methods{build(
        source, [](const Mesh& m) { return build_by_facet_shift(m, {.texture_colors = mean_texture_colors(m)}); })};
    if (!alone) methods.push_back(build(source, [](const Mesh& m) { return build_by_edge_collapse(m); }));
    const std::string stem = std::filesystem::path{file}.stem().string();
    std::printf("%s\n{\"name\": \"%s\", \"triangles\": %u", count++ == 0 ? "" : ",", stem.c_str(),
                source.triangle_count());
    const Differences shift = differences("facet_shift", source, methods[0]);
    const Differences edge = alone ? shift : differences("edge_collapse", source, methods[1]);
    for (std::size_t i = 0; i < ratio_count; ++i) {
      shift_sum[i] += shift[i];
      edge_sum[i] += edge[i];
      better[i] += shift[i] < edge[i] ? 1 : 0;
    }
    std::printf("}");
    std::fflush(stdout);
    if (folder.empty()) continue;
    methods.push_back(by_peer(source));
    write_sheet(folder + "/" + stem + ".png", source, methods);
  }
  std::printf("],\n\"means\": [");
  for (std::size_t i = 0; i < ratio_count; ++i) {
    std::printf("%s{\"ratio\": %.2f, \"facet_shift\": %.2f", i == 0 ? "" : ", ", ratios[i], shift_sum[i] / count);
    if (!alone) std::printf(", \"edge_collapse\": %.2f, \"better\": %d", edge_sum[i] / count, better[i]);
    std::printf("}");
  }
  std::printf("]}\n");
  return count > 0 ? 0 : 1;
}

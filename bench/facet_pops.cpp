// SPDX-License-Identifier: MIT
// What jumps while a building coarsens: the largest difference of two successive pictures of a sweep from all triangles
// to 1 % of them in 300 frames of 240 x 180, by facet shift, by the same model in five levels switched and faded, and
// by edge collapse. One JSON object on stdout.
//
//     bench_facet_pops [--worst COUNT FOLDER] FILE...
//
// --worst writes the COUNT worst pairs of pictures of the facet shift, four times as large, before and after, and what
// differs, with the block marked in the file's name: FRAME_POP_XxY.png.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <lodestone/edge_collapse.h>
#include <lodestone/facet_shift.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>
#include <lodestone/texture_colors.h>

#include "viewer/headless/headless.h"

namespace {

using namespace lodestone;
using Model = std::shared_ptr<const ProgressiveModel>;

constexpr std::uint32_t block_px = 16;
constexpr std::uint32_t enlarged = 4;

render::SweepOptions sweep_options(render::SweepStyle style) {
  render::SweepOptions options{.frames = 300, .from_ratio = 1.0, .to_ratio = 0.01, .style = style};
  options.render = {.width_px = 240, .height_px = 180};
  return options;
}

struct Pair {
  std::uint32_t frame = 0;
  double pop = 0.0;
  Image before, after;
};

// Before, after and the difference, in one row.
Image enlarge(const Pair& pair) {
  Image sheet;
  const std::uint32_t width = pair.before.width;
  sheet.width = 3 * enlarged * width;
  sheet.height = enlarged * pair.before.height;
  sheet.channels = 3;
  sheet.pixels.resize(std::size_t{3} * sheet.width * sheet.height);
  for (std::uint32_t y = 0; y < sheet.height; ++y) {
    for (std::uint32_t x = 0; x < sheet.width; ++x) {
      const std::uint32_t column = x / enlarged % width;
      const std::uint8_t* before = pair.before.at(column, y / enlarged);
      const std::uint8_t* after = pair.after.at(column, y / enlarged);
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t which = x / enlarged / width;
        const int value = which == 0 ? before[c] : which == 1 ? after[c] : 255 - 4 * std::abs(before[c] - after[c]);
        sheet.at(x, y)[c] = static_cast<std::uint8_t>(std::max(value, 0));
      }
    }
  }
  return sheet;
}

double pop_of(const Model& model, render::SweepStyle style) {
  const auto report = render::sweep(model, sweep_options(style));
  if (!report) std::fprintf(stderr, "%s\n", to_line(report.error()).c_str());
  return report ? report->pop_max : -1.0;
}

double worst_of(const Model& model, std::size_t count, const std::string& folder) {
  std::vector<Pair> worst;
  Image last;
  auto options = sweep_options(render::SweepStyle::Morph);
  options.on_frame = [&](const Image& image, std::uint32_t frame) -> Status {
    if (frame > 0) {
      worst.push_back({frame, block_pop(last, image), last, image});
      std::stable_sort(worst.begin(), worst.end(), [](const Pair& a, const Pair& b) { return a.pop > b.pop; });
      if (worst.size() > count) worst.pop_back();
    }
    last = image;
    return Done{};
  };
  const auto report = render::sweep(model, options);
  std::filesystem::create_directories(folder);
  for (const Pair& pair : worst) {
    char name[64];
    std::snprintf(name, sizeof name, "/%05.2f_frame%03u.png", pair.pop, pair.frame);
    if (const auto written = write_image(enlarge(pair), folder + name); !written) std::fprintf(stderr, "not written\n");
  }
  return report ? report->pop_max : -1.0;
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t worst = 0;
  std::string folder;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--worst" && i + 2 < argc) {
      worst = std::strtoul(argv[i + 1], nullptr, 10);
      folder = argv[i + 2];
      i += 2;
    } else {
      files.push_back(word);
    }
  }
  int count = 0;
  std::printf("{\"buildings\": [");
  for (const std::string& file : files) {
    const auto loaded = read_mesh(file);
    if (!loaded) continue;
    const Mesh& source = loaded->mesh;
    const auto shift = build_by_facet_shift(source, {.texture_colors = mean_texture_colors(source)});
    if (!shift) continue;
    const std::string stem = std::filesystem::path{file}.stem().string();
    const double ours = worst > 0 ? worst_of(shift->model, worst, folder + "/" + stem)
                                  : pop_of(shift->model, render::SweepStyle::Morph);
    std::printf("%s\n{\"name\": \"%s\", \"facet_shift\": %.2f", count++ == 0 ? "" : ",", stem.c_str(), ours);
    if (worst == 0) {
      std::printf(", \"discrete\": %.2f, \"fade\": %.2f", pop_of(shift->model, render::SweepStyle::Discrete),
                  pop_of(shift->model, render::SweepStyle::Fade));
      const auto edge = build_by_edge_collapse(source);
      if (edge) std::printf(", \"edge_collapse\": %.2f", pop_of(edge->model, render::SweepStyle::Morph));
    }
    std::printf("}");
    std::fflush(stdout);
  }
  std::printf("]}\n");
  return count > 0 ? 0 : 1;
}

// SPDX-License-Identifier: MIT
// The first picture of a pyramid (Table 3 of Ao et al. 2025): a program that shows pyramids and nothing else, from
// where it is told to open one.
//
//     bench_first_picture FOLDER      the root tile of FOLDER/tileset.json, drawn once, with one sample a pixel
//     bench_first_picture             an empty picture: what the driver and a frame of this size take by themselves
//
// Prints one JSON object.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

#include <lodestone/tile_loader.h>

#include "processor_clock.h"
#include "viewer/headless/stage.h"
#include "viewer/render/tile_scene.h"

namespace {

using namespace lodestone;

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// Pages of the libraries that draw in software: what a machine with a graphics card has in its driver.
double driver_mb() {
  std::ifstream maps{"/proc/self/smaps"};
  double kb = 0.0;
  bool inside = false;
  for (std::string line; std::getline(maps, line);) {
    if (line.find("-") < line.find(" "))
      inside = line.find("libLLVM") != line.npos || line.find("libOSMesa") != line.npos;
    if (inside && line.rfind("Rss:", 0) == 0) kb += std::atof(line.c_str() + 4);
  }
  return kb / 1024.0;
}

// Memory of the process's own.
double private_mb() {
  std::ifstream status{"/proc/self/status"};
  for (std::string word; status >> word;) {
    double kb = 0.0;
    if (word == "RssAnon:" && status >> kb) return kb / 1024.0;
  }
  return 0.0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto start = std::chrono::steady_clock::now();
  std::shared_ptr<const TilePyramid> pyramid;
  if (argc > 1) {
    auto opened = TilePyramid::open(std::filesystem::path{argv[1]} / "tileset.json");
    if (!opened) return 2;
    pyramid = *opened;
  }
  auto stage = render::Stage::create();
  if (!stage) return 2;
  render::RenderOptions options{.width_px = 1280, .height_px = 720, .supersample = 1};
  std::optional<render::TileScene> scene;
  Box bounds{.min = glm::dvec3{-1.0}, .max = glm::dvec3{1.0}};
  if (pyramid) {
    scene.emplace((*stage)->gl(), pyramid);
    bounds = pyramid->bounds();
    options.camera.yaw_rad = scene->yaw_rad();
    options.look.lighting = scene->lighting(options.look.lighting);
  }
  const auto view = render::view_of(options, bounds, glm::dvec3{0.0}, {});
  render::FrameSize size = render::frame_size(options);
  size.coverage_samples = 1;
  const auto frame = render::Frame::create((*stage)->gl(), size);
  if (!view || !frame) return 2;
  std::span<const render::Item> items;
  if (scene) {
    scene->update(*view, 0.0);
    items = scene->items();
  }
  (*stage)->renderer().draw(*frame, *view, bounds, items, options.look);
  const Image picture = (*stage)->presenter().read(*frame);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf(
      "{\"first_picture_seconds\": %.2f, \"processor_seconds\": %.2f, \"peak_megabytes\": %.0f, "
      "\"private_megabytes\": %.0f, \"driver_megabytes\": %.0f, \"triangles\": %u}\n",
      seconds, processor_seconds(), peak_mb(), private_mb(), driver_mb(), scene ? scene->triangle_count() : 0);
  return picture.empty() ? 2 : 0;
}

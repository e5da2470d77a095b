// SPDX-License-Identifier: MIT
// How long the perceptual metric takes.
//
//     bench_perception [--triangles 196037] [--samples 200]
//
// Generates a house of so many triangles, and prints one JSON object: seconds of wall and processor for the samples on
// a screen of 1280 x 1024 (rendering and looking, headless; pixels far from the object are left out), and milliseconds
// of the wavelet, filters and reconstruction of one whole picture of that size on one thread, best of 20.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <lodestone/edge_collapse.h>
#include <lodestone/generate.h>

#include "processor_clock.h"
#include "viewer/headless/detail_stage.h"

namespace {

using namespace lodestone;

double clock_seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::uint32_t option(int argc, char** argv, const char* name, std::uint32_t otherwise) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], name) == 0) return static_cast<std::uint32_t>(std::strtoul(argv[i + 1], nullptr, 10));
  }
  return otherwise;
}

// The picture in the middle of a white screen.
Image on_screen(const Image& image, const Display& display) {
  Image screen{display.width_px, display.height_px, image.channels, {}};
  screen.pixels.assign(std::size_t{screen.width} * screen.height * screen.channels, 255);
  const std::uint32_t left = (screen.width - image.width) / 2;
  const std::uint32_t top = (screen.height - image.height) / 2;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    std::copy_n(image.at(0, y), std::size_t{image.width} * image.channels, screen.at(left, top + y));
  }
  return screen;
}

int fail(const Error& error) {
  std::fprintf(stderr, "bench_perception: %s\n", to_line(error).c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint32_t triangles = option(argc, argv, "--triangles", 196'037);
  const std::uint32_t count = option(argc, argv, "--samples", 200);
  HouseOptions house;
  house.triangles = triangles + triangles % 2;  // the generator makes even numbers
  house.pixels = Pixels::Skip;
  const auto mesh = generate_house(house);
  if (!mesh) return fail(mesh.error());
  // Only the finest level is looked at, so the stack is kept short.
  const auto built = build_by_edge_collapse(*mesh, {.target_triangles = mesh->triangle_count() - 100});
  if (!built) return fail(built.error());

  const Display display;
  const VisionModel vision{display};
  auto stage = render::DetailStage::create(built->model, display);
  if (!stage) return fail(stage.error());
  const Sides sides = find_sides(*mesh);
  const double first_m = first_distance_m(sides.bounds.radius_m, display.fov_y_rad);
  const auto picture = [&](double distance_m) { return (*stage)->picture(sides.front_rad, distance_m); };
  const double wall = clock_seconds(CLOCK_MONOTONIC);
  const double processor = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  const auto samples =
      sample_perceptual_metric({first_m, 15.6 * first_m, count, Sampling::EqualSteps}, vision, picture);
  const double wall_s = clock_seconds(CLOCK_MONOTONIC) - wall;
  const double processor_s = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - processor;
  if (!samples) return fail(samples.error());

  const auto first = picture(first_m);
  if (!first) return fail(first.error());
  const Image screen = on_screen(first->image, display);
  double filter_s = 1e9;
  for (int i = 0; i < 20; ++i) {
    const double start = thread_seconds();
    if (!vision.simulate(screen)) return 1;
    filter_s = std::min(filter_s, thread_seconds() - start);
  }
  std::printf(
      "{\"triangles\": %u, \"samples\": %zu, \"wall_seconds\": %.2f, \"processor_seconds\": %.2f, "
      "\"vision_milliseconds\": %.2f}\n",
      mesh->triangle_count(), samples->size(), wall_s, processor_s, 1e3 * filter_s);
  return 0;
}

// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 2000, Image-driven simplification (image metric over several views).
// Differs: six axis views, and only pixels that either mesh covers count, so that framing does not dilute the figure.
#include <cmath>

#include "stage.h"

namespace lodestone::render {
namespace {

// A mesh ready to draw on a stage.
struct Actor {
  Actor(const Gl& gl, const Mesh& mesh) : sorted(mesh), geometry(gl, sorted.arrays()), surfaces(gl, mesh) {}
  SortedMesh sorted;
  Geometry geometry;
  Surfaces surfaces;
};

struct SquareSum {
  double sum = 0.0;
  double count = 0.0;
};

void add_covered(SquareSum& total, const Image& a, const Image& b, const Image& empty) {
  for (std::size_t pixel = 0; pixel < a.pixels.size(); pixel += 3) {
    double squares = 0.0;
    bool covered = false;
    for (std::size_t c = pixel; c < pixel + 3; ++c) {
      const double difference = static_cast<double>(a.pixels[c]) - b.pixels[c];
      squares += difference * difference;
      covered = covered || a.pixels[c] != empty.pixels[c] || b.pixels[c] != empty.pixels[c];
    }
    if (!covered) continue;
    total.sum += squares;
    total.count += 3.0;
  }
}

}  // namespace

Result<double> six_direction_rms(const Mesh& a, const Mesh& b, std::uint32_t size_px, const Look& look) {
  if (size_px == 0) return Error{ErrorCode::BadArgument, "a picture needs at least one pixel", ""};
  auto stage = Stage::create();
  if (!stage) return stage.error();
  Stage& on = **stage;
  const auto frame = Frame::create(on.gl(), {size_px, size_px, 1});
  if (!frame) return frame.error();
  const Actor first{on.gl(), a};
  const Actor second{on.gl(), b};
  const glm::dvec3 offset_m = b.origin - a.origin;
  const Box framed = bounds(a);
  Box all = framed;
  const Box box_b = bounds(b);
  if (!box_b.empty()) {
    all.add(box_b.min + offset_m);
    all.add(box_b.max + offset_m);
  }
  const auto picture = [&](const View& view, std::span<const Item> items) {
    on.renderer().draw(*frame, view, all, items, look);
    return on.presenter().read(*frame);
  };
  SquareSum total;
  for (int direction = 0; direction < 6; ++direction) {
    const View view = axis_view(framed, direction, size_px, size_px);
    const Item item_a{.geometry = &first.geometry, .surfaces = &first.surfaces};
    const Item item_b{.geometry = &second.geometry, .surfaces = &second.surfaces, .offset_m = offset_m};
    add_covered(total, picture(view, {&item_a, 1}), picture(view, {&item_b, 1}), picture(view, {}));
  }
  return total.count > 0.0 ? std::sqrt(total.sum / total.count) : 0.0;
}

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
#include "generate/facade.h"

#include <algorithm>
#include <numbers>

namespace lodestone::generate {

namespace {

const int recess = grid(0.1875);
const int frame_width = grid(0.0625);
const int bar_width = grid(0.03125);
const int pane_depth = grid(0.03125);

// Outline of an opening or a pane: flat, or with a round arch above.
Loop2 outline_of(int u0, int u1, int z0, int z1, int arch) {
  Loop2 loop{{u0, z0}, {u1, z0}, {u1, z1}};
  if (arch > 0) {
    constexpr int steps = 10;
    for (int i = 1; i < steps; ++i) {
      const double angle = std::numbers::pi * i / steps;
      loop.emplace_back((u0 + u1) / 2 + static_cast<int>(std::lround(0.5 * (u1 - u0) * std::cos(angle))),
                        z1 + static_cast<int>(std::lround(arch * std::sin(angle))));
    }
  }
  loop.emplace_back(u0, z1);
  return loop;
}

Loop lift(const Facade& facade, const Loop2& flat, int out_by) {
  Loop loop;
  for (const Point2& p : flat) loop.push_back(facade.at(p.x, p.y, out_by));
  return loop;
}

Loop reversed(Loop loop) {
  std::reverse(loop.begin(), loop.end());
  return loop;
}

// The sides of a recess between two depths.
void add_reveal(House& house, const Facade& facade, const Loop2& outline, int front, int back, Look look) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Point2& p = outline[i];
    const Point2& q = outline[(i + 1) % outline.size()];
    house.body.add({{facade.at(p.x, p.y, front), facade.at(q.x, q.y, front), facade.at(q.x, q.y, back),
                     facade.at(p.x, p.y, back)}},
                   look);
  }
}

struct Pane {
  Loop2 outline;
  bool glazed = true;
};

std::vector<Pane> panes_of(const Opening& o) {
  std::vector<Pane> panes;
  const int left = o.u0 + frame_width;
  const int right = o.u1 - frame_width;
  const int bottom = o.z0 + frame_width;
  const int top = o.arch > 0 ? o.z1 - bar_width : o.z1 - frame_width;
  const int columns = o.columns;
  const int rows = o.rows;
  for (int r = 0; r < rows; ++r) {
    // The lowest row of doors is a panel, twice as high.
    const bool tall = o.leaf != Leaf::Window;
    const int parts = tall ? rows + 1 : rows;
    const auto edge = [&](int k) { return bottom + (top - bottom) * (tall && k > 0 ? k + 1 : k) / parts; };
    const int low = edge(r) + (r > 0 ? bar_width / 2 : 0);
    const int high = edge(r + 1) - (r + 1 < rows ? bar_width / 2 : 0);
    for (int c = 0; c < columns; ++c) {
      const int u0 = left + (right - left) * c / columns + (c > 0 ? bar_width / 2 : 0);
      const int u1 = left + (right - left) * (c + 1) / columns - (c + 1 < columns ? bar_width / 2 : 0);
      const bool panel =
          o.leaf == Leaf::Louvre || (o.leaf == Leaf::Door ? r + 1 < rows : o.leaf == Leaf::FrenchWindow && r == 0);
      panes.push_back({outline_of(u0, u1, low, high, 0), !panel});
    }
  }
  if (o.arch > 0)
    panes.push_back(
        {outline_of(left, right, o.z1 + bar_width, o.z1 + bar_width * 2, o.arch - frame_width - bar_width * 2),
         o.leaf != Leaf::Louvre});
  return panes;
}

void fill_opening(House& house, const Facade& facade, const Opening& o, FeatureId feature, Look wall) {
  const Palette& palette = house.palette;
  const Loop2 outline = outline_of(o.u0, o.u1, o.z0, o.z1, o.arch);
  add_reveal(house, facade, outline, 0, -recess, wall);
  const bool wooden = o.leaf == Leaf::Door || o.leaf == Leaf::Louvre;
  const Look frame{wooden ? palette.wood : palette.frame, feature};
  const Look panel{wooden ? palette.wood : palette.frame, feature};
  std::vector<Loop> rings{lift(facade, outline, -recess)};
  for (const Pane& pane : panes_of(o)) {
    rings.push_back(reversed(lift(facade, pane.outline, -recess)));
    add_reveal(house, facade, pane.outline, -recess, -recess - pane_depth, frame);
    const Look filling = pane.glazed ? Look{palette.glass, feature} : panel;
    house.body.add({lift(facade, pane.outline, -recess - pane_depth)}, filling);
  }
  house.body.add(std::move(rings), frame);
}

}  // namespace

Frame Facade::frame(int u, int z) const {
  return {metres(at(u, z)), {along.x, along.y, 0.0}, {0.0, 0.0, 1.0}, glm::dvec3{out()}};
}

Frame Facade::upright(int u, int z) const {
  return {metres(at(u, z)), {along.x, along.y, 0.0}, -glm::dvec3{out()}, {0.0, 0.0, 1.0}};
}

void add_wall(House& house, const Facade& facade, const Loop2& outline, const std::vector<Opening>& openings,
              Look look) {
  std::vector<Loop> rings{lift(facade, outline, 0)};
  for (const Opening& o : openings) {
    rings.push_back(reversed(lift(facade, outline_of(o.u0, o.u1, o.z0, o.z1, o.arch), 0)));
    const bool door = o.leaf == Leaf::Door || o.leaf == Leaf::FrenchWindow;
    const std::string id = (door ? "door_" : "window_") + std::to_string(house.mesh->features.size());
    const FeatureId feature = house.feature(id, door ? "Door" : "Window", look.feature);
    fill_opening(house, facade, o, feature, look);
  }
  house.body.add(std::move(rings), look);
}

}  // namespace lodestone::generate

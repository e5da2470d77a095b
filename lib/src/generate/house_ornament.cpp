// SPDX-License-Identifier: MIT
#include <algorithm>
#include <numbers>

#include "generate/house_plan.h"

namespace lodestone::generate {

namespace {

// How deep parts are let into the body, so that no face of theirs lies in one of its planes.
constexpr double sunk_m = 0.046875;

void box(House& house, Frame frame, const glm::dvec3& at, const glm::dvec3& size, Look look) {
  frame.origin = frame.at(at);
  house.parts.list.push_back({.shape = Shape::Box, .frame = frame, .size = size, .look = look});
}

// Turned baluster, vase-shaped, of that height.
std::vector<glm::dvec2> baluster(double h) {
  return {{0.055, 0.0},      {0.055, 0.06 * h}, {0.030, 0.10 * h}, {0.028, 0.16 * h}, {0.050, 0.26 * h},
          {0.060, 0.36 * h}, {0.052, 0.48 * h}, {0.030, 0.66 * h}, {0.024, 0.80 * h}, {0.036, 0.86 * h},
          {0.030, 0.91 * h}, {0.052, 0.95 * h}, {0.052, h}};
}

// A louvred panel seen from its end, (out, up).
std::vector<glm::dvec2> louvre(double height) {
  std::vector<glm::dvec2> outline{{-sunk_m, 0.0}, {0.035, 0.0}, {0.06, 0.005}, {0.06, 0.09}};
  const int slats = std::max(3, static_cast<int>((height - 0.18) / 0.075));
  const double step = (height - 0.18) / slats;
  for (int i = 0; i < slats; ++i) {
    outline.emplace_back(0.028, 0.09 + (i + 0.15) * step);
    outline.emplace_back(0.052, 0.09 + (i + 0.30) * step);
    outline.emplace_back(0.030, 0.09 + (i + 0.98) * step);
  }
  outline.insert(outline.end(), {{0.06, height - 0.09}, {0.06, height}, {-sunk_m, height}});
  return outline;
}

std::uint32_t shared_outline(House& house, std::vector<glm::dvec2> outline) {
  auto& all = house.parts.outlines;
  const auto found = std::find(all.begin(), all.end(), outline);
  return found != all.end() ? static_cast<std::uint32_t>(found - all.begin())
                            : house.parts.add_outline(std::move(outline));
}

void add_shutters(House& house, const Facade& facade, const Opening& o, FeatureId feature) {
  const double width = 0.42 * metres(o.u1 - o.u0);
  const double height = metres(o.z1 - o.z0);
  const std::uint32_t outline = shared_outline(house, louvre(height));
  for (const bool left : {true, false}) {
    const Frame wall = facade.frame(left ? o.u0 : o.u1, o.z0);
    Part part{
        .shape = Shape::Prism, .outline = outline, .size = {0.0, width, 0.0}, .look = {house.palette.shutter, feature}};
    const double gap = 0.19;
    part.frame = {wall.at({left ? -width - gap : gap, 0.0, 0.0}), wall.z, wall.x, wall.y};
    house.parts.list.push_back(part);
  }
}

}  // namespace

void add_opening_trim(House& house, const Facade& facade, const Opening& o, bool shutters, FeatureId feature) {
  const Look trim{house.palette.trim, feature};
  const double width = metres(o.u1 - o.u0);
  if (o.arch == 0) {
    Part part{.shape = Shape::Sweep,
              .moulding = Moulding::Surround,
              .segments = 1,
              .frame = facade.frame(o.u0, o.z0),
              .look = trim};
    part.size = {width, metres(o.z1 - o.z0), 0.0};
    house.parts.list.push_back(part);
  } else {
    const Frame key = facade.frame((o.u0 + o.u1) / 2, o.z1 + o.arch);
    const std::uint32_t outline = shared_outline(house, {{-0.09, -0.03}, {0.09, -0.03}, {0.14, 0.30}, {-0.14, 0.30}});
    Part part{.shape = Shape::Prism, .outline = outline, .size = {0.0, 0.10 + sunk_m, 0.0}, .look = trim};
    part.frame = {key.at({0.0, 0.0, 0.10}), key.x, -key.z, key.y};
    house.parts.list.push_back(part);
  }
  if (o.leaf == Leaf::Window) {
    const Frame sill = facade.upright((o.u0 + o.u1) / 2, o.z0);
    box(house, sill, {0.0, 0.02, -0.13}, {width + 0.44, 0.34, 0.10}, trim);
  }
  if (shutters && o.arch == 0 && o.leaf == Leaf::Window) add_shutters(house, facade, o, feature);
}

void add_balcony(House& house, const Facade& facade, const Opening& o, int floor_z) {
  const FeatureId feature =
      house.feature("balcony_" + std::to_string(house.mesh->features.size()), "BuildingInstallation", house.building);
  const Look stone{house.palette.trim, feature};
  const Frame f = facade.upright((o.u0 + o.u1) / 2, floor_z);
  constexpr double half = 1.05;
  constexpr double deep = 0.95;
  constexpr double rail = 0.85;
  box(house, f, {0.0, 0.5 * (sunk_m - deep), -0.18}, {2.0 * half + 0.12, deep + sunk_m, 0.15}, stone);
  const std::uint32_t bracket = shared_outline(
      house,
      {{-0.60, 0.40}, {-0.62, 0.30}, {-0.42, 0.24}, {-0.24, 0.12}, {-0.14, -0.06}, {sunk_m, -0.12}, {sunk_m, 0.40}});
  for (const double side : {-0.72, 0.72}) {
    Part part{.shape = Shape::Prism, .outline = bracket, .size = {0.0, 0.16, 0.0}, .look = stone};
    part.frame = {f.at({side + 0.08, 0.0, -0.55}), f.y, -f.x, f.z};
    house.parts.list.push_back(part);
  }
  // Three sides of turned balusters between a foot and a rail, posts at the corners.
  const std::uint32_t turned = shared_outline(house, baluster(rail + 0.02));
  const auto stand = [&](double x, double y) {
    Part part{.shape = Shape::Lathe, .segments = 6, .outline = turned, .frame = f, .look = stone};
    part.frame.origin = f.at({x, y, -0.04});
    house.parts.list.push_back(part);
  };
  const double front = -deep + 0.08;
  for (int i = 1; i < 11; ++i) stand(-half + 2.0 * half * i / 11, front);
  for (int i = 1; i < 5; ++i) {
    for (const double side : {-half, half}) stand(side, front - front * i / 5);
  }
  for (const double side : {-half, half}) {
    box(house, f, {side, front, -0.06}, {0.17, 0.17, rail + 0.24}, stone);
    box(house, f, {side, 0.5 * front, rail - 0.05}, {0.13, -front + 2.0 * sunk_m - 0.01, 0.09}, stone);
  }
  box(house, f, {0.0, front, rail - 0.055}, {2.0 * half, 0.14, 0.10}, stone);
}

void add_steps(House& house, const Facade& facade, const Opening& door, FeatureId feature) {
  const Look stone{house.palette.trim, feature};
  const Frame f = facade.upright((door.u0 + door.u1) / 2, 0);
  const double width = metres(door.u1 - door.u0);
  const double floor = metres(door.z0);
  constexpr int steps = 3;
  for (int i = 0; i < steps; ++i) {
    const double run = 0.32 * (steps - i);
    box(house, f, {0.0, 0.5 * (sunk_m - run), 0.0},
        {width + 0.9 + 0.3 * (steps - i), run + sunk_m, floor * (i + 1) / steps - 0.01}, stone);
  }
}

void add_pediment(House& house, const Facade& facade, const Opening& door, FeatureId feature) {
  const Look stone{house.palette.trim, feature};
  const Frame f = facade.upright((door.u0 + door.u1) / 2, 0);
  const double width = metres(door.u1 - door.u0);
  // On two consoles over the door.
  const double top = metres(door.z1 + door.arch) + 0.42;
  const double half = 0.5 * width + 0.45;
  box(house, f, {0.0, 0.5 * (sunk_m - 0.5), top - 0.12}, {2.0 * half, 0.5 + sunk_m, 0.12}, stone);
  const std::uint32_t gable = shared_outline(
      house, {{-half - 0.06, 0.0}, {half + 0.06, 0.0}, {half + 0.06, 0.06}, {0.0, 0.5}, {-half - 0.06, 0.06}});
  Part pediment{.shape = Shape::Prism, .outline = gable, .size = {0.0, 0.55 + sunk_m, 0.0}, .look = stone};
  pediment.frame = f;
  pediment.frame.origin = f.at({0.0, -0.55, top - 0.01});
  house.parts.list.push_back(pediment);
  for (const double side : {-1.0, 1.0})
    box(house, f, {side * (half - 0.16), 0.5 * (sunk_m - 0.32), top - 0.55}, {0.16, 0.32 + sunk_m, 0.45}, stone);
}

void add_lamps(House& house, const Facade& facade, const Opening& door, FeatureId feature) {
  const Frame f = facade.upright((door.u0 + door.u1) / 2, 0);
  const double half = 0.5 * metres(door.u1 - door.u0) + 0.45;
  for (const double side : {-1.0, 1.0}) {
    const std::uint32_t lamp =
        shared_outline(house, {{0.03, 0.0}, {0.09, 0.06}, {0.11, 0.14}, {0.12, 0.34}, {0.04, 0.42}, {0.02, 0.50}});
    Part part{
        .shape = Shape::Lathe, .segments = 8, .outline = lamp, .frame = f, .look = {house.palette.metal, feature}};
    part.frame.origin = f.at({side * (half + 0.12), -0.10, metres(door.z0) + 1.7});
    house.parts.list.push_back(part);
  }
}

void add_clock(House& house, const Facade& facade, int u, int z, FeatureId feature) {
  const Frame wall = facade.frame(u, z);
  const Look face{house.palette.frame, feature};
  const Look hands{house.palette.metal, feature};
  const std::uint32_t disc =
      shared_outline(house, {{0.86, 0.0}, {0.86, 0.10}, {0.80, 0.14}, {0.74, 0.10}, {0.72, 0.09}});
  Part part{.shape = Shape::Lathe, .segments = 12, .outline = disc, .frame = wall, .look = face};
  part.frame.origin = wall.at({0.0, 0.0, -sunk_m});
  house.parts.list.push_back(part);
  // Ten past ten; twelve marks around.
  for (int hour = 0; hour < 12; ++hour) {
    const double angle = std::numbers::pi * hour / 6.0;
    const glm::dvec3 out = wall.turn({std::sin(angle), std::cos(angle), 0.0});
    const Frame ray{wall.at({0.0, 0.0, 0.045}), wall.z, glm::cross(out, wall.z), out};
    const double from = hour == 10 || hour == 2 ? 0.0 : 0.56;
    const double to = hour == 10 ? 0.42 : 0.66;
    box(house, ray, {0.0, 0.0, from}, {0.06, hour % 3 == 0 ? 0.08 : 0.05, to - from}, hands);
  }
}

void add_ring(House& house, const Footprint& plan, int z, Moulding moulding, Look look) {
  Part part{.shape = Shape::Sweep, .moulding = moulding, .segments = 2, .look = look};
  part.frame.origin = metres(Point{plan.x0, plan.y0, z});
  part.size = {metres(plan.width()), metres(plan.depth()), 0.0};
  house.parts.list.push_back(part);
}

void add_dentils(House& house, const Footprint& plan, int z, Look look) {
  for (int k = 0; k < 4; ++k) {
    const double width = metres(k % 2 == 0 ? plan.width() : plan.depth());
    const int count = static_cast<int>(width / 0.36);
    const Frame f = plan.side(k).upright(0, z);
    for (int i = 0; i < count; ++i) {
      box(house, f, {width * (i + 0.5) / count, 0.5 * (sunk_m - 0.22), 0.0}, {0.17, 0.22 + sunk_m, 0.2}, look);
    }
  }
}

void add_quoins(House& house, const Footprint& plan, int z0, int z1, Look look) {
  const double height = metres(z1 - z0);
  const int count = std::max(1, static_cast<int>(height / 0.42));
  for (int k = 0; k < 4; ++k) {
    const Frame corner = plan.side(k).upright(0, z0);
    for (int i = 0; i < count; ++i) {
      // Long and short in turn, around the corner.
      const double along = i % 2 == 0 ? 0.62 : 0.38;
      const double back = i % 2 == 0 ? 0.38 : 0.62;
      box(house, corner, {0.5 * along - 0.035, 0.5 * back - 0.035, height * i / count + 0.012},
          {along, back, height / count - 0.024}, look);
    }
  }
}

void add_chimney_pots(House& house, const Point& top) {
  const Look clay{house.palette.tile, house.building};
  Frame f;
  f.origin = metres(top);
  box(house, f, {0.0, 0.0, -0.16}, {1.16, 0.80, 0.12}, {house.palette.trim, house.building});
  const std::uint32_t pot = shared_outline(
      house,
      {{0.15, 0.0}, {0.15, 0.05}, {0.11, 0.09}, {0.10, 0.42}, {0.14, 0.46}, {0.14, 0.52}, {0.10, 0.53}, {0.09, 0.30}});
  for (const double x : {-0.24, 0.24}) {
    Part part{.shape = Shape::Lathe, .segments = 8, .outline = pot, .frame = f, .look = clay};
    part.frame.origin = f.at({x, 0.0, -0.02});
    house.parts.list.push_back(part);
  }
}

void add_ridge_tiles(House& house, const std::array<Point, 2>& ridge, double width_m, Look look) {
  const glm::dvec3 a = metres(ridge[0]);
  const glm::dvec3 d = metres(ridge[1]) - a;
  const double length = glm::length(d);
  const int count = std::max(1, static_cast<int>(length / (1.6 * width_m)));
  Part tile{.shape = Shape::Tile,
            .segments = 4,
            .size = {1.35 * width_m, 1.12 * length / count, 0.55 * width_m},
            .look = look};
  tile.frame.y = d / length;
  tile.frame.x = glm::normalize(glm::cross(tile.frame.y, glm::dvec3{0.0, 0.0, 1.0}));
  tile.frame.z = glm::cross(tile.frame.x, tile.frame.y);
  tile.frame.y = glm::normalize(tile.frame.y - 0.03 * tile.frame.z);
  tile.frame.z = glm::cross(tile.frame.x, tile.frame.y);
  for (int i = 0; i < count; ++i) {
    tile.frame.origin = a + d * (static_cast<double>(i) / count) + 0.02 * tile.frame.z;
    house.parts.list.push_back(tile);
  }
}

void add_finial(House& house, const Point& foot, Look look) {
  Part part{.shape = Shape::Spike, .segments = 8, .look = look};
  // Most of the lower cone stands in what carries it: on its tip it would seem to float.
  part.frame.origin = metres(foot) + glm::dvec3{0.0, 0.0, -0.25};
  part.size = {0.28, 0.28, 1.1};
  house.parts.list.push_back(part);
}

}  // namespace lodestone::generate

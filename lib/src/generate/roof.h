// SPDX-License-Identifier: MIT
// Roofs that close a house's body, with dormers and chimneys cut into them.
#pragma once

#include <array>
#include <vector>

#include "generate/facade.h"

namespace lodestone::generate {

// An upright box of the plan, lattice lengths.
struct Footprint {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int depth() const { return y1 - y0; }
  // Front (facing -y), right, back, left.
  [[nodiscard]] Facade side(int k) const;
};

// One plane of a roof: u along the eave, v level distance from the eave inwards; rises `quarters` / 4 per metre.
struct Slope {
  Facade eave;  // origin on the eave line at u = 0; its z counts from 0
  int z0 = 0;   // height of the eave
  int quarters = 4;
  Loop2 outline;             // (u, v), counter-clockwise from above, convex
  std::vector<Loop2> holes;  // counter-clockwise; convex
  MaterialId material = 0;
  FeatureId feature = 0;

  [[nodiscard]] int z(int v) const { return z0 + v * quarters / 4; }
  [[nodiscard]] Point at(int u, int v) const { return eave.at(u, z(v), -v); }
  [[nodiscard]] Point above(int u, int v, int height) const { return eave.at(u, height, -v); }
};

struct RoofShape {
  std::vector<Slope> slopes;
  std::vector<std::array<Point, 2>> ridges;  // ridges and hips, to be capped
  int top = 0;                               // height of the highest point
};

// Each closes the body above walls that end at height `eave_z`. Slopes are returned, not yet added, so that dormers and
// chimneys can be cut first.
[[nodiscard]] RoofShape add_flat_roof(House& house, const Footprint& plan, int eave_z);
// Gable walls stand on sides 1 and 3. With `tower_from` < `tower_to` (along y) the roof ends flush at x0 against a
// tower.
[[nodiscard]] RoofShape add_gable_roof(House& house, const Footprint& plan, int eave_z, int quarters,
                                       FeatureId right_wall, FeatureId left_wall, int tower_from = 0, int tower_to = 0);
[[nodiscard]] RoofShape add_hip_roof(House& house, const Footprint& plan, int eave_z, int quarters);
// A steep pyramid with flared eaves on a square plan.
[[nodiscard]] RoofShape add_spire(House& house, const Footprint& plan, int eave_z);

// Cuts a dormer with its front at v, centred on u; false (nothing done) if it does not fit below the ridge
// and beside what has been cut already.
bool add_dormer(House& house, Slope& slope, int u, int v);
// Cuts a chimney, u and v its middle; returns its top's middle. Precondition: it fits on the slope.
Point add_chimney(House& house, Slope& slope, int u, int v, int top_z);
void add_slope(House& house, const Slope& slope);
// Tiles on a slope as closed parts, `width_m` apart, none on holes.
void add_tiles(House& house, const Slope& slope, double width_m);

}  // namespace lodestone::generate

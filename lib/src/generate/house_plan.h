// SPDX-License-Identifier: MIT
// What a house will be like, and the drawing of it.
#pragma once

#include <vector>

#include "generate/roof.h"

namespace lodestone::generate {

// How much a house is given. Richer tiers have more of everything.
struct Tier {
  int storeys, bays, side_bays;
  bool trim;  // sills, surrounds, cornice, shutters
  bool balconies;
  bool dentils;   // dentils, quoins
  double tile_m;  // width of roof tiles; 0 = painted only
};

struct HousePlan {
  Roof roof = Roof::Gable;
  Tier tier{};
  std::uint64_t seed = 1;
};

// The tier with that index, 0 the plainest; beyond the last it stays the last.
[[nodiscard]] Tier tier(std::uint32_t index, std::uint64_t seed);

// Draws the body and all parts. Materials must be in the mesh; features are added to it.
[[nodiscard]] House draw_house(Mesh& mesh, const Palette& palette, const HousePlan& plan, const std::string& prefix);

// Chooses the richest tier that fits into `triangles` and divides curved parts until it is met exactly (even numbers
// from the plainest house's size on). Appends to the mesh.
void append_house(Mesh& mesh, const Palette& palette, Roof roof, std::uint64_t seed, std::uint32_t triangles,
                  const std::string& prefix, const Context& context);

// Ornaments: closed parts on a facade.
void add_opening_trim(House& house, const Facade& facade, const Opening& o, bool shutters, FeatureId feature);
void add_balcony(House& house, const Facade& facade, const Opening& o, int floor_z);
void add_steps(House& house, const Facade& facade, const Opening& door, FeatureId feature);
void add_pediment(House& house, const Facade& facade, const Opening& door, FeatureId feature);
void add_lamps(House& house, const Facade& facade, const Opening& door, FeatureId feature);
void add_clock(House& house, const Facade& facade, int u, int z, FeatureId feature);  // its centre
void add_ring(House& house, const Footprint& plan, int z, Moulding moulding, Look look);
void add_dentils(House& house, const Footprint& plan, int z, Look look);
void add_quoins(House& house, const Footprint& plan, int z0, int z1, Look look);
void add_chimney_pots(House& house, const Point& top);
void add_ridge_tiles(House& house, const std::array<Point, 2>& ridge, double width_m, Look look);
void add_finial(House& house, const Point& foot, Look look);

}  // namespace lodestone::generate

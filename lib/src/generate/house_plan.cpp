// SPDX-License-Identifier: MIT
#include "generate/house_plan.h"

#include <algorithm>

#include "base/rng.h"

namespace lodestone::generate {

namespace {

const int bay = grid(2.5);
const int margin = grid(0.75);
const int ground_height = grid(4.0);
const int storey_height = grid(3.25);

struct Draft {
  House& house;
  const HousePlan& plan;
  Rng rng;
  FeatureId walls[4] = {0, 0, 0, 0};
  bool arched_ground = false;
  bool shutters = false;
};

int floor_z(int storey) { return storey == 0 ? 0 : ground_height + (storey - 1) * storey_height; }

Opening opening_at(const Draft& d, int side, int storey, int i, int bays) {
  Opening o;
  const int middle = margin + bay * i + bay / 2;
  const int base = floor_z(storey);
  o.u0 = middle - grid(0.5625);
  o.u1 = middle + grid(0.5625);
  o.z0 = base + grid(storey == 0 ? 1.25 : 0.9375);
  o.z1 = base + grid(storey == 0 ? 3.0 : 2.6875);
  if (!d.plan.tier.trim) o.rows = 2;
  if (storey == 0 && d.arched_ground) o.arch = (o.u1 - o.u0) / 2;
  if (storey == 0 && side == 0 && i == bays / 2) {
    o.leaf = Leaf::Door;
    o.z0 = grid(0.5);
    o.rows = 3;
  }
  return o;
}

// Whether that bay of the front has a balcony: a pattern, so that it looks meant.
bool has_balcony(const Draft& d, int storey, int i, int bays) {
  if (!d.plan.tier.balconies || storey == 0) return false;
  const std::uint64_t pattern = d.plan.seed % 3;
  if (pattern == 0) return i == bays / 2;
  if (pattern == 1) return storey == 1 && i % 2 == 1;
  return (i + storey) % 3 == 1;
}

void add_entrance(Draft& d, const Facade& facade, const Opening& door, int bays) {
  const std::string id = "entrance_" + std::to_string(d.house.mesh->features.size());
  const FeatureId feature = d.house.feature(id, "BuildingInstallation", d.house.building);
  add_steps(d.house, facade, door, feature);
  if (d.plan.tier.trim) add_lamps(d.house, facade, door, feature);
  // A balcony over the door takes the pediment's place.
  if (!has_balcony(d, 1, bays / 2, bays)) add_pediment(d.house, facade, door, feature);
}

void add_storey(Draft& d, const Footprint& footprint, int side, int storey) {
  House& house = d.house;
  const Facade facade = footprint.side(side);
  const int width = side % 2 == 0 ? footprint.width() : footprint.depth();
  const int bays = (width - 2 * margin) / bay;
  const int low = floor_z(storey);
  const int high = floor_z(storey + 1);
  std::vector<Opening> openings;
  std::vector<bool> balconies;
  for (int i = 0; i < bays; ++i) {
    Opening o = opening_at(d, side, storey, i, bays);
    const bool balcony = side == 0 && has_balcony(d, storey, i, bays);
    if (balcony) {
      o.leaf = Leaf::FrenchWindow;
      o.z0 = low + grid(0.1875);
    }
    openings.push_back(o);
    balconies.push_back(balcony);
  }
  const Look look{storey == 0 ? house.palette.stone : house.palette.plaster, d.walls[side]};
  add_wall(house, facade, {{0, low}, {width, low}, {width, high}, {0, high}}, openings, look);
  for (std::size_t i = 0; i < openings.size(); ++i) {
    const Opening& o = openings[i];
    if (d.plan.tier.trim) add_opening_trim(house, facade, o, d.shutters && storey > 0, d.walls[side]);
    if (balconies[i]) add_balcony(house, facade, o, o.z0 - grid(0.0625));
    if (o.leaf == Leaf::Door) add_entrance(d, facade, o, bays);
  }
}

void add_ground(House& house, const Footprint& f) {
  const FeatureId feature =
      house.feature("ground_" + std::to_string(house.mesh->features.size()), "GroundSurface", house.building);
  house.body.add({{{f.x0, f.y0, 0}, {f.x0, f.y1, 0}, {f.x1, f.y1, 0}, {f.x1, f.y0, 0}}},
                 {house.palette.stone, feature});
}

// The hall's wall against which the tower stands: a strip on either side of it.
void add_tower_side(Draft& d, const Footprint& hall, int from, int to, int top) {
  const Facade facade = hall.side(3);
  for (int storey = 0; floor_z(storey) < top; ++storey) {
    const int low = floor_z(storey);
    const int high = std::min(top, floor_z(storey + 1));
    const Look look{storey == 0 ? d.house.palette.stone : d.house.palette.plaster, d.walls[3]};
    add_wall(d.house, facade, {{0, low}, {from, low}, {from, high}, {0, high}}, {}, look);
    add_wall(d.house, facade, {{to, low}, {hall.depth(), low}, {hall.depth(), high}, {to, high}}, {}, look);
  }
}

// A tower at the hall's left side, in storeys, with a belfry and a spire.
RoofShape add_tower(Draft& d, const Footprint& tower, int hall_top, int ridge_top,
                    const std::array<Point, 3>& roof_line) {
  House& house = d.house;
  const FeatureId wall_feature = house.feature("tower", "WallSurface", house.building);
  const int width = tower.width();
  const int shaft = (ridge_top + grid(0.75)) / 256 * 256;
  const int top = shaft + grid(3.75);
  const Look stone{house.palette.stone, wall_feature};
  const Look plaster{house.palette.plaster, wall_feature};
  const int half = width / 2;
  for (const int side : {0, 2, 3}) {
    const Facade facade = tower.side(side);
    const int slit = grid(0.3125);
    std::vector<Opening> low{{half - slit, half + slit, grid(1.5), grid(2.75), slit, Leaf::Window, 1, 2}};
    std::vector<Opening> high{
        {half - slit, half + slit, hall_top - grid(1.5), hall_top + grid(0.5), slit, Leaf::Window, 1, 3}};
    add_wall(house, facade, {{0, 0}, {width, 0}, {width, ground_height}, {0, ground_height}}, low, stone);
    add_wall(house, facade, {{0, ground_height}, {width, ground_height}, {width, shaft}, {0, shaft}}, high, plaster);
    if (d.plan.tier.trim) {
      add_opening_trim(house, facade, low[0], false, wall_feature);
      add_opening_trim(house, facade, high[0], false, wall_feature);
      add_clock(house, facade, half, shaft - grid(1.25), wall_feature);
    }
  }
  // Above the hall's roof the tower has a fourth side.
  house.body.add({{roof_line[0], roof_line[1], roof_line[2], Point{tower.x1, roof_line[2].y, shaft},
                   Point{tower.x1, roof_line[0].y, shaft}}},
                 plaster);
  for (int side = 0; side < 4; ++side) {
    const Facade facade = tower.side(side);
    const int wide = grid(0.625);
    const Opening belfry{half - wide, half + wide, shaft + grid(0.75), shaft + grid(2.25), wide, Leaf::Louvre, 1, 7};
    add_wall(house, facade, {{0, shaft}, {width, shaft}, {width, top}, {0, top}}, {belfry}, plaster);
    if (d.plan.tier.trim) add_opening_trim(house, facade, belfry, false, wall_feature);
  }
  add_ground(house, tower);
  if (d.plan.tier.trim) {
    add_ring(house, tower, shaft, Moulding::Band, {house.palette.trim, wall_feature});
    add_ring(house, tower, top - grid(0.46875), Moulding::Cornice, {house.palette.trim, wall_feature});
  }
  return add_spire(house, tower, top);
}

// Near the ridge on the back, or on the deck.
void add_chimneys(Draft& d, RoofShape& roof) {
  const bool flat = d.plan.roof == Roof::Flat;
  Slope& slope = flat ? roof.slopes[0] : roof.slopes[roof.slopes.size() > 2 ? 2 : 1];
  const int width = slope.outline[1].x;
  const int depth = slope.outline[2].y;
  const int v = (flat ? depth * 3 / 4 : depth - grid(0.75)) / 64 * 64;
  const int reach = flat ? 0 : slope.outline[1].x - slope.outline[2].x;  // of the hips
  const int ridge = width - 2 * reach;
  for (const int share : {1, 3}) {
    if (ridge < grid(share == 1 ? 2.0 : 5.0)) continue;
    const int u = (reach + grid(0.75) + (ridge - grid(1.5)) * share / 4) / 64 * 64;
    add_chimney_pots(d.house, add_chimney(d.house, slope, u, v, roof.top + grid(0.875)));
  }
}

// In the long sides of a roof, wherever there is room.
void add_dormers(Draft& d, RoofShape& roof) {
  for (Slope& slope : roof.slopes) {
    if (slope.eave.along.x == 0 || slope.quarters == 0) continue;
    const int width = slope.outline[1].x;
    const int step = 2 * bay;
    const int count = std::max(1, (width - 2 * bay) / step);
    for (int i = 0; i < count; ++i) {
      add_dormer(d.house, slope, (width / 2 + step * (2 * i - count + 1) / 2) / 64 * 64, grid(1.0));
    }
  }
}

void finish_roof(Draft& d, const RoofShape& roof, bool slate) {
  const double tile = d.plan.tier.tile_m;
  for (const Slope& slope : roof.slopes) {
    add_slope(d.house, slope);
    if (tile > 0.0 && slope.quarters > 0 && !slate) add_tiles(d.house, slope, tile);
  }
  const Slope& any = roof.slopes.front();
  for (const auto& ridge : roof.ridges) {
    if (tile > 0.0 && !slate) add_ridge_tiles(d.house, ridge, tile, {any.material, any.feature});
  }
}

void add_mouldings(Draft& d, const Footprint& footprint, int eave_z) {
  House& house = d.house;
  const FeatureId feature = house.feature("mouldings", "BuildingInstallation", house.building);
  const Look trim{house.palette.trim, feature};
  if (d.plan.tier.trim) {
    for (int s = 1; s < d.plan.tier.storeys; ++s)
      add_ring(house, footprint, floor_z(s) - grid(0.0625), Moulding::Band, trim);
    add_ring(house, footprint, eave_z - grid(0.46875), Moulding::Cornice, trim);
  }
  if (d.plan.tier.dentils) {
    add_dentils(house, footprint, eave_z - grid(0.703125), trim);
    for (int s = 1; s < d.plan.tier.storeys; ++s) {
      const bool last = s + 1 == d.plan.tier.storeys;
      add_quoins(house, footprint, floor_z(s) + grid(0.1875), floor_z(s + 1) - grid(last ? 0.75 : 0.125), trim);
    }
  }
}

RoofShape add_hall_roof(Draft& d, const Footprint& hall, int eave_z, int quarters) {
  switch (d.plan.roof) {
    case Roof::Flat:
      return add_flat_roof(d.house, hall, eave_z);
    case Roof::Hip:
      return add_hip_roof(d.house, hall, eave_z, quarters);
    case Roof::Gable:
      return add_gable_roof(d.house, hall, eave_z, quarters, d.walls[1], d.walls[3]);
    case Roof::Spire:
      break;
  }
  const int side = grid(4.5);
  const int from = (hall.depth() - side) / 2;
  const int to = from + side;
  add_tower_side(d, hall, from, to, eave_z);
  RoofShape roof = add_gable_roof(d.house, hall, eave_z, quarters, d.walls[1], d.walls[3], from, to);
  const Footprint tower{hall.x0 - side, hall.y0 + from, hall.x0, hall.y0 + to};
  const auto over = [&](int y, int from_wall) {
    return Point{hall.x0, y, eave_z + grid(0.25) + from_wall * quarters / 4};
  };
  const std::array<Point, 3> line{over(tower.y0, from), over(hall.y0 + hall.depth() / 2, hall.depth() / 2),
                                  over(tower.y1, from)};
  const RoofShape spire = add_tower(d, tower, eave_z, roof.top, line);
  finish_roof(d, spire, true);
  add_finial(d.house, {(tower.x0 + tower.x1) / 2, (tower.y0 + tower.y1) / 2, spire.top},
             {d.house.palette.metal, d.house.building});
  return roof;
}

}  // namespace

House draw_house(Mesh& mesh, const Palette& palette, const HousePlan& plan, const std::string& prefix) {
  House house;
  house.mesh = &mesh;
  house.palette = palette;
  house.prefix = prefix;
  house.building = house.feature("building", "Building", none);
  Draft d{house, plan, Rng{plan.seed, 51}};
  static constexpr const char* names[] = {"front", "right", "back", "left"};
  for (int k = 0; k < 4; ++k)
    d.walls[k] = house.feature(std::string{"wall_"} + names[k], "WallSurface", house.building);
  d.arched_ground = d.rng.unit() < 0.5 && plan.tier.trim;
  d.shutters = plan.tier.trim && d.rng.unit() < 0.7;
  const Footprint hall{0, 0, plan.tier.bays * bay + 2 * margin, plan.tier.side_bays * bay + 2 * margin};
  const int eave_z = floor_z(plan.tier.storeys);
  for (int storey = 0; storey < plan.tier.storeys; ++storey) {
    for (int side = 0; side < 4; ++side) {
      if (plan.roof != Roof::Spire || side != 3) add_storey(d, hall, side, storey);
    }
  }
  add_ground(house, hall);
  const int quarters = plan.tier.side_bays > 4 ? 3 : 4;
  RoofShape roof = add_hall_roof(d, hall, eave_z, quarters);
  add_chimneys(d, roof);
  add_dormers(d, roof);
  finish_roof(d, roof, false);
  add_mouldings(d, hall, eave_z);
  const Look metal{palette.metal, house.building};
  if (roof.ridges.empty()) {
    for (const int x : {hall.x0 + grid(0.1875), hall.x1 - grid(0.1875)})
      add_finial(house, {x, hall.y0 + grid(0.1875), roof.top}, metal);
  } else {
    const auto& ridge = roof.ridges.back();
    for (const Point& end : ridge) add_finial(house, end, metal);
  }
  house.body.close_t_junctions();
  return house;
}

}  // namespace lodestone::generate

// SPDX-License-Identifier: MIT
#include "generate/roof.h"

#include <algorithm>
#include <array>

namespace lodestone::generate {

namespace {

const int overhang = grid(0.5);
const int fascia = grid(0.25);

Look roof_look(const House& house, FeatureId feature) { return {house.palette.tile, feature}; }

FeatureId roof_feature(House& house, const char* name) {
  const std::string id = std::string{name} + "_" + std::to_string(house.mesh->features.size());
  return house.feature(id, "RoofSurface", house.building);
}

// Soffit (a level ring from the walls out to the eaves) and fascia; returns the plan of the eaves.
Footprint add_eaves(House& house, const Footprint& plan, int eave_z, int out_by, int height, Look look) {
  const Footprint outer{plan.x0 - out_by, plan.y0 - out_by, plan.x1 + out_by, plan.y1 + out_by};
  const auto ring = [&](const Footprint& f) {
    return Loop{
        {f.x0, f.y0, eave_z}, {f.x0, f.y1, eave_z}, {f.x1, f.y1, eave_z}, {f.x1, f.y0, eave_z}};  // seen from below
  };
  Loop inner = ring(plan);
  std::reverse(inner.begin(), inner.end());
  house.body.add({ring(outer), inner}, look);
  for (int k = 0; k < 4; ++k) {
    const Facade side = outer.side(k);
    const int width = k % 2 == 0 ? outer.width() : outer.depth();
    house.body.add(
        {{side.at(0, eave_z), side.at(width, eave_z), side.at(width, eave_z + height), side.at(0, eave_z + height)}},
        look);
  }
  return outer;
}

// The four planes over a rectangular eave, up to level `inset` from it, or to the ridge if that is nearer.
void add_hip_slopes(RoofShape& roof, const Footprint& eaves, int z0, int quarters, int inset, MaterialId material,
                    FeatureId feature) {
  for (int k = 0; k < 4; ++k) {
    const int width = k % 2 == 0 ? eaves.width() : eaves.depth();
    const int across = k % 2 == 0 ? eaves.depth() : eaves.width();
    const int rise_v = std::min({inset, width / 2, across / 2});
    Slope slope;
    slope.eave = eaves.side(k);
    slope.z0 = z0;
    slope.quarters = quarters;
    slope.outline = {{0, 0}, {width, 0}, {width - rise_v, rise_v}};
    if (width != 2 * rise_v) slope.outline.emplace_back(rise_v, rise_v);
    slope.material = material;
    slope.feature = feature;
    roof.top = std::max(roof.top, slope.z(rise_v));
    roof.ridges.push_back({slope.at(0, 0), slope.at(rise_v, rise_v)});
    roof.slopes.push_back(std::move(slope));
  }
}

// The planes of a gable roof's slab, and the numbers they share.
struct Gable {
  Footprint plan;
  int eave_z, quarters, left, right;  // left, right: how far the roof runs past the gable walls
  [[nodiscard]] int under(int y_from_wall) const { return eave_z + y_from_wall * quarters / 4; }
  [[nodiscard]] int over(int y_from_wall) const { return under(y_from_wall) + fascia; }
  [[nodiscard]] int half() const { return plan.depth() / 2; }
};

// Underside of one slope outside the walls; `eave` has u = 0 at the wall's left corner.
void add_underside(House& house, const Gable& g, const Facade& wall, int before, int after, Look look) {
  const int width = g.plan.width();
  const auto at = [&](int u, int v) { return wall.at(u, g.under(v), -v); };
  Loop loop{at(-before, -overhang)};
  if (before > 0) loop.insert(loop.end(), {at(-before, g.half()), at(0, g.half())});
  loop.push_back(at(0, 0));
  loop.push_back(at(width, 0));
  if (after > 0) loop.insert(loop.end(), {at(width, g.half()), at(width + after, g.half())});
  loop.push_back(at(width + after, -overhang));
  house.body.add({loop}, look);
}

// The end of the slab, in the plane of the facade `side`: whole if it overhangs, else in two pieces beside a tower.
void add_verge(House& house, const Gable& g, const Facade& side, int out_by, int from, int to, Look look) {
  const int depth = g.plan.depth();
  const auto from_wall = [&](int u) { return u <= g.half() ? u : depth - u; };
  const auto low = [&](int u) { return side.at(u, g.under(from_wall(u)), out_by); };
  const auto high = [&](int u) { return side.at(u, g.over(from_wall(u)), out_by); };
  if (from < to) {
    house.body.add({{low(-overhang), low(0), low(from), high(from), high(-overhang)}}, look);
    house.body.add({{low(to), low(depth), low(depth + overhang), high(depth + overhang), high(to)}}, look);
    return;
  }
  house.body.add(
      {{low(-overhang), low(g.half()), low(depth + overhang), high(depth + overhang), high(g.half()), high(-overhang)}},
      look);
}

void add_gable_walls(House& house, const Gable& g, FeatureId right_wall, FeatureId left_wall, int from, int to) {
  const int depth = g.plan.depth();
  const Look right{house.palette.plaster, right_wall};
  const Look left{house.palette.plaster, left_wall};
  const int top = g.under(g.half());
  const int sill = g.eave_z + grid(0.5);
  const int half_window = grid(0.5);
  std::vector<Opening> attic;
  if (g.under(g.half() - half_window - grid(0.25)) > sill + grid(1.5)) {
    attic.push_back(
        {g.half() - half_window, g.half() + half_window, sill, sill + grid(0.875), half_window, Leaf::Window, 2, 2});
  }
  add_wall(house, g.plan.side(1), {{0, g.eave_z}, {depth, g.eave_z}, {g.half(), top}}, attic, right);
  if (from < to) {
    add_wall(house, g.plan.side(3), {{0, g.eave_z}, {from, g.eave_z}, {from, g.under(from)}}, {}, left);
    add_wall(house, g.plan.side(3), {{to, g.eave_z}, {depth, g.eave_z}, {to, g.under(depth - to)}}, {}, left);
  } else {
    add_wall(house, g.plan.side(3), {{0, g.eave_z}, {depth, g.eave_z}, {g.half(), top}}, attic, left);
  }
}

// Whether the boxes around two outlines come nearer than `clear`.
bool near(const Loop2& a, const Loop2& b, int clear) {
  const auto box = [](const Loop2& loop) {
    std::array<Point2, 2> ends{loop[0], loop[0]};
    for (const Point2& p : loop) ends = {glm::min(ends[0], p), glm::max(ends[1], p)};
    return ends;
  };
  const auto [a_low, a_high] = box(a);
  const auto [b_low, b_high] = box(b);
  return a_low.x - clear < b_high.x && b_low.x - clear < a_high.x && a_low.y - clear < b_high.y &&
         b_low.y - clear < a_high.y;
}

bool inside(const Loop2& convex, const Point2& p) {
  for (std::size_t i = 0; i < convex.size(); ++i) {
    if (orient(convex[i], convex[(i + 1) % convex.size()], p) < 0) return false;
  }
  return true;
}

}  // namespace

Facade Footprint::side(int k) const {
  if (k == 0) return {{x0, y0, 0}, {1, 0}};
  if (k == 1) return {{x1, y0, 0}, {0, 1}};
  if (k == 2) return {{x1, y1, 0}, {-1, 0}};
  return {{x0, y1, 0}, {0, -1}};
}

RoofShape add_flat_roof(House& house, const Footprint& plan, int eave_z) {
  const FeatureId feature = roof_feature(house, "roof");
  const int thick = grid(0.375);
  const int top = eave_z + grid(0.75);
  const int deck = eave_z + grid(0.125);
  const Footprint inner{plan.x0 + thick, plan.y0 + thick, plan.x1 - thick, plan.y1 - thick};
  const auto ring = [](const Footprint& f, int z) {
    return Loop{{f.x0, f.y0, z}, {f.x1, f.y0, z}, {f.x1, f.y1, z}, {f.x0, f.y1, z}};
  };
  Loop hole = ring(inner, top);
  std::reverse(hole.begin(), hole.end());
  const Look stone{house.palette.trim, feature};
  house.body.add({ring(plan, top), hole}, stone);
  for (int k = 0; k < 4; ++k) {
    const int width = k % 2 == 0 ? plan.width() : plan.depth();
    const Facade outer_side = plan.side(k);
    house.body.add(
        {{outer_side.at(0, eave_z), outer_side.at(width, eave_z), outer_side.at(width, top), outer_side.at(0, top)}},
        stone);
    const Facade side = inner.side(k);
    const int inner_width = k % 2 == 0 ? inner.width() : inner.depth();
    house.body.add({{side.at(inner_width, deck), side.at(0, deck), side.at(0, top), side.at(inner_width, top)}}, stone);
  }
  RoofShape roof;
  Slope slope;
  slope.eave = inner.side(0);
  slope.z0 = deck;
  slope.quarters = 0;
  slope.outline = {{0, 0}, {inner.width(), 0}, {inner.width(), inner.depth()}, {0, inner.depth()}};
  slope.material = house.palette.gravel;
  slope.feature = feature;
  roof.slopes.push_back(std::move(slope));
  roof.top = top;
  return roof;
}

RoofShape add_gable_roof(House& house, const Footprint& plan, int eave_z, int quarters, FeatureId right_wall,
                         FeatureId left_wall, int tower_from, int tower_to) {
  const bool tower = tower_from < tower_to;
  const Gable g{plan, eave_z, quarters, tower ? 0 : grid(0.375), grid(0.375)};
  RoofShape roof;
  const FeatureId edge_feature = roof_feature(house, "eaves");
  const Look edge{house.palette.wood, edge_feature};
  add_gable_walls(house, g, right_wall, left_wall, tower_from, tower_to);
  add_verge(house, g, plan.side(1), g.right, 0, 0, edge);
  add_verge(house, g, plan.side(3), g.left, tower_from, tower_to, edge);
  for (const int k : {0, 2}) {
    const Facade wall = plan.side(k);
    const int before = k == 0 ? g.left : g.right;
    const int after = k == 0 ? g.right : g.left;
    const int width = plan.width() + before + after;
    add_underside(house, g, wall, before, after, edge);
    Slope slope;
    slope.eave = {wall.at(-before, 0, overhang), wall.along};
    slope.z0 = g.over(-overhang);
    slope.quarters = quarters;
    const int run = g.half() + overhang;
    slope.outline = {{0, 0}, {width, 0}, {width, run}, {0, run}};
    const Point low = wall.at(-before, g.under(-overhang), overhang);
    const Point far = wall.at(plan.width() + after, g.under(-overhang), overhang);
    house.body.add({{low, far, slope.at(width, 0), slope.at(0, 0)}}, edge);
    slope.feature = roof_feature(house, "roof");
    slope.material = house.palette.tile;
    if (k == 0) roof.ridges.push_back({slope.at(0, run), slope.at(width, run)});
    roof.top = slope.z(run);
    roof.slopes.push_back(std::move(slope));
  }
  return roof;
}

RoofShape add_hip_roof(House& house, const Footprint& plan, int eave_z, int quarters) {
  RoofShape roof;
  const FeatureId feature = roof_feature(house, "roof");
  const Footprint eaves = add_eaves(house, plan, eave_z, overhang, fascia, {house.palette.wood, feature});
  add_hip_slopes(roof, eaves, eave_z + fascia, quarters, grid(1000.0), house.palette.tile, feature);
  for (Slope& slope : roof.slopes) slope.feature = roof_feature(house, "roof_plane");
  // The ridge joins the tips of the two short hips.
  const Point a = roof.ridges[0][1];
  const Point b = roof.ridges[2][1];
  if (a != b) roof.ridges.push_back({a, b});
  return roof;
}

RoofShape add_spire(House& house, const Footprint& plan, int eave_z) {
  RoofShape roof;
  const FeatureId feature = roof_feature(house, "spire");
  const Footprint eaves = add_eaves(house, plan, eave_z, grid(0.375), grid(0.1875), {house.palette.trim, feature});
  const int flare = grid(0.75);
  add_hip_slopes(roof, eaves, eave_z + grid(0.1875), 4, flare, house.palette.slate, feature);
  const Footprint upper{eaves.x0 + flare, eaves.y0 + flare, eaves.x1 - flare, eaves.y1 - flare};
  add_hip_slopes(roof, upper, roof.top, 18, grid(1000.0), house.palette.slate, feature);
  return roof;
}

bool add_dormer(House& house, Slope& slope, int u, int v) {
  const int half = grid(0.75);
  // Lengths on the slope chosen so that all heights are whole: cheeks rise about 1.5 m, the dormer's roof 0.75 m.
  const int run = grid(1.5) * 4 / slope.quarters / 64 * 64;
  const int cheek = v + run;
  const int ridge = cheek + run / 2;
  const auto corner = [&](int du, int dv) { return Point2{u + du, dv}; };
  const Loop2 cut{corner(-half, v), corner(half, v), corner(half, cheek), corner(0, ridge), corner(-half, cheek)};
  const int clear = grid(0.375);
  for (const Point2& p : {corner(-half - clear, v), corner(half + clear, v), corner(-half - clear, ridge + clear),
                          corner(half + clear, ridge + clear)}) {
    if (!inside(slope.outline, p)) return false;
  }
  if (std::any_of(slope.holes.begin(), slope.holes.end(), [&](const Loop2& h) { return near(h, cut, clear); }))
    return false;
  const FeatureId feature =
      house.feature("dormer_" + std::to_string(house.mesh->features.size()), "BuildingInstallation", house.building);
  const Look wall{house.palette.plaster, feature};
  const Look roof = roof_look(house, feature);
  const int z_low = slope.z(v);
  const int z_eave = slope.z(cheek);
  const int z_top = slope.z(ridge);
  const Facade front{slope.eave.at(u - half, 0, -v), slope.eave.along};
  const Opening window{
      grid(0.25), 2 * half - grid(0.25), z_low + grid(0.3125), z_eave - grid(0.125), 0, Leaf::Window, 2, 2};
  add_wall(house, front, {{0, z_low}, {2 * half, z_low}, {2 * half, z_eave}, {half, z_top}, {0, z_eave}}, {window},
           wall);
  const auto at = [&](int du, int dv, int z) { return slope.above(u + du, dv, z); };
  house.body.add({{at(half, v, z_low), at(half, cheek, z_eave), at(half, v, z_eave)}}, wall);
  house.body.add({{at(-half, v, z_low), at(-half, v, z_eave), at(-half, cheek, z_eave)}}, wall);
  house.body.add({{at(half, v, z_eave), at(half, cheek, z_eave), at(0, ridge, z_top), at(0, v, z_top)}}, roof);
  house.body.add({{at(-half, v, z_eave), at(0, v, z_top), at(0, ridge, z_top), at(-half, cheek, z_eave)}}, roof);
  slope.holes.push_back(cut);
  return true;
}

Point add_chimney(House& house, Slope& slope, int u, int v, int top_z) {
  const int half_u = grid(0.5);
  const int half_v = grid(0.3125);
  const FeatureId feature =
      house.feature("chimney_" + std::to_string(house.mesh->features.size()), "BuildingInstallation", house.building);
  const Look look{house.palette.stone, feature};
  const Loop2 cut{
      {u - half_u, v - half_v}, {u + half_u, v - half_v}, {u + half_u, v + half_v}, {u - half_u, v + half_v}};
  Loop top;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point2& p = cut[i];
    const Point2& q = cut[(i + 1) % 4];
    house.body.add(
        {{slope.at(p.x, p.y), slope.at(q.x, q.y), slope.above(q.x, q.y, top_z), slope.above(p.x, p.y, top_z)}}, look);
    top.push_back(slope.above(p.x, p.y, top_z));
  }
  house.body.add({top}, look);
  slope.holes.push_back(cut);
  return slope.above(u, v, top_z);
}

void add_slope(House& house, const Slope& slope) {
  const auto lift = [&](const Loop2& flat) {
    Loop loop;
    for (const Point2& p : flat) loop.push_back(slope.at(p.x, p.y));
    return loop;
  };
  std::vector<Loop> rings{lift(slope.outline)};
  for (const Loop2& hole : slope.holes) {
    rings.push_back(lift(hole));
    std::reverse(rings.back().begin(), rings.back().end());
  }
  house.body.add(std::move(rings), {slope.material, slope.feature});
}

void add_tiles(House& house, const Slope& slope, double width_m) {
  const double rise = 0.25 * slope.quarters;
  const double per_v = std::sqrt(1.0 + rise * rise);  // metres on the slope per level metre
  const double length_m = 1.45 * width_m;
  const int step_u = grid(width_m);
  const int step_v = grid(length_m / per_v);
  const glm::dvec3 in = -glm::dvec3{slope.eave.out()};
  Part tile{.shape = Shape::Tile,
            .segments = 3,
            .size = {0.96 * width_m, 1.18 * length_m, 0.36 * width_m},
            .look = {slope.material, slope.feature}};
  tile.frame.x = {slope.eave.along.x, slope.eave.along.y, 0.0};
  // Each tile lies on the one below: its lower end is raised a little.
  const glm::dvec3 up_slope = (in + glm::dvec3{0.0, 0.0, rise}) / per_v;
  const glm::dvec3 normal = glm::cross(tile.frame.x, up_slope);
  tile.frame.y = glm::normalize(up_slope - 0.07 * normal);
  tile.frame.z = glm::cross(tile.frame.x, tile.frame.y);
  int v_end = 0;
  for (const Point2& p : slope.outline) v_end = std::max(v_end, p.y);
  int u_end = 0;
  for (const Point2& p : slope.outline) u_end = std::max(u_end, p.x);
  const auto free = [&](int u, int v) {
    const Point2 corners[] = {{u - step_u / 2, v},
                              {u + step_u / 2, v},
                              {u + step_u / 2, v + step_v},
                              {u - step_u / 2, v + step_v},
                              {u, v + step_v / 2}};
    for (const Point2& p : corners) {
      if (!inside(slope.outline, p)) return false;
      for (const Loop2& hole : slope.holes) {
        if (inside(hole, p)) return false;
      }
    }
    return true;
  };
  const int margin = (u_end % step_u) / 2;
  for (int v = 0; v + step_v <= v_end; v += step_v) {
    for (int u = margin + step_u / 2; u + step_u / 2 <= u_end; u += step_u) {
      if (!free(u, v)) continue;
      tile.frame.origin = metres(slope.at(u, v)) + 0.02 * normal;
      house.parts.list.push_back(tile);
    }
  }
}

}  // namespace lodestone::generate

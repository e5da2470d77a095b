// SPDX-License-Identifier: MIT
#include <algorithm>

#include "generate/house_plan.h"
#include "generate/sheet.h"

namespace lodestone {

namespace generate {

namespace {

// Triangles of everything at its fewest segments.
std::uint64_t least_triangles(const House& house) {
  return house.body.triangle_count() + house.parts.least_triangles();
}

}  // namespace

Tier tier(std::uint32_t index, std::uint64_t seed) {
  static constexpr Tier tiers[] = {
      {2, 3, 2, false, false, false, 0.0}, {2, 3, 2, true, false, false, 0.0},  {2, 4, 3, true, true, false, 0.0},
      {3, 5, 3, true, true, true, 0.0},    {3, 5, 3, true, true, true, 0.34},   {3, 6, 4, true, true, true, 0.28},
      {4, 7, 4, true, true, true, 0.25},   {4, 9, 5, true, true, true, 0.25},   {5, 13, 6, true, true, true, 0.22},
      {5, 19, 8, true, true, true, 0.20},  {6, 27, 10, true, true, true, 0.20}, {7, 39, 14, true, true, true, 0.20}};
  Tier t = tiers[std::min<std::size_t>(index, std::size(tiers) - 1)];
  if (index > 0 && seed % 2 == 1 && t.bays % 2 == 0) ++t.bays;  // an odd number has the door in the middle
  return t;
}

void append_house(Mesh& mesh, const Palette& palette, Roof roof, std::uint64_t seed, std::uint32_t triangles,
                  const std::string& prefix, const Context& context) {
  constexpr std::uint32_t tiers = 12;
  const std::size_t features = mesh.features.size();
  HousePlan plan{roof, tier(0, seed), seed};
  House house = draw_house(mesh, palette, plan, prefix);
  for (std::uint32_t i = 1; i < tiers && !context.cancelled(); ++i) {
    std::vector<Feature> kept{mesh.features.begin() + static_cast<std::ptrdiff_t>(features), mesh.features.end()};
    mesh.features.resize(features);
    plan.tier = tier(i, seed);
    House richer = draw_house(mesh, palette, plan, prefix);
    if (least_triangles(richer) > triangles) {
      mesh.features.resize(features);
      mesh.features.insert(mesh.features.end(), kept.begin(), kept.end());
      break;
    }
    house = std::move(richer);
  }
  const std::uint64_t least = least_triangles(house);
  const std::vector<std::uint32_t> segments = house.parts.share_out(triangles > least ? triangles - least : 0);
  const std::vector<double> uv_scale = uv_scales(mesh);
  house.body.emit(mesh, uv_scale);
  for (std::size_t i = 0; i < segments.size() && !context.cancelled(); ++i) {
    house.parts.emit(house.parts.list[i], segments[i], mesh, uv_scale);
  }
}

}  // namespace generate

Result<Mesh> generate_house(const HouseOptions& options, const Context& context) {
  using namespace generate;
  if (Status status = check_options(options); !status) return status.error();
  Mesh mesh;
  mesh.origin = {677'250.0, 5'403'120.0, 372.0};
  mesh.crs = "EPSG:25832";
  add_textures(mesh, options, house_cloths, context);
  const Palette palette = add_palette(mesh, options.seed);
  append_house(mesh, palette, options.roof, options.seed, options.triangles == 0 ? 30'000 : options.triangles, "",
               context);
  return finish(std::move(mesh), options, context);
}

}  // namespace lodestone

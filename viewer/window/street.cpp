// SPDX-License-Identifier: MIT
#include "street.h"

#include <lodestone/auto_build.h>
#include <lodestone/generate.h>

#include <array>
#include <cmath>
#include <numbers>

#include "../render/camera.h"

namespace lodestone::render {
namespace {

constexpr std::array roofs{Roof::Gable, Roof::Hip, Roof::Flat, Roof::Spire};
constexpr double half_roadway_m = 3.5;
constexpr double half_street_m = 6.0;  // with pavements
constexpr double front_garden_m = 3.0;
constexpr double gap_m = 5.0;  // between neighbours
constexpr double lawn_m = 60.0;
constexpr double ground_z_m = -0.02;  // below the floors of the houses, so that the two do not flicker

enum class Side : std::uint8_t { West, East };

// By a quarter turn, exact in floats: the front, south as generated, comes to face the roadway.
void face_roadway(Mesh& house, Side side) {
  const auto turned = [&](const glm::vec3& v) {
    return side == Side::West ? glm::vec3{-v.y, v.x, v.z} : glm::vec3{v.y, -v.x, v.z};
  };
  for (glm::vec3& p : house.vertices.positions) p = turned(p);
  for (glm::vec3& n : house.vertices.normals) n = turned(n);
}

Result<std::shared_ptr<const ProgressiveModel>> build_house(std::size_t kind, Side side, std::uint32_t triangles,
                                                            const Context& context) {
  // Houses that face each other differ in their roofs.
  const std::size_t roof = (kind + (side == Side::East ? 1 : 0)) % roofs.size();
  auto house = generate_house({{.triangles = triangles, .texture_size_px = 256, .seed = 1 + kind}, roofs[roof]});
  if (!house) return house.error();
  face_roadway(*house, side);
  Context silent = context;
  silent.progress = nullptr;  // the street reports house by house
  auto built = build_automatically(*house, {}, silent);
  if (!built) return built.error();
  return std::move(built->model);
}

void add_strip(double from_x_m, double to_x_m, double from_y_m, double to_y_m, MaterialId material, Mesh& ground) {
  const auto first = ground.vertex_count();
  for (const auto& [x, y] : {std::pair{from_x_m, from_y_m}, std::pair{to_x_m, from_y_m}, std::pair{to_x_m, to_y_m},
                             std::pair{from_x_m, to_y_m}}) {
    ground.vertices.positions.emplace_back(glm::dvec3{x, y, ground_z_m});
  }
  for (const VertexId corner : {0U, 1U, 2U, 0U, 2U, 3U}) ground.indices.push_back(first + corner);
  ground.face_materials.insert(ground.face_materials.end(), 2, material);
}

Mesh make_ground(double from_y_m, double to_y_m) {
  Mesh ground;
  ground.materials = {{.name = "asphalt", .base_color = {0.42F, 0.42F, 0.44F, 1.0F}},
                      {.name = "pavement", .base_color = {0.72F, 0.70F, 0.67F, 1.0F}},
                      {.name = "lawn", .base_color = {0.50F, 0.60F, 0.38F, 1.0F}}};
  add_strip(-half_roadway_m, half_roadway_m, from_y_m, to_y_m, 0, ground);
  for (const double side : {-1.0, 1.0}) {
    const auto add = [&](double near_m, double far_m, MaterialId material) {
      add_strip(std::min(side * near_m, side * far_m), std::max(side * near_m, side * far_m), from_y_m, to_y_m,
                material, ground);
    };
    add(half_roadway_m, half_street_m, 1);
    add(half_street_m, half_street_m + lawn_m, 2);
  }
  return ground;
}

// Its front at the garden's inner edge, its lowest point on the ground, its south end at `from_y_m`.
glm::dvec3 place(const Box& box, Side side, double from_y_m) {
  const double front_m = half_street_m + front_garden_m;
  return {side == Side::West ? -front_m - box.max.x : front_m - box.min.x, from_y_m - box.min.y, -box.min.z};
}

}  // namespace

Result<std::shared_ptr<const Street>> make_street(const StreetOptions& options, const Context& context) {
  auto street = std::make_shared<Street>();
  std::array<std::array<std::shared_ptr<const ProgressiveModel>, roofs.size()>, 2> models;
  std::array<double, 2> row_end_m{0.0, 0.0};
  for (unsigned i = 0; i < options.house_count; ++i) {
    context.report("building houses", double(i) / double(options.house_count));
    const std::size_t row = i % 2;
    const Side side = row == 0 ? Side::West : Side::East;
    const std::size_t kind = (i / 2) % roofs.size();
    auto& model = models[row][kind];
    if (!model) {
      auto built = build_house(kind, side, options.house_triangles, context);
      if (!built) return built.error();
      model = std::move(*built);
    }
    const Box& box = model->bounds();
    const glm::dvec3 offset_m = place(box, side, row_end_m[row]);
    row_end_m[row] += box.size().y + gap_m;
    street->houses.push_back({model, offset_m});
    street->bounds.add(box.min + offset_m);
    street->bounds.add(box.max + offset_m);
  }
  street->ground = make_ground(-lawn_m, std::max(row_end_m[0], row_end_m[1]) + lawn_m);
  for (const glm::vec3& p : street->ground.vertices.positions) street->bounds.add(glm::dvec3{p});
  return std::shared_ptr<const Street>{std::move(street)};
}

Standpoint near_end(const Street& street) {
  const double start_m = street.bounds.min.y + lawn_m - 25.0;
  return {.eye = {0.0, start_m, 9.0}, .target = {0.0, start_m + 60.0, 5.0}};
}

View along_street(const Street& street, double turns, std::uint32_t width_px, std::uint32_t height_px) {
  Standpoint stand = near_end(street);
  const double length_m = street.bounds.max.y - lawn_m - stand.eye.y;
  constexpr double flown_share = 0.7;
  const double way_m = 0.5 * flown_share * length_m * (1.0 - std::cos(2.0 * std::numbers::pi * turns));
  stand.eye.y += way_m;
  stand.target.y += way_m;
  return look_at(stand.eye, stand.target, width_px, height_px, 0.8);
}

}  // namespace lodestone::render

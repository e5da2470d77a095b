// SPDX-License-Identifier: MIT
#include "generate/palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "base/parallel.h"
#include "base/rng.h"
#include "generate/noise.h"
#include "generate/pixels.h"

namespace lodestone::generate {

namespace {

struct ClothFacts {
  const char* name;
  double tile_m;
};
constexpr ClothFacts facts[] = {{"plaster", 4.0}, {"roof_tile", 2.0}, {"stone", 2.5}, {"wood", 1.0},
                                {"trim", 2.0},    {"metal", 1.0},     {"slate", 2.0}, {"gravel", 2.0},
                                {"paving", 3.0},  {"asphalt", 4.0},   {"grass", 4.0}};

// Rows of stones or tiles, each row shifted by half a stone; all counts divide the picture, so that it repeats.
struct Course {
  double in_x, in_y;  // place inside the stone, 0..1
  double value;       // the stone's own shade, 0..1
};
Course course_at(std::uint32_t seed, double u, double v, int columns, int rows) noexcept {
  const double y = v * rows;
  const auto row = static_cast<std::int32_t>(std::floor(y));
  const double x = u * columns + 0.5 * (row & 1);
  const auto column = static_cast<std::int32_t>(std::floor(x));
  return {x - column, y - row, lattice_unit(seed, column % columns, row)};
}

float joint(double t, double width) noexcept {
  return static_cast<float>(smooth_step(0.0, width, std::min(t, 1.0 - t)));
}

struct Grain {
  float broad, mid, fine;
};

glm::vec3 stone_color(std::uint32_t seed, double u, double v, const Grain& g, int columns, int rows, double gap) {
  const Course c = course_at(seed, u, v, columns, rows);
  const float edge = joint(c.in_x, gap * columns / rows) * joint(c.in_y, gap);
  const float lit = 1.0F + 0.10F * static_cast<float>(c.in_y - 0.5) + 0.06F * static_cast<float>(0.5 - c.in_x);
  const glm::vec3 block = glm::vec3{0.86F, 0.84F, 0.80F} * (0.82F + 0.22F * static_cast<float>(c.value)) * lit *
                          (1.0F + 0.16F * g.fine + 0.12F * g.mid);
  return glm::mix(glm::vec3{0.50F, 0.48F, 0.45F} * (1.0F + 0.2F * g.fine), block, edge);
}

glm::vec3 tile_color(std::uint32_t seed, double u, double v, const Grain& g, bool slate) {
  const Course c = course_at(seed, u, v, slate ? 10 : 8, slate ? 14 : 6);
  const float hump = slate ? 1.0F : static_cast<float>(0.72 + 0.36 * std::sin(3.14159265358979 * c.in_x));
  const float lap = 0.55F + 0.45F * static_cast<float>(smooth_step(0.0, 0.16, c.in_y));
  const float gap = 0.45F + 0.55F * joint(c.in_x, 0.06);
  const auto own = static_cast<float>(c.value);
  const glm::vec3 clay = glm::mix(glm::vec3{0.72F, 0.38F, 0.26F}, glm::vec3{0.55F, 0.28F, 0.21F}, own);
  const glm::vec3 grey = glm::mix(glm::vec3{0.34F, 0.37F, 0.41F}, glm::vec3{0.24F, 0.26F, 0.30F}, own);
  const float moss = 0.30F * static_cast<float>(smooth_step(0.15, 0.5, g.mid + 0.4F * g.broad));
  return glm::mix((slate ? grey : clay) * hump * lap * gap * (1.0F + 0.18F * g.fine), glm::vec3{0.33F, 0.34F, 0.22F},
                  moss * 0.5F);
}

glm::vec3 wood_color(double u, double v, const Grain& g) {
  const double board = u * 6.0;
  const auto number = static_cast<std::int32_t>(std::floor(board));
  const float edge = joint(board - number, 0.05);
  const auto ring = static_cast<float>(std::sin(6.28318530717959 * (3.0 * (board - number) + 0.8 * g.mid + 2.0 * v)));
  const float own = 0.9F + 0.2F * static_cast<float>(lattice_unit(7, number));
  return glm::vec3{0.80F, 0.66F, 0.50F} * own * (0.92F + 0.07F * ring + 0.10F * g.fine) * (0.5F + 0.5F * edge);
}

glm::vec3 color_at(Cloth cloth, std::uint32_t seed, double u, double v, const Grain& g) {
  switch (cloth) {
    case Cloth::Plaster:
      return glm::vec3{0.93F} * (1.0F + 0.07F * g.fine + 0.06F * g.mid + 0.07F * g.broad);
    case Cloth::Tile:
      return tile_color(seed, u, v, g, false);
    case Cloth::Slate:
      return tile_color(seed, u, v, g, true);
    case Cloth::Stone:
      return stone_color(seed, u, v, g, 4, 6, 0.06);
    case Cloth::Paving:
      return stone_color(seed, u, v, g, 6, 6, 0.04) * 0.85F;
    case Cloth::Wood:
      return wood_color(u, v, g);
    case Cloth::Trim:
      return glm::vec3{0.90F, 0.87F, 0.80F} * (1.0F + 0.12F * g.fine + 0.07F * g.mid + 0.06F * g.broad);
    case Cloth::Metal:
      return glm::vec3{0.75F} * (1.0F + 0.10F * g.fine + 0.25F * g.mid);
    case Cloth::Gravel:
      return glm::vec3{0.55F, 0.53F, 0.50F} * (1.0F + 0.7F * g.fine + 0.15F * g.broad);
    case Cloth::Asphalt:
      return glm::vec3{0.34F, 0.34F, 0.35F} * (1.0F + 0.35F * g.fine + 0.15F * g.mid + 0.12F * g.broad);
    case Cloth::Grass:
      return glm::mix(glm::vec3{0.28F, 0.38F, 0.15F}, glm::vec3{0.46F, 0.48F, 0.22F}, 0.5F + 0.6F * g.mid) *
             (1.0F + 0.6F * g.fine);
  }
  return glm::vec3{1.0F};
}

// A muted colour of old townhouses.
glm::vec3 facade_tint(Rng& rng) {
  static constexpr float tints[][3] = {{1.00F, 0.93F, 0.78F}, {0.97F, 0.84F, 0.66F}, {0.93F, 0.76F, 0.66F},
                                       {0.86F, 0.90F, 0.84F}, {0.84F, 0.88F, 0.93F}, {1.00F, 0.97F, 0.92F},
                                       {0.95F, 0.86F, 0.60F}, {0.88F, 0.72F, 0.62F}};
  const auto& t = tints[rng.below(8)];
  return {t[0], t[1], t[2]};
}

glm::vec3 shutter_tint(Rng& rng) {
  static constexpr float tints[][3] = {
      {0.36F, 0.50F, 0.40F}, {0.40F, 0.48F, 0.58F}, {0.55F, 0.34F, 0.28F}, {0.62F, 0.62F, 0.58F}};
  const auto& t = tints[rng.below(4)];
  return {t[0], t[1], t[2]};
}

Image paint(Cloth cloth, std::uint32_t size_px, std::uint64_t seed, const NoiseTable& table, const Context& context) {
  const auto own = static_cast<std::uint32_t>(hash_combine(seed, 32 + static_cast<std::uint64_t>(cloth)));
  Image image = blank(size_px);
  parallel_for_each(size_px, 16, context, [&](std::size_t row) {
    const double v = 1.0 - (static_cast<double>(row) + 0.5) / size_px;
    for (std::uint32_t x = 0; x < size_px; ++x) {
      const double u = (x + 0.5) / size_px;
      const Grain grain{table.at(u, v), table.at(2.0 * u + 0.3, 2.0 * v), table.at(7.0 * u, 7.0 * v + 0.6)};
      put(image, x, static_cast<std::uint32_t>(row), color_at(cloth, own, u, v, grain));
    }
  });
  return image;
}

}  // namespace

double tile_m(Cloth cloth) noexcept { return facts[static_cast<std::size_t>(cloth)].tile_m; }

void add_textures(Mesh& mesh, const GenerateOptions& options, std::uint32_t cloths, const Context& context) {
  const std::uint32_t count = options.textures == 0 ? cloths : std::min(options.textures, cloths);
  const NoiseTable table{static_cast<std::uint32_t>(hash_combine(options.seed, 31))};
  for (std::uint32_t i = 0; i < count && !context.cancelled(); ++i) {
    Texture texture;
    texture.name = facts[i].name;
    if (options.pixels == Pixels::Make) {
      texture.image = std::make_shared<const Image>(
          paint(static_cast<Cloth>(i), options.texture_size_px, options.seed, table, context));
    }
    mesh.textures.push_back(std::move(texture));
  }
}

MaterialId add_material(Mesh& mesh, const char* name, Cloth cloth, const glm::vec3& tint, std::uint32_t number) {
  Material material;
  material.name = number == none ? std::string{name} : std::string{name} + "_" + std::to_string(number);
  material.base_color = glm::vec4{tint, 1.0F};
  const auto texture = static_cast<std::uint32_t>(cloth);
  if (texture < mesh.textures.size()) material.texture = texture;
  mesh.materials.push_back(std::move(material));
  return static_cast<MaterialId>(mesh.materials.size() - 1);
}

Palette add_palette(Mesh& mesh, std::uint64_t seed, std::uint32_t number) {
  Rng rng{seed, 41};
  const glm::vec3 facade = facade_tint(rng);
  const auto age = static_cast<float>(rng.uniform(0.8, 1.1));
  Palette p;
  p.plaster = add_material(mesh, "plaster", Cloth::Plaster, facade, number);
  p.tile = add_material(mesh, "roof_tile", Cloth::Tile, glm::min(glm::vec3{1.0F, 0.97F, 0.95F} * age, glm::vec3{1.0F}),
                        number);
  p.stone = add_material(mesh, "stone", Cloth::Stone, {0.86F, 0.80F, 0.70F}, number);
  p.wood = add_material(mesh, "wood", Cloth::Wood, {0.55F, 0.42F, 0.32F}, number);
  p.trim = add_material(mesh, "trim", Cloth::Trim, {0.97F, 0.95F, 0.90F}, number);
  p.metal = add_material(mesh, "metal", Cloth::Metal, {0.22F, 0.23F, 0.25F}, number);
  p.slate = add_material(mesh, "slate", Cloth::Slate, {1.0F, 1.0F, 1.0F}, number);
  p.gravel = add_material(mesh, "gravel", Cloth::Gravel, {0.9F, 0.9F, 0.9F}, number);
  p.frame = add_material(mesh, "frame", Cloth::Trim, {0.95F, 0.95F, 0.94F}, number);
  p.shutter = add_material(mesh, "shutter", Cloth::Wood, shutter_tint(rng), number);
  p.glass = add_material(mesh, "glass", Cloth::Plaster, {0.42F, 0.52F, 0.58F}, number);
  mesh.materials[p.glass].base_color.a = 0.45F;
  mesh.materials[p.glass].texture = none;
  return p;
}

std::vector<double> uv_scales(const Mesh& mesh) {
  std::vector<double> scales;
  for (const Material& m : mesh.materials) {
    scales.push_back(m.texture == none ? 1.0 : 1.0 / tile_m(static_cast<Cloth>(m.texture)));
  }
  return scales;
}

}  // namespace lodestone::generate

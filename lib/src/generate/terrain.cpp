// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/rng.h"
#include "generate/noise.h"
#include "generate/pixels.h"
#include "generate/sheet.h"

namespace lodestone {

namespace generate {
namespace {

constexpr double side_m = 2048.0;

class TerrainField {
 public:
  explicit TerrainField(std::uint64_t seed) : seed_(static_cast<std::uint32_t>(hash_combine(seed, 21))) {}

  // Ridges and gullies of fluvial relief: sharp crests above, a broad valley with a meandering stream below.
  [[nodiscard]] double height(double x, double y, double cell_m) const noexcept {
    int octaves = 3;
    for (double wave = 160.0; octaves < 9 && wave > 2.0 * cell_m; wave *= 0.5) ++octaves;
    const double wx = x + 120.0 * noise(seed_, x / 700.0, y / 700.0);
    const double wy = y + 120.0 * noise(seed_ + 1, x / 700.0, y / 700.0);
    const double hills = fractal(seed_ + 2, wx / 1300.0, wy / 1300.0, 3) * 0.5 + 0.5;
    const double crests = ridged(seed_ + 10, wx / 900.0, wy / 900.0, octaves);
    const double from_stream = std::abs(stream_offset(x, y));
    const double valley = smooth_step(10.0, 620.0, from_stream);
    const double rough = 3.0 * fractal(seed_ + 30, x / 60.0, y / 60.0, std::max(1, octaves - 3));
    return 20.0 + valley * (330.0 * hills * crests + 60.0 * hills + rough) -
           3.0 * (1.0 - smooth_step(4.0, 12.0, from_stream));
  }
  [[nodiscard]] double stream_offset(double x, double y) const noexcept {
    return y - 0.42 * side_m - 260.0 * noise(seed_ + 40, x / 800.0, 0.3) - 45.0 * noise(seed_ + 41, x / 170.0, 0.6);
  }
  [[nodiscard]] std::uint32_t seed() const noexcept { return seed_; }

 private:
  std::uint32_t seed_;
};

SheetKind terrain_kind(const TerrainField& field) {
  SheetKind kind;
  kind.width_m = side_m;
  kind.height_m = side_m;
  kind.natural_triangles = 131'072;
  kind.natural_textures = 1;
  kind.texture_name = "terrain";
  kind.semantic_class = "ReliefFeature";
  kind.position = [&field](double s, double t, double cell) {
    return glm::dvec3{s - 0.5 * side_m, t - 0.5 * side_m, field.height(s, t, cell)};
  };
  return kind;
}

class GroundPainter {
 public:
  explicit GroundPainter(const TerrainField& field) : field_(field), table_(field.seed() + 95) {}

  [[nodiscard]] glm::vec3 texel(double x, double y, double texel_m) const noexcept {
    const double h = std::max(texel_m, 1.0);
    const double z = field_.height(x, y, h);
    const double dx = (field_.height(x + h, y, h) - z) / h;
    const double dy = (field_.height(x, y + h, h) - z) / h;
    const auto slope = static_cast<float>(std::sqrt(dx * dx + dy * dy));
    const auto height = static_cast<float>(z);
    const auto light = static_cast<float>((0.9 + 0.55 * dx - 0.55 * dy) / std::sqrt(1.0 + dx * dx + dy * dy));
    const float broad = table_.at(x / 1900.0, y / 1900.0);
    const float mid = table_.at(x / 330.0 + 0.2, y / 330.0);
    const float fine = table_.at(x / 61.0, y / 61.0 + 0.6);

    glm::vec3 color = glm::mix(glm::vec3{0.36F, 0.42F, 0.20F}, glm::vec3{0.53F, 0.50F, 0.30F}, 0.5F + 0.7F * broad) *
                      (1.0F + 0.14F * mid + 0.12F * fine);
    const float low = 1.0F - glm::smoothstep(24.0F, 60.0F, height);
    if (low > 0.0F && slope < 0.35F) color = glm::mix(color, field_color(x, y) * (1.0F + 0.1F * fine), 0.85F * low);
    const float wood = glm::smoothstep(0.05F, 0.16F, mid + 0.5F * broad + 0.25F * fine) * (1.0F - low) *
                       (1.0F - glm::smoothstep(150.0F, 230.0F, height + 40.0F * mid)) *
                       (1.0F - glm::smoothstep(0.7F, 1.0F, slope));
    color = glm::mix(color, glm::vec3{0.13F, 0.21F, 0.10F} * (1.0F + 0.9F * fine), wood);
    const float rock = glm::smoothstep(0.55F, 0.9F, slope + 0.25F * fine);
    color = glm::mix(color, glm::vec3{0.52F, 0.49F, 0.45F} * (1.0F + 0.3F * fine), rock);
    const auto stream = static_cast<float>(std::abs(field_.stream_offset(x, y)));
    color = glm::mix(glm::vec3{0.16F, 0.24F, 0.25F}, color, glm::smoothstep(6.0F, 9.0F, stream));
    return color * glm::clamp(light, 0.35F, 1.35F);
  }

 private:
  // Strips of farmland with hedges between.
  [[nodiscard]] glm::vec3 field_color(double x, double y) const noexcept {
    const double u = (x + 0.3 * y) / 90.0;
    const auto column = static_cast<std::int32_t>(std::floor(u));
    const double v = (y - 0.3 * x) / 140.0 + lattice_unit(field_.seed() + 50, column);
    const auto row = static_cast<std::int32_t>(std::floor(v));
    static constexpr float crops[][3] = {{0.55F, 0.52F, 0.28F},
                                         {0.36F, 0.46F, 0.20F},
                                         {0.45F, 0.36F, 0.24F},
                                         {0.62F, 0.58F, 0.36F},
                                         {0.30F, 0.40F, 0.18F}};
    const auto& c = crops[lattice_hash(field_.seed() + 51, column, row) % 5];
    const double edge =
        std::min({(u - column) * 90.0, (column + 1 - u) * 90.0, (v - row) * 140.0, (row + 1 - v) * 140.0});
    const auto furrow = static_cast<float>(0.04 * std::sin((u - column) * 90.0 * 1.6));
    const glm::vec3 crop = glm::vec3{c[0], c[1], c[2]} * (1.0F + furrow);
    return edge < 2.5 ? glm::vec3{0.17F, 0.24F, 0.11F} : crop;
  }

  const TerrainField& field_;
  NoiseTable table_;
};

}  // namespace
}  // namespace generate

Image terrain_texture(const GenerateOptions& options, std::uint32_t index, const Context& context) {
  using namespace generate;
  const TerrainField field{options.seed};
  const SheetKind kind = terrain_kind(field);
  const SheetLayout layout = lay_out(options, kind);
  const GroundPainter painter{field};
  Image image = blank(options.texture_size_px);
  for (const TexelWindow& w : texel_windows(layout, kind, index)) {
    parallel_for_each(w.y_end - w.y_begin, 16, context, [&](std::size_t row) {
      const double t = w.t0_m + static_cast<double>(row) * w.dt_m;
      for (std::uint32_t x = w.x_begin; x < w.x_end; ++x) {
        put(image, x, w.y_begin + static_cast<std::uint32_t>(row),
            painter.texel(w.s0_m + (x - w.x_begin) * w.ds_m, t, w.ds_m));
      }
    });
  }
  return image;
}

Result<Mesh> generate_terrain(const GenerateOptions& options, const Context& context) {
  using namespace generate;
  if (Status status = check_options(options); !status) return status.error();
  const TerrainField field{options.seed};
  const SheetKind kind = terrain_kind(field);
  Mesh mesh = make_sheet(lay_out(options, kind), kind, {677'000.0, 5'402'000.0, 380.0}, context);
  return with_pixels(std::move(mesh), options, context, terrain_texture);
}

}  // namespace lodestone

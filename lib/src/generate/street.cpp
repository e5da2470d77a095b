// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "base/rng.h"
#include "generate/house_plan.h"
#include "generate/sheet.h"

namespace lodestone {

namespace generate {
namespace {

constexpr std::uint32_t natural_triangles = 260'000;
constexpr double road_half_m = 4.0;
constexpr double pavement_m = 3.0;
constexpr double kerb_m = 0.25;

// One plot: which house, and where its left front corner stands, seen from the road.
struct Plot {
  Roof roof = Roof::Flat;
  std::uint64_t seed = 0;
  std::uint32_t triangles = 0;
  bool far_side = false;
};

std::vector<Plot> plan_plots(const GenerateOptions& options, std::uint32_t triangles) {
  Rng rng{options.seed, 61};
  const std::uint32_t count = std::clamp(triangles / 12'000, 8U, 24U) / 2 * 2;
  std::vector<Plot> plots(count);
  double sum = 0.0;
  std::vector<double> shares;
  for (std::uint32_t i = 0; i < count; ++i) {
    // All four roofs in every four plots, in an order of its own; one spire to a side is enough of a skyline.
    static constexpr std::array<Roof, 4> roofs{Roof::Gable, Roof::Hip, Roof::Flat, Roof::Gable};
    plots[i].roof = i == 2 || i == count - 3 ? Roof::Spire : roofs[(i + i / 4 + options.seed) % 4];
    plots[i].seed = rng.next();
    plots[i].far_side = i % 2 == 1;
    shares.push_back(rng.uniform(0.75, 1.35));
    sum += shares.back();
  }
  // Pavements, kerbs and lamps need their part.
  const double for_houses = std::max(0.0, triangles * 0.99 - 700.0 * count);
  for (std::uint32_t i = 0; i < count; ++i) {
    plots[i].triangles = static_cast<std::uint32_t>(for_houses * shares[i] / sum) / 2 * 2;
  }
  return plots;
}

// Moves the vertices from `first` on to their place, turned about z by half a circle for the far side.
void place(Mesh& mesh, VertexId first, const glm::dvec2& to, bool turned) {
  const float sign = turned ? -1.0F : 1.0F;
  for (VertexId v = first; v < mesh.vertex_count(); ++v) {
    glm::vec3& p = mesh.vertices.positions[v];
    p = glm::vec3{sign * p.x + static_cast<float>(to.x), sign * p.y + static_cast<float>(to.y), p.z};
    glm::vec3& n = mesh.vertices.normals[v];
    n = glm::vec3{sign * n.x, sign * n.y, n.z};
  }
}

class StreetGround {
 public:
  explicit StreetGround(Mesh& mesh) : mesh_(mesh) {
    paving_ = add_material(mesh, "paving", Cloth::Paving, glm::vec3{0.95F});
    asphalt_ = add_material(mesh, "asphalt", Cloth::Asphalt, glm::vec3{1.0F});
    grass_ = add_material(mesh, "grass", Cloth::Grass, glm::vec3{1.0F});
    kerb_ = add_material(mesh, "kerb", Cloth::Trim, glm::vec3{0.75F});
    lamp_ = add_material(mesh, "lamp", Cloth::Metal, glm::vec3{0.20F, 0.22F, 0.21F});
    road_ = add_feature(mesh, "road", "Road", none);
    pavement_ = add_feature(mesh, "pavement", "TrafficArea", road_);
    lamps_ = add_feature(mesh, "lamps", "CityFurniture", road_);
    garden_ = add_feature(mesh, "gardens", "PlantCover", none);
  }

  // The whole ground between x0 and x1, gardens `depth_m` deep behind the pavements.
  void draw(double x0, double x1, double depth_m) {
    const double middle = 0.5 * (x0 + x1);
    const double length = x1 - x0;
    box({middle, 0.0, -0.55}, {length, 2.0 * road_half_m + 0.1, 0.4}, {asphalt_, road_});
    for (const double side : {-1.0, 1.0}) {
      const double edge = road_half_m + kerb_m;
      box({middle, side * (edge + 0.5 * pavement_m - 0.02), -0.55}, {length - 0.02, pavement_m, 0.53},
          {paving_, pavement_});
      box({middle, side * (edge + pavement_m + 0.5 * depth_m - 0.06), -0.60}, {length - 0.04, depth_m, 0.54},
          {grass_, garden_});
      const int stones = static_cast<int>(length / 1.25);
      for (int i = 0; i < stones; ++i) {
        const double x = x0 + length * (i + 0.5) / stones;
        box({x, side * (road_half_m + 0.5 * kerb_m), -0.5}, {length / stones - 0.015, kerb_m, 0.5}, {kerb_, pavement_});
      }
      const double first = x0 + 6.0 + 6.0 * side;
      const int lamps = static_cast<int>(std::ceil((x1 - 2.0 - first) / 24.0));
      for (int i = 0; i < lamps; ++i) lamp({first + 24.0 * i, side * (edge + 0.5), -0.05});
    }
  }
  // Appends it; lamps are turned as finely as it takes to use up `triangles`.
  void emit(std::uint32_t triangles) {
    Part bollard{.shape = Shape::Spike, .segments = 8, .size = {0.35, 0.35, 0.9}, .look = {lamp_, lamps_}};
    bollard.frame.origin = {-2.0, road_half_m + kerb_m + 0.5, -0.1};
    parts_.list.push_back(bollard);
    const std::uint64_t least = parts_.least_triangles();
    const std::vector<std::uint32_t> segments = parts_.share_out(triangles > least ? triangles - least : 0);
    const std::vector<double> scales = uv_scales(mesh_);
    for (std::size_t i = 0; i < segments.size(); ++i) parts_.emit(parts_.list[i], segments[i], mesh_, scales);
  }

 private:
  void box(const glm::dvec3& at, const glm::dvec3& size, Look look) {
    Part part{.shape = Shape::Box, .size = size, .look = look};
    part.frame.origin = at;
    parts_.list.push_back(part);
  }
  void lamp(const glm::dvec3& at) {
    if (parts_.outlines.empty()) {
      parts_.add_outline({{0.16, 0.0},
                          {0.16, 0.25},
                          {0.08, 0.32},
                          {0.06, 0.9},
                          {0.045, 3.6},
                          {0.08, 3.65},
                          {0.08, 3.75},
                          {0.04, 3.8},
                          {0.10, 3.9},
                          {0.20, 4.3},
                          {0.24, 4.34},
                          {0.10, 4.52},
                          {0.03, 4.58},
                          {0.03, 4.7}});
    }
    Part part{.shape = Shape::Lathe, .segments = 6, .outline = 0, .look = {lamp_, lamps_}};
    part.frame.origin = at;
    parts_.list.push_back(part);
  }

  Mesh& mesh_;
  Parts parts_;
  MaterialId paving_ = 0, asphalt_ = 0, grass_ = 0, kerb_ = 0, lamp_ = 0;
  FeatureId road_ = 0, pavement_ = 0, lamps_ = 0, garden_ = 0;
};

// Builds one plot's house at x (its left end), and returns where it ends.
double build_plot(Mesh& mesh, const Plot& plot, std::uint32_t number, double x, const Context& context) {
  const VertexId first = mesh.vertex_count();
  const Palette palette = add_palette(mesh, plot.seed, number);
  std::string prefix = std::to_string(number + 1);
  prefix = "house_" + std::string(prefix.size() < 2 ? 1 : 0, '0') + prefix + "/";
  append_house(mesh, palette, plot.roof, plot.seed, plot.triangles, prefix, context);
  double low = 0.0;
  double high = 0.0;
  for (VertexId v = first; v < mesh.vertex_count(); ++v) {
    low = std::min(low, static_cast<double>(mesh.vertices.positions[v].x));
    high = std::max(high, static_cast<double>(mesh.vertices.positions[v].x));
  }
  // On whole quarters of a metre, so that the turned and moved body stays on its lattice.
  const double front = road_half_m + kerb_m + pavement_m + 1.5;
  const double left = std::ceil(4.0 * (plot.far_side ? x + high : x - low)) / 4.0;
  place(mesh, first, {left, plot.far_side ? -front : front}, plot.far_side);
  return x + high - low;
}

}  // namespace
}  // namespace generate

Result<Mesh> generate_street(const GenerateOptions& options, const Context& context) {
  using namespace generate;
  if (Status status = check_options(options); !status) return status.error();
  const std::uint32_t wanted = options.triangles == 0 ? natural_triangles : options.triangles;
  Mesh mesh;
  mesh.origin = {677'120.0, 5'403'050.0, 370.0};
  mesh.crs = "EPSG:25832";
  add_textures(mesh, options, street_cloths, context);
  const std::vector<Plot> plots = plan_plots(options, wanted);
  StreetGround ground{mesh};
  Rng rng{options.seed, 62};
  double ends[2] = {0.0, 2.0};
  for (std::uint32_t i = 0; i < plots.size() && !context.cancelled(); ++i) {
    context.report("building houses", static_cast<double>(i) / static_cast<double>(plots.size()));
    double& x = ends[plots[i].far_side ? 1 : 0];
    x = build_plot(mesh, plots[i], i, x, context) + rng.uniform(1.5, 5.0);
  }
  ground.draw(-4.0, std::max(ends[0], ends[1]) + 2.0, 24.0);
  ground.emit(wanted - std::min(wanted, mesh.triangle_count()));
  return finish(std::move(mesh), options, context);
}

}  // namespace lodestone

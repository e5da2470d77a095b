// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, section 5.1 (facades by orientation, there by hand).
// Differs: the orientation is the mean direction of the walls, each doubled twice so that right angles agree.
#include <lodestone/perception.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double steepest_wall_slope = 0.3;  // |z| of a unit normal, above it a face is a roof or a floor

double turned(double azimuth_rad, double by_rad) noexcept {
  const double a = std::fmod(azimuth_rad + by_rad, 2.0 * pi);
  return a < 0.0 ? a + 2.0 * pi : a;
}

struct Wall {
  double azimuth_rad;
  double area;  // twice, square metres
};

std::vector<Wall> walls_of(const Mesh& mesh) {
  std::vector<Wall> walls;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const auto corner = [&](std::size_t c) { return glm::dvec3{mesh.vertices.positions[mesh.indices[i + c]]}; };
    const glm::dvec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    const double area = glm::length(normal);
    if (!(area > 0.0) || std::abs(normal.z) > steepest_wall_slope * area) continue;
    walls.push_back({std::atan2(normal.x, normal.y), area});
  }
  return walls;
}

Sphere sphere_about(const Mesh& mesh) {
  Sphere sphere;
  Box box;
  for (const VertexId v : mesh.indices) box.add(glm::dvec3{mesh.vertices.positions[v]});
  if (box.empty()) return sphere;
  sphere.center = box.center();
  for (const VertexId v : mesh.indices) {
    sphere.radius_m = std::max(sphere.radius_m, glm::length(glm::dvec3{mesh.vertices.positions[v]} - sphere.center));
  }
  return sphere;
}

}  // namespace

double Sides::back_rad() const noexcept { return turned(front_rad, pi); }
double Sides::left_rad() const noexcept { return turned(front_rad, 0.5 * pi); }
double Sides::right_rad() const noexcept { return turned(front_rad, -0.5 * pi); }

Sides find_sides(const Mesh& mesh) {
  Sides sides{.front_rad = pi, .bounds = sphere_about(mesh)};
  const std::vector<Wall> walls = walls_of(mesh);
  if (walls.empty()) return sides;
  double x = 0.0;
  double y = 0.0;
  for (const Wall& wall : walls) {
    x += wall.area * std::cos(4.0 * wall.azimuth_rad);
    y += wall.area * std::sin(4.0 * wall.azimuth_rad);
  }
  const double axis_rad = std::atan2(y, x) / 4.0;
  std::array<std::size_t, 4> facing{};
  for (const Wall& wall : walls) {
    const double quarters = turned(wall.azimuth_rad, -axis_rad) / (0.5 * pi);
    ++facing[static_cast<std::size_t>(std::lround(quarters)) % 4];
  }
  const auto most = std::max_element(facing.begin(), facing.end());
  sides.front_rad = turned(axis_rad, 0.5 * pi * static_cast<double>(most - facing.begin()));
  return sides;
}

}  // namespace lodestone

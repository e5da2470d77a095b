// SPDX-License-Identifier: MIT
// Based on: Catmull 1974 (depth buffer), drawn from directions spread evenly over the sphere (Vogel 1979, spiral).
#include "facets/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lodestone::facets {
namespace {

constexpr int side_px = 400;
constexpr int direction_count = 96;
constexpr double slack_px = 1.5;  // a face does not hide itself

class DepthBuffer {
 public:
  DepthBuffer(const Box& box) : middle_(0.5 * (box.min + box.max)), pixel_m_(box.diagonal_m() / (side_px - 2)) {
    depths_.resize(std::size_t{side_px} * side_px);
  }

  // Looks along `direction` from infinity.
  void look(const glm::dvec3& direction) {
    along_ = direction;
    const glm::dvec3 up = std::abs(direction.z) < 0.9 ? glm::dvec3{0.0, 0.0, 1.0} : glm::dvec3{1.0, 0.0, 0.0};
    right_ = glm::normalize(glm::cross(direction, up));
    up_ = glm::cross(right_, direction);
    std::fill(depths_.begin(), depths_.end(), std::numeric_limits<double>::infinity());
  }

  void draw(const std::array<glm::dvec3, 3>& corners) {
    const glm::dvec3 a = project(corners[0]);
    const glm::dvec3 b = project(corners[1]);
    const glm::dvec3 c = project(corners[2]);
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (std::abs(area) < 1e-9) return;
    const glm::ivec2 low{static_cast<int>(std::min({a.x, b.x, c.x})), static_cast<int>(std::min({a.y, b.y, c.y}))};
    const glm::ivec2 high{static_cast<int>(std::max({a.x, b.x, c.x})), static_cast<int>(std::max({a.y, b.y, c.y}))};
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const glm::dvec2 p{x + 0.5, y + 0.5};
        const double wb = ((p.x - a.x) * (c.y - a.y) - (p.y - a.y) * (c.x - a.x)) / area;
        const double wc = ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / area;
        if (wb < 0.0 || wc < 0.0 || wb + wc > 1.0) continue;
        double& depth = depths_[index(x, y)];
        depth = std::min(depth, a.z + wb * (b.z - a.z) + wc * (c.z - a.z));
      }
    }
  }

  [[nodiscard]] bool shows(const glm::dvec3& place) const {
    const glm::dvec3 p = project(place);
    return p.z <= depths_[index(static_cast<int>(p.x), static_cast<int>(p.y))] + slack_px;
  }

 private:
  // In pixels, depth too.
  [[nodiscard]] glm::dvec3 project(const glm::dvec3& p) const {
    const glm::dvec3 d = (p - middle_) / pixel_m_;
    return {glm::dot(d, right_) + 0.5 * side_px, glm::dot(d, up_) + 0.5 * side_px, glm::dot(d, along_)};
  }
  static std::size_t index(int x, int y) {
    return static_cast<std::size_t>(std::clamp(y, 0, side_px - 1)) * side_px +
           static_cast<std::size_t>(std::clamp(x, 0, side_px - 1));
  }

  glm::dvec3 middle_, along_{0.0}, right_{0.0}, up_{0.0};
  double pixel_m_;
  std::vector<double> depths_;
};

}  // namespace

glm::dvec3 spiral_direction(int i, int count) {
  const double z = 1.0 - (2.0 * i + 1.0) / count;
  const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt(1.0 - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

std::vector<std::uint8_t> seen_surfaces(const Mesh& mesh, const CharacteristicSurfaces& surfaces) {
  std::vector<std::uint8_t> seen(surfaces.surfaces.size(), 0);
  const Box box = bounds(mesh);
  if (!(box.diagonal_m() > 0.0)) return seen;
  const auto corners = [&](FaceId f) {
    std::array<glm::dvec3, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = glm::dvec3{mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + k]]};
    }
    return p;
  };
  DepthBuffer buffer{box};
  for (int i = 0; i < direction_count; ++i) {
    buffer.look(spiral_direction(i, direction_count));
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
      if (!mesh.materials[mesh.face_material(f)].transparent()) buffer.draw(corners(f));
    }
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
      const std::uint32_t s = surfaces.surface_of_face[f];
      if (s == none || seen[s] != 0) continue;
      const auto p = corners(f);
      const glm::dvec3 middle = (p[0] + p[1] + p[2]) / 3.0;
      const bool shown = buffer.shows(middle) || std::any_of(p.begin(), p.end(), [&](const glm::dvec3& corner) {
                           return buffer.shows(glm::mix(corner, middle, 0.2));
                         });
      seen[s] = shown ? 1 : 0;
    }
  }
  return seen;
}

}  // namespace lodestone::facets

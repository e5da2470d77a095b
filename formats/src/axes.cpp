// SPDX-License-Identifier: MIT
#include "axes.h"

#include <cmath>

namespace lodestone {

LoadedMesh to_lodestone_axes(Mesh mesh, std::string format, UpAxis file_up, double file_unit_m,
                             const ReadOptions& options) {
  const UpAxis up = options.up != UpAxis::FromFile ? options.up : file_up;
  const double unit_m = options.unit_m > 0.0 ? options.unit_m : (file_unit_m > 0.0 ? file_unit_m : 1.0);
  if (up == UpAxis::Y) {
    mesh.origin = y_up_to_z_up(mesh.origin) + 0.0;  // no -0
    for (auto& p : mesh.vertices.positions) p = y_up_to_z_up(p);
    for (auto& n : mesh.vertices.normals) n = y_up_to_z_up(n);
  }
  if (unit_m != 1.0) {
    mesh.origin *= unit_m;
    for (auto& p : mesh.vertices.positions) p = glm::vec3{glm::dvec3{p} * unit_m};
  }
  LoadedMesh loaded{std::move(mesh), {}};
  loaded.info.format = std::move(format);
  loaded.info.up_axis = up == UpAxis::Y ? "Y" : "Z";
  loaded.info.unit_m = unit_m;
  return loaded;
}

glm::dvec3 choose_origin(const Box& bounds) noexcept {
  constexpr double far_m = 1e4;
  glm::dvec3 origin{0.0};
  if (bounds.empty()) return origin;
  const glm::dvec3 centre = bounds.center();
  for (int axis = 0; axis < 3; ++axis) {
    const double reach = std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis]));
    if (reach > far_m && std::isfinite(centre[axis])) origin[axis] = std::round(centre[axis] / 100.0) * 100.0;
  }
  return origin;
}

}  // namespace lodestone

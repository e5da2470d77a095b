// SPDX-License-Identifier: MIT
#include "collapse/last_faces.h"

#include <algorithm>

namespace lodestone::collapse {
namespace {

bool lies_in(const Face& face, const Range& points) {
  return std::all_of(face.point.begin(), face.point.end(),
                     [&](std::uint32_t p) { return p >= points.begin && p < points.end; });
}

bool has_area(const WorkingMesh& mesh, const Face& face) {
  const auto at = [&](std::size_t k) { return glm::dvec3{mesh.position[face.point[k]]}; };
  return glm::cross(at(1) - at(0), at(2) - at(0)) != glm::dvec3{0.0};
}

}  // namespace

void LastFaces::count(const WorkingMesh& mesh, std::span<const Range> regions) {
  if (group_of_.empty()) return;
  constexpr std::uint32_t safe = none - 1;
  const std::size_t groups = std::size_t{*std::max_element(group_of_.begin(), group_of_.end())} + 1;
  keeper_.assign(groups, none);
  left_.assign(groups, 0);
  for (const Face& f : mesh.faces) {
    if (f.id == none) continue;
    const std::uint32_t g = group(f.id);
    if (keeper_[g] == safe || !has_area(mesh, f)) continue;
    if (keeper_[g] == none) {
      const auto at = std::find_if(regions.begin(), regions.end(), [&](const Range& r) { return lies_in(f, r); });
      keeper_[g] = at == regions.end() ? safe : static_cast<std::uint32_t>(at - regions.begin());
    }
    if (keeper_[g] != safe && lies_in(f, regions[keeper_[g]])) ++left_[g];
  }
}

bool LastFaces::may_go(std::span<const FaceId> faces, std::uint32_t region) const {
  if (group_of_.empty()) return true;
  return std::all_of(faces.begin(), faces.end(), [&](FaceId face) {
    const std::uint32_t g = group(face);
    if (keeper_[g] != region) return true;
    const auto going = std::count_if(faces.begin(), faces.end(), [&](FaceId other) { return group(other) == g; });
    return static_cast<std::uint32_t>(going) < left_[g];
  });
}

void LastFaces::take(std::span<const FaceId> faces, std::uint32_t region) {
  if (group_of_.empty()) return;
  for (const FaceId face : faces) {
    const std::uint32_t g = group(face);
    if (keeper_[g] == region && left_[g] > 0) --left_[g];
  }
}

}  // namespace lodestone::collapse

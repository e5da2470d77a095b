// SPDX-License-Identifier: MIT
#include "facets/point_cells.h"

namespace lodestone::facets {
namespace {

constexpr float cell_m = 0.5F;
constexpr float most_cells = 256.0F;  // along the longest side

}  // namespace

PointCells::PointCells(const FacetMesh& mesh) : mesh_(mesh), seen_at_(mesh.place) {
  FloatBox box;
  for (const glm::vec3& p : mesh.place) box.add(p);
  if (!mesh.place.empty()) {
    low_ = box.low;
    high_ = box.high;
  }
  const glm::vec3 size = high_ - low_;
  const float longest = std::max({size.x, size.y, size.z});
  scale_ = 1.0F / std::max(cell_m, longest / most_cells);
  count_ = glm::ivec3{size * scale_} + 1;
  changed_at_.assign(index_of(count_ - 1) + 1, 0);
  sort_points();
}

void PointCells::sort_points() {
  first_.assign(changed_at_.size() + 1, 0);
  cell_.resize(mesh_.point_count());
  for (std::uint32_t p = 0; p < mesh_.point_count(); ++p) {
    if (mesh_.faces_of[p].empty()) continue;
    cell_[p] = static_cast<std::uint32_t>(index_of(cell_of(mesh_.place[p])));
    ++first_[cell_[p] + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  points_.resize(first_.back());
  at_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t p = 0; p < mesh_.point_count(); ++p) {
    if (mesh_.faces_of[p].empty()) continue;
    const std::uint32_t i = next[cell_[p]]++;
    points_[i] = p;
    at_[i] = mesh_.place[p];
  }
}

void PointCells::update(const std::vector<FaceId>& changed) {
  if (changed.empty()) return;
  ++now_;
  for (const FaceId f : changed) {
    for (const std::uint32_t p : mesh_.faces[f].point) {
      changed_at_[index_of(cell_of(seen_at_[p]))] = now_;
      changed_at_[index_of(cell_of(mesh_.place[p]))] = now_;
      seen_at_[p] = mesh_.place[p];
    }
  }
  sort_points();
}

std::uint64_t PointCells::last_change(const FloatBox& box) const {
  std::uint32_t last = 0;
  visit_cells(box, [&](std::size_t cell) { last = std::max(last, changed_at_[cell]); });
  return last;
}

}  // namespace lodestone::facets

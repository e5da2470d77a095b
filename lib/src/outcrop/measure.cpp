// SPDX-License-Identifier: MIT
// Based on: outcrop/deviation.h.
#include "outcrop/measure.h"

#include <algorithm>
#include <cmath>

#include "mesh/weld.h"

namespace lodestone {
namespace {

// What only faces without area reach lies anywhere: coarser levels lose it, and no distance tells of it.
void keep_solid(std::vector<outcrop::BorderEdge>& edges, const std::vector<std::uint8_t>& solid) {
  if (solid.empty()) return;
  std::erase_if(edges, [&](const outcrop::BorderEdge& edge) { return solid[edge.a] == 0 || solid[edge.b] == 0; });
}

}  // namespace

void LevelMeasurer::find_source_borders() {
  const OutcropPyramid::LevelMesh& source = out_.meshes_.front();
  source_weld_ = weld_by_position(source.vertices.positions);
  source_borders_ = outcrop::find_borders(source.indices, source_weld_, leaf_of_face_).edges;
  source_solid_ = outcrop::solid_points(source.vertices.positions, source.indices, source_weld_);
  keep_solid(source_borders_, source_solid_);
}

std::vector<std::uint32_t> LevelMeasurer::tile_of_faces() const {
  const OutcropPyramid::LevelMesh& level = out_.meshes_.back();
  std::vector<std::uint32_t> result;
  result.reserve(level.face_materials.size());
  for (std::uint32_t i = 0; i + 1 < level.first_face.size(); ++i) {
    result.insert(result.end(), level.first_face[i + 1] - level.first_face[i], i);
  }
  return result;
}

// What skirts will need.
void LevelMeasurer::keep_borders(const Weld& weld, const outcrop::Borders& borders) const {
  OutcropPyramid::LevelMesh& level = out_.meshes_.back();
  level.face_borders = outcrop::border_bits(level.indices, weld, borders.edges);
  std::vector<std::uint32_t> place(weld.point_count(), none);
  for (const outcrop::BorderEdge& edge : borders.edges) {
    for (const std::uint32_t point : {edge.a, edge.b}) {
      if (place[point] != none) continue;
      place[point] = static_cast<std::uint32_t>(level.border_points.size());
      level.border_points.push_back({.position = level.vertices.positions[weld.first_vertex[point]]});
    }
  }
  const TriangleBvh rim = outcrop::segments_between(level.vertices.positions, weld, borders.open_points);
  for (OutcropPyramid::BorderPoint& point : level.border_points) {
    point.rim_m = static_cast<float>(std::sqrt(rim.nearest(glm::dvec3{point.position}).squared_distance));
  }
  for (std::size_t c = 0; c < level.indices.size(); ++c) {
    const std::uint32_t at = place[weld.point_of[level.indices[c]]];
    if (at == none) continue;
    const VertexId* v = &level.indices[c - c % 3];
    const auto& p = level.vertices.positions;
    const glm::vec3 area = glm::cross(p[v[1]] - p[v[0]], p[v[2]] - p[v[0]]);
    const float size = glm::length(area);
    if (size > 0.0F) level.border_points[at].normal += area / size;
  }
  std::sort(level.border_points.begin(), level.border_points.end(),
            [](const auto& a, const auto& b) { return outcrop::is_before(a.position, b.position); });
}

void LevelMeasurer::hold_against_source(const std::vector<std::uint32_t>& tile_of_cell, const outcrop::Tiled& level,
                                        const Context& context) {
  const OutcropPyramid::LevelMesh& source = out_.meshes_.front();
  std::vector<std::uint32_t> of_source;
  of_source.reserve(leaf_of_face_.size());
  for (const std::uint32_t leaf : leaf_of_face_) of_source.push_back(tile_of_cell[leaf]);
  std::vector<outcrop::BorderEdge> source_borders;
  for (const outcrop::BorderEdge& edge : source_borders_) {
    const std::uint32_t left = tile_of_cell[edge.left];
    const std::uint32_t right = tile_of_cell[edge.right];
    if (left != right) source_borders.push_back({edge.a, edge.b, left, right});
  }
  const auto tiles = static_cast<std::uint32_t>(deviations_.size());
  deviations_ = deviation_->measure(
      {source.vertices.positions, source.indices, of_source, source_weld_, source_borders, source_solid_}, level, tiles,
      context);
  std::vector<double> sorted;
  for (const outcrop::TileDeviation& one : deviations_) sorted.push_back(one.surface_m);
  out_.levels_.back().geometric_error_m = *std::max_element(sorted.begin(), sorted.end());
  std::nth_element(sorted.begin(), sorted.begin() + tiles / 2, sorted.end());
  middle_deviation_m_ = sorted[tiles / 2];
}

void LevelMeasurer::measure(const std::vector<std::uint32_t>& tile_of_cell, const Context& context) {
  const bool is_source = out_.meshes_.size() == 1;
  const OutcropPyramid::LevelMesh& level = out_.meshes_.back();
  if (is_source) find_source_borders();
  const Weld own = is_source ? Weld{} : weld_by_position(level.vertices.positions);
  const Weld& weld = is_source ? source_weld_ : own;
  const std::vector<std::uint32_t> tile_of_face = tile_of_faces();
  outcrop::Borders borders = outcrop::find_borders(level.indices, weld, tile_of_face);
  OutcropLevel& info = out_.levels_.back();
  info.open_edges = borders.open_edges;
  std::vector<std::uint8_t> on_border(weld.point_count(), 0);
  for (const outcrop::BorderEdge& edge : borders.edges) on_border[edge.a] = on_border[edge.b] = 1;
  for (std::size_t c = 0; c < level.indices.size(); c += 3) {
    const auto touches = [&](std::size_t k) { return on_border[weld.point_of[level.indices[c + k]]] != 0; };
    if (touches(0) || touches(1) || touches(2)) ++info.border_triangles;
  }
  keep_borders(weld, borders);
  deviations_.assign(level.first_face.size() - 1, {});
  if (is_source) {
    deviation_ = std::make_unique<outcrop::Deviation>(level.vertices.positions, level.indices);
    return;
  }
  const std::vector<std::uint8_t> solid = outcrop::solid_points(level.vertices.positions, level.indices, weld);
  keep_solid(borders.edges, solid);
  hold_against_source(tile_of_cell, {level.vertices.positions, level.indices, tile_of_face, weld, borders.edges, solid},
                      context);
}

}  // namespace lodestone

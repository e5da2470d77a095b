// SPDX-License-Identifier: MIT
// Based on: Ao et al. 2025, sections 3.2 and 3.3 (strategy 1: tile borders).
// Differs: tiles are not simplified one by one behind frozen borders. The whole outcrop is simplified from level to
// level by the shared edge collapse, which keeps the borders between the tiles of the next level as lines: they are
// thinned along themselves, once for both sides. So the tiles of a level meet in the same vertices, no rim of small
// triangles builds up, and borders inside a tile that was merged are free at once. The deviation of every tile, and of
// the chains between tiles, is measured against the source, where the paper has no error.
#include <lodestone/edge_collapse.h>
#include <lodestone/outcrop.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "mesh/weld.h"
#include "outcrop/borders.h"
#include "outcrop/cells.h"
#include "outcrop/deviation.h"
#include "outcrop/tree.h"

namespace lodestone {

namespace {

constexpr double unknown_texel_bytes = 0.4;  // of a JPEG photograph
constexpr std::uint64_t least_tile_bytes = 128'000;
constexpr std::uint64_t most_tile_bytes = 1'000'000;
constexpr std::uint64_t tiles_aimed_at = 64;
constexpr std::uint32_t most_levels = 96;
constexpr double border_slack = 1.1;       // chains are measured at samples
constexpr double error_step = 1.0 + 1e-4;  // a parent's error is at least so many times a child's

Error bad_argument(std::string message) { return {ErrorCode::BadArgument, std::move(message), ""}; }

Status check(const Mesh& mesh, std::span<const TextureInfo> textures, const OutcropOptions& options) {
  if (Status status = validate(mesh); !status) return status.error();
  if (mesh.triangle_count() == 0) return Error{ErrorCode::BadData, "the outcrop has no triangles", ""};
  if (textures.size() != mesh.textures.size()) return bad_argument("the sizes of all textures must be given");
  const auto in_range = [](double ratio) { return ratio == 0.0 || (ratio >= 0.1 && ratio <= 0.95); };
  if (!in_range(options.ratio)) return bad_argument("the ratio between levels must be 0.1 to 0.95, or 0 for automatic");
  if (!in_range(options.texture_ratio))
    return bad_argument("the texture ratio must be 0.1 to 0.95, or 0 for automatic");
  if (options.tile_bytes != 0 && options.tile_bytes < 4096) return bad_argument("tiles below 4 kB make no sense");
  return Done{};
}

}  // namespace

class OutcropBuilder {
 public:
  OutcropBuilder(Mesh mesh, std::span<const TextureInfo> textures, const OutcropOptions& options,
                 const Context& context)
      : mesh_(std::move(mesh)), textures_(textures), options_(options), context_(context) {
    out_->meshes_.reserve(most_levels);  // the finest is referred to
  }

  Result<std::shared_ptr<const OutcropPyramid>> build();

 private:
  // What a face is besides its corners, carried through every collapse by its feature number.
  struct FaceName {
    std::uint32_t leaf = 0;
    MaterialId material = 0;
    FeatureId feature = none;
    friend auto operator<=>(const FaceName&, const FaceName&) = default;
  };

  void plan_bytes();
  void name_faces();
  void mark_tiles();
  [[nodiscard]] double choose_ratio() const;
  [[nodiscard]] Status simplify_once();
  void add_level(double texture_scale);
  void place_faces();
  void find_source_borders();
  [[nodiscard]] std::vector<std::uint32_t> tile_of_faces() const;
  void keep_borders(const Weld& weld, const outcrop::Borders& borders);
  void measure_level();
  void describe_tile(std::uint32_t local);
  void weigh_cells();
  void link_children();
  void widen_skirts();
  [[nodiscard]] double bytes_of_front() const;
  [[nodiscard]] Status climb();
  [[nodiscard]] double texture_ratio() const {
    if (options_.texture_ratio > 0.0) return options_.texture_ratio;
    return options_.ratio > 0.0 ? options_.ratio : 0.5;
  }
  [[nodiscard]] std::uint32_t tile_count() const { return static_cast<std::uint32_t>(cells_of_level_.size()); }

  Mesh mesh_;  // the newest level
  std::span<const TextureInfo> textures_;
  const OutcropOptions& options_;
  const Context& context_;
  std::shared_ptr<OutcropPyramid> out_{new OutcropPyramid};
  outcrop::Segmentation segmentation_;
  outcrop::ByteModel bytes_;
  outcrop::CellTree tree_;
  std::vector<FaceName> names_;
  std::vector<double> leaf_texture_bytes_;  // per cell, at full size
  outcrop::CellBytes cell_bytes_;
  std::vector<std::uint32_t> cells_of_level_;  // per tile of the level at hand
  std::vector<std::uint32_t> cells_below_;     // of the level below
  std::vector<std::uint32_t> tile_of_cell_;    // for leaves and what lies between them and the front
  double texel_m_ = 0.0;                       // mean over textured faces
  double ratio_ = 0.4;                         // of triangles, of the last step

  Weld source_weld_;
  std::vector<std::uint32_t> leaf_of_source_face_;
  std::vector<outcrop::BorderEdge> source_borders_;  // between leaves
  std::unique_ptr<outcrop::Deviation> deviation_;
  std::vector<outcrop::TileDeviation> deviations_;  // per tile of the newest level
  std::vector<double> borders_below_m_;             // per tile of the newest level: of the chains of finer levels
  double middle_deviation_m_ = 0.0;                 // of the newest level's tiles
};

// Weights of the data, and V_t.
void OutcropBuilder::plan_bytes() {
  const VertexArrays& v = mesh_.vertices;
  const double per_vertex =
      12.0 + (v.normals.empty() ? 0.0 : 12.0) + (v.uvs.empty() ? 0.0 : 8.0) + (v.colors.empty() ? 0.0 : 8.0);
  bytes_.per_triangle = 0.55 * per_vertex + 6.0;
  const double geometry = bytes_.per_triangle * mesh_.triangle_count();
  double texture = 0.0;
  double area_m2 = 0.0;
  double area_px = 0.0;
  for (std::size_t s = 0; s < segmentation_.segments.size(); ++s) {
    const OutcropSegment& segment = segmentation_.segments[s];
    bytes_.per_texel.push_back(0.0);
    if (segment.texture == none) continue;
    const TextureInfo& info = textures_[segment.texture];
    const double pixels = static_cast<double>(info.width_px) * info.height_px;
    bytes_.per_texel[s] =
        info.file_bytes > 0 ? std::min(3.0, static_cast<double>(info.file_bytes) / pixels) : unknown_texel_bytes;
    const double used = static_cast<double>(segment.width_px) * segment.height_px;
    texture += used * bytes_.per_texel[s];
    area_px += used;
    area_m2 += used * segment.texel_m * segment.texel_m;
  }
  texel_m_ = area_px > 0.0 ? std::sqrt(area_m2 / area_px) : 0.0;
  out_->tile_bytes_ = options_.tile_bytes;
  if (options_.tile_bytes == 0) {
    const auto share = static_cast<std::uint64_t>((geometry + texture) / tiles_aimed_at);
    out_->tile_bytes_ = std::clamp(share, least_tile_bytes, most_tile_bytes);
  }
  const auto whole = static_cast<double>(out_->tile_bytes_);
  bytes_.tile_geometry = whole * geometry / (geometry + texture);
  bytes_.tile_texture = whole - bytes_.tile_geometry;
}

// Faces keep their feature through every collapse: it carries the leaf, the material and the feature of each.
void OutcropBuilder::name_faces() {
  leaf_texture_bytes_.assign(tree_.cells.size(), 0.0);
  for (std::size_t s = 0; s < segmentation_.segments.size(); ++s) {
    if (segmentation_.segments[s].texture == none) continue;
    for (const FaceId f : segmentation_.faces[s]) {
      const VertexId* v = &mesh_.indices[3 * std::size_t{f}];
      const auto px = [&](int k) { return outcrop::to_pixels(mesh_.vertices.uvs[v[k]], segmentation_.image_px[s]); };
      leaf_texture_bytes_[tree_.leaf_of_face[f]] += outcrop::area_px2(px(0), px(1), px(2)) * bytes_.per_texel[s];
    }
  }
  std::map<FaceName, FeatureId> known;
  std::vector<FeatureId> numbers(mesh_.triangle_count());
  for (FaceId f = 0; f < mesh_.triangle_count(); ++f) {
    const FaceName name{tree_.leaf_of_face[f], mesh_.face_material(f), mesh_.face_feature(f)};
    const auto [at, is_new] = known.try_emplace(name, static_cast<FeatureId>(names_.size()));
    if (is_new) names_.push_back(name);
    numbers[f] = at->second;
  }
  mesh_.face_features = std::move(numbers);
  mesh_.features.assign(names_.size(), Feature{});
}

// Gives every pair of material and tile a material of its own: the collapse keeps to the lines between them.
void OutcropBuilder::mark_tiles() {
  std::map<std::pair<MaterialId, std::uint32_t>, MaterialId> known;
  mesh_.materials.clear();
  mesh_.textures.clear();
  mesh_.face_materials.resize(mesh_.triangle_count());
  for (FaceId f = 0; f < mesh_.triangle_count(); ++f) {
    const FaceName& name = names_[mesh_.face_features[f]];
    const std::pair<MaterialId, std::uint32_t> key{name.material, tile_of_cell_[name.leaf]};
    const auto [at, is_new] = known.try_emplace(key, static_cast<MaterialId>(mesh_.materials.size()));
    if (is_new) {
      mesh_.materials.push_back(out_->surroundings_.materials[name.material]);
      mesh_.materials.back().texture = none;
    }
    mesh_.face_materials[f] = at->second;
  }
}

// Of the next step. Without a wish it keeps the deviation of the middle tile at the size of a texel: what went too far
// or not far enough in the step before is made up for in the next.
double OutcropBuilder::choose_ratio() const {
  if (options_.ratio > 0.0) return options_.ratio;
  if (texel_m_ == 0.0 || out_->levels_.size() == 1) return ratio_;
  constexpr double least_ratio = 0.2;
  constexpr double most_ratio = 0.7;
  const double texel_m = texel_m_ / out_->levels_.back().texture_scale;
  const double room = texel_m / std::max(middle_deviation_m_, 1e-6 * texel_m);
  return std::clamp(ratio_ * std::sqrt(room), least_ratio, most_ratio);
}

Status OutcropBuilder::simplify_once() {
  mark_tiles();
  EdgeCollapseOptions collapse;
  collapse.target_triangles = std::max(1U, static_cast<std::uint32_t>(mesh_.triangle_count() * ratio_));
  collapse.uv_weight = 0.2;
  collapse.sharpness_power = 2.0;
  auto simplified = simplify(mesh_, collapse, context_);
  if (!simplified) return simplified.error();
  mesh_ = std::move(simplified->mesh);
  return Done{};
}

// The newest level's faces, sorted by tile.
void OutcropBuilder::place_faces() {
  const std::uint32_t count = mesh_.triangle_count();
  OutcropPyramid::LevelMesh& out = out_->meshes_.emplace_back();
  const auto tile_of = [&](FaceId f) { return tile_of_cell_[names_[mesh_.face_features[f]].leaf]; };
  out.first_face.assign(tile_count() + 1, 0);
  for (FaceId f = 0; f < count; ++f) ++out.first_face[tile_of(f) + 1];
  std::partial_sum(out.first_face.begin(), out.first_face.end(), out.first_face.begin());
  std::vector<std::uint32_t> at(out.first_face.begin(), out.first_face.end() - 1);
  out.indices.resize(3 * std::size_t{count});
  out.face_materials.resize(count);
  const bool featured = !out_->surroundings_.features.empty();
  if (featured) out.face_features.resize(count);
  if (out_->meshes_.size() == 1) leaf_of_source_face_.resize(count);
  for (FaceId f = 0; f < count; ++f) {
    const std::uint32_t to = at[tile_of(f)]++;
    const FaceName& name = names_[mesh_.face_features[f]];
    for (std::size_t k = 0; k < 3; ++k) out.indices[3 * std::size_t{to} + k] = mesh_.indices[3 * std::size_t{f} + k];
    out.face_materials[to] = name.material;
    if (featured) out.face_features[to] = name.feature;
    if (out_->meshes_.size() == 1) leaf_of_source_face_[to] = name.leaf;
  }
  out.vertices = mesh_.vertices;
}

void OutcropBuilder::find_source_borders() {
  const OutcropPyramid::LevelMesh& source = out_->meshes_.front();
  source_weld_ = weld_by_position(source.vertices.positions);
  outcrop::Borders borders = outcrop::find_borders(source.indices, source_weld_, leaf_of_source_face_);
  source_borders_ = std::move(borders.edges);
  deviation_ = std::make_unique<outcrop::Deviation>(source.vertices.positions, source.indices);
}

// Per face of the newest level.
std::vector<std::uint32_t> OutcropBuilder::tile_of_faces() const {
  const OutcropPyramid::LevelMesh& level = out_->meshes_.back();
  std::vector<std::uint32_t> result;
  result.reserve(level.face_materials.size());
  for (std::uint32_t i = 0; i < tile_count(); ++i) {
    result.insert(result.end(), level.first_face[i + 1] - level.first_face[i], i);
  }
  return result;
}

// What skirts will need of the newest level.
void OutcropBuilder::keep_borders(const Weld& weld, const outcrop::Borders& borders) {
  OutcropPyramid::LevelMesh& level = out_->meshes_.back();
  level.face_borders = outcrop::border_bits(level.indices, weld, borders.edges);
  std::vector<std::uint32_t> place(weld.point_count(), none);
  for (const outcrop::BorderEdge& edge : borders.edges) {
    for (const std::uint32_t point : {edge.a, edge.b}) {
      if (place[point] != none) continue;
      place[point] = static_cast<std::uint32_t>(level.border_points.size());
      level.border_points.push_back({.position = level.vertices.positions[weld.first_vertex[point]]});
    }
  }
  for (const std::uint32_t point : borders.open_points) {
    if (place[point] != none) level.border_points[place[point]].on_rim = true;
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

// Borders of the newest level, and how far it is from the source.
void OutcropBuilder::measure_level() {
  const OutcropPyramid::LevelMesh& source = out_->meshes_.front();
  const OutcropPyramid::LevelMesh& level = out_->meshes_.back();
  OutcropLevel& info = out_->levels_.back();
  const std::vector<std::uint32_t> tile_of_face = tile_of_faces();
  const Weld weld = weld_by_position(level.vertices.positions);
  const outcrop::Borders borders = outcrop::find_borders(level.indices, weld, tile_of_face);
  info.open_edges = borders.open_edges;
  std::vector<std::uint8_t> on_border(weld.point_count(), 0);
  for (const outcrop::BorderEdge& edge : borders.edges) on_border[edge.a] = on_border[edge.b] = 1;
  for (std::size_t c = 0; c < level.indices.size(); c += 3) {
    const auto touches = [&](std::size_t k) { return on_border[weld.point_of[level.indices[c + k]]] != 0; };
    if (touches(0) || touches(1) || touches(2)) ++info.border_triangles;
  }
  keep_borders(weld, borders);
  deviations_.assign(tile_count(), {});
  if (out_->meshes_.size() == 1) return;
  std::vector<std::uint32_t> of_source;
  of_source.reserve(leaf_of_source_face_.size());
  for (const std::uint32_t leaf : leaf_of_source_face_) of_source.push_back(tile_of_cell_[leaf]);
  std::vector<outcrop::BorderEdge> source_borders;
  for (const outcrop::BorderEdge& edge : source_borders_) {
    const std::uint32_t left = tile_of_cell_[edge.left];
    const std::uint32_t right = tile_of_cell_[edge.right];
    if (left != right) source_borders.push_back({edge.a, edge.b, left, right});
  }
  deviations_ = deviation_->measure(
      {source.vertices.positions, source.indices, of_source, source_weld_, source_borders},
      {level.vertices.positions, level.indices, tile_of_face, weld, borders.edges}, tile_count(), context_);
  std::vector<double> sorted;
  for (const outcrop::TileDeviation& one : deviations_) sorted.push_back(one.surface_m);
  info.geometric_error_m = *std::max_element(sorted.begin(), sorted.end());
  std::nth_element(sorted.begin(), sorted.begin() + tile_count() / 2, sorted.end());
  middle_deviation_m_ = sorted[tile_count() / 2];
}

// Box, segments, texel size of a tile of the newest level.
void OutcropBuilder::describe_tile(std::uint32_t local) {
  const OutcropPyramid::LevelMesh& level = out_->meshes_.back();
  const double scale = out_->levels_.back().texture_scale;
  OutcropTile& tile = out_->tiles_[out_->first_tile_.back() + local];
  tile.triangles = level.first_face[local + 1] - level.first_face[local];
  std::vector<std::uint8_t> used(segmentation_.segments.size(), 0);
  double area_m2 = 0.0;
  double area_px = 0.0;
  for (FaceId f = level.first_face[local]; f < level.first_face[local + 1]; ++f) {
    const VertexId* v = &level.indices[3 * std::size_t{f}];
    const std::uint32_t s = out_->segment_of_material_[level.face_materials[f]];
    used[s] = 1;
    glm::dvec3 p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = glm::dvec3{level.vertices.positions[v[k]]};
      tile.bounds.add(p[k]);
    }
    if (segmentation_.segments[s].texture == none) continue;
    const auto px = [&](int k) { return outcrop::to_pixels(level.vertices.uvs[v[k]], out_->image_px_[s]) * scale; };
    area_px += outcrop::area_px2(px(0), px(1), px(2));
    area_m2 += 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  }
  for (std::uint32_t s = 0; s < used.size(); ++s) {
    if (used[s] != 0) tile.segments.push_back(s);
  }
  tile.texel_m = area_px > 0.0 ? std::sqrt(area_m2 / area_px) : 0.0;
  tile.error_m = tile.level == 0 ? 0.0 : std::max(deviations_[local].surface_m, tile.texel_m);
}

// Ties the newest level to the one below it: boxes enclose, errors grow. Beside a neighbour of any finer level a border
// gapes by no more than both chains together deviate from the source's.
void OutcropBuilder::link_children() {
  std::vector<double> below_m(tile_count(), 0.0);
  const std::uint32_t here = out_->first_tile_.back();
  if (out_->first_tile_.size() > 1) {
    const std::uint32_t below = out_->first_tile_[out_->first_tile_.size() - 2];
    for (std::uint32_t i = 0; i < cells_below_.size(); ++i) {
      const std::uint32_t local = tile_of_cell_[cells_below_[i]];
      OutcropTile& child = out_->tiles_[below + i];
      child.parent = here + local;
      OutcropTile& tile = out_->tiles_[here + local];
      tile.children.push_back(below + i);
      tile.bounds.add(child.bounds.min);
      tile.bounds.add(child.bounds.max);
      tile.error_m = std::max(tile.error_m, child.error_m * error_step);
      below_m[local] = std::max(below_m[local], borders_below_m_[i]);
    }
  }
  borders_below_m_.clear();
  for (std::uint32_t i = 0; i < tile_count(); ++i) {
    double& error_m = out_->tiles_[here + i].error_m;
    if (out_->levels_.size() > 1) error_m = std::max(error_m, border_slack * (deviations_[i].border_m + below_m[i]));
    borders_below_m_.push_back(std::max(below_m[i], deviations_[i].border_m));
    out_->tiles_[here + i].gap_m = border_slack * (deviations_[i].border_m + below_m[i]);
  }
}

// A tile may meet neighbours that are coarser than itself: its skirt is deep enough for those up to two levels up.
void OutcropBuilder::widen_skirts() {
  std::vector<OutcropTile>& tiles = out_->tiles_;
  for (OutcropTile& tile : tiles) {  // children stand before their parents
    if (tile.parent != none) tiles[tile.parent].gap_m = std::max(tiles[tile.parent].gap_m, tile.gap_m);
  }
  constexpr int levels_up = 2;
  constexpr double longest = 2.3;  // a strip's diagonal at a corner, at most
  for (OutcropTile& tile : tiles) {
    const OutcropTile* above = &tile;
    for (int i = 0; i < levels_up && above->parent != none; ++i) above = &tiles[above->parent];
    tile.skirt_m = above->gap_m;
    tile.bounds.add(tile.bounds.min - longest * tile.skirt_m);
    tile.bounds.add(tile.bounds.max + longest * tile.skirt_m);
  }
}

void OutcropBuilder::weigh_cells() {
  const double scale = out_->levels_.back().texture_scale;
  cell_bytes_.geometry.assign(tree_.cells.size(), 0.0);
  cell_bytes_.texture.assign(tree_.cells.size(), 0.0);
  for (std::uint32_t c = 0; c < tree_.cells.size(); ++c) {
    const std::uint32_t tile = tile_of_cell_[c];
    if (tile != none) cell_bytes_.texture[cells_of_level_[tile]] += leaf_texture_bytes_[c] * scale * scale;
  }
  for (std::uint32_t i = 0; i < tile_count(); ++i) {
    const OutcropTile& tile = out_->tiles_[out_->first_tile_.back() + i];
    cell_bytes_.geometry[cells_of_level_[i]] = bytes_.per_triangle * tile.triangles;
  }
}

void OutcropBuilder::add_level(double texture_scale) {
  out_->levels_.push_back({.tiles = tile_count(), .triangles = mesh_.triangle_count(), .texture_scale = texture_scale});
  place_faces();
  if (out_->meshes_.size() == 1) find_source_borders();
  measure_level();
  out_->first_tile_.push_back(static_cast<std::uint32_t>(out_->tiles_.size()));
  out_->tiles_.resize(out_->tiles_.size() + tile_count());
  for (std::uint32_t i = 0; i < tile_count(); ++i) {
    out_->tiles_[out_->first_tile_.back() + i].level = static_cast<std::uint32_t>(out_->levels_.size() - 1);
    describe_tile(i);
  }
  link_children();
  weigh_cells();
}

double OutcropBuilder::bytes_of_front() const {
  return std::accumulate(cell_bytes_.geometry.begin(), cell_bytes_.geometry.end(), 0.0) +
         std::accumulate(cell_bytes_.texture.begin(), cell_bytes_.texture.end(), 0.0);
}

// Level after level until one small tile is left.
Status OutcropBuilder::climb() {
  const Error cancelled{ErrorCode::Cancelled, "building the pyramid was cancelled", ""};
  outcrop::Front front{tree_};
  cells_of_level_ = front.cells();
  tile_of_cell_ = front.cover();
  double scale = 1.0;
  add_level(scale);
  const auto enough = static_cast<double>(out_->tile_bytes_);
  bool stuck = false;
  while (tile_count() > 1 || (bytes_of_front() > enough && !stuck)) {
    if (context_.cancelled()) return cancelled;
    ratio_ = choose_ratio();
    stuck = stuck || out_->levels_.size() + 2 >= most_levels;
    front.merge(cell_bytes_, ratio_, texture_ratio() * texture_ratio(), enough, stuck);
    cells_below_ = std::move(cells_of_level_);
    cells_of_level_ = front.cells();
    tile_of_cell_ = front.cover();
    const std::uint32_t before = mesh_.triangle_count();
    if (Status status = simplify_once(); !status) return status;
    stuck = mesh_.triangle_count() >= before && texel_m_ == 0.0;  // no better level will come: merge what there is
    scale *= texture_ratio();
    add_level(scale);
    context_.report("levels", 1.0 - 1.0 / static_cast<double>(out_->levels_.size()));
    if (out_->levels_.size() >= most_levels) break;
  }
  if (context_.cancelled()) return cancelled;
  widen_skirts();
  return Done{};
}

Result<std::shared_ptr<const OutcropPyramid>> OutcropBuilder::build() {
  if (Status status = check(mesh_, textures_, options_); !status) return status.error();
  auto segmentation = outcrop::segment_by_image(mesh_, textures_);
  if (!segmentation) return segmentation.error();
  segmentation_ = std::move(*segmentation);
  plan_bytes();
  tree_ = outcrop::make_cells(mesh_, segmentation_, bytes_, options_.split);
  out_->surroundings_ = mesh_;
  out_->segment_of_material_ = segmentation_.segment_of_material;
  out_->image_px_ = segmentation_.image_px;
  out_->segments_ = segmentation_.segments;
  name_faces();
  segmentation_.faces.clear();
  if (Status status = climb(); !status) return status.error();
  return std::shared_ptr<const OutcropPyramid>{std::move(out_)};
}

Result<std::shared_ptr<const OutcropPyramid>> OutcropPyramid::build(Mesh mesh, std::span<const TextureInfo> textures,
                                                                    const OutcropOptions& options,
                                                                    const Context& context) {
  return OutcropBuilder{std::move(mesh), textures, options, context}.build();
}

std::size_t OutcropPyramid::memory_bytes() const noexcept {
  std::size_t bytes = 0;
  for (const LevelMesh& level : meshes_) {
    const VertexArrays& v = level.vertices;
    bytes += v.positions.size() * sizeof(glm::vec3) + v.normals.size() * sizeof(glm::vec3) +
             v.uvs.size() * sizeof(glm::vec2) + v.colors.size() * sizeof(glm::u8vec4) +
             (level.indices.size() + level.face_materials.size() + level.face_features.size()) * sizeof(std::uint32_t) +
             level.face_borders.size() + level.border_points.size() * sizeof(BorderPoint);
  }
  return bytes;
}

glm::uvec2 OutcropPyramid::image_size(std::uint32_t segment, std::uint32_t level) const noexcept {
  const auto scaled = [&](std::uint32_t size) {
    return static_cast<std::uint32_t>(std::max(1.0, std::round(size * levels_[level].texture_scale)));
  };
  return {scaled(segments_[segment].width_px), scaled(segments_[segment].height_px)};
}

}  // namespace lodestone

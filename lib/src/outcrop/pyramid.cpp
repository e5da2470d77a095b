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
#include <optional>
#include <tuple>

#include "base/parallel.h"
#include "mesh/weld.h"
#include "outcrop/cells.h"
#include "outcrop/measure.h"
#include "outcrop/ratio.h"
#include "outcrop/tree.h"

namespace lodestone {

namespace {

constexpr double unknown_texel_bytes = 0.4;  // of a JPEG photograph
constexpr std::uint64_t least_tile_bytes = 128'000;
constexpr std::uint64_t most_tile_bytes = 1'000'000;
constexpr std::uint64_t most_root_bytes = 256'000;  // all of it is read before anything shows
constexpr std::uint64_t tiles_aimed_at = 64;
constexpr std::uint32_t most_levels = 96;
constexpr std::uint32_t least_triangles = 64;  // of a level: fewer show nothing of a rock and save nothing
constexpr double border_slack = 1.1;           // chains are measured at samples
constexpr double error_step = 1.0 + 1e-4;      // a parent's error is at least so many times a child's

Error bad_argument(std::string message) { return {ErrorCode::BadArgument, std::move(message), ""}; }

Status check(const Mesh& mesh, std::span<const TextureInfo> textures, const OutcropOptions& options) {
  if (Status status = validate(mesh); !status) return status.error();
  if (mesh.triangle_count() == 0) return Error{ErrorCode::BadData, "the outcrop has no triangles", ""};
  if (degenerate_triangle_count(mesh) == mesh.triangle_count()) {
    return Error{ErrorCode::BadData, "no triangle of the outcrop has an area", ""};
  }
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
    friend auto operator<=>(const FaceName&, const FaceName&) = default;  // NOLINT(modernize-use-nullptr): has none
  };

  void plan_bytes();
  void name_faces();
  void mark_tiles();
  [[nodiscard]] double choose_ratio() const;
  [[nodiscard]] bool ratio_is_known() const;
  [[nodiscard]] Status simplify_once(const Context& context);
  [[nodiscard]] Status go_up();
  void add_level(double texture_scale);
  void place_faces();
  void describe_tile(std::uint32_t local);
  void weigh_cells();
  void link_children();
  void settle_errors();
  void widen_skirts();
  [[nodiscard]] double bytes_of_front() const;
  [[nodiscard]] Status climb();
  [[nodiscard]] std::uint32_t tile_count() const { return static_cast<std::uint32_t>(cells_of_level_.size()); }

  Mesh mesh_;  // the newest level
  std::span<const TextureInfo> textures_;
  const OutcropOptions& options_;
  const Context& context_;
  std::shared_ptr<OutcropPyramid> out_{new OutcropPyramid};
  outcrop::Segmentation segmentation_;
  outcrop::ByteModel bytes_;
  outcrop::CellTree tree_;
  std::optional<outcrop::Front> front_;
  const double texture_ratio_ = outcrop::texture_ratio(options_);
  bool stuck_ = false;  // levels do not become smaller
  std::vector<FaceName> names_;
  std::vector<double> leaf_texture_bytes_;  // per cell, at full size
  outcrop::CellBytes cell_bytes_;
  std::vector<std::uint32_t> cells_of_level_;    // per tile of the level at hand
  std::vector<std::uint32_t> cells_below_;       // of the level below
  std::vector<std::uint32_t> tile_of_cell_;      // for leaves and what lies between them and the front
  std::vector<std::uint32_t> tile_of_material_;  // of mark_tiles()
  double texel_m_ = 0.0;                         // mean over textured faces
  double ratio_ = outcrop::untextured_ratio;     // of triangles, of the last step

  LevelMeasurer measurer_{*out_};
  std::vector<double> borders_below_m_;  // per tile of the newest level: of the chains of finer levels
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
  if (texel_m_ > 0.0) ratio_ = outcrop::followed_ratio(options_).first;
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

// Gives every pair of material and tile a material of its own: the collapse keeps to the lines between them, and leaves
// each tile a face.
void OutcropBuilder::mark_tiles() {
  std::map<std::pair<MaterialId, std::uint32_t>, MaterialId> known;
  tile_of_material_.clear();
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
      tile_of_material_.push_back(key.second);
    }
    mesh_.face_materials[f] = at->second;
  }
}

// Before the newest level is measured.
bool OutcropBuilder::ratio_is_known() const {
  return options_.ratio > 0.0 || texel_m_ == 0.0 || out_->levels_.size() == 1;
}

// Of the next step. Without a wish it is to bring the deviation of the middle tile to the size of the next level's
// texels, as if one fell as the other's number grows: so it is on smooth rock. What rough rock makes of it is measured
// before the step after.
double OutcropBuilder::choose_ratio() const {
  if (options_.ratio > 0.0) return options_.ratio;
  if (ratio_is_known()) return ratio_;
  const double next_texel_m = texel_m_ / (out_->levels_.back().texture_scale * texture_ratio_);
  const outcrop::FollowedRatio bounds = outcrop::followed_ratio(options_);
  return std::clamp(measurer_.middle_deviation_m() / next_texel_m, bounds.least, bounds.most);
}

Status OutcropBuilder::simplify_once(const Context& context) {
  mark_tiles();
  EdgeCollapseOptions collapse;
  collapse.target_triangles = std::max(least_triangles, static_cast<std::uint32_t>(mesh_.triangle_count() * ratio_));
  collapse.uv_weight = 0.2;
  collapse.sharpness_power = 2.0;
  collapse.material_groups = tile_of_material_;  // no tile loses its last face
  auto simplified = simplify(std::move(mesh_), collapse, context);
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
  std::vector<std::uint32_t> leaves(out_->meshes_.size() == 1 ? count : 0);
  for (FaceId f = 0; f < count; ++f) {
    const std::uint32_t to = at[tile_of(f)]++;
    const FaceName& name = names_[mesh_.face_features[f]];
    for (std::size_t k = 0; k < 3; ++k) out.indices[3 * std::size_t{to} + k] = mesh_.indices[3 * std::size_t{f} + k];
    out.face_materials[to] = name.material;
    if (featured) out.face_features[to] = name.feature;
    if (!leaves.empty()) leaves[to] = name.leaf;
  }
  if (!leaves.empty()) measurer_.take_leaves(std::move(leaves));
  out.vertices = mesh_.vertices;
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
}

// Ties the newest level to the one below it: boxes enclose.
void OutcropBuilder::link_children() {
  if (out_->first_tile_.size() == 1) return;
  const std::uint32_t here = out_->first_tile_.back();
  const std::uint32_t below = out_->first_tile_[out_->first_tile_.size() - 2];
  for (std::uint32_t i = 0; i < cells_below_.size(); ++i) {
    OutcropTile& child = out_->tiles_[below + i];
    child.parent = here + tile_of_cell_[cells_below_[i]];
    OutcropTile& tile = out_->tiles_[child.parent];
    tile.children.push_back(below + i);
    tile.bounds.add(child.bounds.min);
    tile.bounds.add(child.bounds.max);
  }
}

// Of the newest level once it is measured: errors grow upwards. Beside a neighbour of any finer level a border gapes by
// no more than both chains together deviate from the source's.
void OutcropBuilder::settle_errors() {
  std::vector<double> borders_m;
  const std::uint32_t here = out_->first_tile_.back();
  const std::uint32_t below = here - static_cast<std::uint32_t>(borders_below_m_.size());
  for (std::uint32_t i = here; i < out_->tiles_.size(); ++i) {
    OutcropTile& tile = out_->tiles_[i];
    const outcrop::TileDeviation& deviation = measurer_.deviations()[i - here];
    double below_m = 0.0;
    // However large its texels, nothing lies farther away than the tile reaches.
    const double texel_m = std::min(tile.texel_m, tile.bounds.diagonal_m());
    tile.error_m = tile.level == 0 ? 0.0 : std::max(deviation.surface_m, texel_m);
    for (const std::uint32_t child : tile.children) {
      tile.error_m = std::max(tile.error_m, out_->tiles_[child].error_m * error_step);
      below_m = std::max(below_m, borders_below_m_[child - below]);
    }
    tile.gap_m = border_slack * (deviation.border_m + below_m);
    tile.skirt_m = deviation.surface_m;  // until widen_skirts()
    if (tile.level > 0) tile.error_m = std::max(tile.error_m, tile.gap_m);
    borders_m.push_back(std::max(below_m, deviation.border_m));
  }
  borders_below_m_ = std::move(borders_m);
}

// A tile may meet neighbours that are coarser than itself: its skirt is deep enough for those up to two levels up.
// Their chains lie as far off as the gap, but most of that sideways: in depth no farther than both surfaces are off. A
// skirt is not so flat either that it would show through the rock beside it.
void OutcropBuilder::widen_skirts() {
  constexpr int levels_up = 2;
  constexpr double flattest = 0.25;
  constexpr double longest = 2.3;  // a strip's diagonal at a corner, at most
  std::vector<OutcropTile>& tiles = out_->tiles_;
  for (OutcropTile& tile : tiles) {  // children stand before their parents
    if (tile.parent == none) continue;
    OutcropTile& above = tiles[tile.parent];
    above.gap_m = std::max(above.gap_m, tile.gap_m);
    above.skirt_m = std::max(above.skirt_m, tile.skirt_m);
  }
  for (OutcropTile& tile : tiles) {
    const OutcropTile* above = &tile;
    for (int i = 0; i < levels_up && above->parent != none; ++i) above = &tiles[above->parent];
    const double deep_m = border_slack * (above->skirt_m + tile.skirt_m);
    tile.skirt_m = std::clamp(deep_m, flattest * above->gap_m, above->gap_m);
    tile.bounds.add(tile.bounds.min - longest * std::max(tile.gap_m, tile.skirt_m));
    tile.bounds.add(tile.bounds.max + longest * std::max(tile.gap_m, tile.skirt_m));
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

// Makes the next level, and meanwhile measures the newest one.
Status OutcropBuilder::go_up() {
  const std::vector<std::uint32_t> tile_of_cell = std::move(tile_of_cell_);
  const auto measure = [&](const Context& context) { measurer_.measure(tile_of_cell, context); };
  const bool first_measure = !ratio_is_known();
  if (first_measure) measure(context_);
  ratio_ = choose_ratio();
  const auto enough = static_cast<double>(out_->tile_bytes_);
  front_->merge(cell_bytes_, ratio_, texture_ratio_ * texture_ratio_, enough, stuck_);
  cells_below_ = std::move(cells_of_level_);
  cells_of_level_ = front_->cells();
  tile_of_cell_ = front_->cover();
  if (first_measure) {
    settle_errors();
    return simplify_once(context_);
  }
  Status status = Done{};
  parallel_both(
      context_, [&](const Context& context) { status = simplify_once(context); }, measure);
  settle_errors();
  return status;
}

// Level after level until one small tile is left.
Status OutcropBuilder::climb() {
  const Error cancelled{ErrorCode::Cancelled, "building the pyramid was cancelled", ""};
  front_.emplace(tree_);
  cells_of_level_ = front_->cells();
  tile_of_cell_ = front_->cover();
  double scale = 1.0;
  add_level(scale);
  const auto root_bytes = static_cast<double>(std::min(most_root_bytes, out_->tile_bytes_));
  while (tile_count() > 1 || (bytes_of_front() > root_bytes && !stuck_)) {
    if (out_->levels_.size() >= most_levels) break;
    if (context_.cancelled()) return cancelled;
    stuck_ = stuck_ || out_->levels_.size() + 2 >= most_levels;
    const std::uint32_t before = mesh_.triangle_count();
    if (Status status = go_up(); !status) return status;
    stuck_ = mesh_.triangle_count() >= before && texel_m_ == 0.0;  // no better level will come: merge what there is
    scale *= texture_ratio_;
    add_level(scale);
    context_.report("levels", 1.0 - 1.0 / static_cast<double>(out_->levels_.size()));
  }
  measurer_.measure(tile_of_cell_, context_);
  settle_errors();
  if (context_.cancelled()) return cancelled;
  widen_skirts();
  return Done{};
}

Result<std::shared_ptr<const OutcropPyramid>> OutcropBuilder::build() {
  if (Status status = check(mesh_, textures_, options_); !status) return status.error();
  segmentation_ = outcrop::segment_by_image(mesh_, textures_);
  std::vector<Warning> warnings;
  if (segmentation_.plain_faces > 0) {
    warnings.push_back({"a triangle's texture repeats more than four times or lies too far out, it stays plain",
                        "triangle " + std::to_string(segmentation_.first_plain), segmentation_.plain_faces});
  }
  plan_bytes();
  tree_ = outcrop::make_cells(mesh_, segmentation_, bytes_, options_.split);
  out_->surroundings_ = mesh_;
  out_->segment_of_material_ = segmentation_.segment_of_material;
  out_->image_px_ = segmentation_.image_px;
  out_->segments_ = segmentation_.segments;
  name_faces();
  segmentation_.faces.clear();
  tree_.leaf_of_face = {};
  if (Status status = climb(); !status) return status.error();
  return {std::shared_ptr<const OutcropPyramid>{std::move(out_)}, std::move(warnings)};
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

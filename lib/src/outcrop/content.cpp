// SPDX-License-Identifier: MIT
// Based on: Ao et al. 2025, section 3.4 (crop by uv extent, equation 8).
// Differs: a tile may show several pieces of an image, or of several images; each gets a rectangle of its own in the
// tile's texture. Rectangles lie on whole pixels of the level image, so tiles that meet show the same texels there.
#include <lodestone/outcrop.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/disjoint_sets.h"
#include "mesh/vertex_copy.h"
#include "outcrop/segments.h"

namespace lodestone {
namespace {

constexpr int gutter_px = 8;  // around each piece: clean down to mip level 3
constexpr std::uint32_t most_parts = 256;
constexpr double merge_waste = 1.1;  // rectangles join if that makes them no larger than so many times their sum

struct Rect {
  std::uint32_t segment = 0;
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  std::vector<std::uint32_t> parts;  // connected parts of the tile that it holds

  [[nodiscard]] double area() const { return static_cast<double>(x1 - x0) * (y1 - y0); }
};

void grow(Rect& rect, const Rect& other) {
  rect.x0 = std::min(rect.x0, other.x0);
  rect.y0 = std::min(rect.y0, other.y0);
  rect.x1 = std::max(rect.x1, other.x1);
  rect.y1 = std::max(rect.y1, other.y1);
}

double joint_area(const Rect& a, const Rect& b) {
  return static_cast<double>(std::max(a.x1, b.x1) - std::min(a.x0, b.x0)) *
         (std::max(a.y1, b.y1) - std::min(a.y0, b.y0));
}

void absorb(Rect& into, const Rect& from) {
  grow(into, from);
  into.parts.insert(into.parts.end(), from.parts.begin(), from.parts.end());
}

// So many that pairs cannot be tried: those whose middles lie in one of 16 x 16 fields become one.
void join_fields(std::vector<Rect>& rects, const glm::uvec2& image) {
  constexpr std::uint32_t fields = 16;
  std::vector<std::uint32_t> at(std::size_t{fields} * fields, none);
  std::vector<Rect> out;
  for (Rect& rect : rects) {
    const auto field = [&](std::int32_t low, std::int32_t high, std::uint32_t size) {
      return static_cast<std::uint32_t>(std::clamp((low + high) / 2.0 / size * fields, 0.0, fields - 1.0));
    };
    std::uint32_t& slot = at[field(rect.y0, rect.y1, image.y) * fields + field(rect.x0, rect.x1, image.x)];
    if (slot == none) {
      slot = static_cast<std::uint32_t>(out.size());
      out.push_back(std::move(rect));
    } else {
      absorb(out[slot], rect);
    }
  }
  rects.swap(out);
}

void join_neighbours(std::vector<Rect>& rects) {
  for (std::size_t i = 1; i < rects.size();) {
    bool joined = false;
    for (std::size_t j = 0; j < i && !joined; ++j) {
      if (joint_area(rects[i], rects[j]) > merge_waste * (rects[i].area() + rects[j].area())) continue;
      absorb(rects[j], rects[i]);
      rects.erase(rects.begin() + static_cast<std::ptrdiff_t>(i));
      // The grown one may now join with an earlier one.
      i = std::max<std::size_t>(j, 1);
      joined = true;
    }
    if (!joined) ++i;
  }
}

std::uint32_t rounded_up(std::uint32_t value, std::uint32_t step) { return (value + step - 1) / step * step; }

// Shelves, the tallest first.
void pack(const std::vector<Rect>& rects, TileTexture& texture) {
  double area = 0.0;
  std::uint32_t widest = 0;
  for (const Rect& rect : rects) {
    texture.pieces.push_back({rect.segment, rect.x0, rect.y0, 0, 0, static_cast<std::uint32_t>(rect.x1 - rect.x0),
                              static_cast<std::uint32_t>(rect.y1 - rect.y0)});
    area += rect.area();
    widest = std::max(widest, texture.pieces.back().width);
  }
  std::vector<std::uint32_t> order(rects.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return texture.pieces[a].height > texture.pieces[b].height;
  });
  const std::uint32_t limit = std::max(widest, static_cast<std::uint32_t>(std::sqrt(area) * 1.05));
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t shelf = 0;
  for (const std::uint32_t i : order) {
    TexturePiece& piece = texture.pieces[i];
    if (x > 0 && x + piece.width > limit) {
      x = 0;
      y += shelf;
      shelf = 0;
    }
    piece.to_x = x;
    piece.to_y = y;
    x += piece.width;
    shelf = std::max(shelf, piece.height);
    texture.width = std::max(texture.width, x);
  }
  texture.width = rounded_up(texture.width, 8);
  texture.height = rounded_up(y + shelf, 8);
}

// Makes room for the gutter and puts the corners on a grid, so that the first mip levels of the tile are those of the
// image, pixel by pixel. The only piece need not reach beyond the image.
void add_gutter(Rect& rect, bool alone, const glm::uvec2& image) {
  const auto stretch = [&](std::int32_t& low, std::int32_t& high, std::uint32_t size) {
    low = static_cast<std::int32_t>(std::floor((low - gutter_px) / static_cast<double>(gutter_px))) * gutter_px;
    high = static_cast<std::int32_t>(std::ceil((high + gutter_px) / static_cast<double>(gutter_px))) * gutter_px;
    if (!alone) return;
    const auto end = static_cast<std::int32_t>(rounded_up(size, gutter_px));
    low = std::clamp(low, 0, end - gutter_px);
    high = std::clamp(high, low + gutter_px, end);
  };
  stretch(rect.x0, rect.x1, image.x);
  stretch(rect.y0, rect.y1, image.y);
}

}  // namespace

// A tile while it is put together: a vertex is one of the level within one segment.
class TileDraft {
 public:
  TileDraft(const OutcropPyramid& pyramid, std::uint32_t tile)
      : pyramid_(pyramid),
        info_(pyramid.tiles_[tile]),
        level_(pyramid.meshes_[info_.level]),
        begin_(level_.first_face[tile - pyramid.first_tile_[info_.level]]),
        end_(level_.first_face[tile - pyramid.first_tile_[info_.level] + 1]) {}

  TileContent make() {
    gather_corners();
    find_places();
    find_pieces();
    return {fill_mesh(), std::move(texture_)};
  }

 private:
  void gather_corners();
  void find_places();
  [[nodiscard]] std::vector<Rect> rects_of(std::uint32_t segment, DisjointSets& parts) const;
  void find_pieces();
  [[nodiscard]] Mesh fill_mesh();
  [[nodiscard]] std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(source_.size()); }
  [[nodiscard]] bool textured(std::uint32_t segment) const { return pyramid_.segments_[segment].texture != none; }

  const OutcropPyramid& pyramid_;
  const OutcropTile& info_;
  const OutcropPyramid::LevelMesh& level_;
  FaceId begin_, end_;
  std::vector<VertexId> source_;        // per vertex: that of the level
  std::vector<std::uint32_t> segment_;  // per vertex
  std::vector<VertexId> indices_;
  std::vector<glm::dvec2> place_;     // per vertex: in pixels of its level image
  std::vector<std::uint32_t> piece_;  // per vertex; none if untextured
  TileTexture texture_;
};

void TileDraft::gather_corners() {
  std::unordered_map<std::uint64_t, VertexId> known;
  for (FaceId f = begin_; f < end_; ++f) {
    const std::uint32_t segment = pyramid_.segment_of_material_[level_.face_materials[f]];
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = level_.indices[3 * std::size_t{f} + k];
      const auto [at, is_new] = known.try_emplace(std::uint64_t{segment} << 32U | v, vertex_count());
      if (is_new) {
        source_.push_back(v);
        segment_.push_back(segment);
      }
      indices_.push_back(at->second);
    }
  }
}

void TileDraft::find_places() {
  place_.assign(vertex_count(), glm::dvec2{0.0});
  for (VertexId v = 0; v < vertex_count(); ++v) {
    const std::uint32_t s = segment_[v];
    if (!textured(s)) continue;
    const OutcropSegment& segment = pyramid_.segments_[s];
    const glm::dvec2 px = outcrop::to_pixels(level_.vertices.uvs[source_[v]], pyramid_.image_px_[s]);
    const glm::dvec2 size{segment.width_px, segment.height_px};
    place_[v] =
        (px - glm::dvec2{segment.left_px, segment.top_px}) / size * glm::dvec2{pyramid_.image_size(s, info_.level)};
  }
}

// One rectangle per connected part, joined where that wastes little.
std::vector<Rect> TileDraft::rects_of(std::uint32_t segment, DisjointSets& parts) const {
  std::vector<Rect> rects;
  std::vector<std::uint32_t> rect_of(vertex_count(), none);  // per part, at its first vertex
  for (VertexId v = 0; v < vertex_count(); ++v) {
    if (segment_[v] != segment) continue;
    const std::uint32_t part = parts.find(v);
    const glm::dvec2 low = glm::floor(place_[v]);
    const glm::dvec2 high = glm::max(glm::ceil(place_[v]), low + 1.0);
    const Rect pixel{segment,
                     static_cast<std::int32_t>(low.x),
                     static_cast<std::int32_t>(low.y),
                     static_cast<std::int32_t>(high.x),
                     static_cast<std::int32_t>(high.y),
                     {}};
    if (rect_of[part] == none) {
      rect_of[part] = static_cast<std::uint32_t>(rects.size());
      rects.push_back(pixel);
      rects.back().parts.push_back(part);
    } else {
      grow(rects[rect_of[part]], pixel);
    }
  }
  const glm::uvec2 image = pyramid_.image_size(segment, info_.level);
  if (rects.size() > most_parts) join_fields(rects, image);
  join_neighbours(rects);
  return rects;
}

void TileDraft::find_pieces() {
  texture_.level = info_.level;
  DisjointSets parts{vertex_count()};
  for (std::size_t c = 0; c < indices_.size(); c += 3) {
    parts.join(indices_[c], indices_[c + 1]);
    parts.join(indices_[c], indices_[c + 2]);
  }
  std::vector<Rect> rects;
  for (const std::uint32_t s : info_.segments) {
    if (!textured(s)) continue;
    for (Rect& rect : rects_of(s, parts)) rects.push_back(std::move(rect));
  }
  const bool alone = rects.size() == 1;
  for (Rect& rect : rects) add_gutter(rect, alone, pyramid_.image_size(rect.segment, info_.level));
  if (!rects.empty()) pack(rects, texture_);
  std::vector<std::uint32_t> piece_of_part(vertex_count(), none);
  for (std::uint32_t r = 0; r < rects.size(); ++r) {
    for (const std::uint32_t part : rects[r].parts) piece_of_part[part] = r;
  }
  for (VertexId v = 0; v < vertex_count(); ++v) piece_.push_back(piece_of_part[parts.find(v)]);
}

Mesh TileDraft::fill_mesh() {
  Mesh mesh;
  static_cast<Surroundings&>(mesh) = pyramid_.surroundings_;
  mesh.textures.clear();
  const bool any = !texture_.pieces.empty();
  if (any) mesh.textures.push_back({.name = "tile"});
  for (std::size_t m = 0; m < mesh.materials.size(); ++m) {
    const std::uint32_t s = pyramid_.segment_of_material_[m];
    mesh.materials[m].texture = any && s != none && textured(s) ? 0 : none;
  }
  mesh.vertices = gathered(level_.vertices, source_);
  mesh.vertices.uvs.assign(any ? source_.size() : 0, glm::vec2{0.0F});
  for (VertexId v = 0; any && v < vertex_count(); ++v) {
    if (piece_[v] == none) continue;
    const TexturePiece& piece = texture_.pieces[piece_[v]];
    const glm::dvec2 at = place_[v] - glm::dvec2{piece.from_x, piece.from_y} + glm::dvec2{piece.to_x, piece.to_y};
    mesh.vertices.uvs[v] = glm::vec2{at.x / texture_.width, 1.0 - at.y / texture_.height};
  }
  mesh.indices = std::move(indices_);
  mesh.face_materials.assign(level_.face_materials.begin() + begin_, level_.face_materials.begin() + end_);
  if (!level_.face_features.empty()) {
    mesh.face_features.assign(level_.face_features.begin() + begin_, level_.face_features.begin() + end_);
  }
  remove_unused(mesh);
  return mesh;
}

TileContent OutcropPyramid::content(std::uint32_t tile) const { return TileDraft{*this, tile}.make(); }

}  // namespace lodestone

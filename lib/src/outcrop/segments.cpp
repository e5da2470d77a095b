// SPDX-License-Identifier: MIT
// Based on: Ao et al. 2025, section 3.1 (one sub-model per texture image).
// Differs: textures that repeat and images with several charts are taken too; what has no texture is a segment as well.
#include "outcrop/segments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <lodestone/repair.h>

#include "base/disjoint_sets.h"
#include "mesh/vertex_copy.h"
#include "mesh/weld.h"

namespace lodestone::outcrop {
namespace {

constexpr double repeat_slack = 1e-4;  // of a texture: how far a chart may stick out without being moved
constexpr double most_repeats = 4.0;
constexpr double farthest_repeat = 1 << 10;  // where a step of floats is half a pixel of 4096

struct Extent {
  glm::dvec2 low{std::numeric_limits<double>::infinity()};
  glm::dvec2 high{-std::numeric_limits<double>::infinity()};
  void add(const glm::dvec2& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

glm::dvec2 repeats_before(const Extent& extent) { return glm::floor(extent.low + repeat_slack); }

Extent extent_of(const Mesh& mesh, FaceId f) {
  Extent extent;
  for (int k = 0; k < 3; ++k) extent.add(glm::dvec2{mesh.vertices.uvs[mesh.indices[3 * std::size_t{f} + k]]});
  return extent;
}

class Unwrapper {
 public:
  explicit Unwrapper(Mesh& mesh) : mesh_(mesh), charts_(mesh.vertex_count()), extents_(mesh.vertex_count()) {}

  void find_charts(const std::vector<FaceId>& faces) {
    for (const FaceId f : faces) {
      const VertexId* v = &mesh_.indices[3 * std::size_t{f}];
      charts_.join(v[0], v[1]);
      charts_.join(v[0], v[2]);
    }
  }
  void measure(const std::vector<FaceId>& faces) {
    for (const FaceId f : faces) {
      const Extent extent = extent_of(mesh_, f);
      Extent& chart = extents_[chart_of(f)];
      chart.add(extent.low);
      chart.add(extent.high);
    }
  }
  [[nodiscard]] std::uint32_t chart_of(FaceId f) { return charts_.find(mesh_.indices[3 * std::size_t{f}]); }

  // Faces of charts wider than the image move on their own.
  void move_faces(const std::vector<FaceId>& faces) {
    for (const FaceId f : faces) {
      if (!is_wide(extents_[chart_of(f)])) continue;
      const glm::dvec2 shift = repeats_before(extent_of(mesh_, f));
      const glm::ivec2 key{shift};
      for (int k = 0; k < 3; ++k) {
        VertexId& v = mesh_.indices[3 * std::size_t{f} + k];
        v = shifted_copy(v, key);
      }
    }
  }
  // The others as wholes.
  void move_charts(std::uint32_t vertices) {
    for (VertexId v = 0; v < vertices; ++v) {
      const Extent& chart = extents_[charts_.find(v)];
      if (!(chart.low.x <= chart.high.x) || is_wide(chart)) continue;
      mesh_.vertices.uvs[v] = glm::vec2{glm::dvec2{mesh_.vertices.uvs[v]} - repeats_before(chart)};
    }
  }

 private:
  static bool is_wide(const Extent& extent) {
    const glm::dvec2 end = extent.high - repeats_before(extent);
    return end.x > 1.0 + repeat_slack || end.y > 1.0 + repeat_slack;
  }
  VertexId shifted_copy(VertexId v, const glm::ivec2& key) {
    const auto [at, is_new] = copies_.try_emplace({v, {key.x, key.y}}, none);
    if (is_new) {
      at->second = append_vertex_copy(mesh_.vertices, v);
      mesh_.vertices.uvs[at->second] = glm::vec2{glm::dvec2{mesh_.vertices.uvs[v]} - glm::dvec2{key}};
    }
    return at->second;
  }

  Mesh& mesh_;
  DisjointSets charts_;
  std::vector<Extent> extents_;  // per chart, at its first vertex
  std::map<std::pair<VertexId, std::pair<int, int>>, VertexId> copies_;
};

// One corner far out is a damaged number, and many repeats are none that a photograph has: neither is worth more texels
// than the rest of the outcrop together.
void leave_endless_plain(Mesh& mesh, std::span<const TextureInfo> textures, Segmentation& out) {
  std::vector<bool> faces(mesh.vertices.uvs.empty() ? 0 : mesh.triangle_count());
  for (FaceId f = 0; f < faces.size(); ++f) {
    const std::uint32_t texture = mesh.materials[mesh.face_material(f)].texture;
    if (texture == none || textures[texture].width_px == 0) continue;
    const Extent extent = extent_of(mesh, f);
    const glm::dvec2 farthest = glm::max(glm::abs(extent.low), glm::abs(extent.high));
    faces[f] = glm::any(glm::greaterThan(extent.high - extent.low, glm::dvec2{most_repeats})) ||
               glm::any(glm::greaterThan(farthest, glm::dvec2{farthest_repeat}));
    if (!faces[f]) continue;
    ++out.plain_faces;
    out.first_plain = std::min(out.first_plain, f);
  }
  if (out.plain_faces == 0) return;
  leave_plain(mesh, faces);
  // The number itself would be all that the collapse sees.
  std::vector<bool> shown(mesh.vertex_count(), false);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    if (!faces[i / 3]) shown[mesh.indices[i]] = true;
  }
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    if (!shown[v]) mesh.vertices.uvs[v] = glm::vec2{0.0F};
  }
}

// Used part and texel size.
void measure(const Mesh& mesh, const std::vector<FaceId>& faces, const glm::uvec2& image_px, OutcropSegment& segment) {
  Extent used;
  double area_m2 = 0.0;
  double area_px = 0.0;
  for (const FaceId f : faces) {
    glm::dvec2 p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = to_pixels(mesh.vertices.uvs[mesh.indices[3 * std::size_t{f} + k]], image_px);
      used.add(p[k]);
    }
    area_px += area_px2(p[0], p[1], p[2]);
    area_m2 += 0.5 * glm::length(area_vector(mesh, f));
  }
  segment.texel_m = area_px > 0.0 ? std::sqrt(area_m2 / area_px) : 0.0;
  // A pixel more on every side where there is one, which is what bilinear filters reach for, and out to the grid of the
  // third mip level, so that mip levels of a part are parts of the mip levels.
  constexpr double grid = 8.0;
  const auto whole_begin = [](double low, std::uint32_t size) {
    const double first = std::floor((low - 0.5 - 1e-3) / grid) * grid;
    return static_cast<std::int32_t>(low >= -1e-3 * size ? std::max(first, 0.0) : first);
  };
  const auto whole_end = [](double high, std::uint32_t size) {
    const double last = std::ceil((high + 0.5 + 1e-3) / grid) * grid;
    return static_cast<std::int32_t>(high <= size * (1.0 + 1e-3) ? std::min<double>(last, size) : last);
  };
  segment.left_px = whole_begin(used.low.x, image_px.x);
  segment.top_px = whole_begin(used.low.y, image_px.y);
  segment.width_px = static_cast<std::uint32_t>(std::max(1, whole_end(used.high.x, image_px.x) - segment.left_px));
  segment.height_px = static_cast<std::uint32_t>(std::max(1, whole_end(used.high.y, image_px.y) - segment.top_px));
}

void list_segments(const Mesh& mesh, std::span<const TextureInfo> textures, Segmentation& out) {
  const auto usable = [&](std::uint32_t texture) {
    return texture != none && textures[texture].width_px > 0 && textures[texture].height_px > 0 &&
           !mesh.vertices.uvs.empty();
  };
  std::vector<std::uint8_t> used(mesh.textures.size() + 1, 0);
  const auto texture_of = [&](MaterialId m) {
    const std::uint32_t texture = mesh.materials[m].texture;
    return usable(texture) ? texture : static_cast<std::uint32_t>(mesh.textures.size());
  };
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) used[texture_of(mesh.face_material(f))] = 1;
  std::vector<std::uint32_t> segment_of(used.size(), none);
  for (std::uint32_t t = 0; t < used.size(); ++t) {
    if (used[t] == 0) continue;
    segment_of[t] = static_cast<std::uint32_t>(out.segments.size());
    const bool textured = t < mesh.textures.size();
    out.segments.push_back({.texture = textured ? t : none});
    out.image_px.push_back(textured ? glm::uvec2{textures[t].width_px, textures[t].height_px} : glm::uvec2{0});
  }
  for (MaterialId m = 0; m < mesh.materials.size(); ++m) out.segment_of_material.push_back(segment_of[texture_of(m)]);
  out.faces.resize(out.segments.size());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    out.faces[out.segment_of_material[mesh.face_material(f)]].push_back(f);
  }
}

}  // namespace

Segmentation segment_by_image(Mesh& mesh, std::span<const TextureInfo> textures) {
  Segmentation out;
  leave_endless_plain(mesh, textures, out);
  list_segments(mesh, textures, out);
  const std::uint32_t vertices = mesh.vertex_count();
  Unwrapper unwrapper{mesh};
  for (const auto& faces : out.faces) unwrapper.find_charts(faces);
  for (std::size_t s = 0; s < out.segments.size(); ++s) {
    if (out.segments[s].texture == none) continue;
    unwrapper.measure(out.faces[s]);
    std::vector<std::uint32_t> charts;
    for (const FaceId f : out.faces[s]) charts.push_back(unwrapper.chart_of(f));
    std::sort(charts.begin(), charts.end());
    out.segments[s].charts = static_cast<std::uint32_t>(std::unique(charts.begin(), charts.end()) - charts.begin());
  }
  for (std::size_t s = 0; s < out.segments.size(); ++s) {
    if (out.segments[s].texture != none) unwrapper.move_faces(out.faces[s]);
  }
  unwrapper.move_charts(mesh.vertices.uvs.empty() ? 0 : vertices);
  for (std::size_t s = 0; s < out.segments.size(); ++s) {
    out.segments[s].triangles = static_cast<std::uint32_t>(out.faces[s].size());
    if (out.segments[s].texture == none) continue;
    measure(mesh, out.faces[s], out.image_px[s], out.segments[s]);
  }
  return out;
}

}  // namespace lodestone::outcrop

// SPDX-License-Identifier: MIT
// Based on: quantized-mesh 1.0 (Cesium); Meyer et al. 2010, "On floating-point normal vectors" (octahedral normals).
#include <lodestone/terrain_files.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>

namespace lodestone {
namespace {

static_assert(std::endian::native == std::endian::little,
              "tiles are little-endian and written as numbers lie in memory");

class Bytes {
 public:
  template <class Number>
  void put(Number value) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof value);
  }
  void put(const glm::dvec3& p) {
    put(p.x);
    put(p.y);
    put(p.z);
  }
  void put_all(std::span<const std::uint8_t> more) { bytes_.insert(bytes_.end(), more.begin(), more.end()); }
  void align(std::size_t to) { bytes_.resize((bytes_.size() + to - 1) / to * to); }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

constexpr glm::dvec3 radii_m{6378137.0, 6378137.0, 6356752.3142451793};

// The point beyond the tile from which on, along the direction of its centre, nothing of it is hidden by the horizon;
// in units of the ellipsoid's radii. A point far out where there is none: (0, 0, 0) would hide the tile for ever.
glm::dvec3 horizon_occlusion_point(const std::vector<glm::dvec3>& places_m, const glm::dvec3& center_m) {
  constexpr double far_out = 1e6;
  const glm::dvec3 direction = glm::normalize(center_m / radii_m);
  double most = 1.0;
  for (const glm::dvec3& place_m : places_m) {
    const glm::dvec3 scaled = place_m / radii_m;
    const double squared = std::max(1.0, glm::dot(scaled, scaled));
    const glm::dvec3 towards = glm::normalize(scaled);
    const double cos_alpha = glm::dot(towards, direction), sin_alpha = glm::length(glm::cross(towards, direction));
    const double cos_beta = 1.0 / std::sqrt(squared), sin_beta = std::sqrt(squared - 1.0) * cos_beta;
    const double below = cos_alpha * cos_beta - sin_alpha * sin_beta;
    most = below > 1.0 / far_out ? std::max(most, 1.0 / below) : far_out;
    if (most >= far_out) break;
  }
  return direction * most;
}

void put_header(Bytes& out, const TerrainTile& tile) {
  const std::vector<glm::dvec3> places_m = ecef_positions_m(tile);
  Box box;
  for (const glm::dvec3& place_m : places_m) box.add(place_m);
  double radius_m = 0.0;
  for (const glm::dvec3& place_m : places_m) radius_m = std::max(radius_m, glm::distance(place_m, box.center()));
  out.put(box.center());
  out.put(static_cast<float>(tile.min_height_m));
  out.put(static_cast<float>(tile.min_height_m + quantized_max * tile.step_m));
  out.put(box.center());
  out.put(radius_m);
  out.put(horizon_occlusion_point(places_m, box.center()));
}

void put_deltas(Bytes& out, const std::vector<std::uint16_t>& values) {
  int last = 0;
  for (const std::uint16_t value : values) {
    const int delta = value - last;
    last = value;
    out.put(static_cast<std::uint16_t>(static_cast<unsigned>(delta) << 1U ^ static_cast<unsigned>(delta >> 31)));
  }
}

template <class Index>
void put_indices(Bytes& out, const TerrainTile& tile) {
  out.put(tile.triangle_count());
  std::uint32_t next = 0;  // the high-water mark: vertices come in the order of their first use
  for (const std::uint32_t vertex : tile.triangles) {
    assert(vertex <= next);
    out.put(static_cast<Index>(next - vertex));
    if (vertex == next) ++next;
  }
  for (const auto* border : {&tile.west, &tile.south, &tile.east, &tile.north}) {
    out.put(static_cast<std::uint32_t>(border->size()));
    for (const std::uint32_t vertex : *border) out.put(static_cast<Index>(vertex));
  }
}

std::uint8_t oct_byte(float value) {
  return static_cast<std::uint8_t>(std::lround((std::clamp(value, -1.0F, 1.0F) * 0.5F + 0.5F) * 255.0F));
}

void put_normals(Bytes& out, const TerrainTile& tile) {
  out.put(std::uint8_t{1});
  out.put(static_cast<std::uint32_t>(2 * tile.normals.size()));
  for (const glm::vec3& n : tile.normals) {
    const float sum = std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z);
    glm::vec2 p{n.x / sum, n.y / sum};
    if (n.z < 0.0F) {
      p = {(1.0F - std::fabs(p.y)) * std::copysign(1.0F, p.x), (1.0F - std::fabs(p.x)) * std::copysign(1.0F, p.y)};
    }
    out.put(oct_byte(p.x));
    out.put(oct_byte(p.y));
  }
}

void put_metadata(Bytes& out, std::span<const std::vector<TileRange>> available) {
  nlohmann::ordered_json zooms = nlohmann::ordered_json::array();
  for (const std::vector<TileRange>& ranges : available) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const TileRange& range : ranges) {
      list.push_back(
          {{"startX", range.start_x}, {"startY", range.start_y}, {"endX", range.end_x}, {"endY", range.end_y}});
    }
    zooms.push_back(std::move(list));
  }
  const std::string text = nlohmann::ordered_json{{"available", std::move(zooms)}}.dump();
  out.put(std::uint8_t{4});
  out.put(static_cast<std::uint32_t>(text.size() + 4));  // the length of the text stands before it
  out.put(static_cast<std::uint32_t>(text.size()));
  out.put_all({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace

std::vector<std::uint8_t> encode_quantized_mesh(const TerrainTile& tile,
                                                std::span<const std::vector<TileRange>> available) {
  Bytes out;
  put_header(out, tile);
  out.put(tile.vertex_count());
  put_deltas(out, tile.u);
  put_deltas(out, tile.v);
  put_deltas(out, tile.height);
  constexpr std::uint32_t most_short = 65536;
  if (tile.vertex_count() > most_short) {
    out.align(4);
    put_indices<std::uint32_t>(out, tile);
  } else {
    out.align(2);
    put_indices<std::uint16_t>(out, tile);
  }
  if (!tile.normals.empty()) put_normals(out, tile);
  if (!tile.water.empty()) {
    out.put(std::uint8_t{2});
    out.put(static_cast<std::uint32_t>(tile.water.size()));
    out.put_all(tile.water);
  }
  if (!available.empty()) put_metadata(out, available);
  return out.take();
}

}  // namespace lodestone

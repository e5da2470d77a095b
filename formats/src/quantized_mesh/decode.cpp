// SPDX-License-Identifier: MIT
// Trusts nothing: counts are held against the bytes that are left before anything is allocated.
#include <lodestone/terrain_files.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "quantized_mesh/gzip.h"

namespace lodestone {
namespace {

constexpr std::size_t max_tile_bytes = 64U << 20U;

class TileReader {
 public:
  explicit TileReader(std::span<const std::uint8_t> bytes) : bytes_{bytes} {}
  [[nodiscard]] Result<QuantizedMesh> read();

 private:
  template <class Number>
  [[nodiscard]] Number get() {
    Number value{};
    if (bytes_.size() - at_ < sizeof value) {
      cut_ = true;
      at_ = bytes_.size();
      return value;
    }
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  [[nodiscard]] glm::dvec3 get_point() {
    const auto x = get<double>(), y = get<double>(), z = get<double>();
    return {x, y, z};
  }
  // Whether so many elements of that size can still come.
  [[nodiscard]] bool room(std::uint64_t count, std::size_t size) {
    cut_ = cut_ || count > (bytes_.size() - at_) / size;
    return !cut_;
  }
  [[nodiscard]] Error bad(const std::string& message) const {
    return {ErrorCode::BadData, message, "byte " + std::to_string(at_)};
  }
  void align(std::size_t to) { at_ = std::min(bytes_.size(), (at_ + to - 1) / to * to); }

  [[nodiscard]] Status read_vertices();
  template <class Index>
  [[nodiscard]] Status read_indices();
  [[nodiscard]] Status read_extensions();
  [[nodiscard]] Status read_normals(std::uint32_t length);
  [[nodiscard]] Status read_metadata(std::span<const std::uint8_t> bytes);

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool cut_ = false;
  QuantizedMesh mesh_;
};

Status TileReader::read_vertices() {
  const auto count = get<std::uint32_t>();
  if (!room(count, 6)) return bad("the vertices are cut short");
  for (auto* values : {&mesh_.u, &mesh_.v, &mesh_.height}) {
    values->reserve(count);
    int value = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const int code = get<std::uint16_t>();
      value += (code >> 1) ^ -(code & 1);
      if (value < 0 || value > quantized_max) return bad("a vertex lies outside 0..32767");
      values->push_back(static_cast<std::uint16_t>(value));
    }
  }
  return Done{};
}

template <class Index>
Status TileReader::read_indices() {
  align(sizeof(Index));
  const auto triangles = get<std::uint32_t>();
  if (!room(std::uint64_t{triangles} * 3, sizeof(Index))) return bad("the triangles are cut short");
  std::uint32_t next = 0;
  for (std::uint64_t i = 0; i < std::uint64_t{triangles} * 3; ++i) {
    const std::uint32_t code = get<Index>();
    if (code > next || next - code >= mesh_.u.size()) return bad("a triangle names a vertex that is not there");
    mesh_.triangles.push_back(next - code);
    if (code == 0) ++next;
  }
  for (auto* border : {&mesh_.west, &mesh_.south, &mesh_.east, &mesh_.north}) {
    const auto count = get<std::uint32_t>();
    if (!room(count, sizeof(Index))) return bad("a border is cut short");
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t vertex = get<Index>();
      if (vertex >= mesh_.u.size()) return bad("a border names a vertex that is not there");
      border->push_back(vertex);
    }
  }
  return cut_ ? Status{bad("a border is cut short")} : Status{Done{}};
}

Status TileReader::read_normals(std::uint32_t length) {
  if (length != 2 * mesh_.u.size()) return bad("there must be two bytes a vertex for normals");
  for (std::size_t i = 0; i < mesh_.u.size(); ++i) {
    const float x = static_cast<float>(get<std::uint8_t>()) / 255.0F * 2.0F - 1.0F;
    const float y = static_cast<float>(get<std::uint8_t>()) / 255.0F * 2.0F - 1.0F;
    glm::vec3 n{x, y, 1.0F - std::fabs(x) - std::fabs(y)};
    if (n.z < 0.0F) {
      n.x = (1.0F - std::fabs(y)) * std::copysign(1.0F, x);
      n.y = (1.0F - std::fabs(x)) * std::copysign(1.0F, y);
    }
    mesh_.normals.push_back(glm::normalize(n));
  }
  return Done{};
}

Status TileReader::read_metadata(std::span<const std::uint8_t> bytes) {
  try {
    std::uint32_t length = 0;
    if (bytes.size() < sizeof length) return bad("the metadata is cut short");
    std::memcpy(&length, bytes.data(), sizeof length);
    if (length > bytes.size() - sizeof length) return bad("the metadata is cut short");
    const auto* text = reinterpret_cast<const char*>(bytes.data()) + sizeof length;
    const auto json = nlohmann::json::parse(text, text + length);
    for (const auto& zoom : json.at("available")) {
      auto& ranges = mesh_.available.emplace_back();
      for (const auto& range : zoom) {
        ranges.push_back({range.at("startX").get<std::uint32_t>(), range.at("startY").get<std::uint32_t>(),
                          range.at("endX").get<std::uint32_t>(), range.at("endY").get<std::uint32_t>()});
      }
    }
    return Done{};
  } catch (const nlohmann::json::exception&) {
    return bad("the metadata is no list of available tiles");
  }
}

Status TileReader::read_extensions() {
  while (at_ < bytes_.size()) {
    const auto kind = get<std::uint8_t>();
    const auto length = get<std::uint32_t>();
    if (!room(length, 1)) return bad("an extension is cut short");
    const std::size_t end = at_ + length;
    Status status = Done{};
    if (kind == 1) status = read_normals(length);
    if (kind == 2) {
      constexpr std::uint32_t full = tile_intervals * tile_intervals;
      if (length != 1 && length != full) return bad("a water mask has 1 or 65536 bytes");
      mesh_.water.assign(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                         bytes_.begin() + static_cast<std::ptrdiff_t>(end));
    }
    if (kind == 4) status = read_metadata(bytes_.subspan(at_, length));
    if (!status) return status;
    at_ = end;  // unknown kinds are passed over
  }
  return Done{};
}

Result<QuantizedMesh> TileReader::read() {
  mesh_.center_m = get_point();
  mesh_.min_height_m = get<float>();
  mesh_.max_height_m = get<float>();
  mesh_.bounds.center = get_point();
  mesh_.bounds.radius_m = get<double>();
  mesh_.horizon_occlusion_point = get_point();
  if (cut_) return bad("the header is cut short");
  if (!std::isfinite(mesh_.min_height_m) || !std::isfinite(mesh_.max_height_m)) return bad("a height is not finite");
  if (Status status = read_vertices(); !status) return status.error();
  constexpr std::size_t most_short = 65536;
  Status status = mesh_.u.size() > most_short ? read_indices<std::uint32_t>() : read_indices<std::uint16_t>();
  if (!status) return status.error();
  if (status = read_extensions(); !status) return status.error();
  return std::move(mesh_);
}

}  // namespace

Result<QuantizedMesh> decode_quantized_mesh(std::span<const std::uint8_t> bytes) {
  if (!is_gzip(bytes)) return TileReader{bytes}.read();
  const auto plain = from_gzip(bytes, max_tile_bytes);
  if (!plain) return plain.error();
  return TileReader{*plain}.read();
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include "city_builder.h"

#include <lodestone/polygon.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "axes.h"

namespace lodestone::gis {
namespace {

bool finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

// Drops points that repeat their predecessor, the closing point included.
void drop_repeats(Ring& ring) {
  Ring clean;
  for (std::size_t i = 0; i < ring.points.size(); ++i) {
    if (!clean.points.empty() && clean.points.back() == ring.points[i]) continue;
    clean.points.push_back(ring.points[i]);
    if (!ring.uvs.empty()) clean.uvs.push_back(ring.uvs[i]);
  }
  while (clean.points.size() > 1 && clean.points.front() == clean.points.back()) {
    clean.points.pop_back();
    if (!clean.uvs.empty()) clean.uvs.pop_back();
  }
  ring = std::move(clean);
}

struct WedgeKey {
  std::array<std::uint32_t, 5> bits;
  friend bool operator==(const WedgeKey&, const WedgeKey&) = default;
};

struct WedgeHash {
  std::size_t operator()(const WedgeKey& key) const noexcept {
    std::uint64_t h = 0x9E3779B97F4A7C15ULL;
    for (const std::uint32_t word : key.bits) h = (h ^ word) * 0xBF58476D1CE4E5B9ULL;
    return static_cast<std::size_t>(h ^ (h >> 31));
  }
};

// Vertices with equal position and uv become one wedge.
class Wedges {
 public:
  explicit Wedges(VertexArrays& vertices) : vertices_(vertices) {}

  VertexId add(const glm::vec3& position, const glm::vec2& uv) {
    WedgeKey key{};
    const std::array<float, 5> values{position.x + 0.0F, position.y + 0.0F, position.z + 0.0F, uv.x + 0.0F,
                                      uv.y + 0.0F};
    std::memcpy(key.bits.data(), values.data(), sizeof key.bits);
    const auto [entry, fresh] = ids_.try_emplace(key, vertices_.size());
    if (fresh) {
      vertices_.positions.push_back(position);
      vertices_.uvs.push_back(uv);
    }
    return entry->second;
  }

 private:
  VertexArrays& vertices_;
  std::unordered_map<WedgeKey, VertexId, WedgeHash> ids_;
};

void add_polygon(Mesh& mesh, Wedges& wedges, const Polygon& polygon) {
  std::vector<glm::dvec3> points;
  std::vector<glm::vec2> uvs;
  std::vector<std::uint32_t> ring_ends;
  for (const Ring& ring : polygon.rings) {
    points.insert(points.end(), ring.points.begin(), ring.points.end());
    if (ring.uvs.empty()) {
      uvs.resize(points.size(), glm::vec2{0.0F});
    } else {
      uvs.insert(uvs.end(), ring.uvs.begin(), ring.uvs.end());
    }
    ring_ends.push_back(static_cast<std::uint32_t>(points.size()));
  }
  // Near the outer ring's first point the triangulation keeps the digits that UTM coordinates would cost it.
  const glm::dvec3 near = points.front();
  for (auto& p : points) p -= near;
  for (const auto& triangle : triangulate_polygon(points, ring_ends)) {
    std::array<VertexId, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t i = triangle[c];
      corners[c] = wedges.add(glm::vec3{(points[i] + near) - mesh.origin}, uvs[i]);
    }
    if (polygon.reversed) std::swap(corners[1], corners[2]);
    mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
    mesh.face_materials.push_back(polygon.material);
    mesh.face_features.push_back(polygon.feature);
  }
}

}  // namespace

FeatureId CityBuilder::add_feature(std::string id, std::string semantic_class, FeatureId parent) {
  mesh_.features.push_back({std::move(id), std::move(semantic_class), parent});
  return static_cast<FeatureId>(mesh_.features.size() - 1);
}

MaterialId CityBuilder::material(const Look& look) {
  std::string key = look.texture_uri;
  for (int c = 0; c < 4; ++c) key += '|' + std::to_string(look.color[c]);
  const auto [entry, fresh] = materials_.try_emplace(std::move(key), static_cast<MaterialId>(mesh_.materials.size()));
  if (fresh) {
    Material material{.name = look.name};
    material.base_color = look.color;
    if (!look.texture_uri.empty()) {
      material.texture = add_texture_file(mesh_, look.texture_uri, input_, options_, warnings_);
    }
    mesh_.materials.push_back(std::move(material));
  }
  return entry->second;
}

void CityBuilder::add(Polygon polygon, const std::string& where) {
  std::size_t points = 0;
  for (Ring& ring : polygon.rings) {
    if (!std::all_of(ring.points.begin(), ring.points.end(), finite)) {
      warnings_.add("a ring holds a coordinate that is not a finite number; the polygon was left out", where);
      return;
    }
    for (auto& uv : ring.uvs) {
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = glm::vec2{0.0F};
    }
    drop_repeats(ring);
    points += ring.points.size();
  }
  std::vector<Ring> rings;
  for (Ring& ring : polygon.rings) {
    if (ring.points.size() >= 3) {
      rings.push_back(std::move(ring));
      continue;
    }
    warnings_.add(rings.empty() ? "a polygon has fewer than three different points and was left out"
                                : "a hole has fewer than three different points and was left out",
                  where);
    if (rings.empty()) return;
  }
  if (rings.empty()) return;
  polygon.rings = std::move(rings);
  triangle_bound_ += points + 2 * polygon.rings.size();
  polygons_.push_back(std::move(polygon));
}

void CityBuilder::set_crs(std::string_view srs_name) {
  if (!mesh_.crs.empty()) return;
  mesh_.crs = epsg_name(srs_name);
  if (mesh_.crs == "EPSG:4326" || mesh_.crs == "EPSG:4979" || mesh_.crs == "EPSG:4258") {
    warnings_.add("the coordinates are degrees of longitude and latitude (" + mesh_.crs +
                  ") and are taken as metres; reproject the file to a metric system first");
  }
}

Result<LoadedMesh> CityBuilder::finish(std::string format, const Context& context) {
  if (polygons_.empty()) {
    return Error{ErrorCode::BadData, "holds no polygon that could be read as " + format, input_.name()};
  }
  if (full()) return too_large(input_, "triangles", triangle_bound_, options_.max_triangles);
  Box box;
  for (const Polygon& polygon : polygons_) {
    for (const Ring& ring : polygon.rings) {
      for (const auto& p : ring.points) box.add(p);
    }
  }
  const double reach = std::max(glm::length(box.min), glm::length(box.max));
  if (!(reach < 1e12)) {
    return Error{ErrorCode::BadData, "holds coordinates beyond 1e12 m; check the file's transform", input_.name()};
  }
  mesh_.origin = choose_origin(box);
  Wedges wedges{mesh_.vertices};
  for (std::size_t i = 0; i < polygons_.size(); ++i) {
    if (i % 1024 == 0) {
      if (context.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", input_.name()};
      context.report("triangulating", static_cast<double>(i) / static_cast<double>(polygons_.size()));
    }
    add_polygon(mesh_, wedges, polygons_[i]);
  }
  const auto& uvs = mesh_.vertices.uvs;
  if (std::all_of(uvs.begin(), uvs.end(), [](const glm::vec2& uv) { return uv == glm::vec2{0.0F}; })) {
    mesh_.vertices.uvs.clear();
  }
  return {to_lodestone_axes(std::move(mesh_), std::move(format), UpAxis::Z, 1.0, options_), warnings_.take()};
}

std::string epsg_name(std::string_view srs_name) {
  const std::size_t at = srs_name.find("EPSG");
  if (at == std::string_view::npos) return std::string{srs_name};
  // The code is the last run of digits before a comma or the end; versions ("6.12", "0") come before it.
  const std::string_view tail = srs_name.substr(at + 4, srs_name.substr(at).find(',') - 4);
  std::string code;
  for (const char c : tail) {
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      code += c;
    } else {
      if (c != ':' && c != '/' && c != '.') break;
      code.clear();
    }
  }
  return code.empty() ? std::string{srs_name} : "EPSG:" + code;
}

}  // namespace lodestone::gis

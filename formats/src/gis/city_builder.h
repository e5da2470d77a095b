// SPDX-License-Identifier: MIT
// Gathers the polygons of a city model, with their looks and meanings, and turns them into a Mesh. Shared by the
// CityGML and CityJSON readers, which only differ in how they find the polygons.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "reader.h"

namespace lodestone::gis {

// A ring without its closing point. `uvs` is empty or of the same size.
struct Ring {
  std::vector<glm::dvec3> points;
  std::vector<glm::vec2> uvs;
};

// First ring outside, the others holes.
struct Polygon {
  std::vector<Ring> rings;
  MaterialId material = 0;
  FeatureId feature = none;
  bool reversed = false;  // the face looks the other way
};

// What a polygon looks like; equal looks share a material.
struct Look {
  std::string name;
  glm::vec4 color{1.0F};
  std::string texture_uri;  // empty: plain colour
};

class CityBuilder {
 public:
  CityBuilder(const Input& input, const ReadOptions& options) : input_(input), options_(options) {}

  [[nodiscard]] FeatureId add_feature(std::string id, std::string semantic_class, FeatureId parent);
  [[nodiscard]] MaterialId material(const Look& look);
  // Polygons with fewer than three distinct points, or with numbers that are not finite, are dropped with a warning.
  void add(Polygon polygon, const std::string& where);
  void set_crs(std::string_view srs_name);

  [[nodiscard]] Warnings& warnings() noexcept { return warnings_; }
  [[nodiscard]] bool full() const noexcept { return triangle_bound_ > options_.max_triangles; }

  // Triangulates everything. Z up, metres. Errors: TooLarge, Cancelled, BadData if there is no polygon at all.
  [[nodiscard]] Result<LoadedMesh> finish(std::string format, const Context& context);

 private:
  const Input& input_;
  const ReadOptions& options_;
  Warnings warnings_;
  Mesh mesh_;
  std::vector<Polygon> polygons_;
  std::map<std::string, MaterialId> materials_;
  std::uint64_t triangle_bound_ = 0;
};

// "EPSG:25832" out of "urn:ogc:def:crs:EPSG::25832", "http://www.opengis.net/def/crs/EPSG/0/7415",
// "urn:ogc:def:crs,crs:EPSG:6.12:31467,crs:EPSG:6.12:5783" (the first of a compound); else the name unchanged.
[[nodiscard]] std::string epsg_name(std::string_view srs_name);

}  // namespace lodestone::gis

// SPDX-License-Identifier: MIT
#include <lodestone/generate.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <numeric>
#include <set>

#include "base/rng.h"
#include "generate/house_plan.h"

using namespace lodestone;

namespace {

constexpr Roof roofs[] = {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire};

HouseOptions small(Roof roof, std::uint32_t triangles, std::uint64_t seed = 1) {
  HouseOptions options;
  options.roof = roof;
  options.triangles = triangles;
  options.seed = seed;
  options.texture_size_px = 32;
  return options;
}

Mesh house(const HouseOptions& options) {
  Result<Mesh> result = generate_house(options);
  REQUIRE(result.ok());
  return std::move(*result);
}

bool same_geometry(const Mesh& a, const Mesh& b) {
  return a.vertices == b.vertices && a.indices == b.indices && a.face_materials == b.face_materials &&
         a.face_features == b.face_features;
}

// Only the body of a house, without the parts that are put on it.
Mesh body_of(Roof roof, std::uint32_t tier, std::uint64_t seed) {
  Mesh mesh;
  const generate::Palette palette = generate::add_palette(mesh, seed);
  const generate::HousePlan plan{roof, generate::tier(tier, seed), seed};
  const generate::House house = generate::draw_house(mesh, palette, plan, "");
  house.body.emit(mesh, generate::uv_scales(mesh));
  REQUIRE(mesh.triangle_count() == house.body.triangle_count());
  return mesh;
}

using Whole = glm::i64vec3;

Whole whole(const glm::vec3& p) { return Whole{glm::round(glm::dvec3{p} * 1024.0)}; }

std::int64_t volume(const Whole& a, const Whole& b, const Whole& c, const Whole& d) {
  const Whole x = b - a;
  const Whole y = c - a;
  const Whole z = d - a;
  return x.x * (y.y * z.z - y.z * z.y) - x.y * (y.x * z.z - y.z * z.x) + x.z * (y.x * z.y - y.y * z.x);
}

// Whether the edge passes from one side to the other through the inside of the triangle. Exact.
bool pierces(const Whole& p, const Whole& q, const std::array<Whole, 3>& t) {
  const std::int64_t above = volume(t[0], t[1], t[2], p);
  const std::int64_t below = volume(t[0], t[1], t[2], q);
  if (above == 0 || below == 0 || (above > 0) == (below > 0)) return false;
  const std::int64_t a = volume(p, q, t[0], t[1]);
  const std::int64_t b = volume(p, q, t[1], t[2]);
  const std::int64_t c = volume(p, q, t[2], t[0]);
  return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

std::uint32_t pierced_triangles(const Mesh& mesh) {
  struct Face {
    std::array<Whole, 3> corner;
    Whole low, high;
  };
  std::vector<Face> faces;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    Face face;
    for (std::size_t k = 0; k < 3; ++k) face.corner[k] = whole(mesh.vertices.positions[mesh.indices[3 * f + k]]);
    face.low = glm::min(face.corner[0], glm::min(face.corner[1], face.corner[2]));
    face.high = glm::max(face.corner[0], glm::max(face.corner[1], face.corner[2]));
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.low.x < b.low.x; });
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t j = i + 1; j < faces.size() && faces[j].low.x <= faces[i].high.x; ++j) {
      const Face& a = faces[i];
      const Face& b = faces[j];
      if (a.low.y > b.high.y || b.low.y > a.high.y || a.low.z > b.high.z || b.low.z > a.high.z) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        count += pierces(a.corner[k], a.corner[(k + 1) % 3], b.corner) ? 1U : 0U;
        count += pierces(b.corner[k], b.corner[(k + 1) % 3], a.corner) ? 1U : 0U;
      }
    }
  }
  return count;
}

double signed_volume_m3(const Mesh& mesh) {
  double sum = 0.0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const auto at = [&](std::size_t k) { return glm::dvec3{mesh.vertices.positions[mesh.indices[3 * f + k]]}; };
    sum += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
  }
  return sum;
}

std::set<std::string> classes(const Mesh& mesh) {
  std::set<std::string> found;
  for (const FeatureId f : mesh.face_features) found.insert(mesh.features[f].semantic_class);
  return found;
}

}  // namespace

TEST_CASE("houses of every roof are closed, manifold and valid at every size") {
  for (const Roof roof : roofs) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      for (const std::uint32_t triangles : {6'000U, 30'000U, 100'000U}) {
        const Mesh mesh = house(small(roof, triangles, seed));
        CAPTURE(static_cast<int>(roof), seed, triangles);
        REQUIRE(validate(mesh).ok());
        const MeshReport report = inspect(mesh);
        CHECK(report.boundary_edges == 0);
        CHECK(report.non_manifold_edges == 0);
        CHECK(report.degenerate_triangles == 0);
        CHECK(report.duplicate_triangles == 0);
        CHECK(mesh.triangle_count() == triangles);
      }
    }
  }
}

TEST_CASE("the body of a house is one closed surface that does not cut itself") {
  for (const Roof roof : roofs) {
    for (const std::uint32_t tier : {0U, 1U, 2U, 3U, 5U, 7U}) {
      const Mesh body = body_of(roof, tier, 1 + tier);
      CAPTURE(static_cast<int>(roof), tier);
      const MeshReport report = inspect(body);
      CHECK(report.components == 1);
      CHECK(report.boundary_edges == 0);
      CHECK(report.non_manifold_edges == 0);
      CHECK(pierced_triangles(body) == 0);
      CHECK(signed_volume_m3(body) > 300.0);
    }
  }
}

TEST_CASE("every corner of the body lies on the lattice and every facet has exactly its plane") {
  for (const Roof roof : roofs) {
    const Mesh body = body_of(roof, 4, 7);
    for (const glm::vec3& p : body.vertices.positions) REQUIRE(glm::dvec3{whole(p)} / 1024.0 == glm::dvec3{p});
    for (FaceId f = 0; f < body.triangle_count(); ++f) {
      // Faces of a facet share their normal bit for bit, so it is enough that each face agrees with it exactly: walls
      // (normals without z) must be upright to the last bit.
      const glm::vec3 n = body.vertices.normals[body.indices[3 * f]];
      const Whole a = whole(body.vertices.positions[body.indices[3 * f]]);
      const Whole b = whole(body.vertices.positions[body.indices[3 * f + 1]]);
      const Whole c = whole(body.vertices.positions[body.indices[3 * f + 2]]);
      const Whole exact{(b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y),
                        (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z),
                        (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)};
      for (int k = 0; k < 3; ++k) REQUIRE((exact[k] == 0) == (n[k] == 0.0F));
      REQUIRE(glm::dot(glm::normalize(glm::dvec3{exact}), glm::dvec3{n}) > 0.9999999);
    }
  }
}

TEST_CASE("the facade on the street is one exact plane and most of it is wall") {
  const Mesh mesh = house(small(Roof::Hip, 30'000));
  double area_m2 = 0.0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const Feature& feature = mesh.features[mesh.face_features[f]];
    const std::string& material = mesh.materials[mesh.face_materials[f]].name;
    const glm::vec3 n = mesh.vertices.normals[mesh.indices[3 * f]];
    if (feature.id != "wall_front" || (material != "plaster" && material != "stone") ||
        n != glm::vec3{0.0F, -1.0F, 0.0F})
      continue;
    const auto at = [&](std::size_t k) { return mesh.vertices.positions[mesh.indices[3 * f + k]]; };
    for (std::size_t k = 0; k < 3; ++k) REQUIRE(at(k).y == 0.0F);
    area_m2 += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
  }
  CHECK(area_m2 > 60.0);
}

TEST_CASE("the building of Table 1 has exactly its 499,128 triangles") {
  for (const Roof roof : roofs) CHECK(house(small(roof, 499'128)).triangle_count() == 499'128);
}

TEST_CASE("an odd or too small wish gives the next house there is") {
  CHECK(house(small(Roof::Gable, 30'001)).triangle_count() == 30'000);
  CHECK(house(small(Roof::Gable, 10)).triangle_count() < 4'500);
}

TEST_CASE("the same options give the same bytes for any number of threads, another seed another house") {
  const HouseOptions options = small(Roof::Spire, 50'000, 5);
  Context context;
  context.max_workers = 1;
  const Mesh first = generate_house(options, context).value();
  for (const unsigned workers : {2U, 8U}) {
    context.max_workers = workers;
    const Mesh again = generate_house(options, context).value();
    CHECK(same_geometry(first, again));
    for (std::size_t i = 0; i < first.textures.size(); ++i)
      CHECK(first.textures[i].image->pixels == again.textures[i].image->pixels);
  }
  CHECK_FALSE(same_geometry(first, house(small(Roof::Spire, 50'000, 6))));
}

TEST_CASE("a house knows what its faces are and what they belong to") {
  for (const Roof roof : roofs) {
    const Mesh mesh = house(small(roof, 60'000));
    const std::set<std::string> found = classes(mesh);
    for (const char* name : {"WallSurface", "RoofSurface", "GroundSurface", "Window", "Door", "BuildingInstallation"}) {
      CAPTURE(name);
      CHECK(found.count(name) == 1);
    }
    std::set<std::string> ids;
    for (const Feature& feature : mesh.features) {
      ids.insert(feature.id);
      if (feature.semantic_class == "Building") continue;
      REQUIRE(feature.parent < mesh.features.size());
      const std::string& parent = mesh.features[feature.parent].semantic_class;
      if (feature.semantic_class == "Window" || feature.semantic_class == "Door") {
        CHECK((parent == "WallSurface" || parent == "BuildingInstallation"));
      } else {
        CHECK(parent == "Building");
      }
    }
    CHECK(ids.size() == mesh.features.size());
  }
}

TEST_CASE("window panes are glass, and every material that is used has a picture or is plain on purpose") {
  const Mesh mesh = house(small(Roof::Gable, 30'000));
  bool glass = false;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const Material& material = mesh.materials[mesh.face_materials[f]];
    glass = glass || material.transparent();
    REQUIRE((material.texture != none || material.transparent()));
    if (material.transparent()) REQUIRE(mesh.features[mesh.face_features[f]].semantic_class != "WallSurface");
  }
  CHECK(glass);
  HouseOptions two = small(Roof::Gable, 30'000);
  two.textures = 2;
  CHECK(house(two).textures.size() == 2);
}

TEST_CASE("a street has houses of all roofs, a road, and exactly the wanted triangles") {
  GenerateOptions options;
  options.triangles = 300'000;
  options.texture_size_px = 32;
  const Mesh street = generate_street(options).value();
  REQUIRE(validate(street).ok());
  CHECK(street.triangle_count() == 300'000);
  const MeshReport report = inspect(street);
  CHECK(report.boundary_edges == 0);
  CHECK(report.non_manifold_edges == 0);
  std::size_t houses = 0;
  for (const Feature& feature : street.features) houses += feature.semantic_class == "Building" ? 1U : 0U;
  CHECK(houses >= 10);
  CHECK(houses <= 24);
  std::set<std::string> used;
  for (const MaterialId m : street.face_materials) used.insert(street.materials[m].name.substr(0, 5));
  for (const char* name : {"slate", "grave", "roof_", "pavin", "aspha"}) CHECK(used.count(name) == 1);
  CHECK(street.origin.x > 100'000.0);
}

TEST_CASE("options out of range and a raised cancel flag end generation with an error") {
  HouseOptions options = small(Roof::Flat, 0);
  options.texture_size_px = 8;
  CHECK(generate_house(options).error().code == ErrorCode::BadArgument);
  options = small(Roof::Flat, 200'000'000);
  CHECK(generate_house(options).error().code == ErrorCode::BadArgument);
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  CHECK(generate_house(small(Roof::Flat, 0), context).error().code == ErrorCode::Cancelled);
  CHECK(generate_street(small(Roof::Flat, 0), context).error().code == ErrorCode::Cancelled);
}

// SPDX-License-Identifier: MIT
// Faces that keep their planes while edges collapse.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include <lodestone/edge_collapse.h>
#include <lodestone/facet_shift.h>
#include <lodestone/generate.h>
#include <lodestone/metrics.h>

#include "shapes.h"

namespace lodestone {
namespace {

// The plane of a face is its material's name, which tells it in what is left of the mesh too; the last material is no
// plane.
struct Held {
  Mesh mesh;
  EdgeCollapseOptions options{.attributes = Attributes::None};
};

void make_materials(Held& held) {
  held.mesh.materials.assign(held.options.planes.size() + 1, Material{});
  for (std::size_t i = 0; i < held.mesh.materials.size(); ++i) held.mesh.materials[i].name = std::to_string(i);
  const auto free = static_cast<std::uint32_t>(held.options.planes.size());
  for (const std::uint32_t plane : held.options.face_planes)
    held.mesh.face_materials.push_back(plane == none ? free : plane);
}

// All planes of a mesh that are large enough.
Held hold_all(Mesh mesh, double least_m2 = 0.0) {
  Held held{.mesh = std::move(mesh)};
  held.mesh.face_materials.clear();
  CharacteristicSurfaces found = characteristic_surfaces(held.mesh, {.angle_rad = 1e-5, .offset_m = 1e-5});
  for (const CharacteristicSurface& s : found.surfaces) held.options.planes.push_back({s.normal, s.offset_m});
  held.options.face_planes = std::move(found.surface_of_face);
  for (std::uint32_t& s : held.options.face_planes) {
    if (s != none && found.surfaces[s].area_m2 < least_m2) s = none;
  }
  make_materials(held);
  return held;
}

struct Strayed {
  double offset_m = 0.0;  // of a corner from its face's plane
  double sine = 0.0;      // of a face that is no sliver to its plane
};

Strayed strayed(const Mesh& mesh, const std::vector<HeldPlane>& planes) {
  Strayed worst;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const auto id = static_cast<std::size_t>(std::stoul(mesh.materials[mesh.face_material(f)].name));
    if (id >= planes.size()) continue;
    const HeldPlane& plane = planes[id];
    std::array<glm::dvec3, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = glm::dvec3{mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + k]]};
      worst.offset_m = std::max(worst.offset_m, std::abs(glm::dot(plane.normal, at[k]) - plane.offset_m));
    }
    const glm::dvec3 n = glm::cross(at[1] - at[0], at[2] - at[0]);
    const double longest =
        std::max({glm::length(at[1] - at[0]), glm::length(at[2] - at[1]), glm::length(at[0] - at[2])});
    if (glm::length(n) < 1e-3 * longest) continue;
    worst.sine = std::max(worst.sine, glm::length(glm::cross(n, plane.normal)) / glm::length(n));
    CHECK(glm::dot(n, plane.normal) > 0.0);
  }
  return worst;
}

// A box with many faces to a side; `height(x, y)` is added to the points of its top.
template <class Height>
Mesh box(std::uint32_t n, Height height) {
  Mesh mesh;
  mesh.materials.emplace_back();
  std::vector<glm::vec3> points;
  const auto vertex = [&](const glm::vec3& p) {
    const auto at = std::find(points.begin(), points.end(), p);
    if (at != points.end()) return static_cast<VertexId>(at - points.begin());
    points.push_back(p);
    return static_cast<VertexId>(points.size() - 1);
  };
  for (int side = 0; side < 6; ++side) {
    const auto place = [&](std::uint32_t i, std::uint32_t j) {
      const float a = 8.0F * static_cast<float>(i) / static_cast<float>(n) - 4.0F;
      const float b = 8.0F * static_cast<float>(j) / static_cast<float>(n) - 4.0F;
      if (side == 0) return glm::vec3{a, b, 4.0F};
      if (side == 1) return glm::vec3{b, a, -4.0F};
      if (side == 2) return glm::vec3{4.0F, a, b};
      if (side == 3) return glm::vec3{-4.0F, b, a};
      return side == 4 ? glm::vec3{b, 4.0F, a} : glm::vec3{a, -4.0F, b};
    };
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = 0; j < n; ++j) {
        const std::array<VertexId, 4> v{vertex(place(i, j)), vertex(place(i + 1, j)), vertex(place(i + 1, j + 1)),
                                        vertex(place(i, j + 1))};
        mesh.indices.insert(mesh.indices.end(), {v[0], v[1], v[2], v[0], v[2], v[3]});
      }
    }
  }
  for (glm::vec3& p : points) {
    if (p.z == 4.0F && std::abs(p.x) < 4.0F && std::abs(p.y) < 4.0F) p.z += height(p.x, p.y);
  }
  mesh.vertices.positions = points;
  return mesh;
}

float bumps(float x, float y) { return 0.4F * std::sin(2.0F * x) * std::cos(3.0F * y); }

}  // namespace

TEST_CASE("a box with all planes held goes down to twelve triangles without a corner out of place") {
  for (const Placement placement :
       {Placement::Optimal, Placement::OnEdge, Placement::Midpoint, Placement::EndPoint, Placement::Subset}) {
    CAPTURE(static_cast<int>(placement));
    Held held = hold_all(box(8, [](float, float) { return 0.0F; }));
    REQUIRE(held.options.planes.size() == 6);
    held.options.placement = placement;
    held.options.target_triangles = 12;
    const auto result = simplify(held.mesh, held.options);
    REQUIRE(result.ok());
    CHECK(result->mesh.triangle_count() == 12);
    const Strayed worst = strayed(result->mesh, held.options.planes);
    CHECK(worst.offset_m < 1e-6 * bounds(held.mesh).diagonal_m());
    for (const glm::vec3& p : result->mesh.vertices.positions) {
      CHECK((std::abs(p.x) == 4.0F && std::abs(p.y) == 4.0F && std::abs(p.z) == 4.0F));
    }
  }
}

TEST_CASE("the larger planes of a house at a tenth of its triangles are where they were, and turn the same way") {
  for (const Roof roof : {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire}) {
    CAPTURE(static_cast<int>(roof));
    HouseOptions house;
    house.triangles = 6'000;
    house.pixels = Pixels::Skip;
    house.roof = roof;
    Held held = hold_all(generate_house(house).value(), 0.5);
    held.options.target_triangles = held.mesh.triangle_count() / 10;
    const auto result = simplify(held.mesh, held.options);
    REQUIRE(result.ok());
    const Strayed worst = strayed(result->mesh, held.options.planes);
    // The source's own corners lie within the tolerance that the planes were found with.
    CHECK(worst.offset_m < 1e-5 + 1e-6 * bounds(held.mesh).diagonal_m());
    CHECK(worst.sine < 0.01);
    CHECK(result->report.target_reached);
  }
}

TEST_CASE("free faces simplify beside held ones, and stay as good as without") {
  Held held = hold_all(box(24, bumps));
  // Five sides are held, the sixth is rough.
  std::vector<HeldPlane> planes;
  std::vector<std::uint32_t> of_face;
  for (const std::uint32_t s : held.options.face_planes) {
    const HeldPlane& plane = held.options.planes[s];
    const bool level = plane.normal.z > 0.1;
    const auto at = std::find_if(planes.begin(), planes.end(),
                                 [&](const HeldPlane& p) { return glm::dot(p.normal, plane.normal) > 0.999; });
    of_face.push_back(level ? none : static_cast<std::uint32_t>(at - planes.begin()));
    if (!level && at == planes.end()) planes.push_back(plane);
  }
  REQUIRE(planes.size() == 5);
  const Mesh source = held.mesh;
  held.options.target_triangles = source.triangle_count() / 10;
  held.options.planes.clear();
  held.options.face_planes.clear();
  const auto without = simplify(source, held.options);
  held.options.planes = planes;
  held.options.face_planes = of_face;
  held.mesh.face_materials.clear();
  make_materials(held);
  const auto with = simplify(held.mesh, held.options);
  REQUIRE((with.ok() && without.ok()));
  CHECK(with->report.target_reached);
  CHECK(strayed(with->mesh, planes).offset_m < 1e-6 * bounds(source).diagonal_m());
  const double rms_with_m = compare(source, with->mesh, {.samples = 20'000}).value().rms_m;
  const double rms_without_m = compare(source, without->mesh, {.samples = 20'000}).value().rms_m;
  CHECK(rms_with_m < 1.1 * rms_without_m);
}

TEST_CASE("where no face has a plane the result is that of no planes at all") {
  const Mesh mesh = test::grid(30, 30, 0.5F);
  EdgeCollapseOptions options{.target_triangles = 200};
  const Mesh without = simplify(mesh, options).value().mesh;
  options.planes = {{{0.0, 0.0, 1.0}, 0.0}};
  options.face_planes.assign(mesh.triangle_count(), none);
  options.plane_arm_m = 5.0;
  const Mesh with = simplify(mesh, options).value().mesh;
  CHECK(with.vertices.positions == without.vertices.positions);
  CHECK(with.indices == without.indices);
}

TEST_CASE("a bevel between two planes becomes the edge where they meet") {
  // A roof of two slopes whose ridge is cut off level, over a length of ten parts.
  Mesh mesh;
  mesh.materials.emplace_back();
  const std::array<glm::vec2, 4> profile{glm::vec2{-4.0F, 0.0F}, {-0.5F, 3.5F}, {0.5F, 3.5F}, {4.0F, 0.0F}};
  std::vector<std::uint32_t> of_face;
  for (std::uint32_t i = 0; i <= 10; ++i) {
    for (const glm::vec2& p : profile) mesh.vertices.positions.emplace_back(p.x, static_cast<float>(i), p.y);
  }
  for (std::uint32_t i = 0; i < 10; ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const VertexId a = 4 * i + k;
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + 5, a, a + 5, a + 4});
      of_face.insert(of_face.end(), 2, k == 0 ? 0U : k == 1 ? none : 1U);
    }
  }
  const double half = std::sqrt(0.5);
  Held held{.mesh = mesh};
  held.options.planes = {{{-half, 0.0, half}, 4.0 * half}, {{half, 0.0, half}, 4.0 * half}};
  held.options.face_planes = of_face;
  held.options.target_triangles = 4;
  make_materials(held);
  const auto result = simplify(held.mesh, held.options);
  REQUIRE(result.ok());
  CHECK(result->report.target_reached);
  CHECK(strayed(result->mesh, held.options.planes).offset_m < 1e-5);
  const auto ridge = std::count_if(result->mesh.vertices.positions.begin(), result->mesh.vertices.positions.end(),
                                   [](const glm::vec3& p) { return std::abs(p.z - 4.0F) < 1e-5F; });
  CHECK(ridge >= 2);
}

TEST_CASE("planes that are not firm turn less the longer their arm is") {
  HouseOptions house;
  house.triangles = 6'000;
  house.pixels = Pixels::Skip;
  Held held = hold_all(generate_house(house).value());
  for (HeldPlane& plane : held.options.planes) plane.firm = false;
  held.options.prune_parts = false;  // another way to be rid of faces
  held.options.target_triangles = held.mesh.triangle_count() / 30;
  const auto deviation = [&](double arm_m) {
    held.options.plane_arm_m = arm_m;
    const auto result = simplify(held.mesh, held.options);
    REQUIRE(result->report.target_reached);
    return compare(held.mesh, result->mesh, {.samples = 2'000}).value().normal_deviation_rad;
  };
  CHECK(deviation(5.0) < 0.7 * deviation(0.0));
}

TEST_CASE("a target that planes forbid is told with its reason") {
  Held held = hold_all(test::cube());
  held.options.target_triangles = 4;
  const auto result = simplify(held.mesh, held.options);
  REQUIRE(result.ok());
  CHECK_FALSE(result->report.target_reached);
  CHECK(result->report.locked_by_planes > 0.5);
  CHECK(result->report.sentence.find("by planes") != std::string::npos);
  CHECK(result->mesh.triangle_count() == 12);
}

TEST_CASE("lists of planes that do not fit the mesh are refused") {
  const Mesh mesh = test::cube();
  EdgeCollapseOptions options;
  options.face_planes.assign(3, none);
  CHECK(simplify(mesh, options).error().code == ErrorCode::BadArgument);
  options.face_planes.assign(mesh.triangle_count(), 0);
  CHECK(simplify(mesh, options).error().code == ErrorCode::BadArgument);
  options.planes = {{{0.0, 0.0, 2.0}, 0.0}};
  CHECK(simplify(mesh, options).error().code == ErrorCode::BadArgument);
  options.planes = {{{0.0, 0.0, 1.0}, std::nan("")}};
  CHECK(simplify(mesh, options).error().code == ErrorCode::BadArgument);
}

}  // namespace lodestone

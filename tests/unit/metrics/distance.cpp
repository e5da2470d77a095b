// SPDX-License-Identifier: MIT
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include <lodestone/metrics.h>

#include "base/rng.h"
#include "geometry/bvh.h"
#include "mesh/sampling.h"
#include "shapes.h"

using namespace lodestone;

namespace {

Mesh moved(Mesh mesh, const glm::vec3& by) {
  for (glm::vec3& p : mesh.vertices.positions) p += by;
  return mesh;
}

Mesh scaled(Mesh mesh, float by) {
  for (glm::vec3& p : mesh.vertices.positions) p *= by;
  return mesh;
}

Mesh tilted(Mesh mesh, double angle_rad) {
  for (glm::vec3& p : mesh.vertices.positions) {
    p = {p.x * std::cos(angle_rad) - p.z * std::sin(angle_rad), p.y,
         p.x * std::sin(angle_rad) + p.z * std::cos(angle_rad)};
  }
  return mesh;
}

}  // namespace

TEST_CASE("distance to a triangle is that to its nearest face, side or corner") {
  const glm::dvec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
  const auto d2 = [&](const glm::dvec3& p) { return squared_distance_to_triangle(p, a, b, c); };
  CHECK(d2({1, 1, 3}) == Approx(9.0));
  CHECK(d2({1, -2, 0}) == Approx(4.0));
  CHECK(d2({3, 3, 0}) == Approx(2.0));
  CHECK(d2({-3, -4, 0}) == Approx(25.0));
  CHECK(d2({7, -4, 12}) == Approx(9.0 + 16.0 + 144.0));
  CHECK(d2({2, 2, 0}) == 0.0);
  // Degenerate: a segment and a point.
  CHECK(squared_distance_to_triangle({1, 2, 0}, a, b, {2, 0, 0}) == Approx(4.0));
  CHECK(squared_distance_to_triangle({5, 0, 1}, a, b, a) == Approx(2.0));
  CHECK(squared_distance_to_triangle({1, 1, 1}, a, a, a) == Approx(3.0));
}

TEST_CASE("the tree finds what a look at every triangle finds") {
  for (const auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    const TriangleBvh tree{mesh.vertices.positions, mesh.indices};
    CHECK(tree.empty() == mesh.indices.empty());
    const Box box = bounds(mesh);
    Rng rng{11};
    std::uint32_t hint = none;
    for (int i = 0; i < 60 && !tree.empty(); ++i) {
      const glm::dvec3 p =
          box.center() + (box.size() + 0.1) * glm::dvec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
      std::vector<double> all;
      for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
        const auto at = [&](std::size_t c) { return glm::dvec3{mesh.vertices.positions[mesh.indices[3 * f + c]]}; };
        all.push_back(squared_distance_to_triangle(p, at(0), at(1), at(2)));
      }
      const auto nearest = tree.nearest(p, hint);
      hint = nearest.slot;
      CHECK(nearest.squared_distance == Approx(*std::min_element(all.begin(), all.end())).epsilon(1e-12));
      CHECK(all[nearest.face] == nearest.squared_distance);

      const double radius = 0.4 * box.diagonal_m();
      std::vector<std::uint8_t> found(all.size(), 0);
      tree.within(
          p, radius, [](FaceId f) { return f % 3 != 1; }, [&](FaceId f) { return found[f] = 1, true; });
      for (std::size_t f = 0; f < all.size(); ++f) CHECK((found[f] != 0) == (f % 3 != 1 && all[f] <= radius * radius));
      int visits = 0;
      tree.within(
          p, 10.0 * box.diagonal_m() + 10.0, [](FaceId) { return true; }, [&](FaceId) { return ++visits < 1; });
      CHECK(visits == 1);
    }
  }
}

TEST_CASE("a tree over triangles that cannot be told apart, or that shrink geometrically, stays shallow") {
  Mesh mesh = test::cube();
  mesh.indices.clear();
  for (int i = 0; i < 5000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  CHECK(TriangleBvh{mesh.vertices.positions, mesh.indices}.nearest({-1, -1, -3}).squared_distance == Approx(4.0));
  mesh.vertices.positions.clear();
  mesh.indices.clear();
  for (int i = 0; i < 3000; ++i) {
    const float x = std::ldexp(1.0F, 100 - i % 220) * (1.0F + static_cast<float>(i) * 1e-4F);
    for (int c = 0; c < 3; ++c) {
      mesh.indices.push_back(mesh.vertex_count());
      mesh.vertices.positions.emplace_back(x, c == 1 ? x : 0.0F, c == 2 ? x : 0.0F);
    }
  }
  CHECK(TriangleBvh{mesh.vertices.positions, mesh.indices}.nearest({-1, 0, 0}).squared_distance == Approx(1.0));
}

TEST_CASE("a mesh is at distance zero from itself, however it is indexed") {
  for (const auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    if (mesh.indices.empty()) {
      const auto result = compare(mesh, test::cube());
      REQUIRE_FALSE(result.ok());
      CHECK(result.error().where == "first mesh");
      continue;
    }
    const auto result = compare(mesh, test::unwelded(mesh), {.samples = 2000});
    REQUIRE(result.ok());
    CHECK(result->hausdorff_m < 1e-12 * (1.0 + result->diagonal_m));
    CHECK(result->normal_deviation_rad < 1e-6);
  }
}

TEST_CASE("parallel planes are at their offset everywhere") {
  const Mesh plane = test::grid(10, 10, 0.0F);
  const auto result = compare(plane, moved(test::grid(7, 3, 0.0F), {0, 0, 0.25F}), {.samples = 5000});
  REQUIRE(result.ok());
  for (const Distances& side : {result->a_to_b, result->b_to_a}) {
    CHECK(side.max_m == Approx(0.25));
    CHECK(side.mean_m == Approx(0.25));
    CHECK(side.rms_m == Approx(0.25));
    CHECK(side.p999_m == Approx(0.25));
  }
  CHECK(result->hausdorff_m == Approx(0.25));
  CHECK(result->diagonal_m == Approx(std::sqrt(2.0)));
  CHECK(result->normal_deviation_rad < 1e-9);
}

TEST_CASE("origins are taken into account, without loss at map coordinates") {
  Mesh a = test::grid(10, 10, 0.1F);
  Mesh b = moved(a, {-2.0F, 4.0F, 0.5F});
  a.origin = {670000.0, 5400000.0, 370.0};
  b.origin = a.origin + glm::dvec3{2.0, -4.0, -0.5};
  CHECK(compare(a, b, {.samples = 1000})->hausdorff_m < 1e-6);
  b.origin.z += 0.125;
  CHECK(compare(a, b, {.samples = 1000})->hausdorff_m == Approx(0.125).epsilon(1e-4));
}

TEST_CASE("one side only: a part is near the whole, the whole is not near the part") {
  const Mesh whole = test::grid(20, 20, 0.0F);
  Mesh part = whole;
  part.indices.resize(part.indices.size() / 2);  // the lower half, y <= 0.5; the upper vertices are unused now
  const auto result = compare(part, whole, {.samples = 100'000});
  CHECK(result->a_to_b.max_m == 0.0);
  CHECK(result->b_to_a.max_m == Approx(0.5));
  CHECK(result->b_to_a.mean_m == Approx(0.125).epsilon(0.01));
  CHECK(result->b_to_a.rms_m == Approx(std::sqrt(1.0 / 24.0)).epsilon(0.01));
  CHECK(result->b_to_a.p999_m == Approx(0.499).epsilon(0.001));
}

TEST_CASE("concentric spheres differ by their radii") {
  const Mesh inner = test::sphere(90, 180);
  const auto result = compare(inner, scaled(inner, 1.5F), {.samples = 20'000});
  CHECK(result->hausdorff_m == Approx(0.5).epsilon(2e-3));
  CHECK(result->mean_m == Approx(0.5).epsilon(2e-3));
  CHECK(result->rms_m == Approx(0.5).epsilon(2e-3));
}

TEST_CASE("normal deviation is the tilt of a plane, and zero for faces moved along the source's planes") {
  const Mesh plane = test::grid(40, 40, 0.0F);
  CHECK(normal_deviation_rad(plane, tilted(plane, 0.3)) == Approx(0.3).epsilon(1e-3));
  CHECK(normal_deviation_rad(plane, tilted(plane, -0.3)) == Approx(0.3).epsilon(1e-3));
  CHECK(normal_deviation_rad(test::cube(), scaled(test::cube(), 0.9F)) < 1e-9);
  // A chamfer on a cube's edge lies at 45 degrees to both of its planes.
  Mesh chamfer = test::cube();
  chamfer.vertices.positions = {{1.0F, -1.0F, 0.9F}, {1.0F, 1.0F, 0.9F}, {0.9F, 1.0F, 1.0F}, {0.9F, -1.0F, 1.0F}};
  chamfer.indices = {0, 1, 2, 0, 2, 3};
  CHECK(normal_deviation_rad(test::cube(), chamfer) == Approx(std::numbers::pi / 4).epsilon(1e-6));
  Mesh line = chamfer;
  line.indices = {0, 0, 1};
  CHECK(normal_deviation_rad(test::cube(), line) == 0.0);
  CHECK(normal_deviation_rad(line, test::cube()) == Approx(std::numbers::pi / 2));
}

TEST_CASE("the same figures come out for 1, 2 and 8 threads") {
  const Mesh a = test::sphere(60, 120);
  const Mesh b = test::sphere(13, 17);
  const auto with = [&](unsigned workers) {
    return compare(a, b, {.samples = 50'000}, {.max_workers = workers}).value();
  };
  const MeshDistance one = with(1);
  for (const unsigned workers : {2U, 8U}) {
    const MeshDistance other = with(workers);
    CHECK(other.hausdorff_m == one.hausdorff_m);
    CHECK(other.mean_m == one.mean_m);
    CHECK(other.rms_m == one.rms_m);
    CHECK(other.p999_m == one.p999_m);
    CHECK(other.normal_deviation_rad == one.normal_deviation_rad);
  }
}

TEST_CASE("a cancelled comparison says so") {
  const std::atomic<bool> cancel{true};
  const auto result = compare(test::cube(), test::cube(), {}, {.cancel = &cancel});
  REQUIRE_FALSE(result.ok());
  CHECK(result.error().code == ErrorCode::Cancelled);
}

TEST_CASE("meshes that cannot be compared are an error, not an infinite distance") {
  const Mesh sphere = test::sphere(8, 16);
  Mesh spoilt = sphere;
  spoilt.vertices.positions[spoilt.indices[0]].x = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(compare(spoilt, sphere));
  CHECK_FALSE(compare(sphere, Mesh{}));
  CHECK_FALSE(compare(Mesh{}, sphere));
}

TEST_CASE("samples are spread by area and lie on their faces") {
  Mesh mesh = test::cube();
  mesh.vertices.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 5}, {3, 0, 5}, {0, 1, 5}, {7, 7, 7}};
  mesh.indices = {6, 6, 6, 0, 1, 2, 0, 0, 1, 3, 4, 5, 1, 1, 1};
  const SurfaceSampler sampler{mesh};
  CHECK(sampler.area() == Approx(2.0));
  std::vector<std::uint32_t> hits(mesh.triangle_count(), 0);
  glm::dvec3 sum{0.0};
  constexpr std::uint32_t n = 40'000;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto sample = sampler.sample(i, n, 5);
    ++hits[sample.face];
    if (sample.face == 1) sum += sample.position;
    CHECK((sample.position.z == 0.0 || sample.position.z == Approx(5.0)));
  }
  CHECK(hits == std::vector<std::uint32_t>{0, n / 4, 0, 3 * n / 4, 0});
  CHECK(glm::distance(sum / (n / 4.0), glm::dvec3{1.0 / 3.0, 1.0 / 3.0, 0.0}) < 0.01);
}

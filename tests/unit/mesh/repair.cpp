// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>

#include <lodestone/formats.h>
#include <lodestone/metrics.h>
#include <lodestone/repair.h>

#include "base/rng.h"
#include "data.h"
#include "mesh/weld.h"
#include "shapes.h"

using namespace lodestone;

namespace {

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) sum += 0.5 * glm::length(area_vector(mesh, f));
  return sum;
}

double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    sum += glm::dot(area_vector(mesh, f), glm::dvec3{mesh.vertices.positions[mesh.indices[3 * f]]}) / 6.0;
  }
  return sum;
}

// A flat grid of one column left of a flat grid of `rows` rows: the left one passes by the right one's points.
Mesh t_junctions(std::uint32_t rows, float gap_m) {
  Mesh mesh = test::grid(1, 1, 0.0F);
  const Mesh right = test::grid(2, rows, 0.0F);
  const VertexId first = mesh.vertex_count();
  for (const glm::vec3& p : right.vertices.positions)
    mesh.vertices.positions.push_back(p + glm::vec3{1.0F + gap_m, 0, 0});
  mesh.vertices.uvs.insert(mesh.vertices.uvs.end(), right.vertices.uvs.begin(), right.vertices.uvs.end());
  for (const VertexId v : right.indices) mesh.indices.push_back(first + v);
  mesh.face_features.assign(mesh.triangle_count(), 1);
  mesh.face_features[0] = mesh.face_features[1] = 0;
  mesh.features = {{.id = "left"}, {.id = "right"}};
  return mesh;
}

Mesh building(const std::filesystem::path& data, const std::string& id) {
  auto read = read_mesh(data / "buildings" / id / (id + ".obj"));
  REQUIRE(read.ok());
  return std::move(read)->mesh;
}

}  // namespace

TEST_CASE("repair removes degenerate and repeated triangles and nothing else") {
  for (auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    const MeshReport before = inspect(mesh);
    const std::uint32_t triangles = mesh.triangle_count();
    const RepairReport report = repair(mesh);
    CHECK(validate(mesh).ok());
    CHECK(report.degenerate_triangles == before.degenerate_triangles);
    CHECK(mesh.triangle_count() == triangles - report.degenerate_triangles - report.duplicate_triangles);
    const MeshReport after = inspect(mesh);
    CHECK(after.degenerate_triangles == 0);
    CHECK(after.duplicate_triangles == 0);
    CHECK(after.components == before.components);
    const RepairReport again = repair(mesh);
    CHECK(again.degenerate_triangles + again.duplicate_triangles == 0);
  }
}

TEST_CASE("the back of a one-sided face is no duplicate") {
  Mesh mesh = test::tetrahedron();
  mesh.indices = {0, 1, 2, 2, 1, 0, 1, 2, 0};
  mesh.materials[0].double_sided = false;
  Mesh sheet = mesh;
  CHECK(repair(mesh).duplicate_triangles == 1);
  CHECK(mesh.indices == std::vector<VertexId>{0, 1, 2, 2, 1, 0});
  sheet.materials[0].double_sided = true;
  CHECK(repair(sheet).duplicate_triangles == 2);
}

TEST_CASE("per-face data stays with its triangle") {
  Mesh mesh = test::seamed_grid(4, 4);
  mesh.features = {{.id = "a"}, {.id = "b"}};
  mesh.face_features.assign(mesh.triangle_count(), 0);
  mesh.face_features.back() = 1;
  const MaterialId last = mesh.face_materials.back();
  mesh.indices[1] = mesh.indices[0];
  mesh.indices[10] = mesh.indices[9];
  CHECK(repair(mesh).degenerate_triangles == 2);
  REQUIRE(mesh.face_features.size() == mesh.triangle_count());
  CHECK(mesh.face_features.back() == 1);
  CHECK(mesh.face_materials.back() == last);
}

TEST_CASE("points within the weld tolerance become one, no point moves farther") {
  Mesh mesh = test::unwelded(test::sphere(20, 40));
  const Mesh before = mesh;
  Rng rng{4};
  for (glm::vec3& p : mesh.vertices.positions) {
    for (int c = 0; c < 3; ++c) p[c] += static_cast<float>(rng.uniform(-1e-4, 1e-4));
  }
  CHECK(inspect(mesh).components == mesh.triangle_count());
  const RepairReport report = repair(mesh, {.weld_tolerance_m = 5e-4});
  CHECK(report.welded_points > 0);
  CHECK(inspect(mesh).components == 1);
  CHECK(inspect(mesh).boundary_edges == 0);
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    CHECK(glm::distance(mesh.vertices.positions[v], before.vertices.positions[v]) < 5e-4F + 2e-4F);
  }
  // Far from the origin, with a tolerance below the spacing of the numbers, nothing happens and nothing overflows.
  Mesh far = test::cube();
  for (glm::vec3& p : far.vertices.positions) p = p * 1e30F;
  CHECK(repair(far, {.weld_tolerance_m = 1e-12}).welded_points == 0);
}

TEST_CASE("T-junctions are closed: the open edges left are those of the outline") {
  for (const std::uint32_t rows : {2U, 3U, 7U, 64U}) {
    Mesh mesh = t_junctions(rows, 0.0F);
    CHECK(inspect(mesh).boundary_edges == 4 + 2 * rows + 4);
    const double area_before = area(mesh);
    const RepairReport report = repair(mesh, {.t_junction_tolerance_m = 1e-5});
    CHECK(report.closed_t_junctions == rows - 1);
    CHECK(validate(mesh).ok());
    CHECK(inspect(mesh).boundary_edges == 3 + rows + 4);
    CHECK(inspect(mesh).components == 1);
    CHECK(mesh.triangle_count() == 2 + rows - 1 + 4 * rows);
    CHECK(area(mesh) == Approx(area_before));
    CHECK(inspect(mesh).degenerate_triangles == 0);
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
      CHECK(mesh.face_features[f] == (f < rows + 1 ? 0U : 1U));  // pieces stand where the cut triangle stood
      for (int c = 0; c < 3; ++c) {  // uv of the left grid equals its position, of inserted vertices too
        const VertexId v = mesh.indices[3 * f + c];
        if (mesh.face_features[f] == 0) {
          CHECK(glm::distance(mesh.vertices.uvs[v], glm::vec2{mesh.vertices.positions[v]}) < 1e-6F);
        }
      }
    }
    CHECK(repair(mesh, {.t_junction_tolerance_m = 1e-5}).closed_t_junctions == 0);
  }
}

TEST_CASE("cracks narrower than the tolerance close, wider ones stay") {
  Mesh narrow = t_junctions(5, 0.0005F);
  CHECK(repair(narrow, {.weld_tolerance_m = 0.001, .t_junction_tolerance_m = 0.001}).closed_t_junctions == 4);
  CHECK(inspect(narrow).components == 1);
  Mesh wide = t_junctions(5, 0.005F);
  CHECK(repair(wide, {.weld_tolerance_m = 0.001, .t_junction_tolerance_m = 0.001}).closed_t_junctions == 0);
  CHECK(inspect(wide).components == 2);
}

TEST_CASE("closing T-junctions leaves meshes that have none as they are") {
  for (auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    if (name == "degenerate") continue;
    const Mesh before = mesh;
    const RepairReport report =
        repair(mesh, {.remove_degenerate = false, .remove_duplicates = false, .t_junction_tolerance_m = 1e-6});
    CHECK(report.closed_t_junctions == 0);
    CHECK(mesh.vertices == before.vertices);
    CHECK(mesh.indices == before.indices);
  }
}

TEST_CASE("small holes are capped, large ones and outlines stay") {
  const auto without = [](Mesh mesh, FaceId begin, FaceId end) {
    mesh.indices.erase(mesh.indices.begin() + 3 * begin, mesh.indices.begin() + 3 * end);
    return mesh;
  };
  Mesh box = without(test::unwelded(test::cube()), 0, 2);
  Mesh kept = box;
  CHECK(repair(kept, {.fill_holes_perimeter_m = 7.9}).filled_holes == 0);
  CHECK(repair(box, {.fill_holes_perimeter_m = 8.1}).filled_holes == 1);
  CHECK(validate(box).ok());
  CHECK(box.triangle_count() == 12);
  CHECK(inspect(box).boundary_edges == 0);
  CHECK(volume(box) == Approx(8.0));
  for (FaceId f = 10; f < 12; ++f) {
    const glm::dvec3 n = glm::normalize(area_vector(box, f));
    CHECK(glm::dot(n, glm::dvec3{box.vertices.normals[box.indices[3 * f]]}) == Approx(1.0));
  }

  Mesh pierced = without(test::seamed_grid(9, 9), 80, 84);
  pierced.face_materials.resize(pierced.triangle_count());
  const double whole = area(test::seamed_grid(9, 9));
  CHECK(repair(pierced, {.fill_holes_perimeter_m = 100.0}).filled_holes == 1);  // and not the outline
  CHECK(validate(pierced).ok());
  CHECK(area(pierced) == Approx(whole).epsilon(0.01));
  for (auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    repair(mesh, {.fill_holes_perimeter_m = 1000.0});
    CHECK(validate(mesh).ok());
  }
}

TEST_CASE("orient turns closed parts outwards and open ones to their majority, normals with them") {
  Mesh ball = test::sphere(16, 24);
  const double full = volume(ball);
  Rng rng{8};
  std::uint32_t turned = 0;
  for (FaceId f = 0; f < ball.triangle_count(); ++f) {
    if (rng.unit() < 0.7) std::swap(ball.indices[3 * f], ball.indices[3 * f + 1]), ++turned;
  }
  CHECK(repair(ball, {.orient = true}).flipped_triangles == turned);
  CHECK(volume(ball) == Approx(full));

  Mesh sheet = test::grid(8, 8, 0.0F);
  for (FaceId f = 0; f < 20; ++f) std::swap(sheet.indices[3 * f], sheet.indices[3 * f + 1]);
  CHECK(repair(sheet, {.orient = true}).flipped_triangles == 20);
  for (FaceId f = 0; f < sheet.triangle_count(); ++f) CHECK(area_vector(sheet, f).z > 0.0);

  Mesh inside_out = test::unwelded(test::cube());
  for (FaceId f = 0; f < 12; ++f) std::swap(inside_out.indices[3 * f], inside_out.indices[3 * f + 1]);
  for (glm::vec3& n : inside_out.vertices.normals) n = -n;
  CHECK(repair(inside_out, {.orient = true}).flipped_triangles == 12);
  CHECK(volume(inside_out) == Approx(8.0));
  for (FaceId f = 0; f < 12; ++f) {
    const glm::dvec3 n = glm::normalize(area_vector(inside_out, f));
    CHECK(glm::dot(n, glm::dvec3{inside_out.vertices.normals[inside_out.indices[3 * f]]}) == Approx(1.0));
  }
}

TEST_CASE("orient ends on a Moebius strip and on every family") {
  Mesh strip = test::tetrahedron();
  strip.vertices.positions.clear();
  strip.indices.clear();
  constexpr std::uint32_t n = 30;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2.0 * 3.141592653589793 * i / n;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1.0 + s * std::cos(0.5 * a);
      strip.vertices.positions.emplace_back(r * std::cos(a), r * std::sin(a), s * std::sin(0.5 * a));
    }
    const VertexId p = 2 * i;
    const VertexId q = i + 1 == n ? 1 : p + 2;
    const VertexId r = i + 1 == n ? 0 : p + 3;
    strip.indices.insert(strip.indices.end(), {p, q, r, p, r, p + 1});
  }
  CHECK(inspect(strip).boundary_edges == 2 * n);
  repair(strip, {.orient = true});
  CHECK(strip.triangle_count() == 2 * n);
  for (auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    const double before = area(mesh);
    repair(mesh, {.remove_duplicates = false, .orient = true});
    CHECK(validate(mesh).ok());
    CHECK(area(mesh) == Approx(before));
  }
}

TEST_CASE("a real building loses most of its open edges and keeps its shape") {
  LODESTONE_REQUIRE_DATA(data);
  for (const char* id : {"4018215", "4018267", "4018210"}) {
    INFO(id);
    const Mesh source = building(data, id);
    Mesh mesh = source;
    const MeshReport before = inspect(mesh);
    const RepairReport report = repair(mesh, {.weld_tolerance_m = 0.0005, .t_junction_tolerance_m = 0.001});
    const MeshReport after = inspect(mesh);
    CAPTURE(before.boundary_edges, after.boundary_edges, before.components, after.components, report.welded_points,
            report.closed_t_junctions, report.duplicate_triangles, source.triangle_count(), mesh.triangle_count());
    CHECK(validate(mesh).ok());
    CHECK(report.closed_t_junctions > 80);
    CHECK(after.boundary_edges < 4 * before.boundary_edges / 5);
    CHECK(after.components <= before.components);
    const auto distance = compare(source, mesh, {.samples = 50'000});
    REQUIRE(distance.ok());
    CHECK(distance->hausdorff_m < 0.002);
  }
}

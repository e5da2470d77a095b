// SPDX-License-Identifier: MIT
#include <lodestone/edge_collapse.h>
#include <lodestone/facet_shift.h>
#include <rapidcheck.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "shapes.h"

namespace lodestone {
namespace {

// Closed, open, non-manifold, unwelded and seamed families, some with what files bring along: faces twice or turned
// round, faces without area, points that fall together.
Mesh any_mesh() {
  auto families = test::mesh_families();
  Mesh mesh = std::move(families[*rc::gen::inRange<std::size_t>(0, families.size())].mesh);
  const auto any_face = [&] { return *rc::gen::inRange(0U, mesh.triangle_count()); };
  const auto any_vertex = [&] { return *rc::gen::inRange(0U, mesh.vertex_count()); };
  const auto add_face = [&](VertexId a, VertexId b, VertexId c, FaceId like) {
    mesh.indices.insert(mesh.indices.end(), {a, b, c});
    if (!mesh.face_materials.empty()) mesh.face_materials.push_back(mesh.face_materials[like]);
    if (!mesh.face_features.empty()) mesh.face_features.push_back(mesh.face_features[like]);
  };
  for (int i = *rc::gen::inRange(0, 6); i > 0; --i) {
    const FaceId f = any_face();
    const VertexId a = mesh.indices[3 * f];
    const VertexId b = mesh.indices[3 * f + 1];
    const VertexId c = mesh.indices[3 * f + 2];
    switch (*rc::gen::inRange(0, 5)) {
      case 0:
        add_face(a, b, c, f);
        break;
      case 1:
        add_face(c, b, a, f);
        break;
      case 2:
        add_face(a, a, b, f);
        break;
      case 3:
        add_face(a, b, any_vertex(), f);
        break;
      default: {
        const glm::vec3 at{mesh.vertices.positions[any_vertex()]};
        mesh.vertices.positions[any_vertex()] = at;
      }
    }
  }
  return mesh;
}

EdgeCollapseOptions any_options(const Mesh& mesh) {
  EdgeCollapseOptions options;
  options.placement = static_cast<Placement>(*rc::gen::inRange(0, 5));
  options.attributes = *rc::gen::arbitrary<bool>() ? Attributes::All : Attributes::None;
  options.borders = *rc::gen::inRange(0, 4) == 0 ? Borders::Lock : Borders::Simplify;
  options.prune_parts = *rc::gen::arbitrary<bool>();
  options.target_triangles = *rc::gen::inRange(0U, mesh.triangle_count() + 1);
  if (*rc::gen::inRange(0, 4) == 0) options.sharp_edge_rad = 0.5;
  if (*rc::gen::inRange(0, 4) == 0) {
    options.frozen.assign(mesh.vertex_count(), 0);
    for (auto& f : options.frozen) f = *rc::gen::inRange(0, 8) == 0 ? 1 : 0;
  }
  if (*rc::gen::inRange(0, 3) == 0) {
    CharacteristicSurfaces found = characteristic_surfaces(mesh);
    for (const CharacteristicSurface& s : found.surfaces)
      options.planes.push_back({s.normal, s.offset_m, *rc::gen::arbitrary<bool>()});
    options.face_planes = std::move(found.surface_of_face);
    options.plane_arm_m = *rc::gen::arbitrary<bool>() ? 2.0 : 0.0;
  }
  return options;
}

}  // namespace

TEST_CASE("whatever mesh and options: the model is exact and monotone, and a target that was missed has a reason") {
  CHECK(rc::check([] {
    const Mesh mesh = any_mesh();
    const EdgeCollapseOptions options = any_options(mesh);
    const auto built = build_by_edge_collapse(mesh, options);
    RC_ASSERT(built.ok());
    RC_ASSERT(validate(*built->model).fault == "");
    RC_ASSERT(compare_with_source(*built->model, mesh) == "");
    const bool reached = built->model->info(0).triangles <= options.target_triangles;
    RC_ASSERT(built->report.target_reached == reached);
    RC_ASSERT(built->report.sentence.empty() == reached);
  }));
}

TEST_CASE("whatever mesh: frozen vertices stay in place at every level") {
  CHECK(rc::check([] {
    const Mesh mesh = any_mesh();
    EdgeCollapseOptions options = any_options(mesh);
    options.frozen.assign(mesh.vertex_count(), 0);
    const std::size_t face = 3 * *rc::gen::inRange<std::size_t>(0, mesh.triangle_count());
    const auto at = [&](std::size_t k) { return mesh.vertices.positions[mesh.indices[face + k]]; };
    RC_PRE(at(0) != at(1) && at(1) != at(2) && at(2) != at(0));  // faces without area go first of all
    const VertexId frozen = mesh.indices[face];
    options.frozen[frozen] = 1;
    options.target_triangles = 0;
    const auto result = simplify(mesh, options);
    RC_ASSERT(result.ok());
    const auto& kept = result->mesh.vertices.positions;
    RC_ASSERT(std::find(kept.begin(), kept.end(), mesh.vertices.positions[frozen]) != kept.end());
  }));
}

}  // namespace lodestone

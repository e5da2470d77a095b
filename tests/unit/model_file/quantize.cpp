// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "data.h"
#include "model_file/reorder.h"
#include "shapes.h"
#include "support.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

// Faces as sorted lists of corner values, so that meshes can be compared that number their vertices differently.
std::vector<std::array<float, 9>> faces_of(const Mesh& mesh) {
  std::vector<std::array<float, 9>> faces(mesh.triangle_count());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    std::array<std::array<float, 3>, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::vec3& p = mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + c]];
      corners[c] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    for (std::size_t i = 0; i < 9; ++i) faces[f][i] = corners[i / 3][i % 3];
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

}  // namespace

TEST_CASE("reordering keeps the finest level, the base and the levels between its windows") {
  for (const NamedMesh& family : mesh_families()) {
    for (const Placement placement : {Placement::Subset, Placement::Optimal}) {
      INFO(family.name << ", placement " << static_cast<int>(placement));
      const Model model = build(family.mesh, placement);
      auto result = ProgressiveModel::from_data(model_file::reorder(model->data()));
      INFO((result ? std::string{} : to_line(result.error())));
      REQUIRE(result.ok());
      const auto& reordered = *result.value();
      REQUIRE(reordered.record_count() == model->record_count());
      for (const ErrorStep& step : reordered.data().errors) {
        CHECK(faces_of(reordered.extract(step.level)) == faces_of(model->extract(step.level)));
        CHECK(reordered.error_m(step.level) == model->error_m(step.level));
      }
      CHECK(faces_of(reordered.extract(reordered.record_count())) == faces_of(model->extract(model->record_count())));
      for (Level level = 0; level <= model->record_count(); level += 7) {
        CHECK(reordered.error_m(level) >= model->error_m(level));
        CHECK(reordered.error_m(level) * model_file::window_error_ratio <= model->error_m(level) * 1.0001);
      }
    }
  }
}

TEST_CASE("a quantised model has every vertex within half a step and says so in its errors") {
  const auto folder = scratch_folder("lode-quantize");
  for (const NamedMesh& family : mesh_families()) {
    INFO(family.name);
    const Model model = build(family.mesh, Placement::Optimal);
    for (const std::uint32_t bits : {8U, 14U}) {
      (void)written(*model, folder / "q.lode", {.quantize_bits = bits});
      const auto back = read_model(folder / "q.lode");
      INFO((back ? std::string{} : to_line(back.error())));
      REQUIRE(back.ok());
      const Mesh fine = back.value()->extract(back.value()->record_count());
      CHECK(fine.triangle_count() == family.mesh.triangle_count());
      const glm::dvec3 size = model->bounds().size();
      const double step_m =
          model->bounds().empty() ? 1.0 : std::max({size.x, size.y, size.z}) / static_cast<double>((1U << bits) - 1);
      double worst_m = 0.0;
      for (const glm::vec3& p : fine.vertices.positions) {
        double nearest_m = std::numeric_limits<double>::infinity();
        for (const glm::vec3& q : family.mesh.vertices.positions) {
          nearest_m = std::min(nearest_m, glm::length(glm::dvec3{p} - glm::dvec3{q}));
        }
        worst_m = std::max(worst_m, nearest_m);
      }
      CHECK(worst_m <= step_m * std::sqrt(3.0) / 2.0 * 1.001);
      CHECK(back.value()->error_m(back.value()->record_count()) >= worst_m * 0.999);
      CHECK(validate(*back.value()).fault.empty());
    }
  }
}

TEST_CASE("quantising halves a file of a smooth surface at least, attributes included") {
  const auto folder = scratch_folder("lode-quantize-size");
  const Model model = build(sphere(90, 120), Placement::Subset);
  const Bytes lossless = written(*model, folder / "a.lode");
  const Bytes quantised = written(*model, folder / "b.lode", {.quantize_bits = 12});
  CHECK(quantised.size() * 2 < lossless.size());
  const Mesh fine = read_model(folder / "b.lode").value()->extract(model->record_count());
  for (VertexId v = 0; v < fine.vertex_count(); ++v) {
    // A unit sphere: normals are positions.
    CHECK(glm::length(fine.vertices.normals[v] - fine.vertices.positions[v]) < 2e-3F);
  }
}

TEST_CASE("more bits than there are is a wrong argument") {
  const auto result = write_model(*rich_model(), scratch_folder("lode-bits") / "a.lode", {.quantize_bits = 21});
  REQUIRE_FALSE(result.ok());
  CHECK(result.error().code == ErrorCode::BadArgument);
}

// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <map>

#include "producer.h"
#include "shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

const std::vector<ProducerOptions>& mixes() {
  static const std::vector<ProducerOptions> all{
      {.seed = 1},
      {.seed = 2, .keep_ratio = 0.0},
      {.seed = 3, .move_share = 0.5},
      {.seed = 4, .keep_ratio = 0.0, .move_share = 0.3, .vanish_share = 0.2, .nudge_share = 0.1},
  };
  return all;
}

// A mesh with every attribute, several materials and features, and a border.
Mesh rich() {
  Mesh mesh = seamed_grid(20, 18);
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    mesh.vertices.normals.push_back(glm::normalize(glm::vec3{0.1F * static_cast<float>(v % 7), 0.2F, 1.0F}));
    mesh.vertices.colors.emplace_back(v % 256, v / 256, 7, 255);
  }
  mesh.features = {Feature{.id = "bed"}, Feature{.id = "joint"}};
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) mesh.face_features.push_back(f % 3 == 2 ? none : f % 3);
  return mesh;
}

}  // namespace

TEST_CASE("A recorded model validates and its finest level is the source, on every family of meshes") {
  auto families = mesh_families();
  families.push_back({"rich", rich()});
  for (const NamedMesh& family : families) {
    for (const ProducerOptions& mix : mixes()) {
      INFO(family.name << ", seed " << mix.seed);
      const auto model = random_model(family.mesh, mix);
      const ModelReport report = validate(*model);
      CHECK(report.fault == "");
      CHECK(report.exact);
      CHECK(report.monotone);
      CHECK(report.in_use_consistent);
      CHECK(compare_with_source(*model, family.mesh) == "");
    }
  }
}

TEST_CASE("compare_with_source tells a changed triangle, attribute, material or feature") {
  const Mesh source = rich();
  const auto model = random_model(source, {.seed = 5});
  REQUIRE(compare_with_source(*model, source) == "");
  Mesh other = source;
  std::swap(other.indices[3], other.indices[4]);
  CHECK(compare_with_source(*model, other) != "");
  other = source;
  std::rotate(other.indices.begin() + 3, other.indices.begin() + 4, other.indices.begin() + 6);
  CHECK(compare_with_source(*model, other) == "");
  other = source;
  other.vertices.uvs[7].x = std::nextafter(other.vertices.uvs[7].x, 9.0F);
  CHECK(compare_with_source(*model, other) != "");
  other = source;
  other.face_materials[9] ^= 1U;
  CHECK(compare_with_source(*model, other) != "");
  other = source;
  other.face_features[9] = none;
  other.face_features[11] = 0;
  CHECK(compare_with_source(*model, other) != "");
  other = source;
  other.indices.resize(other.indices.size() - 3);
  other.face_materials.pop_back();
  other.face_features.pop_back();
  CHECK(compare_with_source(*model, other) != "");
}

TEST_CASE("Edge collapses without seams are stored as fans") {
  const auto model = random_model(sphere(24, 48), {.seed = 6, .keep_ratio = 0.5});
  std::size_t fans = 0;
  for (const std::uint8_t shape : model->data().shapes) fans += (shape >> RecordShape::kind_shift & 3) != 3 ? 1 : 0;
  CHECK(static_cast<double>(fans) > 0.95 * model->record_count());
}

TEST_CASE("Levels are found by triangles and by error") {
  const auto model = random_model(rich(), {.seed = 7, .keep_ratio = 0.0, .vanish_share = 0.1});
  REQUIRE(model->record_count() > 256);
  for (Level level = 0; level <= model->record_count(); ++level) {
    const LevelInfo info = model->info(level);
    const Level found = model->level_of_triangles(info.triangles);
    CHECK(found >= level);
    CHECK(model->info(found).triangles == info.triangles);
    if (found < model->record_count()) CHECK(model->info(found + 1).triangles > info.triangles);
    const Level by_error = model->level_of_error(info.error_m);
    CHECK(by_error <= level);
    CHECK(model->error_m(by_error) <= info.error_m);
    if (by_error > 0) CHECK(model->error_m(by_error - 1) > info.error_m);
  }
  CHECK(model->info(model->record_count()).error_m == 0.0);
  CHECK(model->level_of_triangles(0) == 0);
  CHECK(model->level_of_error(0.0) <= model->record_count());
}

TEST_CASE("Errors become steps that never fall below what the producer said, nor 0.2 % above") {
  const Mesh source = grid(30, 30);
  std::vector<float> errors;
  progressive::EditLog log{5};
  for (std::uint32_t i = 0; i < 500; ++i) {
    errors.push_back(i < 10 ? 0.0F : 0.001F * static_cast<float>(i * i % 977));
    log.begin(errors.back());
    log.remove_face(i);
    log.end();
  }
  const auto model = ProgressiveModel::from_data(progressive::record(source, std::move(log), "test"));
  REQUIRE(model);
  float worst = 0.0F;
  for (std::uint32_t i = 0; i < errors.size(); ++i) {
    worst = std::max(worst, errors[i]);
    const double told = (*model)->error_m(static_cast<Level>(errors.size()) - 1 - i);
    CHECK(told >= worst);
    CHECK(told <= 1.002 * worst);
  }
}

TEST_CASE("A named level is found, an unknown name lists those there are") {
  auto data = progressive::record(grid(4, 4), random_log(grid(4, 4), {}), "test");
  data.named_levels = {{"lod1", 0}, {"lod3", static_cast<Level>(data.shapes.size())}};
  const auto model = ProgressiveModel::from_data(std::move(data));
  REQUIRE(model);
  CHECK((*model)->level_of_name("lod3").value() == (*model)->record_count());
  const auto unknown = (*model)->level_of_name("lod9");
  REQUIRE_FALSE(unknown);
  CHECK(unknown.error().message.find("lod1, lod3") != std::string::npos);
}

TEST_CASE("A chain or cycle of merge targets in one record gets slots in which each merges into a lower one") {
  Mesh source = grid(3, 1);
  progressive::EditLog log{5};
  log.begin(1.0F);
  for (FaceId f = 0; f < source.triangle_count(); ++f) log.remove_face(f);
  log.remove_vertex(5, 4);
  log.remove_vertex(4, 3);
  log.remove_vertex(3, 3);
  log.remove_vertex(0, 1);
  log.remove_vertex(1, 2);
  log.remove_vertex(2, 0);
  log.end();
  const auto model = ProgressiveModel::from_data(progressive::record(source, std::move(log), "test"));
  REQUIRE(model);
  CHECK(validate(**model).fault == "");
  CHECK(compare_with_source(**model, source) == "");
  CHECK((*model)->info(0).vertices == source.vertex_count() - 6);
}

// SPDX-License-Identifier: MIT
#include <cstdlib>
#include <map>
#include <set>
#include <tuple>

#include "data.h"
#include "reading.h"
#include "shapes.h"

using namespace lodestone;

namespace {

// A triangle as the file formats carry it: its corners' values and its material's name.
using Corner = std::tuple<float, float, float, float, float, float, float, float>;
using Face = std::pair<std::string, std::array<Corner, 3>>;

std::multiset<Face> faces_of(const Mesh& mesh) {
  std::multiset<Face> faces;
  const VertexArrays& v = mesh.vertices;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    Face face{mesh.materials[mesh.face_material(f)].name, {}};
    for (std::size_t c = 0; c < 3; ++c) {
      const VertexId i = mesh.indices[3 * f + c];
      const glm::vec3 n = v.normals.empty() ? glm::vec3{0.0F} : v.normals[i];
      const glm::vec2 uv = v.uvs.empty() ? glm::vec2{0.0F} : v.uvs[i];
      face.second[c] = {v.positions[i].x, v.positions[i].y, v.positions[i].z, n.x, n.y, n.z, uv.x, uv.y};
    }
    faces.insert(std::move(face));
  }
  return faces;
}

Mesh decorated() {
  Mesh mesh = test::seamed_grid(12, 9);
  compute_normals(mesh);
  mesh.origin = {678116.0, 5403773.5, 416.25};
  mesh.crs = "EPSG:25832";
  mesh.materials[0].base_color = {0.25F, 0.5F, 1.0F, 0.5F};
  mesh.materials[1].texture = 0;
  Texture texture;
  texture.name = "odd name\\with/slashes.jpg";
  texture.image = std::make_shared<const Image>(Image{2, 2, 3, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}});
  mesh.textures.push_back(texture);
  mesh.face_features.assign(mesh.triangle_count(), none);
  for (const char* id : {"wall", "roof with blanks"}) {
    Feature feature;
    feature.id = id;
    mesh.features.push_back(feature);
  }
  for (FaceId f = 10; f < 60; ++f) mesh.face_features[f] = f % 2;
  return mesh;
}

std::size_t entries(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::recursive_directory_iterator{folder}, {}));
}

}  // namespace

TEST_CASE("GLB keeps which feature every face belongs to, what it is and what it belongs to") {
  Mesh mesh = decorated();
  mesh.features = {{"house", "Building", none}, {"unused", "Window", 0}, {"wall", "WallSurface", 0}, {"", "Door", 2}};
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) mesh.face_features[f] = f % 3 == 0 ? none : 1 + f % 3;
  const auto file = test::scratch_folder("glb_features") / "mesh.glb";
  REQUIRE(write_mesh(mesh, file).ok());
  const auto read = read_mesh(file);
  REQUIRE(read.ok());
  CHECK(read.warnings().empty());
  CHECK(read->mesh.vertex_count() == mesh.vertex_count());
  REQUIRE(read->mesh.features.size() == 3);  // not the one that nothing belongs to
  CHECK(read->mesh.features[0].id == "house");
  CHECK(read->mesh.features[0].parent == none);
  CHECK(read->mesh.features[1].semantic_class == "WallSurface");
  CHECK(read->mesh.features[2].parent == 1);
  // Faces come back in the order of their materials; what a face is, by its corners.
  const auto kinds_of = [](const Mesh& m) {
    std::multiset<std::pair<std::string, std::vector<float>>> kinds;
    for (FaceId f = 0; f < m.triangle_count(); ++f) {
      std::vector<float> corners;
      for (std::size_t c = 0; c < 3; ++c) {
        const glm::vec3 p = m.vertices.positions[m.indices[3 * f + c]];
        corners.insert(corners.end(), {p.x, p.y, p.z});
      }
      const FeatureId feature = m.face_feature(f);
      kinds.insert({feature == none ? "" : m.features[feature].id + "/" + m.features[feature].semantic_class, corners});
    }
    return kinds;
  };
  CHECK(kinds_of(read->mesh) == kinds_of(mesh));
}

TEST_CASE("every family of meshes comes back from OBJ and PLY bit for bit") {
  const auto folder = test::scratch_folder("round_trip");
  for (const auto& [name, mesh] : test::mesh_families()) {
    if (mesh.triangle_count() == 0) continue;
    for (const char* extension : {".obj", ".ply"}) {
      CAPTURE(name, extension);
      const auto file = folder / (std::string{"mesh"} + extension);
      REQUIRE(write_mesh(mesh, file).ok());
      const auto read = read_mesh(file);
      REQUIRE(read.ok());
      Mesh expected = mesh;
      if (std::string_view{extension} == ".ply") {  // has no names of materials
        expected.face_materials.clear();
        expected.materials.resize(1);
        expected.materials[0].name = "default";
      }
      CHECK(faces_of(read->mesh) == faces_of(expected));
    }
  }
}

TEST_CASE("OBJ keeps place, materials, textures and groups") {
  const auto folder = test::scratch_folder("obj_writer");
  const Mesh mesh = decorated();
  const auto written = write_mesh(mesh, folder / "a.obj");
  REQUIRE(written.ok());
  CHECK(written.warnings().empty());
  ReadOptions options;
  options.textures = LoadTextures::Decoded;
  const auto read = read_mesh(folder / "a.obj", options);
  REQUIRE(read.ok());
  CHECK(read.warnings().empty());
  CHECK(read->mesh.origin == mesh.origin);
  CHECK(read->mesh.crs == mesh.crs);
  REQUIRE(read->mesh.materials.size() == 2);
  std::map<std::string, Material> materials;
  for (const auto& material : read->mesh.materials) materials[material.name] = material;
  CHECK(materials["stone"].base_color == mesh.materials[0].base_color);
  CHECK(materials["lichen"].texture == 0);
  REQUIRE(read->mesh.textures.size() == 1);
  CHECK(read->mesh.textures[0].image->pixels == mesh.textures[0].image->pixels);
  std::map<std::string, int> groups;
  for (FaceId f = 0; f < read->mesh.triangle_count(); ++f) {
    const FeatureId feature = read->mesh.face_feature(f);
    ++groups[feature == none ? "" : read->mesh.features[feature].id];
  }
  CHECK(groups["wall"] == 25);
  CHECK(groups["roof with blanks"] == 25);
  // At 5,403 km a double has steps of a nanometre; finer parts of a float cannot be kept.
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(glm::length(test::corner(read->mesh, f, c) - test::corner(mesh, f, c)) < 2e-9);
    }
  }
}

TEST_CASE("PLY keeps place and texture numbers") {
  const auto folder = test::scratch_folder("ply_writer");
  const Mesh mesh = decorated();
  REQUIRE(write_mesh(mesh, folder / "a.ply").ok());
  const auto read = read_mesh(folder / "a.ply");
  REQUIRE(read.ok());
  CHECK(read->mesh.origin == mesh.origin);
  CHECK(read->mesh.crs == mesh.crs);
  REQUIRE(read->mesh.triangle_count() == mesh.triangle_count());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const bool textured = mesh.materials[mesh.face_material(f)].texture != none;
    CHECK((read->mesh.materials[read->mesh.face_material(f)].texture != none) == textured);
  }
}

TEST_CASE("colours survive OBJ and PLY") {
  const auto folder = test::scratch_folder("colors");
  Mesh mesh = test::grid(15, 16);
  for (std::uint32_t i = 0; i < mesh.vertex_count(); ++i) {
    mesh.vertices.colors.emplace_back(i % 256, 255 - i % 256, (7 * i) % 256, 255);
  }
  for (const char* name : {"a.obj", "a.ply"}) {
    REQUIRE(write_mesh(mesh, folder / name).ok());
    const auto read = read_mesh(folder / name);
    REQUIRE(read.ok());
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      REQUIRE(read->mesh.vertices.colors[read->mesh.indices[i]] == mesh.vertices.colors[mesh.indices[i]]);
    }
  }
}

TEST_CASE("a cancelled or failed write leaves nothing behind, an old file stays") {
  const auto folder = test::scratch_folder("cancelled_write");
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  for (const char* name : {"a.obj", "a.ply", "a.glb"}) {
    CAPTURE(name);
    CHECK(write_mesh(decorated(), folder / name, context).error().code == ErrorCode::Cancelled);
    CHECK(entries(folder) == 0);
  }
  test::write_text(folder / "old.ply", "old");
  CHECK_FALSE(write_mesh(decorated(), folder / "old.ply", context).ok());
  CHECK(entries(folder) == 1);
  CHECK(std::filesystem::file_size(folder / "old.ply") == 3);
  CHECK(write_mesh(decorated(), folder / "no" / "where.obj").error().code == ErrorCode::Unreadable);
  CHECK(write_mesh(decorated(), folder / "a.step").error().code == ErrorCode::BadArgument);
}

TEST_CASE("a mesh that is not valid is not written") {
  const auto folder = test::scratch_folder("invalid_mesh");
  Mesh mesh = test::cube();
  mesh.indices[5] = 99;
  CHECK(write_mesh(mesh, folder / "a.obj").error().code == ErrorCode::BadArgument);
  CHECK(entries(folder) == 0);
}

// SPDX-License-Identifier: MIT
#include <cstdlib>
#include <cstring>

#include "data.h"
#include "reading.h"
#include "shapes.h"

using namespace lodestone;
using lodestone::test::corner;
using lodestone::test::read_text;
using lodestone::test::warned;

namespace {

std::string base64(std::string_view bytes) {
  static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? letters[(group >> (18 - 6 * k)) & 63] : '=';
    }
  }
  return text;
}

// A square in the file's x, y plane, four vertices, then the indices 0 1 2 3 as bytes.
std::string square_buffer() {
  std::string bytes;
  for (const float value : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 1.0F, 1.0F, 0.0F}) {
    bytes.append(reinterpret_cast<const char*>(&value), 4);
  }
  return bytes + std::string{"\0\1\2\3", 4};
}

std::string gltf(const std::string& primitive, const std::string& node, const std::string& more = "",
                 const std::string& uri = "data:application/octet-stream;base64," + base64(square_buffer())) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" + node +
         R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0})" + primitive +
         R"(}]}],"buffers":[{"byteLength":52,"uri":")" + uri +
         R"("}],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":4}],"accessors":[
         {"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
         {"bufferView":1,"componentType":5121,"count":4,"type":"SCALAR"})" +
         more + "}";
}

}  // namespace

TEST_CASE("gltf: strips, fans and triangles without indices; points are left out") {
  const auto strip = read_text(gltf(R"(,"mode":5,"indices":1)", ""), "a.gltf");
  REQUIRE_FALSE(strip.ok());  // the list of accessors is not closed: refused with its name
  CHECK(strip.error().where == "a.gltf");
  const std::string end = "]";
  const auto good = read_text(gltf(R"(,"mode":5,"indices":1)", "", end), "a.gltf");
  REQUIRE(good.ok());
  CHECK(good->mesh.triangle_count() == 2);
  CHECK(good->info.up_axis == "Y");
  CHECK(test::area(good->mesh) == Approx(1.0));
  for (std::size_t f = 0; f < 2; ++f) {  // both look along the file's +z, our -y
    const glm::dvec3 n = glm::cross(corner(good->mesh, f, 1) - corner(good->mesh, f, 0),
                                    corner(good->mesh, f, 2) - corner(good->mesh, f, 0));
    CHECK(n.y < 0.0);
  }
  CHECK(read_text(gltf(R"(,"mode":6,"indices":1)", "", end), "a.gltf")->mesh.triangle_count() == 2);
  CHECK(read_text(gltf(R"(,"mode":4)", "", end), "a.gltf")->mesh.triangle_count() == 1);
  const auto points = read_text(gltf(R"(,"mode":0)", "", end), "a.gltf");
  REQUIRE_FALSE(points.ok());
  CHECK(points.error().message.find("lines and points") != std::string::npos);
}

TEST_CASE("gltf: nodes place the mesh; a far translation becomes the origin; a mirror turns the faces") {
  const auto far = read_text(
      gltf(R"(,"mode":5,"indices":1)", R"(,"translation":[678116.123456,416.5,-5403773.654321])", "]"), "a.gltf");
  REQUIRE(far.ok());
  CHECK(far->mesh.origin == glm::dvec3(678116.123456, 5403773.654321, 416.5));
  CHECK(far->mesh.vertices.positions[1] == glm::vec3(1, 0, 0));
  const auto mirror = read_text(gltf(R"(,"mode":5,"indices":1)", R"(,"scale":[-2,1,1])", "]"), "a.gltf");
  REQUIRE(mirror.ok());
  CHECK(test::area(mirror->mesh) == Approx(2.0));
  const glm::dvec3 n = glm::cross(corner(mirror->mesh, 0, 1) - corner(mirror->mesh, 0, 0),
                                  corner(mirror->mesh, 0, 2) - corner(mirror->mesh, 0, 0));
  CHECK(n.y < 0.0);
  const auto turned = read_text(
      gltf(R"(,"mode":5,"indices":1)", R"(,"rotation":[0,0,0.70710678118654757,0.70710678118654757])", "]"), "a.gltf");
  CHECK(glm::length(corner(turned->mesh, 0, 1) - glm::dvec3(0, 0, 1)) < 1e-6);
}

TEST_CASE("gltf: sparse values replace those of the buffer, or zeros") {
  std::string bytes = square_buffer();
  const float moved[] = {5.0F, 6.0F, 7.0F};
  bytes.append(reinterpret_cast<const char*>(moved), sizeof moved);
  bytes += '\3';
  const auto read = read_text(
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],
      "buffers":[{"byteLength":65,"uri":"data:application/octet-stream;base64,)" +
          base64(bytes) +
          R"("}],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":64,"byteLength":1}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,
      "indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":1,"byteOffset":0}}}]})",
      "a.gltf");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 2);
}

TEST_CASE("gltf: what reaches outside its buffer, is missing or needs an unknown extension is refused") {
  const auto refused = [](const std::string& text) {
    const auto read = read_text(text, "bad.gltf");
    REQUIRE_FALSE(read.ok());
    CHECK(read.error().where.find("bad.gltf") == 0);
    return read.error().code;
  };
  CHECK(refused(gltf("", "", "]", "nowhere.bin")) == ErrorCode::BadData);
  std::string long_count = gltf("", "", "]");
  long_count.replace(long_count.find("\"count\":4"), 9, "\"count\":4000000000");
  refused(long_count);
  std::string too_many = gltf("", "", "]");
  too_many.replace(too_many.find("\"count\":4"), 9, "\"count\":5");
  CHECK(refused(too_many) == ErrorCode::BadData);
  CHECK(refused(gltf("", "", R"(],"extensionsRequired":["ACME_secret"])")) == ErrorCode::Unsupported);
  CHECK(refused("{\"asset\":") == ErrorCode::BadData);
  CHECK(refused(std::string(100'000, '[')) == ErrorCode::BadData);
  CHECK(refused("glTF\2\0\0\0") == ErrorCode::BadData);
}

TEST_CASE("gltf: indices out of range and a node that is its own child are warnings") {
  std::string text = gltf(R"(,"mode":4,"indices":1)", R"(,"children":[0])", "]");
  const auto loop = read_text(text, "a.gltf");
  REQUIRE(loop.ok());
  CHECK(warned(loop, "is its own"));
  std::string bytes = square_buffer();
  bytes[51] = 9;  // of one of the two triangles
  const auto read = read_text(
      gltf(R"(,"mode":5,"indices":1)", "", "]", "data:application/octet-stream;base64," + base64(bytes)), "a.gltf");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 1);
  CHECK(warned(read, "does not exist"));
}

TEST_CASE("glb: every family of meshes comes back, positions bit for bit") {
  const auto folder = test::scratch_folder("glb_round_trip");
  for (const auto& [name, mesh] : test::mesh_families()) {
    CAPTURE(name);
    REQUIRE(write_mesh(mesh, folder / "a.glb").ok());
    const auto read = read_mesh(folder / "a.glb");
    REQUIRE(read.ok() == (mesh.triangle_count() > 0));
    if (!read) continue;
    REQUIRE(read->mesh.triangle_count() == mesh.triangle_count());
    if (!mesh.face_materials.empty()) continue;  // faces are put in the order of materials
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      const VertexId a = mesh.indices[i];
      const VertexId b = read->mesh.indices[i];
      REQUIRE(read->mesh.vertices.positions[b] == mesh.vertices.positions[a]);
      if (!mesh.vertices.normals.empty()) {
        REQUIRE(glm::length(read->mesh.vertices.normals[b] - mesh.vertices.normals[a]) < 1e-6F);
      }
      if (!mesh.vertices.uvs.empty()) REQUIRE(glm::length(read->mesh.vertices.uvs[b] - mesh.vertices.uvs[a]) < 1e-6F);
    }
  }
}

TEST_CASE("glb: place, colours, materials and pictures come back") {
  const auto folder = test::scratch_folder("glb_all");
  Mesh mesh = test::seamed_grid(6, 6);
  mesh.origin = {678116.123, 5403773.5, 416.25};
  mesh.crs = "EPSG:25832";
  for (std::uint32_t i = 0; i < mesh.vertex_count(); ++i)
    mesh.vertices.colors.emplace_back(i * 3, i, 255 - i, 255 - 2 * i);
  mesh.materials[0].base_color = {0.25F, 0.5F, 1.0F, 0.5F};
  mesh.materials[1].texture = 0;
  mesh.materials[1].alpha_cutoff = 0.25F;
  Texture texture;
  texture.name = "stone";
  texture.image = std::make_shared<const Image>(Image{2, 1, 3, {1, 2, 3, 4, 5, 6}});
  mesh.textures.push_back(texture);
  REQUIRE(write_mesh(mesh, folder / "a.glb").ok());
  ReadOptions options;
  options.textures = LoadTextures::Decoded;
  const auto read = read_mesh(folder / "a.glb", options);
  REQUIRE(read.ok());
  CHECK(read->mesh.origin == mesh.origin);
  CHECK(read->mesh.crs == mesh.crs);
  CHECK(read->mesh.vertex_count() == mesh.vertex_count());
  CHECK(read->mesh.vertices.colors == mesh.vertices.colors);
  CHECK(read->mesh.vertices.positions == mesh.vertices.positions);
  REQUIRE(read->mesh.materials.size() == 2);
  CHECK(glm::length(read->mesh.materials[0].base_color - mesh.materials[0].base_color) < 1e-5F);
  CHECK(read->mesh.materials[1].alpha_cutoff == 0.25F);
  REQUIRE(read->mesh.textures.size() == 1);
  CHECK(read->mesh.textures[0].image->pixels == texture.image->pixels);
}

TEST_CASE("glb: every cut of a file is an error, every flipped byte comes back somehow") {
  const auto folder = test::scratch_folder("glb_cuts");
  REQUIRE(write_mesh(test::cube(), folder / "a.glb").ok());
  std::ifstream file{folder / "a.glb", std::ios::binary};
  std::string bytes{std::istreambuf_iterator<char>{file}, {}};
  for (std::size_t size = 4; size < bytes.size(); size += 7)
    CHECK_FALSE(read_text(bytes.substr(0, size), "cut.glb").ok());
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    bytes[at] = static_cast<char>(bytes[at] ^ 0x15);
    const auto read = read_text(bytes, "flipped.glb");
    if (read) CHECK(validate(read->mesh).ok());
    bytes[at] = static_cast<char>(bytes[at] ^ 0x15);
  }
}

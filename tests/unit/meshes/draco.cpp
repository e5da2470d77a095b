// SPDX-License-Identifier: MIT
// glTF compressed with Draco: written here with libdraco, read as any other.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <array>
#include <nlohmann/json.hpp>

#include "reading.h"
#include "shapes.h"

using namespace lodestone;
using lodestone::test::read_text;
using Json = nlohmann::json;

namespace {

// Corners of all triangles, in an order that depends on the places only: Draco orders faces and vertices anew.
using Corner = std::array<float, 8>;
using Corners = std::vector<std::array<Corner, 3>>;

Corners corners_of(const Mesh& mesh) {
  Corners all;
  for (std::size_t f = 0; f < mesh.triangle_count(); ++f) {
    std::array<Corner, 3> face{};
    for (std::size_t c = 0; c < 3; ++c) {
      const VertexId v = mesh.indices[3 * f + c];
      const glm::vec3 p = mesh.vertices.positions[v];
      const glm::vec3 n = mesh.vertices.normals[v];
      const glm::vec2 t = mesh.vertices.uvs[v];
      face[c] = {p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y};
    }
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    all.push_back(face);
  }
  std::sort(all.begin(), all.end());
  return all;
}

// The numbers as a glTF file has them: y up, v downwards.
glm::vec3 to_file(glm::vec3 v) { return {v.x, v.z, -v.y}; }

// Bits 0 keep every float as it is.
std::string packed(const Mesh& mesh, int bits) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(mesh.triangle_count()));
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  for (std::uint32_t f = 0; f < mesh.triangle_count(); ++f) {
    std::array<glm::vec3, 3> p{};
    std::array<glm::vec3, 3> n{};
    std::array<glm::vec2, 3> t{};
    for (std::size_t c = 0; c < 3; ++c) {
      const VertexId v = mesh.indices[3 * std::size_t{f} + c];
      p[c] = to_file(mesh.vertices.positions[v]);
      n[c] = to_file(mesh.vertices.normals[v]);
      t[c] = {mesh.vertices.uvs[v].x, 1.0F - mesh.vertices.uvs[v].y};
    }
    const draco::FaceIndex face{f};
    builder.SetAttributeValuesForFace(position, face, &p[0], &p[1], &p[2]);
    builder.SetAttributeValuesForFace(normal, face, &n[0], &n[1], &n[2]);
    builder.SetAttributeValuesForFace(uv, face, &t[0], &t[1], &t[2]);
  }
  const std::unique_ptr<draco::Mesh> soup = builder.Finalize();
  REQUIRE(soup != nullptr);
  draco::Encoder encoder;
  if (bits > 0) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
  draco::EncoderBuffer out;
  REQUIRE(encoder.EncodeMeshToBuffer(*soup, &out).ok());
  return {out.data(), out.size()};
}

Json document(const Mesh& mesh, std::size_t bytes) {
  return Json::parse(R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_draco_mesh_compression"],
    "extensionsRequired":["KHR_draco_mesh_compression"],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,
    "buffers":[{"byteLength":)" +
                     std::to_string(bytes) + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(bytes) +
                     R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2},"indices":3,
    "extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}}}}]}],
    "accessors":[{"componentType":5126,"count":1,"type":"VEC3"},{"componentType":5126,"count":1,"type":"VEC3"},
    {"componentType":5126,"count":1,"type":"VEC2"},{"componentType":5125,"count":)" +
                     std::to_string(3 * mesh.triangle_count()) + R"(,"type":"SCALAR"}]})");
}

std::string glb(const Json& json, std::string binary) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  const auto word = [](std::size_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    return std::string{reinterpret_cast<const char*>(&number), 4};
  };
  return "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) + "JSON" + text +
         word(binary.size()) + std::string{"BIN\0", 4} + binary;
}

Mesh sample() {
  Mesh mesh = test::seamed_grid(12, 9);
  mesh.face_materials.clear();
  mesh.materials.resize(1);
  mesh.vertices.normals.resize(mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    mesh.vertices.normals[v] = glm::normalize(glm::vec3{static_cast<float>(v % 7), 1.0F, 3.0F});
  }
  return mesh;
}

}  // namespace

TEST_CASE("draco: what was packed without loss comes back, every corner with its normal and uv") {
  const Mesh mesh = sample();
  const std::string bytes = packed(mesh, 0);
  const auto read = read_text(glb(document(mesh, bytes.size()), bytes), "a.glb");
  INFO((read ? std::string{} : to_line(read.error())));
  REQUIRE(read.ok());
  CHECK(read.warnings().empty());
  const Corners expected = corners_of(mesh);
  const Corners found = corners_of(read->mesh);
  REQUIRE(found.size() == expected.size());
  for (std::size_t f = 0; f < found.size(); ++f) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < 3; ++k) CHECK(found[f][c][k] == expected[f][c][k]);
      for (std::size_t k = 3; k < 8; ++k) CHECK(found[f][c][k] == Approx(expected[f][c][k]).margin(1e-6));
    }
  }
}

TEST_CASE("draco: packed to 12 bits every corner lies within a step of its place") {
  const Mesh mesh = sample();
  const std::string bytes = packed(mesh, 12);
  CHECK(bytes.size() < packed(mesh, 0).size());
  const auto read = read_text(glb(document(mesh, bytes.size()), bytes), "a.glb");
  REQUIRE(read.ok());
  REQUIRE(read->mesh.triangle_count() == mesh.triangle_count());
  const double step = bounds(mesh).diagonal_m() / 4095.0;
  for (const glm::vec3& p : read->mesh.vertices.positions) {
    double nearest = 1e9;
    for (const glm::vec3& q : mesh.vertices.positions) nearest = std::min(nearest, glm::length(glm::dvec3{p - q}));
    CHECK(nearest <= step);
  }
}

TEST_CASE("draco: data that stand plainly beside are used") {
  const Mesh mesh = test::cube();
  Json json = document(mesh, 0);
  std::string bytes{"not Draco"};
  bytes.resize(12, ' ');
  Json& views = json["bufferViews"];
  views[0]["byteLength"] = 12;
  const auto append = [&](const void* data, std::size_t size) {
    views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}});
    bytes.append(static_cast<const char*>(data), size);
    return views.size() - 1;
  };
  json["accessors"] = Json::array({{{"componentType", 5126},
                                    {"count", mesh.vertex_count()},
                                    {"type", "VEC3"},
                                    {"bufferView", append(mesh.vertices.positions.data(), mesh.vertex_count() * 12)}},
                                   {{"componentType", 5125},
                                    {"count", mesh.indices.size()},
                                    {"type", "SCALAR"},
                                    {"bufferView", append(mesh.indices.data(), mesh.indices.size() * 4)}}});
  Json& primitive = json["meshes"][0]["primitives"][0];
  primitive["attributes"] = {{"POSITION", 0}};
  primitive["indices"] = 1;
  json.erase("extensionsRequired");
  json["buffers"][0]["byteLength"] = bytes.size();
  const auto read = read_text(glb(json, bytes), "a.glb");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 12);
}

TEST_CASE("draco: what does not fit is refused with its place") {
  const Mesh mesh = sample();
  const std::string bytes = packed(mesh, 0);
  const Json good = document(mesh, bytes.size());
  const auto refused = [](const Json& json, const std::string& binary, const ReadOptions& options = {}) {
    const auto read = read_text(glb(json, binary), "bad.glb", options);
    REQUIRE_FALSE(read.ok());
    CHECK(read.error().where == "bad.glb, mesh 0, primitive 0");
    return read.error().code;
  };
  Json unknown = good;
  unknown["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 77;
  CHECK(refused(unknown, bytes) == ErrorCode::BadData);
  Json swapped = good;
  swapped["accessors"][2]["type"] = "VEC4";
  CHECK(refused(swapped, bytes) == ErrorCode::BadData);
  Json no_view = good;
  no_view["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 9;
  CHECK(refused(no_view, bytes) == ErrorCode::BadData);
  ReadOptions small;
  small.max_triangles = 10;
  CHECK(refused(good, bytes, small) == ErrorCode::TooLarge);
  for (std::size_t cut = 0; cut < bytes.size(); cut += 97) {
    Json shorter = good;
    shorter["bufferViews"][0]["byteLength"] = cut;
    CHECK(refused(shorter, bytes) == ErrorCode::BadData);
  }
}

TEST_CASE("draco: a file that is cut off is refused") {
  const Mesh mesh = sample();
  const std::string bytes = packed(mesh, 11);
  const std::string whole = glb(document(mesh, bytes.size()), bytes);
  for (std::size_t size = 4; size < whole.size(); size += 11)
    CHECK_FALSE(read_text(whole.substr(0, size), "a.glb").ok());
}

TEST_CASE("draco: a flipped byte is an error or a mesh, never a crash") {
  const Mesh mesh = sample();
  std::string bytes = packed(mesh, 11);
  const Json json = document(mesh, bytes.size());
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    bytes[at] = static_cast<char>(bytes[at] ^ 0x5A);
    const auto read = read_text(glb(json, bytes), "a.glb");
    if (read) CHECK(validate(read->mesh).ok());
    bytes[at] = static_cast<char>(bytes[at] ^ 0x5A);
  }
}

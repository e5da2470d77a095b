// SPDX-License-Identifier: MIT
#include <cstring>

#include "data.h"
#include "reading.h"

using namespace lodestone;
using lodestone::test::corner;
using lodestone::test::read_text;
using lodestone::test::warned;

namespace {

template <class T>
void put(std::string& bytes, T value, bool big) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

// A quad and a triangle, doubles, colours, and a property and an element that nobody knows.
std::string binary(bool big) {
  std::string bytes = std::string{"ply\nformat binary_"} + (big ? "big" : "little") +
                      "_endian 1.0\ncomment made for a test\nelement vertex 5\nproperty double x\nproperty double y\n"
                      "property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                      "property list uchar short junk\nelement odd 1\nproperty int a\nelement face 2\n"
                      "property list uchar uint vertex_indices\nproperty int quality\nend_header\n";
  const double xyz[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 2.5}};
  for (const auto& p : xyz) {
    for (const double c : p) put(bytes, c, big);
    for (const int c : {10, 20, 30}) put(bytes, static_cast<std::uint8_t>(c), big);
    put(bytes, std::uint8_t{2}, big);
    put(bytes, std::int16_t{1}, big);
    put(bytes, std::int16_t{2}, big);
  }
  put(bytes, std::int32_t{7}, big);
  put(bytes, std::uint8_t{4}, big);
  for (const std::uint32_t i : {0U, 1U, 2U, 3U}) put(bytes, i, big);
  put(bytes, std::int32_t{0}, big);
  put(bytes, std::uint8_t{3}, big);
  for (const std::uint32_t i : {0U, 1U, 4U}) put(bytes, i, big);
  put(bytes, std::int32_t{0}, big);
  return bytes;
}

constexpr std::string_view header =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
constexpr std::string_view faces = "element face 1\nproperty list uchar int vertex_index\nend_header\n";

}  // namespace

TEST_CASE("ply: binary of either byte order, with unknown properties and elements") {
  for (const bool big : {false, true}) {
    const auto read = read_text(binary(big), "a.ply");
    REQUIRE(read.ok());
    CHECK(read->info.format == "ply");
    CHECK(read->mesh.triangle_count() == 3);
    CHECK(read->mesh.vertices.colors[4] == glm::u8vec4(10, 20, 30, 255));
    CHECK(corner(read->mesh, 2, 2) == glm::dvec3(0, 0, 2.5));
  }
}

TEST_CASE("ply: every cut of a file is an error that names it") {
  const std::string whole = binary(false);
  for (std::size_t size = 3; size < whole.size(); ++size) {
    const auto read = read_text(whole.substr(0, size), "cut.ply");
    CAPTURE(size);
    REQUIRE_FALSE(read.ok());
    CHECK(read.error().where.find("cut.ply") == 0);
  }
}

TEST_CASE("ply: text, with normals, uvs under each of their names, and lines that end anywhere") {
  for (const char* names : {"s t", "u v", "texture_u texture_v", "texture_s texture_t"}) {
    const std::string both = names;
    const std::string u = both.substr(0, both.find(' '));
    const std::string v = both.substr(both.find(' ') + 1);
    const auto read =
        read_text(std::string{header} + "property float nx\nproperty float ny\nproperty float nz\nproperty float " + u +
                      "\nproperty float " + v + "\n" + std::string{faces} +
                      "0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1\n0 0 1 0 0 0 1 0 0.5 3 0 1 2\n",
                  "a.ply");
    CAPTURE(names);
    REQUIRE(read.ok());
    CHECK(read->mesh.triangle_count() == 1);
    CHECK(read->mesh.vertices.uvs[1] == glm::vec2(1.0F, 0.0F));
    CHECK(read->mesh.vertices.uvs[2] == glm::vec2(0.0F, 0.5F));
    CHECK(read->mesh.vertices.normals[0] == glm::vec3(0, 0, 1));
  }
}

TEST_CASE("ply: texture coordinates and textures per face, as MeshLab writes them") {
  const auto folder = test::scratch_folder("ply_textures");
  REQUIRE(write_image(Image{1, 1, 3, {1, 2, 3}}, folder / "one.png").ok());
  const auto read = read_text(
      "ply\nformat ascii 1.0\ncomment TextureFile one.png\ncomment TextureFile two.png\n"
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 3\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "property int texnumber\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
      "3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 6 0 0 1 1 0 1 0\n3 0 2 3 6 0.5 0 1 1 0 1 1\n",
      "a.ply", {}, folder);
  REQUIRE(read.ok());
  const Mesh& mesh = read->mesh;
  CHECK(mesh.triangle_count() == 3);
  CHECK(mesh.vertex_count() == 5);  // corner 0 is split by its second uv, the rest is shared again
  REQUIRE(mesh.materials.size() == 2);
  CHECK(mesh.materials[0].texture == 0);
  CHECK(mesh.materials[1].texture == none);
  CHECK(mesh.face_materials == std::vector<MaterialId>{0, 0, 1});
  CHECK(warned(read, "\"two.png\" is missing"));
}

TEST_CASE("ply: triangle strips") {
  const auto read = read_text(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n",
      "a.ply");
  REQUIRE(read.ok());
  CHECK(read->mesh.indices == std::vector<VertexId>{0, 1, 2, 2, 1, 3, 0, 1, 2});
}

TEST_CASE("ply: faces with wrong indices, too few corners or NaN are left out") {
  const auto read = read_text(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 5\nproperty list uchar int vertex_index\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\nnan 0 0\n3 0 1 2\n3 0 1 7\n3 -1 0 1\n2 0 1\n3 0 1 3\n",
      "a.ply");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 1);
  CHECK(warned(read, "does not exist"));
  CHECK(warned(read, "fewer than three"));
  CHECK(warned(read, "not a finite number"));
}

TEST_CASE("ply: broken headers are refused with their line") {
  const auto refused = [](std::string_view text) {
    const auto read = read_text(text, "bad.ply");
    CAPTURE(text);
    REQUIRE_FALSE(read.ok());
    CHECK(read.error().where.find("bad.ply") == 0);
    return read.error().code;
  };
  CHECK(refused("ply\n") == ErrorCode::BadData);
  CHECK(refused("ply\nformat ebcdic 1.0\nend_header\n") == ErrorCode::Unsupported);
  CHECK(refused("ply\nformat ascii 1.0\nproperty float x\nend_header\n") == ErrorCode::BadData);
  CHECK(refused("ply\nformat ascii 1.0\nelement vertex -3\nend_header\n") == ErrorCode::BadData);
  CHECK(refused("ply\nformat ascii 1.0\nelement vertex 3\nproperty float128 x\nend_header\n") == ErrorCode::BadData);
  CHECK(refused("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n1 2 3\n") ==
        ErrorCode::BadData);
  CHECK(
      refused("ply\nformat ascii 1.0\nelement vertex 300000000\nproperty float x\nproperty float y\nproperty float z\n"
              "end_header\n1 2 3\n") == ErrorCode::BadData);
}

TEST_CASE("ply: doubles of a national grid keep 0.1 mm") {
  const auto read = read_text(
      "ply\nformat ascii 1.0\ncomment crs EPSG:25832\nelement vertex 3\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
      "678116.1234 5403773.5678 416.4321\n678117.1234 5403773.5678 416.4321\n"
      "678116.1234 5403774.5679 416.4321\n3 0 1 2\n",
      "a.ply");
  REQUIRE(read.ok());
  CHECK(read->mesh.crs == "EPSG:25832");
  CHECK(glm::length(corner(read->mesh, 0, 2) - glm::dvec3(678116.1234, 5403774.5679, 416.4321)) < 5e-5);
}

TEST_CASE("ply: coordinates of a national grid keep 0.1 mm beside a stray vertex at zero") {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list uchar int vertex_indices\n";
  const std::string vertices =
      "0 0 0\n678116.1234 5403773.5678 416.4321\n678117.1234 5403773.5678 416.4321\n"
      "678116.1234 5403774.5679 416.4321\n";
  for (const std::string& text :
       {header + "end_header\n" + vertices + "3 1 2 3\n",
        header + "property list uchar float texcoord\nend_header\n" + vertices + "3 1 2 3 6 0 0 1 0 0 1\n"}) {
    const auto read = read_text(text, "a.ply");
    REQUIRE(read.ok());
    CHECK(glm::length(corner(read->mesh, 0, 2) - glm::dvec3(678116.1234, 5403774.5679, 416.4321)) < 5e-5);
  }
}

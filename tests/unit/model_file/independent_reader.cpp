// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cstdlib>
#include <cstring>

#include "data.h"
#include "shapes.h"
#include "support.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

template <class T>
void append(Bytes& out, const std::vector<T>& array, VertexId v) {
  if (array.empty()) return;
  const auto* first = reinterpret_cast<const std::uint8_t*>(&array[v]);
  out.insert(out.end(), first, first + sizeof(T));
}

// What read_lode.py writes: the corners of every face of the finest level, and its feature.
Bytes faces_of(const Mesh& mesh) {
  Bytes out;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    for (std::size_t c = 0; c < 3; ++c) {
      const VertexId v = mesh.indices[3 * std::size_t{f} + c];
      append(out, mesh.vertices.positions, v);
      append(out, mesh.vertices.normals, v);
      append(out, mesh.vertices.uvs, v);
      append(out, mesh.vertices.colors, v);
    }
    append(out, std::vector<FeatureId>{mesh.face_feature(f)}, 0);
  }
  return out;
}

}  // namespace

TEST_CASE("a reader written from docs/FILE_FORMAT.md alone gets every bit of the finest level") {
  const auto folder = scratch_folder("lode-independent");
  const std::string script = LODESTONE_READ_LODE;
  const auto check = [&](const Model& model, std::uint32_t bits) {
    (void)written(*model, folder / "a.lode", {.quantize_bits = bits});
    const std::string command =
        LODESTONE_PYTHON " " + script + " " + (folder / "a.lode").string() + " " + (folder / "a.bin").string();
    REQUIRE(std::system(command.c_str()) == 0);
    const Model back = read_model(folder / "a.lode").value();
    CHECK(slurp(folder / "a.bin") == faces_of(back->extract(back->record_count())));
  };
  SECTION("seams, materials, features and all attributes") { check(rich_model(), 0); }
  SECTION("the same on a grid") { check(rich_model(), 13); }
  SECTION("subset placement") { check(build(sphere(40, 60), Placement::Subset), 0); }
  SECTION("families of meshes") {
    for (const NamedMesh& family : mesh_families()) {
      INFO(family.name);
      check(build(family.mesh, Placement::Optimal), 0);
    }
  }
}

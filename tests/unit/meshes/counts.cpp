// SPDX-License-Identifier: MIT
// Counting a file's mesh before it is read.
#include <cctype>

#include <nlohmann/json.hpp>

#include "base/rng.h"
#include "data.h"
#include "meshes/mesh_count.h"
#include "reading.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

Result<MeshCount> count_of(const Input& input) {
  const ReadFunction reader = find_reader(input);
  if (reader == read_ply) return count_ply(input, {});
  return reader == read_obj ? count_obj(input, {}) : count_gltf(input);
}

Result<MeshCount> count_of(const std::string& text, const std::string& name) {
  return count_of(Input::from_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, name, "/none"));
}

std::string text_of(const fs::path& file) {
  std::ifstream stream{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

// Each with a head that says how much there is.
std::vector<fs::path> seeds() {
  const fs::path corpus{LODESTONE_CORPUS};
  return {corpus / "obj/ngon.obj",   corpus / "obj/negative.obj",
          corpus / "ply/ascii.ply",  corpus / "ply/binary_little_endian.ply",
          corpus / "ply/strips.ply", corpus / "gltf/cube.gltf",
          corpus / "gltf/cube.glb",  corpus / "gltf/features.glb"};
}

void check_holdable(const Result<MeshCount>& count, std::size_t size) {
  if (!count) return;  // its reader will say the same
  CHECK(count->triangles <= size);
  CHECK(count->vertices <= 2 * size);
  CHECK(count->reading_bytes <= 1e4 * static_cast<double>(size));
  CHECK(count->other_image_bytes <= size);
  for (const InnerImage& image : count->images) CHECK(image.offset + image.size_bytes <= size);
}

}  // namespace

TEST_CASE("What is counted before reading is what reading finds") {
  const fs::path folder = scratch_folder("counts");
  const Mesh mesh = sphere(20, 30);
  for (const char* name : {"a.obj", "a.ply", "a.glb"}) {
    INFO(name);
    REQUIRE(write_mesh(mesh, folder / name));
    const auto input = Input::open(folder / name, 1U << 20U);
    REQUIRE(input);
    const auto count = count_of(*input);
    REQUIRE(count);
    const auto loaded = read_mesh(folder / name);
    REQUIRE(loaded);
    CHECK(count->triangles == loaded->mesh.triangle_count());
    CHECK(static_cast<double>(count->vertices) == Approx(loaded->mesh.vertex_count()).epsilon(0.02));
  }
}

TEST_CASE("Of a glTF's files beside it buffers are counted, and images inside them found") {
  const fs::path folder = scratch_folder("counts_beside");
  write_text(folder / "a.bin", std::string(700, 'x'));
  nlohmann::json root;
  root["buffers"] = {{{"uri", "a.bin"}, {"byteLength", 700}}};
  root["bufferViews"] = {{{"buffer", 0}, {"byteLength", 360}},
                         {{"buffer", 0}, {"byteOffset", 360}, {"byteLength", 200}},
                         {{"buffer", 0}, {"byteOffset", 600}, {"byteLength", 5000}}};
  root["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", 30}, {"type", "VEC3"}}};
  root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}};
  root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}}};
  root["images"] = {{{"bufferView", 1}}, {{"bufferView", 2}}, {{"bufferView", 7}}};
  write_text(folder / "a.gltf", root.dump());
  const auto input = Input::open(folder / "a.gltf", 1U << 20U);
  REQUIRE(input);
  const auto count = count_gltf(*input);
  REQUIRE(count);
  CHECK(count->triangles == 20);
  REQUIRE(count->images.size() == 2);
  CHECK(count->images[0].file == folder / "a.bin");
  CHECK(count->images[0].offset == 360);
  CHECK(count->images[0].size_bytes == 200);
  CHECK(count->images[1].size_bytes == 100);  // that are there
  CHECK(count->reading_bytes > 700.0);
}

TEST_CASE("Whatever number a damaged head claims, no more is counted than the file can hold") {
  for (const fs::path& seed : seeds()) {
    INFO(seed.filename());
    const std::string whole = text_of(seed);
    const std::size_t head = std::min<std::size_t>(whole.size(), 2000);
    for (std::size_t at = 0; at < head; ++at) {
      const auto is_digit = [&](std::size_t i) { return std::isdigit(static_cast<unsigned char>(whole[i])) != 0; };
      if (!is_digit(at) || (at > 0 && is_digit(at - 1))) continue;
      std::size_t end = at;
      while (end < whole.size() && is_digit(end)) ++end;
      for (const char* number : {"4000000000000000000", "999999999999999", "4294967295", "0"}) {
        std::string damaged = whole;
        damaged.replace(at, end - at, number);
        if (whole.starts_with("glTF")) {  // the head says how long the text is
          const auto length = static_cast<std::uint8_t>(damaged[12]) + 256 * static_cast<std::uint8_t>(damaged[13]);
          const std::size_t changed = static_cast<std::size_t>(length) + damaged.size() - whole.size();
          damaged[12] = static_cast<char>(changed % 256);
          damaged[13] = static_cast<char>(changed / 256);
        }
        check_holdable(count_of(damaged, seed.filename().string()), damaged.size());
      }
    }
  }
}

TEST_CASE("Counting ends, with an error or a count that can be, for bytes changed at random") {
  Rng rng{7};
  for (const fs::path& seed : seeds()) {
    INFO(seed.filename());
    const std::string whole = text_of(seed);
    for (int run = 0; run < 100; ++run) {
      std::string damaged =
          whole.substr(0, run % 3 == 0 ? rng.below(static_cast<std::uint32_t>(whole.size())) : whole.npos);
      for (std::uint32_t changes = 1 + rng.below(8); changes > 0 && !damaged.empty(); --changes) {
        damaged[rng.below(static_cast<std::uint32_t>(damaged.size()))] = static_cast<char>(rng.below(256));
      }
      const auto count = count_of(damaged, seed.filename().string());
      if (!count) {
        CHECK(!count.error().message.empty());
        continue;
      }
      CHECK(count->triangles <= ReadOptions{}.max_triangles);
      if (seed.extension() != ".gltf" && seed.extension() != ".glb") check_holdable(count, damaged.size());
    }
  }
}

}  // namespace lodestone::test

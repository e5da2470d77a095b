// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>

#include <lodestone/formats.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "data.h"
#include "fixture.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

TilesetOptions options() { return {.pyramid = small_tiles()}; }

TilesetReport write(const fs::path& folder, const TilesetOptions& with = options(), unsigned workers = 2) {
  auto written = write_outcrop(small_cliff(), folder, with, {.max_workers = workers});
  if (!written) FAIL(to_line(written.error()));
  return std::move(*written);
}

void change(const fs::path& file, void (*how)(nlohmann::ordered_json&)) {
  std::ifstream in{file};
  auto json = nlohmann::ordered_json::parse(in);
  in.close();
  how(json["root"]);
  std::ofstream{file} << json.dump();
}

}  // namespace

TEST_CASE("A tileset holds the source, fits without a seam, and passes its own check") {
  const fs::path folder = scratch_folder("tileset_check");
  const TilesetReport written = write(folder);
  CHECK(written.source_triangles == small_cliff().triangle_count());
  CHECK(written.tiles > 10);
  const auto check = check_tileset(folder / "tileset.json");
  REQUIRE(check);
  CHECK(check->tiles == written.tiles);
  CHECK(check->triangles == small_cliff().triangle_count());
  CHECK(check->contents_outside_box == 0);
  CHECK(check->loose_boxes == 0);
  CHECK(check->children_outside_parent == 0);
  CHECK(check->errors_not_monotone == 0);
  CHECK(check->seams_open == 0);
  CHECK(check->faults.empty());
  CHECK(!fs::exists(folder / "work"));
}

TEST_CASE("A limit on memory that cannot be kept is refused before work begins, with one that can") {
  const fs::path folder = scratch_folder("tileset_memory") / "tiles";
  const auto limited = [&](std::size_t bytes, unsigned workers) {
    return write_outcrop(small_cliff(), folder, options(), {.max_workers = workers, .max_memory_bytes = bytes});
  };
  const auto tight = limited(1'000'000, 2);
  REQUIRE(!tight);
  CHECK(tight.error().code == ErrorCode::TooLarge);
  CHECK(!fs::exists(folder));
  const std::string& said = tight.error().message;
  const std::size_t at = said.rfind(": ");
  REQUIRE(said.find("MB will do") != std::string::npos);
  const std::size_t named = std::stoul(said.substr(at + 2)) * 1'000'000;
  CHECK(limited(named - 1'000'000, 2).error().code == ErrorCode::TooLarge);
  const auto just = limited(named, 8);
  REQUIRE(just);
  CHECK(just->geometry_workers == 1);
  const auto enough = limited(1'000'000'000, 2);
  REQUIRE(enough);
  CHECK(enough->geometry_workers == 2);
  CHECK(enough->photograph_workers == 2);
}

TEST_CASE("What building takes grows with the mesh, the ratio and a second worker") {
  const OutcropSize size{1'000'000, 500'000, 20};
  const auto bytes = [&](double ratio, unsigned workers) {
    return static_cast<double>(outcrop_build_bytes(size, {.ratio = ratio}, workers));
  };
  CHECK(bytes(0.5, 1) < bytes(0.8, 1));
  CHECK(bytes(0.5, 1) < bytes(0.5, 2));
  CHECK(bytes(0.5, 2) == bytes(0.5, 8));
  CHECK(2.0 * bytes(0.5, 1) == Approx(outcrop_build_bytes({2'000'000, 1'000'000, 20}, {.ratio = 0.5}, 1)));
  CHECK(outcrop_levels_bytes(size, {.ratio = 0.5}) < outcrop_build_bytes(size, {.ratio = 0.5}, 1));
}

TEST_CASE("The check of a tileset finds what is wrong with it") {
  const fs::path folder = scratch_folder("tileset_faults");
  static_cast<void>(write(folder));
  const fs::path file = folder / "tileset.json";
  const std::string good = files_of(folder)["tileset.json"];
  const auto damaged = [&](void (*how)(nlohmann::ordered_json&)) {
    std::ofstream{file} << good;
    change(file, how);
    auto check = check_tileset(file);
    REQUIRE(check);
    return *check;
  };
  CHECK(damaged([](auto& root) { root["children"][0]["boundingVolume"]["box"][0] = 5e3; }).children_outside_parent > 0);
  CHECK(damaged([](auto& root) { root["children"][0]["boundingVolume"]["box"][3] = 1e-3; }).contents_outside_box > 0);
  CHECK(damaged([](auto& root) {
          for (const int half : {3, 7, 11}) {
            auto& box = root["boundingVolume"]["box"];
            box[half] = 1.1 * box[half].template get<double>();
          }
        }).loose_boxes == 1);
  CHECK(damaged([](auto& root) { root["children"][0]["geometricError"] = 1e9; }).errors_not_monotone > 0);
  CHECK(damaged([](auto& root) { root["children"][0]["children"].erase(0); }).seams_open > 0);
  std::ofstream{file} << good.substr(0, good.size() / 2);
  CHECK(check_tileset(file).error().code == ErrorCode::BadData);
  CHECK(check_tileset(folder / "nothing.json").error().code == ErrorCode::NotFound);
}

TEST_CASE("The same bytes come out for 1, 2 and 8 workers, and after a build that was stopped anywhere") {
  const fs::path one = scratch_folder("tileset_one");
  static_cast<void>(write(one, options(), 1));
  const auto wanted = files_of(one);
  for (const unsigned workers : {2U, 8U}) {
    const fs::path other = scratch_folder("tileset_other");
    static_cast<void>(write(other, options(), workers));
    CHECK(files_of(other) == wanted);
  }
  // What a killed build leaves: some tiles, a half-written one, no tileset.json.
  const fs::path stopped = scratch_folder("tileset_stopped");
  static_cast<void>(write(stopped));
  fs::remove(stopped / "tileset.json");
  std::size_t number = 0;
  for (const auto& [name, content] : wanted) {
    if (name.starts_with("tiles/") && number++ % 3 == 0) fs::remove(stopped / name);
  }
  std::ofstream{stopped / "tiles/L0_0.glb.part1-1"} << "half";
  TilesetOptions resume = options();
  resume.resume = true;
  const TilesetReport report = write(stopped, resume);
  CHECK(report.kept_tiles > 0);
  CHECK(report.kept_tiles < report.tiles);
  CHECK(files_of(stopped) == wanted);

  // What was cut off afterwards is made anew.
  fs::resize_file(stopped / "tiles/L0_1.glb", 500);
  fs::resize_file(stopped / "tiles/L1_0.glb", 0);
  CHECK(write(stopped, resume).kept_tiles == report.tiles - 2);
  CHECK(files_of(stopped) == wanted);

  resume.jpeg_quality = 50;
  const auto refused = write_outcrop(small_cliff(), stopped, resume);
  REQUIRE(!refused);
  CHECK(refused.error().code == ErrorCode::BadArgument);
}

TEST_CASE("A cancelled or failed build leaves no tileset behind") {
  const fs::path folder = scratch_folder("tileset_cancelled");
  const std::atomic<bool> cancelled{true};
  const auto written = write_outcrop(small_cliff(), folder, options(), {.cancel = &cancelled});
  REQUIRE(!written);
  CHECK(written.error().code == ErrorCode::Cancelled);
  CHECK(fs::is_empty(folder));  // and the folder, which was there before, stays

  std::ofstream{folder / "file"} << "in the way";
  CHECK(write_outcrop(small_cliff(), folder / "file", options()).error().code == ErrorCode::Unreadable);
}

TEST_CASE("The root's transform places the outcrop on the globe, or keeps the origin") {
  const fs::path folder = scratch_folder("tileset_place");
  static_cast<void>(write(folder));
  const auto transform = [&] {
    std::ifstream in{folder / "tileset.json"};
    return nlohmann::json::parse(in)["root"]["transform"].get<std::vector<double>>();
  };
  std::vector<double> t = transform();
  const glm::dvec3 east{t[0], t[1], t[2]};
  const glm::dvec3 up{t[8], t[9], t[10]};
  const glm::dvec3 place{t[12], t[13], t[14]};
  CHECK(glm::length(east) == Approx(1.0).margin(1e-3));
  CHECK(std::abs(glm::dot(east, up)) < 1e-3);
  CHECK(glm::dot(up, glm::normalize(place)) > 0.999);  // up is away from the middle of the earth
  CHECK(glm::length(place) == Approx(6.367e6).margin(2e4));

  Mesh nowhere = small_cliff();
  nowhere.crs.clear();
  REQUIRE(write_outcrop(nowhere, folder, options()));
  t = transform();
  CHECK(t[0] == 1.0);
  CHECK(t[12] == nowhere.origin.x);
  nowhere.crs = "EPSG:0";
  const auto written = write_outcrop(nowhere, folder, options());
  REQUIRE(written);
  CHECK(written.warnings().size() == 1);
}

TEST_CASE("Older clients get batched models with the same content") {
  const fs::path glb = scratch_folder("tileset_glb");
  const fs::path b3dm = scratch_folder("tileset_b3dm");
  static_cast<void>(write(glb));
  TilesetOptions older = options();
  older.version = TilesVersion::V10;
  static_cast<void>(write(b3dm, older));
  const auto check = check_tileset(b3dm / "tileset.json");
  REQUIRE(check);
  CHECK(check->faults.empty());
  const auto plain = files_of(glb);
  const auto wrapped = files_of(b3dm);
  const std::string& tile = wrapped.at("tiles/L0_0.b3dm");
  CHECK(tile.size() % 8 == 0);
  CHECK(tile.find(plain.at("tiles/L0_0.glb")) % 8 == 0);
}

TEST_CASE("Textures are JPEG, PNG or WebP, as asked, and read back") {
  for (const auto& [image, type] :
       {std::pair{TileImage::Jpeg, "image/jpeg"}, {TileImage::Png, "image/png"}, {TileImage::Webp, "image/webp"}}) {
    const fs::path folder = scratch_folder("tileset_images");
    TilesetOptions with = options();
    with.image = image;
    static_cast<void>(write(folder, with));
    const auto tile = read_mesh(folder / "tiles/L0_0.glb", {.textures = LoadTextures::Encoded});
    REQUIRE(tile);
    REQUIRE(tile->mesh.textures.size() == 1);
    CHECK(tile->mesh.textures.front().mime_type == type);
    const auto pixels = decode_image(*tile->mesh.textures.front().encoded, "tile");
    REQUIRE(pixels);
    CHECK(pixels->width % 8 == 0);
  }
}

TEST_CASE("A corner that lies astray takes its faces along, with a warning, and not the rest of the outcrop") {
  const fs::path folder = scratch_folder("tileset_astray");
  Mesh mesh = grid(20, 20);
  mesh.origin = {677'400.0, 5'403'200.0, 412.0};
  const double error_m = [&] {
    const auto written = write_outcrop(mesh, folder / "whole", {.pyramid = {.tile_bytes = 4096}});
    REQUIRE(written);
    return written->root_error_m;
  }();
  for (const auto& [corner, x] : {std::pair{0U, 1e30}, {100U, -1e30}, {100U, 1e9}, {0U, 1e9}, {50U, 1e12}}) {
    INFO(corner << " at " << x);
    const fs::path file = folder / "astray.obj";
    std::ofstream obj{file};
    obj << std::setprecision(12);
    for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
      const glm::dvec3 p = mesh.origin + glm::dvec3{mesh.vertices.positions[v]};
      obj << "v " << (v == corner ? x : p.x) << ' ' << p.y << ' ' << p.z << '\n';
    }
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      obj << "f " << mesh.indices[i] + 1 << ' ' << mesh.indices[i + 1] + 1 << ' ' << mesh.indices[i + 2] + 1 << '\n';
    }
    obj.close();
    auto loaded = read_mesh(file);
    REQUIRE(loaded);
    REQUIRE(loaded.warnings().size() == 1);
    CHECK(loaded.warnings().front().message.find("10,000 km") != std::string::npos);
    CHECK(loaded.warnings().front().where == file.string());
    CHECK(loaded->mesh.triangle_count() < mesh.triangle_count());
    CHECK(loaded->mesh.triangle_count() >= mesh.triangle_count() - 6);
    const FaceId last = loaded->mesh.triangle_count() - 1;
    const VertexId kept = loaded->mesh.indices[3 * std::size_t{last}];
    const VertexId meant = mesh.indices[mesh.indices.size() - 3];
    const glm::dvec3 off = loaded->mesh.origin + glm::dvec3{loaded->mesh.vertices.positions[kept]} - mesh.origin -
                           glm::dvec3{mesh.vertices.positions[meant]};
    CHECK(glm::length(off) < 1e-4);
    const auto written = write_outcrop(std::move(loaded->mesh), folder / "tiles", {.pyramid = {.tile_bytes = 4096}});
    REQUIRE(written);
    CHECK(written->root_error_m < 2.0 * error_m + 0.1);
  }
}

}  // namespace lodestone::test

// SPDX-License-Identifier: MIT
#include <sys/resource.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>

#include "data.h"
#include "model_file/columns.h"
#include "shapes.h"
#include "support.h"

using namespace lodestone;
using namespace lodestone::test;

TEST_CASE("a column gives back every value put into it") {
  model_file::ColumnWriter writer;
  std::vector<std::uint32_t> values;
  for (std::uint32_t bit = 0; bit < 32; ++bit) {
    for (const std::uint32_t x : {1U << bit, (1U << bit) - 1, 3U << bit >> 1, ~0U >> bit}) values.push_back(x);
  }
  for (const std::uint32_t x : values) writer.put(x);
  const auto extra = writer.extra();
  model_file::ColumnReader reader{writer.tokens(), extra};
  for (const std::uint32_t x : values) CHECK(reader.get() == x);
  CHECK(reader.left() == 0);
  CHECK_FALSE(reader.overrun());
  CHECK(reader.get() == 0);
  CHECK(reader.overrun());
}

TEST_CASE("a lossless file gives back every bit of the model, for every family of meshes and both kinds of placement") {
  const auto folder = scratch_folder("lode-round-trip");
  for (const NamedMesh& family : mesh_families()) {
    for (const Placement placement : {Placement::Subset, Placement::Optimal}) {
      INFO(family.name << ", placement " << static_cast<int>(placement));
      const Model model = build(family.mesh, placement);
      (void)written(*model, folder / "a.lode");
      const auto back = read_model(folder / "a.lode");
      INFO((back ? std::string{} : to_line(back.error())));
      REQUIRE(back.ok());
      CHECK(back.warnings().empty());
      CHECK(same_data(model->data(), back.value()->data()));
    }
  }
}

TEST_CASE("materials, features, origin and reference system travel along") {
  const auto file = scratch_folder("lode-rich") / "rich.lode";
  const Model model = rich_model();
  (void)written(*model, file);
  CHECK(is_model_file(file));
  const auto back = read_model(file);
  REQUIRE(back.ok());
  const ModelData& data = back.value()->data();
  CHECK(same_data(model->data(), data));
  CHECK(data.materials[1].name == "lichen");
  CHECK(data.features[2].id == "window");
  CHECK(data.features[2].semantic_class == "Window");
  CHECK(data.features[2].parent == 1);
  CHECK(data.crs == "EPSG:25832");
}

TEST_CASE("the same bytes come out for any number of workers") {
  const auto folder = scratch_folder("lode-workers");
  const Model model = rich_model();
  REQUIRE(write_model(*model, folder / "1.lode", {}, {.max_workers = 1}).ok());
  REQUIRE(write_model(*model, folder / "8.lode", {}, {.max_workers = 8}).ok());
  CHECK(slurp(folder / "1.lode") == slurp(folder / "8.lode"));
}

TEST_CASE("a cancelled write leaves the old file and nothing else") {
  const auto folder = scratch_folder("lode-cancel");
  const Model model = rich_model();
  const Bytes old = written(*model, folder / "a.lode");
  const std::atomic<bool> cancel{true};
  const auto result = write_model(*model, folder / "a.lode", {.quantize_bits = 12}, {.cancel = &cancel});
  REQUIRE_FALSE(result.ok());
  CHECK(result.error().code == ErrorCode::Cancelled);
  CHECK(slurp(folder / "a.lode") == old);
  CHECK(std::distance(std::filesystem::directory_iterator{folder}, {}) == 1);
}

TEST_CASE("a folder that is not there and a disk that is full are errors, and the old file stays") {
  const auto folder = scratch_folder("lode-none");
  const Model model = rich_model();
  CHECK_FALSE(write_model(*model, folder / "no" / "a.lode").ok());
  const auto missing = read_model(folder / "a.lode");
  REQUIRE_FALSE(missing.ok());
  CHECK(missing.error().code == ErrorCode::NotFound);

  const Bytes old = written(*model, folder / "a.lode");
  // A limit on the size of files fails a write as a full disk does.
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  const rlimit small{.rlim_cur = 1000, .rlim_max = before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
  const auto full = write_model(*model, folder / "a.lode");
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &before) == 0);
  std::signal(SIGXFSZ, handler);
  REQUIRE_FALSE(full.ok());
  CHECK(full.error().code == ErrorCode::Unreadable);
  CHECK(slurp(folder / "a.lode") == old);
}

// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "data.h"
#include "shapes.h"
#include "support.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

// Reads prefixes of many lengths; each is one clear error or a model equal to some level of the whole one.
void check_prefixes(const Model& model, const std::filesystem::path& file, std::size_t step, const Model& whole) {
  const Bytes bytes = slurp(file);
  Level last = 0;
  bool found_base = false;
  for (std::size_t size = step; size <= bytes.size(); size += step) {
    INFO("prefix of " << size << " of " << bytes.size());
    const auto part = read_model(file, {.max_bytes = size});
    if (!part.ok()) {
      CHECK_FALSE(found_base);
      CHECK_FALSE(part.error().message.empty());
      continue;
    }
    found_base = true;
    const Level level = part.value()->record_count();
    CHECK(level >= last);
    if (level == last && level != 0) continue;
    last = level;
    CHECK(same_mesh(part.value()->extract(level), whole->extract(level)));
    CHECK(part.value()->error_m(level) == whole->error_m(level));
    CHECK(same_mesh(part.value()->extract(level / 2), whole->extract(level / 2)));
  }
  CHECK(found_base);
  CHECK(read_model(file).value()->record_count() == model->record_count());
}

}  // namespace

TEST_CASE("any prefix of a file is a level of the whole model or one clear error") {
  const auto file = scratch_folder("lode-prefix") / "a.lode";
  SECTION("with seams, materials, features and all attributes") {
    const Model model = rich_model();
    (void)written(*model, file);
    check_prefixes(model, file, 97, model);
  }
  SECTION("with many blocks") {
    const Model model = build(sphere(90, 120), Placement::Subset);
    (void)written(*model, file);
    check_prefixes(model, file, 1013, model);
  }
  SECTION("on a grid") {
    const Model model = build(sphere(60, 80), Placement::Optimal);
    (void)written(*model, file, {.quantize_bits = 12});
    check_prefixes(model, file, 499, read_model(file).value());
  }
}

TEST_CASE("a file that was cut short reads as a coarser model with a warning") {
  const auto folder = scratch_folder("lode-cut");
  const Model model = build(sphere(60, 80), Placement::Subset);
  Bytes bytes = written(*model, folder / "a.lode");
  bytes.resize(bytes.size() * 3 / 4);
  spill(folder / "cut.lode", bytes);
  const auto cut = read_model(folder / "cut.lode");
  REQUIRE(cut.ok());
  CHECK(cut.value()->record_count() < model->record_count());
  CHECK(cut.value()->record_count() > 0);
  CHECK(cut.warnings().size() == 1);
}

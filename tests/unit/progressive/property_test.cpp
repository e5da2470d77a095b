// SPDX-License-Identifier: MIT
#include <rapidcheck.h>

#include <catch2/catch.hpp>

#include "drawn.h"
#include "producer.h"
#include "shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

Mesh any_mesh() {
  auto families = mesh_families();
  return std::move(families[*rc::gen::inRange<std::size_t>(0, families.size())].mesh);
}

double any_share() { return 0.1 * *rc::gen::inRange(0, 11); }

std::shared_ptr<const ProgressiveModel> any_model(const Mesh& source) {
  ProducerOptions options;
  options.seed = *rc::gen::arbitrary<std::uint64_t>();
  options.keep_ratio = any_share();
  options.move_share = any_share();
  options.vanish_share = 0.5 * any_share();
  options.nudge_share = 0.5 * any_share();
  options.records = *rc::gen::inRange(0U, 400U);
  return random_model(source, options);
}

}  // namespace

TEST_CASE("Any stack of edits is exact, monotone, consistent and ends in its source") {
  CHECK(rc::check([] {
    const Mesh source = any_mesh();
    const auto model = any_model(source);
    RC_ASSERT(validate(*model).fault == "");
    RC_ASSERT(compare_with_source(*model, source) == "");
  }));
}

TEST_CASE("Any walk of a cursor ends with the bytes of the level it stands at") {
  CHECK(rc::check([] {
    const Mesh source = any_mesh();
    const auto model = any_model(source);
    const Motion motion = *rc::gen::element(Motion::Morph, Motion::Hard, Motion::MorphFade);
    Cursor cursor{model, {.motion = motion, .morph_seconds = 0.2}};
    const auto steps = *rc::gen::inRange(1, 40);
    for (int i = 0; i < steps; ++i) {
      if (*rc::gen::inRange(0, 3) == 0) {
        cursor.set_target(Target::level(*rc::gen::inRange(0U, model->record_count() + 1)));
      }
      cursor.step({.max_records = *rc::gen::inRange(0U, 200U)}, 0.01 * *rc::gen::inRange(0, 15));
      RC_ASSERT(cursor.vertex_count() == model->info(cursor.level()).vertices);
      RC_ASSERT(cursor.triangle_count() == model->info(cursor.level()).triangles);
    }
    while (!cursor.step({}, 0.05).arrived) {
    }
    RC_ASSERT(cursor.level() == cursor.target_level());
    const Cursor fresh{model, {.motion = Motion::Hard, .start_level = cursor.level()}};
    RC_ASSERT(bytes_in_use(cursor) == bytes_in_use(fresh));
  }));
}

// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "drawn.h"
#include "producer.h"
#include "shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

// Records whose faces have no area in the end, on surfaces with and without seams, with and without moves.
std::vector<std::shared_ptr<const ProgressiveModel>> collapses() {
  return {random_model(sphere(14, 20), {.seed = 1, .keep_ratio = 0.05}),
          random_model(sphere(14, 20), {.seed = 2, .keep_ratio = 0.05, .move_share = 0.6}),
          random_model(seamed_grid(14, 12), {.seed = 3, .keep_ratio = 0.05, .move_share = 0.3}),
          random_model(fins(5), {.seed = 4, .keep_ratio = 0.1, .move_share = 0.3})};
}

// Some of these records take faces away that still have an area: these fade.
std::vector<std::shared_ptr<const ProgressiveModel>> with_vanishing() {
  return {random_model(sphere(14, 20), {.seed = 8, .keep_ratio = 0.05, .vanish_share = 0.2}),
          random_model(seamed_grid(14, 12), {.seed = 9, .keep_ratio = 0.05, .move_share = 0.3, .vanish_share = 0.3}),
          random_model(fins(5), {.seed = 10, .keep_ratio = 0.1, .move_share = 0.3, .vanish_share = 0.1})};
}

// What is to be seen: one picture, or two and the share of the second.
struct Seen {
  explicit Seen(const Cursor& cursor) : first(drawn_faces(cursor)), share(cursor.fade()) {
    if (share > 0.0F) second = drawn_faces(*cursor.beside());
  }
  DrawnFaces first, second;
  float share = 0.0F;
};

double area(const DrawnFaces& drawn, std::size_t face) {
  const glm::vec3* p = &drawn.positions[3 * face];
  return 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
}

// How far any corner of a face drawn in both is apart, and the largest area of a face drawn in one only.
struct Difference {
  double moved_m = 0.0;
  double area_m2 = 0.0;
};
Difference difference(const DrawnFaces& a, const DrawnFaces& b) {
  Difference d;
  for (std::size_t f = 0; f < a.in_use.size(); ++f) {
    if (a.in_use[f] && b.in_use[f]) {
      for (std::size_t c = 3 * f; c < 3 * f + 3; ++c) {
        d.moved_m = std::max<double>(d.moved_m, glm::distance(a.positions[c], b.positions[c]));
      }
    } else if (a.in_use[f] || b.in_use[f]) {
      d.area_m2 = std::max(d.area_m2, area(a.in_use[f] ? a : b, f));
    }
  }
  return d;
}

// The most that any face changes in: how far its corners are apart, and its area if it is drawn in one only, by its
// share of what is seen.
Difference difference(const Seen& a, const Seen& b) {
  Difference worst;
  const auto add = [&worst](const DrawnFaces& p, const DrawnFaces& q, float share) {
    const Difference d = difference(p, q);
    worst.moved_m = std::max(worst.moved_m, share * d.moved_m);
    worst.area_m2 = std::max(worst.area_m2, share * d.area_m2);
  };
  const DrawnFaces& a_second = a.share > 0.0F ? a.second : a.first;
  const DrawnFaces& b_second = b.share > 0.0F ? b.second : b.first;
  add(a.first, b.first, std::min(1.0F - a.share, 1.0F - b.share));
  add(a_second, b_second, std::min(a.share, b.share));
  // What one shows more of its second picture than the other is exchanged.
  if (a.share > b.share) add(a_second, b.first, a.share - b.share);
  if (b.share > a.share) add(a.first, b_second, b.share - a.share);
  return worst;
}

}  // namespace

TEST_CASE("Refining changes the topology where it cannot be seen") {
  for (const auto& model : collapses()) {
    Cursor cursor{model, {.morph_seconds = 0.5}};
    for (const double ratio : {0.2, 0.5, 1.0}) {
      const DrawnFaces before = drawn_faces(cursor);
      cursor.set_target(Target::ratio(ratio));
      const StepResult started = cursor.step({}, 0.0);
      CHECK(started.records_moved > 0);
      const Difference d = difference(before, drawn_faces(cursor));
      CHECK(d.moved_m < 1e-5);
      CHECK(d.area_m2 < 1e-6);
      while (!cursor.step({}, 0.1).arrived) {
      }
    }
  }
}

TEST_CASE("Coarsening changes the topology where it cannot be seen") {
  for (const auto& model : collapses()) {
    Cursor cursor{model, {.morph_seconds = 0.5, .start_level = model->record_count()}};
    for (const double ratio : {0.7, 0.3, 0.0}) {
      cursor.set_target(Target::ratio(ratio));
      CHECK(cursor.step({}, 0.5 * (1.0 - 1e-4)).records_moved == 0);
      const DrawnFaces before = drawn_faces(cursor);
      const StepResult landed = cursor.step({}, 0.01);
      CHECK(landed.arrived);
      CHECK(landed.records_moved > 0);
      const Difference d = difference(before, drawn_faces(cursor));
      CHECK(d.moved_m < 1e-5);
      CHECK(d.area_m2 < 1e-5);
    }
  }
}

TEST_CASE("No step moves a corner further than its time allows, however the target jumps about") {
  std::mt19937 random{5};
  for (const auto& model : collapses()) {
    constexpr double morph_seconds = 0.5;
    constexpr double dt_s = 0.001;
    Cursor cursor{model, {.morph_seconds = morph_seconds}};
    DrawnFaces before = drawn_faces(cursor);
    double worst_m = 0.0;
    for (int i = 0; i < 3000; ++i) {
      if (i % 3 == 0) cursor.set_target(Target::level(static_cast<Level>(random() % (model->record_count() + 1))));
      if (i % 700 == 699) cursor.set_target(Target::level(i % 1400 == 699 ? 0 : model->record_count()));
      cursor.step({.max_records = 5}, dt_s);
      DrawnFaces now = drawn_faces(cursor);
      worst_m = std::max(worst_m, difference(before, now).moved_m);
      before = std::move(now);
    }
    // At most the model's size in each step of a chain of merges, at the greatest speed of the smooth motion (1.5).
    const double fair_m = 1.5 * dt_s / morph_seconds * model->bounds().diagonal_m();
    CHECK(worst_m < 8.0 * fair_m);
    CHECK(worst_m > 0.0);
  }
}

TEST_CASE("Turning back in mid-flight is seamless and ends where it came from, bit for bit") {
  for (const auto& model : collapses()) {
    for (const bool refining : {false, true}) {
      const Level from = refining ? 0 : model->record_count();
      Cursor cursor{model, {.morph_seconds = 0.4, .start_level = from}};
      const auto bytes = bytes_in_use(cursor);
      cursor.set_target(Target::level(model->record_count() / 2));
      for (int i = 0; i < 7; ++i) cursor.step({.max_records = 20}, 0.03);
      REQUIRE(cursor.morphing());
      const DrawnFaces before = drawn_faces(cursor);
      cursor.set_target(Target::level(from));
      cursor.step({.max_records = 0}, 0.0);
      CHECK(difference(before, drawn_faces(cursor)).moved_m < 1e-6);
      while (!cursor.step({}, 0.03).arrived) {
      }
      CHECK(cursor.level() == from);
      CHECK(bytes_in_use(cursor) == bytes);
    }
  }
}

TEST_CASE("Every record ends within morph_seconds, and a sweep keeps a bounded number on their way") {
  const auto model = random_model(sphere(30, 40), {.seed = 6, .keep_ratio = 0.02});
  constexpr double morph_seconds = 0.35;
  constexpr double dt_s = 1.0 / 60.0;
  Cursor cursor{model, {.morph_seconds = morph_seconds}};
  cursor.set_target(Target::ratio(1.0));
  double time_s = 0.0;
  while (!cursor.step({}, dt_s).arrived) time_s += dt_s;
  CHECK(time_s <= morph_seconds + dt_s);
  for (int frame = 0; frame < 300; ++frame) {
    const Level target = model->record_count() - model->record_count() * static_cast<Level>(frame) / 300;
    cursor.set_target(Target::level(target));
    cursor.step({}, dt_s);
    CHECK(cursor.level() - target <= model->record_count() * 24 / 300 + 1);
    CHECK(cursor.error_m() == model->error_m(target));
  }
}

TEST_CASE("Normals, uvs and colours move together with positions") {
  Mesh source = seamed_grid(14, 12);
  for (VertexId v = 0; v < source.vertex_count(); ++v) {
    source.vertices.normals.push_back(glm::normalize(glm::vec3{0.3F * std::sin(static_cast<float>(v)), 0.2F, 1.0F}));
    source.vertices.colors.emplace_back(v * 37 % 256, v * 11 % 256, 128, 255);
  }
  const auto model = random_model(source, {.seed = 7, .keep_ratio = 0.1, .move_share = 0.5});
  Cursor cursor{model, {.morph_seconds = 1.0, .start_level = model->record_count()}};
  const VertexArrays fine{{cursor.positions().begin(), cursor.positions().end()},
                          {cursor.normals().begin(), cursor.normals().end()},
                          {cursor.uvs().begin(), cursor.uvs().end()},
                          {cursor.colors().begin(), cursor.colors().end()}};
  cursor.set_target(Target::level(0));
  cursor.step({}, 0.5);
  std::size_t positions = 0;
  std::size_t normals = 0;
  std::size_t uvs = 0;
  std::size_t colors = 0;
  for (VertexId v = model->data().base_vertex_count; v < model->vertex_slot_count(); ++v) {
    positions += cursor.positions()[v] != fine.positions[v] ? 1 : 0;
    normals += cursor.normals()[v] != fine.normals[v] ? 1 : 0;
    uvs += cursor.uvs()[v] != fine.uvs[v] ? 1 : 0;
    colors += cursor.colors()[v] != fine.colors[v] ? 1 : 0;
    CHECK(glm::length(cursor.normals()[v]) == Approx(1.0F).margin(1e-4));
  }
  const std::size_t removed = model->vertex_slot_count() - model->data().base_vertex_count;
  CHECK(positions > removed * 9 / 10);
  CHECK(normals > removed * 9 / 10);
  CHECK(uvs > removed * 9 / 10);
  CHECK(colors > removed * 9 / 10);
}

TEST_CASE("Half way, a vertex is half way to where it merges, a moved one half way through its move") {
  Mesh source = grid(2, 1, 0.0F);
  source.vertices.uvs.clear();
  // Vertex 1 (0.5, 0) goes to vertex 0 (0, 0), which moves to (0, -1).
  progressive::EditLog log{3};
  log.begin(1.0F);
  log.remove_vertex(1, 0);
  std::vector<CornerId> corners;
  for (FaceId f = 0; f < 4; ++f) {
    const VertexId* v = &source.indices[3 * f];
    const bool has_0 = std::count(v, v + 3, 0U) > 0;
    const bool has_1 = std::count(v, v + 3, 1U) > 0;
    if (has_0 && has_1) log.remove_face(f);
    for (std::uint32_t c = 0; c < 3; ++c) {
      if (v[c] == 1 && !has_0) log.repoint(3 * f + c, 0);
    }
  }
  const float place[3] = {0.0F, -1.0F, 0.0F};
  std::uint32_t words[3];
  std::memcpy(words, place, sizeof(place));
  log.move_vertex(0, words);
  log.end();
  const auto model = ProgressiveModel::from_data(progressive::record(source, std::move(log), "test"));
  REQUIRE(model);
  Cursor cursor{*model, {.morph_seconds = 1.0, .start_level = 1}};
  cursor.set_target(Target::level(0));
  cursor.step({}, 0.5);
  const VertexId gone = (*model)->vertex_slot_count() - 1;
  CHECK(cursor.positions()[0].y == Approx(-0.5F));
  CHECK(cursor.positions()[gone].x == Approx(0.25F));
  CHECK(cursor.positions()[gone].y == Approx(-0.25F));
}

TEST_CASE("What edge collapses do never fades, and moves as without") {
  for (const auto& model : collapses()) {
    Cursor plain{model, {.morph_seconds = 0.2}};
    Cursor fading{model, {.motion = Motion::MorphFade, .morph_seconds = 0.2}};
    for (int i = 0; i < 60; ++i) {
      const Target target = Target::ratio(i % 20 < 10 ? 0.9 : 0.1);
      for (Cursor* cursor : {&plain, &fading}) {
        cursor->set_target(target);
        cursor->step({.max_records = 40}, 0.016);
      }
      CHECK(fading.fade() == 0.0F);
      CHECK(bytes_in_use(fading) == bytes_in_use(plain));
    }
  }
}

TEST_CASE("Faces that are drawn anew fade: no step changes more of the picture than its time") {
  constexpr double dt_s = 0.002;
  constexpr double seconds = 0.2;
  std::mt19937 random{11};
  for (const auto& model : with_vanishing()) {
    Cursor cursor{model, {.motion = Motion::MorphFade, .morph_seconds = seconds}};
    const double size_m = model->bounds().diagonal_m();
    double most_m2 = 0.0;
    std::uint32_t faded = 0;
    Seen before{cursor};
    for (int i = 0; i < 2000; ++i) {
      if (i % 130 == 0) cursor.set_target(Target::level(static_cast<Level>(random() % (model->record_count() + 1))));
      cursor.step({.max_records = 400}, dt_s);
      Seen now{cursor};
      const Difference d = difference(before, now);
      CHECK(d.moved_m < 8.0 * 1.5 * dt_s / seconds * size_m);
      most_m2 = std::max(most_m2, d.area_m2);
      faded += now.share > 0.0F ? 1 : 0;
      before = std::move(now);
    }
    CHECK(faded > 100);
    // The faces that vanish have more than a hundred times that.
    CHECK(most_m2 < 0.012 * size_m * size_m);
  }
}

TEST_CASE("What fades begins as the picture before and ends as the picture after") {
  for (const auto& model : with_vanishing()) {
    for (const bool refining : {false, true}) {
      const Level from = refining ? 0 : model->record_count();
      Cursor cursor{model, {.motion = Motion::MorphFade, .morph_seconds = 0.5, .start_level = from}};
      const DrawnFaces at_rest = drawn_faces(cursor);
      cursor.set_target(Target::level(model->record_count() - from));
      cursor.step({}, 1e-6);
      REQUIRE(cursor.morphing());
      CHECK(cursor.fade() == Approx(refining ? 1.0F : 0.0F).margin(1e-4));
      const Difference began = difference(at_rest, refining ? drawn_faces(*cursor.beside()) : drawn_faces(cursor));
      CHECK(began.moved_m < 1e-3);
      CHECK(began.area_m2 == 0.0);
      cursor.step({}, 0.5 - 1e-4);
      CHECK(cursor.fade() == Approx(refining ? 0.0F : 1.0F).margin(1e-3));
      const DrawnFaces nearly = refining ? drawn_faces(cursor) : drawn_faces(*cursor.beside());
      CHECK(cursor.step({}, 0.01).arrived);
      CHECK(cursor.fade() == 0.0F);
      const Difference ended = difference(nearly, drawn_faces(cursor));
      CHECK(ended.moved_m < 1e-3);
      CHECK(ended.area_m2 == 0.0);
    }
  }
}

TEST_CASE("A target within what fades is reached from its finer end") {
  const auto model = with_vanishing().front();
  Cursor cursor{model, {.motion = Motion::MorphFade, .start_level = model->record_count()}};
  cursor.set_target(Target::level(0));
  for (int i = 0; i < 5; ++i) cursor.step({}, 0.02);
  REQUIRE(cursor.fade() > 0.0F);
  const Level middle = model->record_count() / 2;
  cursor.set_target(Target::level(middle));
  float share = cursor.fade();
  while (cursor.fade() > 0.0F && cursor.level() == model->record_count()) {
    cursor.step({}, 0.02);
    CHECK(cursor.fade() <= share);
    share = cursor.fade();
  }
  while (!cursor.step({}, 0.02).arrived) {
  }
  CHECK(cursor.level() == middle);
}

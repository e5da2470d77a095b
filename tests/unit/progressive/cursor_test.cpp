// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <random>

#include "allocations.h"
#include "drawn.h"
#include "producer.h"
#include "shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

std::vector<std::byte> bytes_at(const std::shared_ptr<const ProgressiveModel>& model, Level level) {
  return bytes_in_use(Cursor{model, {.motion = Motion::Hard, .start_level = level}});
}

std::vector<std::shared_ptr<const ProgressiveModel>> models() {
  std::vector<std::shared_ptr<const ProgressiveModel>> all;
  for (const NamedMesh& family : mesh_families()) {
    all.push_back(random_model(family.mesh, {.seed = 1, .keep_ratio = 0.0}));
    all.push_back(random_model(
        family.mesh, {.seed = 2, .keep_ratio = 0.05, .move_share = 0.4, .vanish_share = 0.1, .nudge_share = 0.1}));
  }
  return all;
}

// A copy of a cursor's arrays that follows it by dirty ranges alone.
class Follower {
 public:
  explicit Follower(const Cursor& cursor) : cursor_(cursor) {
    positions_.resize(cursor.positions().size());
    normals_.resize(cursor.normals().size());
    uvs_.resize(cursor.uvs().size());
    colors_.resize(cursor.colors().size());
    indices_.resize(cursor.indices().size());
  }

  void follow() {
    CHECK(sorted_and_disjoint(cursor_.dirty_vertices(), cursor_.model().vertex_slot_count()));
    CHECK(sorted_and_disjoint(cursor_.dirty_indices(), 3 * cursor_.model().face_slot_count()));
    for (const Range range : cursor_.dirty_vertices()) {
      copy(cursor_.positions(), positions_, range, 1);
      copy(cursor_.normals(), normals_, range, 1);
      copy(cursor_.uvs(), uvs_, range, 1);
      copy(cursor_.colors(), colors_, range, 1);
    }
    for (const Range range : cursor_.dirty_indices()) copy(cursor_.indices(), indices_, range, cursor_.index_bytes());
  }

  [[nodiscard]] bool same() const {
    return equal(cursor_.positions(), positions_) && equal(cursor_.normals(), normals_) && equal(cursor_.uvs(), uvs_) &&
           equal(cursor_.colors(), colors_) && equal(cursor_.indices(), indices_);
  }

 private:
  static bool sorted_and_disjoint(std::span<const Range> ranges, std::uint32_t size) {
    std::uint32_t end = 0;
    bool first = true;
    for (const Range range : ranges) {
      if (range.empty() || range.end > size || (!first && range.begin <= end)) return false;
      end = range.end;
      first = false;
    }
    return true;
  }
  template <class T>
  static void copy(std::span<const T> from, std::vector<T>& to, Range range, std::size_t width) {
    if (from.empty()) return;
    std::copy(from.begin() + static_cast<std::ptrdiff_t>(range.begin * width),
              from.begin() + static_cast<std::ptrdiff_t>(range.end * width),
              to.begin() + static_cast<std::ptrdiff_t>(range.begin * width));
  }
  template <class T>
  static bool equal(std::span<const T> a, const std::vector<T>& b) {
    return a.size() == b.size() && (b.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
  }

  const Cursor& cursor_;
  std::vector<glm::vec3> positions_, normals_;
  std::vector<glm::vec2> uvs_;
  std::vector<glm::u8vec4> colors_;
  std::vector<std::byte> indices_;
};

}  // namespace

TEST_CASE("Whatever way a cursor took to a level, its bytes are those of that level") {
  std::mt19937 random{11};
  for (const auto& model : models()) {
    Cursor hard{model, {.motion = Motion::Hard}};
    Cursor gliding{model, {.motion = Motion::Morph, .morph_seconds = 0.1}};
    for (int seek = 0; seek < 20; ++seek) {
      const auto level = static_cast<Level>(random() % (model->record_count() + 1));
      const auto expected = bytes_at(model, level);
      hard.set_target(Target::level(level));
      while (!hard.step({.max_records = 1 + static_cast<std::uint32_t>(random() % 97)}, 0.01).arrived) {
      }
      CHECK(hard.level() == level);
      CHECK(bytes_in_use(hard) == expected);
      gliding.set_target(Target::level(level));
      for (int i = 0; i < seek % 5; ++i) gliding.step({.max_records = 40}, 0.03);
      if (seek % 3 == 0) gliding.set_target(Target::level(static_cast<Level>(random() % (model->record_count() + 1))));
      gliding.step({}, 0.02);
      gliding.set_target(Target::level(level));
      if (seek % 4 == 0) gliding.jump(level);
      while (!gliding.step({.max_records = 300}, 0.03).arrived) {
      }
      CHECK(gliding.level() == level);
      CHECK_FALSE(gliding.morphing());
      CHECK(bytes_in_use(gliding) == expected);
    }
  }
}

TEST_CASE("Dirty ranges cover every changed byte") {
  std::mt19937 random{12};
  for (const auto& model : models()) {
    for (const Motion motion : {Motion::Hard, Motion::Morph, Motion::MorphFade}) {
      Cursor cursor{model, {.motion = motion, .morph_seconds = 0.2, .dirty_block = 64}};
      Follower follower{cursor};
      follower.follow();
      CHECK(follower.same());
      cursor.clear_dirty();
      CHECK(cursor.dirty_vertices().empty());
      CHECK(cursor.dirty_indices().empty());
      for (int i = 0; i < 60; ++i) {
        if (i % 7 == 0) cursor.set_target(Target::ratio(0.01 * static_cast<double>(random() % 101)));
        if (i % 23 == 22) cursor.jump(static_cast<Level>(random() % (model->record_count() + 1)));
        const StepResult result = cursor.step({.max_records = static_cast<std::uint32_t>(random() % 60)}, 0.03);
        if (!cursor.dirty_indices().empty() && i % 23 != 22) CHECK(result.changed);
        follower.follow();
        CHECK(follower.same());
        cursor.clear_dirty();
      }
    }
  }
}

TEST_CASE("The drawn triangles equal those of extract at that level") {
  for (const auto& model : models()) {
    Cursor cursor{model, {.motion = Motion::Morph, .morph_seconds = 0.0}};
    for (std::uint32_t stop = 0; stop <= 6; ++stop) {
      const Level level = model->record_count() / 6 * stop;
      cursor.set_target(Target::level(level));
      cursor.step({}, 0.0);
      REQUIRE(cursor.level() == level);
      const Mesh mesh = model->extract(level);
      REQUIRE(validate(mesh));
      REQUIRE(mesh.triangle_count() == cursor.triangle_count());
      std::size_t face = 0;
      for (const DrawRange& draw : cursor.draws()) {
        for (CornerId c = draw.first_index; c < draw.first_index + draw.index_count; ++c) {
          const VertexId drawn = cursor.index(c);
          const VertexId taken = mesh.indices[3 * face + c % 3];
          CHECK(cursor.positions()[drawn] == mesh.vertices.positions[taken]);
          if (!cursor.uvs().empty()) CHECK(cursor.uvs()[drawn] == mesh.vertices.uvs[taken]);
          if (c % 3 == 2) CHECK(mesh.face_material(static_cast<FaceId>(face++)) == draw.material);
        }
      }
    }
  }
}

TEST_CASE("A cursor allocates once, at construction, and never again") {
  const auto model =
      random_model(seamed_grid(40, 40), {.seed = 3, .keep_ratio = 0.02, .move_share = 0.3, .vanish_share = 0.1});
  for (const Motion motion : {Motion::Hard, Motion::Morph, Motion::MorphFade}) {
    const std::size_t before = allocation_count();
    Cursor cursor{model, {.motion = motion}};
    const std::size_t built = allocation_count();
    std::size_t ranges = 0;
    for (int i = 0; i < 200; ++i) {
      cursor.set_target(Target::ratio(i % 40 < 20 ? 0.1 : 0.9));
      cursor.step({.max_records = 37}, 0.016);
      ranges += cursor.dirty_vertices().size() + cursor.dirty_indices().size() + cursor.draws().size();
      cursor.clear_dirty();
      if (cursor.beside() != nullptr) {
        ranges += cursor.beside()->dirty_indices().size();
        cursor.beside()->clear_dirty();
      }
      if (i == 100) cursor.jump(3);
    }
    const std::size_t after = allocation_count();
    // A second cursor and its block where something can fade. Not earlier: the check itself allocates.
    CHECK(built - before == (motion == Motion::MorphFade ? 3 : 1));
    CHECK(after == built);
    CHECK(ranges > 0);
  }
}

TEST_CASE("A hard cursor over records that move nothing shares the model's vertices") {
  const Mesh source = sphere(20, 30);
  const auto still = random_model(source, {.seed = 4});
  const Cursor sharing{still, {.motion = Motion::Hard}};
  CHECK(sharing.positions().data() == still->data().vertices.positions.data());
  const auto moving = random_model(source, {.seed = 4, .move_share = 0.5});
  const Cursor own{moving, {.motion = Motion::Hard}};
  CHECK(own.positions().data() != moving->data().vertices.positions.data());
  CHECK(own.memory_bytes() > sharing.memory_bytes() + 24 * source.vertex_count());
}

TEST_CASE("16-bit and 32-bit indices hold the same numbers; models of more than 65,536 vertices get 32 bits") {
  const auto small = random_model(grid(50, 40), {.seed = 5, .vanish_share = 0.1});
  Cursor narrow{small, {.motion = Motion::Hard}};
  Cursor wide{small, {.motion = Motion::Hard, .index_width = IndexWidth::Bits32}};
  CHECK(narrow.index_bytes() == 2);
  CHECK(wide.index_bytes() == 4);
  for (const Level level : {small->record_count(), small->record_count() / 3, Level{0}, small->record_count() / 2}) {
    narrow.jump(level);
    wide.jump(level);
    for (const DrawRange& draw : wide.draws()) {
      for (CornerId c = draw.first_index; c < draw.first_index + draw.index_count; ++c) {
        REQUIRE(narrow.index(c) == wide.index(c));
      }
    }
  }
  const auto at_limit = random_model(grid(255, 255), {.seed = 6, .records = 20});
  REQUIRE(at_limit->vertex_slot_count() == 65'536);
  CHECK(Cursor{at_limit, {.motion = Motion::Hard}}.index_bytes() == 2);
  CHECK(validate(*at_limit).fault == "");
  const auto above = random_model(grid(256, 255), {.seed = 6, .records = 20});
  CHECK(Cursor{above, {.motion = Motion::Hard}}.index_bytes() == 4);
}

TEST_CASE("Targets by triangles, ratio, metres and pixels choose the level they describe") {
  const auto model = random_model(grid(40, 40), {.seed = 7});
  Cursor cursor{model, {.motion = Motion::Hard}};
  const auto level_for = [&](const Target& target) {
    cursor.set_target(target);
    return cursor.target_level();
  };
  CHECK(level_for(Target::level(none)) == model->record_count());
  CHECK(level_for(Target::triangles(1000)) == model->level_of_triangles(1000));
  CHECK(level_for(Target::ratio(0.5)) == model->level_of_triangles((model->triangle_count() + 1) / 2));
  // A share that came out a hair too small by rounding still means the same number of triangles.
  CHECK(level_for(Target::ratio((model->triangle_count() - 1e-3) / model->triangle_count())) == model->record_count());
  CHECK(level_for(Target::ratio(1.0)) == model->record_count());
  const double middle_m = model->error_m(model->record_count() / 2);
  CHECK(level_for(Target::error_m(middle_m)) == model->level_of_error(middle_m));
  CHECK(level_for(Target::error_m(std::nan(""))) == model->level_of_error(0.0));
  View view;
  view.eye = {0.5, -20.0, 0.0};
  const Sphere sphere{model->bounds().center(), 0.5 * model->bounds().diagonal_m()};
  const Level found = level_for(Target::pixels(view, 2.0));
  CHECK(error_px(view, model->error_m(found), sphere) <= 2.0 * 1.15);
}

TEST_CASE("A target in pixels stays while the camera moves a little, and follows when it moves far") {
  const auto model = random_model(grid(40, 40), {.seed = 8});
  Cursor cursor{model, {.motion = Motion::Hard}};
  View view;
  const double limit_px = 2.0;
  const Sphere sphere{model->bounds().center(), 0.5 * model->bounds().diagonal_m()};
  const double distance_m = model->error_m(model->record_count() / 2) * focal_px(view) / limit_px;
  const auto at = [&](double factor) {
    view.eye = sphere.center - glm::dvec3{0.0, distance_m * factor + sphere.radius_m, 0.0};
    cursor.set_target(Target::pixels(view, limit_px));
    return cursor.target_level();
  };
  const Level start = at(1.0);
  CHECK(at(1.05) == start);
  CHECK(at(0.95) == start);
  CHECK(at(4.0) < start);
  CHECK(at(0.25) > start);
}

TEST_CASE("Many cursors share one model") {
  const auto model = random_model(sphere(20, 30), {.seed = 9, .move_share = 0.5});
  std::vector<Cursor> cursors;
  for (Level i = 0; i < 20; ++i) {
    cursors.emplace_back(model, CursorOptions{.start_level = model->record_count() * i / 20});
  }
  for (Level i = 0; i < 20; ++i) {
    CHECK(bytes_in_use(cursors[i]) == bytes_at(model, model->record_count() * i / 20));
  }
}

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>
#include <vector>

#include <lodestone/cursor.h>
#include <lodestone/progressive_model.h>

#include "base/hash.h"
#include "progressive/stack.h"

namespace lodestone {
namespace {

// Levels at which the whole state is looked at; all records are played between them.
constexpr std::uint32_t stops = 48;

// Over 32-bit words: tells apart states, not adversaries.
class Hash {
 public:
  void add(std::uint32_t word) noexcept { value_ = hash_combine(value_, word); }
  template <class T>
  void add_all(std::span<const T> array, std::size_t count) noexcept {
    const auto* words = reinterpret_cast<const unsigned char*>(array.data());
    for (std::size_t i = 0; i + 4 <= std::min(count, array.size()) * sizeof(T); i += 4) {
      add(static_cast<std::uint32_t>(words[i]) | static_cast<std::uint32_t>(words[i + 1]) << 8U |
          static_cast<std::uint32_t>(words[i + 2]) << 16U | static_cast<std::uint32_t>(words[i + 3]) << 24U);
    }
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0;
};

std::uint64_t hash_in_use(const Cursor& cursor) {
  Hash hash;
  const std::uint32_t vertices = cursor.vertex_count();
  hash.add(vertices);
  hash.add_all(cursor.positions(), vertices);
  hash.add_all(cursor.normals(), vertices);
  hash.add_all(cursor.uvs(), vertices);
  hash.add_all(cursor.colors(), vertices);
  for (const DrawRange& draw : cursor.draws()) {
    hash.add(draw.index_count);
    for (CornerId c = draw.first_index; c < draw.first_index + draw.index_count; ++c) hash.add(cursor.index(c));
  }
  return hash.value();
}

// What is wrong with the in-use flags at the cursor's level, empty if nothing.
std::string in_use_fault(const Cursor& cursor) {
  const ProgressiveModel& model = cursor.model();
  const std::string at = " at level " + std::to_string(cursor.level());
  const LevelInfo info = model.info(cursor.level());
  if (info.vertices != cursor.vertex_count() || info.triangles != cursor.triangle_count()) return "counts differ" + at;
  std::uint32_t triangles = 0;
  for (const DrawRange& draw : cursor.draws()) {
    triangles += draw.index_count / 3;
    const FaceId begin = model.data().face_begin[draw.material];
    for (FaceId f = begin; f < model.data().face_begin[draw.material + 1]; ++f) {
      const bool in_prefix = 3 * (f - begin) < draw.index_count;
      if (cursor.face_in_use(f) != in_prefix) return "faces in use are no prefix" + at;
      if (!in_prefix) continue;
      for (CornerId c = 3 * f; c < 3 * f + 3; ++c) {
        if (!cursor.vertex_in_use(cursor.index(c))) return "a face in use names a vertex that is not" + at;
      }
    }
  }
  return triangles == cursor.triangle_count() ? std::string{} : "face counts differ" + at;
}

std::string monotone_fault(const ProgressiveModel& model) {
  const auto& errors = model.data().errors;
  for (std::size_t i = 1; i < errors.size(); ++i) {
    if (errors[i].error_m > errors[i - 1].error_m) {
      return "the error grows at level " + std::to_string(errors[i].level);
    }
  }
  progressive::StackPosition at;
  const std::uint32_t words = model.data().value_words();
  at.triangles = model.info(0).triangles;
  while (at.level < model.record_count()) {
    const std::uint32_t before = at.triangles;
    progressive::walk_up(model.data(), at, words);
    if (at.triangles < before) return "triangles decrease at level " + std::to_string(at.level);
  }
  return at.triangles == model.triangle_count() ? std::string{} : "the triangles do not add up";
}

}  // namespace

ModelReport validate(const ProgressiveModel& model) {
  ModelReport report;
  report.records = model.record_count();
  const auto note = [&](const std::string& fault) {
    if (report.fault.empty()) report.fault = fault;
    return fault.empty();
  };
  report.monotone = note(monotone_fault(model));
  report.in_use_consistent = true;
  report.exact = true;

  const std::shared_ptr<const ProgressiveModel> self{std::shared_ptr<const ProgressiveModel>{}, &model};  // not owned
  Cursor cursor{self, {.motion = Motion::Hard}};
  const std::uint32_t last = std::min(stops, report.records);
  const auto level_of = [&](std::uint32_t stop) {
    return last == 0 ? 0 : static_cast<Level>(static_cast<std::uint64_t>(report.records) * stop / last);
  };
  std::vector<std::uint64_t> hashes;
  for (std::uint32_t stop = 0; stop <= last; ++stop) {
    cursor.jump(level_of(stop));
    hashes.push_back(hash_in_use(cursor));
    report.in_use_consistent = note(in_use_fault(cursor)) && report.in_use_consistent;
  }
  const auto compare = [&](std::uint32_t stop) {
    cursor.jump(level_of(stop));
    const bool same = hash_in_use(cursor) == hashes[stop];
    report.exact = report.exact && same;
    if (!same) note("level " + std::to_string(cursor.level()) + " is not the same when it is come back to");
  };
  for (std::uint32_t stop = last + 1; stop-- > 0;) compare(stop);
  for (std::uint32_t stop = 0; stop <= last; ++stop) compare(stop);
  return report;
}

}  // namespace lodestone

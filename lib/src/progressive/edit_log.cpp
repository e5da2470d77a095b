// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cassert>
#include <map>
#include <set>
#include <utility>

#include "progressive/recorder.h"

namespace lodestone::progressive {

void EditLog::begin(float error_m) {
  assert(appended_.empty());
  records_.push_back({error_m, 0, 0, 0, 0});
}
void EditLog::remove_face(FaceId face) { faces_.push_back(face); }
void EditLog::remove_vertex(VertexId vertex, VertexId merges_into) { vertices_.push_back({vertex, merges_into}); }
void EditLog::repoint(CornerId corner, VertexId to) { corners_.push_back({corner, to}); }

void EditLog::move_vertex(VertexId vertex, std::span<const std::uint32_t> words) {
  assert(words.size() == value_words_);
  moved_.push_back(vertex);
  values_.insert(values_.end(), words.begin(), words.end());
}

void EditLog::end() {
  const auto size = [](const auto& array) { return static_cast<std::uint32_t>(array.size()); };
  records_.back() = {records_.back().error_m, size(faces_), size(vertices_), size(corners_), size(moved_)};
}

void EditLog::append(const EditRun& run) {
  assert(run.values.size() == run.moved.size() * value_words_);
  const auto size = [](const auto& array) { return static_cast<std::uint32_t>(array.size()); };
  const RecordEnds to{0.0F, size(faces_), size(vertices_), size(corners_), size(moved_)};
  const auto add = [](auto& array, const auto& part) { array.insert(array.end(), part.begin(), part.end()); };
  add(faces_, run.faces);
  add(vertices_, run.vertices);
  add(corners_, run.corners);
  add(moved_, run.moved);
  add(values_, run.values);
  for (const RecordEnds& r : run.records) {
    records_.push_back({r.error_m, to.faces + (r.faces - run.base.faces),
                        to.vertices + (r.vertices - run.base.vertices), to.corners + (r.corners - run.base.corners),
                        to.moves + (r.moves - run.base.moves)});
  }
  if (run.records.empty()) return;
  if (appended_.empty() || appended_.back().pass != run.pass || appended_.back().lane != run.lane) {
    appended_.push_back({{appended_.empty() ? 0 : appended_.back().records.end, 0}, run.pass, run.lane});
  }
  appended_.back().records.end = record_count();
}

std::vector<EditLog::Stretch> EditLog::stretches() const {
  constexpr std::uint32_t most_records = 16'384;
  const std::vector<Stretch> all =
      appended_.empty() ? std::vector<Stretch>{{.records = {0, record_count()}}} : appended_;
  std::vector<Stretch> cut;
  for (Stretch s : all) {
    const std::uint32_t end = s.records.end;
    for (; s.records.begin < end; s.records.begin = s.records.end) {
      s.records.end = std::min(end, s.records.begin + most_records);
      cut.push_back(s);
    }
  }
  return cut;
}

void EditLog::reserve(std::size_t records, bool moving) {
  records_.reserve(records);
  faces_.reserve(2 * records);
  vertices_.reserve(records);
  corners_.reserve(4 * records);
  if (!moving) return;
  moved_.reserve(records);
  values_.reserve(value_words_ * records);
}

bool EditLog::finite(const VertexArrays& arrays) const {
  const std::uint32_t floats = value_words_ - (arrays.colors.empty() ? 0U : 1U);  // a colour comes last
  constexpr std::uint32_t exponent = 0x7F80'0000U;
  bool all = true;
  for (std::size_t i = 0; i < values_.size(); i += value_words_) {
    for (std::size_t k = i; k < i + floats; ++k) all = all && (values_[k] & exponent) != exponent;
  }
  return all;
}

void EditLog::join_from(std::uint32_t first) {
  if (first + 1 >= record_count()) return;
  appended_.clear();
  const RecordEnds before = first == 0 ? RecordEnds{} : records_[first - 1];
  RecordEnds joined{};
  for (std::uint32_t i = first; i < record_count(); ++i) joined.error_m = std::max(joined.error_m, records_[i].error_m);

  // What is gone at the end need not have been changed on the way, and of several changes the last one counts.
  const std::set<FaceId> gone(faces_.begin() + before.faces, faces_.end());
  std::map<VertexId, VertexId> merged;
  for (std::size_t i = before.vertices; i < vertices_.size(); ++i)
    merged[vertices_[i].vertex] = vertices_[i].merges_into;
  std::map<CornerId, VertexId> corners;
  for (std::size_t i = before.corners; i < corners_.size(); ++i) corners[corners_[i].corner] = corners_[i].to;
  std::map<VertexId, std::size_t> moves;  // where the last value stands
  for (std::size_t i = before.moves; i < moved_.size(); ++i) moves[moved_[i]] = i;

  for (std::size_t i = before.vertices; i < vertices_.size(); ++i) {
    VertexId& onto = vertices_[i].merges_into;
    for (auto at = merged.find(onto); at != merged.end() && at->second != none && at->second != onto;
         at = merged.find(onto)) {
      onto = at->second;
    }
  }
  corners_.resize(before.corners);
  for (const auto& [corner, to] : corners) {
    if (!gone.contains(corner / 3)) corners_.push_back({corner, to});
  }
  const std::vector<std::uint32_t> values(values_.begin() + std::ptrdiff_t{value_words_} * before.moves, values_.end());
  moved_.resize(before.moves);
  values_.resize(std::size_t{value_words_} * before.moves);
  for (const auto& [vertex, at] : moves) {
    if (merged.contains(vertex)) continue;
    const auto from = values.begin() + std::ptrdiff_t{value_words_} * static_cast<std::ptrdiff_t>(at - before.moves);
    moved_.push_back(vertex);
    values_.insert(values_.end(), from, from + value_words_);
  }
  records_.resize(first);
  records_.push_back(joined);
  end();
}

void EditLog::merge(const EditLog& other, FaceId first_face, VertexId first_vertex, std::uint64_t most_faces_gone) {
  EditLog both{value_words_};
  const auto take = [&](const EditLog& log, std::uint32_t i, FaceId face, VertexId vertex, float error_m) {
    const RecordEnds from = i == 0 ? RecordEnds{} : log.records_[i - 1];
    const RecordEnds& to = log.records_[i];
    both.begin(error_m);
    for (std::uint32_t k = from.faces; k < to.faces; ++k) both.remove_face(face + log.faces_[k]);
    for (std::uint32_t k = from.vertices; k < to.vertices; ++k) {
      const auto [v, into] = log.vertices_[k];
      both.remove_vertex(vertex + v, into == none ? none : vertex + into);
    }
    for (std::uint32_t k = from.corners; k < to.corners; ++k) {
      both.repoint(3 * face + log.corners_[k].corner, vertex + log.corners_[k].to);
    }
    for (std::uint32_t k = from.moves; k < to.moves; ++k) {
      both.move_vertex(vertex + log.moved_[k], {&log.values_[std::size_t{k} * value_words_], value_words_});
    }
    both.end();
  };
  float mine_m = 0.0F;
  float other_m = 0.0F;
  for (std::uint32_t i = 0, k = 0; i < record_count() || k < other.record_count();) {
    if (both.faces_.size() >= most_faces_gone) break;
    const float next_mine = i < record_count() ? std::max(mine_m, records_[i].error_m) : 0.0F;
    const float next_other = k < other.record_count() ? std::max(other_m, other.records_[k].error_m) : 0.0F;
    if (k == other.record_count() || (i < record_count() && next_mine <= next_other)) {
      mine_m = next_mine;
      take(*this, i++, 0, 0, mine_m);
    } else {
      other_m = next_other;
      take(other, k++, first_face, first_vertex, other_m);
    }
  }
  *this = std::move(both);
}

}  // namespace lodestone::progressive

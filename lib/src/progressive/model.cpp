// SPDX-License-Identifier: MIT
#include <lodestone/progressive_model.h>

#include <algorithm>
#include <cassert>

#include <lodestone/cursor.h>

#include "progressive/check.h"
#include "progressive/stack.h"
#include "progressive/values.h"

namespace lodestone {

using progressive::StackPosition;

std::uint32_t ModelData::value_words() const noexcept { return progressive::value_words(vertices); }

class progressive::ModelMaker {
 public:
  static std::shared_ptr<const ProgressiveModel> make(ModelData data, const Replay& replay) {
    std::shared_ptr<ProgressiveModel> model{new ProgressiveModel};
    model->data_ = std::move(data);
    model->data_.shapes.shrink_to_fit();
    model->data_.fan_corners.shrink_to_fit();
    model->data_.fan_materials.shrink_to_fit();
    model->data_.edits.shrink_to_fit();
    model->data_.value_xor.shrink_to_fit();
    model->data_.errors.shrink_to_fit();
    model->checkpoints_.reserve(replay.checkpoints.size());
    for (const StackPosition& at : replay.checkpoints) {
      model->checkpoints_.push_back({at.edit_word, at.vertices, at.triangles});
    }
    model->finest_triangles_ = replay.end.triangles;
    model->bounds_ = replay.bounds;
    return model;
  }
};

Result<std::shared_ptr<const ProgressiveModel>> ProgressiveModel::from_data(ModelData data) {
  const auto replay = progressive::check(data);
  if (!replay) return replay.error();
  return progressive::ModelMaker::make(std::move(data), *replay);
}

std::shared_ptr<const ProgressiveModel> progressive::trusted_model(ModelData data, const Box& bounds) {
  assert(check(data).ok());
  Replay replay;
  replay.bounds = bounds;
  StackPosition& at = replay.end;
  at.vertices = data.base_vertex_count;
  at.triangles = static_cast<std::uint32_t>(data.base_indices.size() / 3);
  replay.checkpoints.push_back(at);
  while (at.level < data.shapes.size()) {
    walk_up(data, at, 0);
    if (at.level % checkpoint_spacing == 0 && at.level < data.shapes.size()) replay.checkpoints.push_back(at);
  }
  return ModelMaker::make(std::move(data), replay);
}

namespace {

// Position at a checkpoint, as far as counting needs it.
StackPosition counting_from(const auto& checkpoint, std::size_t number) {
  StackPosition at;
  at.level = static_cast<Level>(number * progressive::checkpoint_spacing);
  at.edit_word = checkpoint.edit_word;
  at.vertices = checkpoint.vertices;
  at.triangles = checkpoint.triangles;
  return at;
}

}  // namespace

LevelInfo ProgressiveModel::info(Level level) const noexcept {
  level = std::min(level, record_count());
  const std::size_t number = std::min<std::size_t>(level / progressive::checkpoint_spacing, checkpoints_.size() - 1);
  StackPosition at = counting_from(checkpoints_[number], number);
  while (at.level < level) progressive::walk_up(data_, at, 0);
  return {level, at.triangles, at.vertices, error_m(level)};
}

double ProgressiveModel::error_m(Level level) const noexcept {
  const auto above = std::upper_bound(data_.errors.begin(), data_.errors.end(), level,
                                      [](Level l, const ErrorStep& step) { return l < step.level; });
  return std::prev(above)->error_m;
}

Level ProgressiveModel::level_of_triangles(std::uint32_t triangles) const noexcept {
  const auto above = std::upper_bound(checkpoints_.begin(), checkpoints_.end(), triangles,
                                      [](std::uint32_t t, const Checkpoint& c) { return t < c.triangles; });
  if (above == checkpoints_.begin()) return 0;
  const auto number = static_cast<std::size_t>(above - checkpoints_.begin()) - 1;
  StackPosition at = counting_from(checkpoints_[number], number);
  Level best = at.level;
  while (at.level < record_count()) {
    progressive::walk_up(data_, at, 0);
    if (at.triangles > triangles) break;
    best = at.level;
  }
  return best;
}

Level ProgressiveModel::level_of_error(double error_m) const noexcept {
  const auto step = std::lower_bound(data_.errors.begin(), data_.errors.end(), error_m,
                                     [](const ErrorStep& s, double limit) { return s.error_m > limit; });
  return step == data_.errors.end() ? record_count() : step->level;
}

Result<Level> ProgressiveModel::level_of_name(const std::string& name) const {
  std::string names;
  for (const NamedLevel& named : data_.named_levels) {
    if (named.name == name) return named.level;
    names += (names.empty() ? "" : ", ") + named.name;
  }
  return Error{ErrorCode::BadArgument,
               "no level is named \"" + name + "\"" + (names.empty() ? "; none has a name" : "; there are " + names),
               {}};
}

Mesh ProgressiveModel::extract(Level level) const {
  const std::shared_ptr<const ProgressiveModel> self{std::shared_ptr<const ProgressiveModel>{}, this};  // not owned
  const Cursor cursor{self, {.motion = Motion::Hard, .start_level = std::min(level, record_count())}};
  Mesh mesh;
  static_cast<Surroundings&>(mesh) = data_;
  std::vector<VertexId> renumbered(vertex_slot_count(), none);
  const auto copy_vertex = [&](VertexId v) {
    mesh.vertices.positions.push_back(cursor.positions()[v]);
    if (!cursor.normals().empty()) mesh.vertices.normals.push_back(cursor.normals()[v]);
    if (!cursor.uvs().empty()) mesh.vertices.uvs.push_back(cursor.uvs()[v]);
    if (!cursor.colors().empty()) mesh.vertices.colors.push_back(cursor.colors()[v]);
  };
  for (const DrawRange& draw : cursor.draws()) {
    for (CornerId c = draw.first_index; c < draw.first_index + draw.index_count; ++c) renumbered[cursor.index(c)] = 0;
  }
  VertexId used = 0;
  for (VertexId v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == none) continue;
    renumbered[v] = used++;
    copy_vertex(v);
  }
  mesh.indices.reserve(3 * static_cast<std::size_t>(cursor.triangle_count()));
  for (const DrawRange& draw : cursor.draws()) {
    for (CornerId c = draw.first_index; c < draw.first_index + draw.index_count; ++c) {
      mesh.indices.push_back(renumbered[cursor.index(c)]);
    }
    if (material_count() > 1)
      mesh.face_materials.insert(mesh.face_materials.end(), draw.index_count / 3, draw.material);
    if (!data_.face_features.empty()) {
      const auto first = data_.face_features.begin() + draw.first_index / 3;
      mesh.face_features.insert(mesh.face_features.end(), first, first + draw.index_count / 3);
    }
  }
  return mesh;
}

std::size_t ProgressiveModel::memory_bytes() const noexcept {
  const auto bytes = [](const auto& array) { return array.capacity() * sizeof(array[0]); };
  const ModelData& d = data_;
  return sizeof(*this) + bytes(d.vertices.positions) + bytes(d.vertices.normals) + bytes(d.vertices.uvs) +
         bytes(d.vertices.colors) + bytes(d.face_begin) + bytes(d.base_face_counts) + bytes(d.base_indices) +
         bytes(d.face_features) + bytes(d.shapes) + bytes(d.fan_corners) + bytes(d.fan_materials) + bytes(d.edits) +
         bytes(d.value_xor) + bytes(d.errors) + bytes(checkpoints_);
}

}  // namespace lodestone

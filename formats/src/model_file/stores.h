// SPDX-License-Identifier: MIT
// Where a record codec takes values from (writing) or puts them (reading): the arrays of a ModelData.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include <lodestone/progressive_model.h>

#include "values.h"

namespace lodestone::model_file {

template <class Space>
class WriteStore {
 public:
  WriteStore(const ModelData& data, const Grid& grid, const ValueLayout& layout)
      : data_(data), grid_(grid), layout_(layout), float_words_(layout_of(data.vertices, 3).words()) {
    if (data.value_xor.empty()) return;
    floats_.resize(std::size_t{data.vertices.size()} * float_words_);
    for (VertexId v = 0; v < data.vertices.size(); ++v) get_floats(data.vertices, v, floats(v));
  }

  void open_block(std::uint32_t /*vertices*/) const noexcept {}
  void before_new(VertexId slot, std::uint32_t* words) const noexcept {
    std::uint32_t now[max_value_words];
    get_floats(data_.vertices, slot, now);
    convert(now, words);
  }
  void after_new(VertexId /*slot*/, PositionWords /*position*/, const std::uint32_t* /*words*/) const noexcept {}

  void before_move(VertexId slot, std::uint32_t* words) noexcept {
    std::uint32_t* now = floats(slot);
    for (std::uint32_t w = 0; w < float_words_; ++w) now[w] ^= data_.value_xor[next_xor_++];
    convert(now, words);
  }
  void after_move(const std::uint32_t* /*before*/, const std::uint32_t* /*words*/) const noexcept {}

  [[nodiscard]] bool has_features() const noexcept { return !data_.face_features.empty(); }
  [[nodiscard]] FeatureId feature(FaceId face) const noexcept { return data_.face_features[face]; }
  void set_feature(FaceId /*face*/, FeatureId /*feature*/) const noexcept {}

 private:
  [[nodiscard]] std::uint32_t* floats(VertexId v) noexcept { return &floats_[std::size_t{v} * float_words_]; }
  void convert(const std::uint32_t* now, std::uint32_t* words) const noexcept {
    if constexpr (Space::on_grid) {
      to_grid(grid_, layout_, now, words);
    } else {
      std::copy_n(now, float_words_, words);
    }
  }

  const ModelData& data_;
  const Grid& grid_;
  ValueLayout layout_;
  std::uint32_t float_words_;
  std::vector<std::uint32_t> floats_;  // values at the level reached; empty if nothing moves
  std::size_t next_xor_ = 0;
};

template <class Space>
class ReadStore {
 public:
  ReadStore(ModelData& data, const Grid& grid, const ValueLayout& layout, bool features)
      : data_(data), grid_(grid), layout_(layout), floats_(layout) {
    floats_.normal_words = layout.normals ? 3 : 0;
    if (features) data.face_features.assign(data.face_begin.back(), none);
    features_ = features;
  }

  void reserve(std::uint32_t vertices) {
    data_.vertices.positions.reserve(vertices);
    if (floats_.normals) data_.vertices.normals.reserve(vertices);
    if (floats_.uvs) data_.vertices.uvs.reserve(vertices);
    if (floats_.colors) data_.vertices.colors.reserve(vertices);
  }
  void open_block(std::uint32_t vertices) {
    const std::size_t count = data_.vertices.size() + std::size_t{vertices};
    data_.vertices.positions.resize(count);
    if (floats_.normals) data_.vertices.normals.resize(count);
    if (floats_.uvs) data_.vertices.uvs.resize(count);
    if (floats_.colors) data_.vertices.colors.resize(count);
  }
  void before_new(VertexId /*slot*/, std::uint32_t* /*words*/) const noexcept {}
  void after_new(VertexId slot, PositionWords position, const std::uint32_t* words) noexcept {
    if constexpr (Space::on_grid) {
      data_.vertices.positions[slot] = grid_point(grid_, position);
    } else {
      data_.vertices.positions[slot] = {std::bit_cast<float>(position.x), std::bit_cast<float>(position.y),
                                        std::bit_cast<float>(position.z)};
    }
    if (floats_.words() == 3) return;
    std::uint32_t now[max_value_words];
    set_attributes(data_.vertices, floats_, slot, convert(words, now));
  }

  void before_move(VertexId /*slot*/, std::uint32_t* /*words*/) const noexcept {}
  void after_move(const std::uint32_t* before, const std::uint32_t* words) {
    std::uint32_t old_buffer[max_value_words];
    std::uint32_t new_buffer[max_value_words];
    const std::uint32_t* was = convert(before, old_buffer);
    const std::uint32_t* is = convert(words, new_buffer);
    for (std::uint32_t w = 0; w < floats_.words(); ++w) data_.value_xor.push_back(was[w] ^ is[w]);
  }

  [[nodiscard]] bool has_features() const noexcept { return features_; }
  [[nodiscard]] static FeatureId feature(FaceId /*face*/) noexcept { return none; }
  void set_feature(FaceId face, FeatureId feature) noexcept { data_.face_features[face] = feature; }

 private:
  [[nodiscard]] const std::uint32_t* convert(const std::uint32_t* words, std::uint32_t* buffer) const noexcept {
    if constexpr (Space::on_grid) {
      from_grid(grid_, layout_, words, buffer);
      return buffer;
    } else {
      return words;
    }
  }

  ModelData& data_;
  const Grid& grid_;
  ValueLayout layout_, floats_;
  bool features_ = false;
};

}  // namespace lodestone::model_file

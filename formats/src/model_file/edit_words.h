// SPDX-License-Identifier: MIT
// Views of the packed arrays of a ModelData; see progressive_model.h and docs/FILE_FORMAT.md for their layout.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <lodestone/progressive_model.h>

namespace lodestone::model_file {

// Element `at` of fan_corners.
[[nodiscard]] inline CornerId load_corner(const ModelData& data, std::size_t at) noexcept {
  const std::uint8_t* from = &data.fan_corners[at * data.corner_bytes];
  const std::uint32_t low =
      from[0] | static_cast<std::uint32_t>(from[1]) << 8 | static_cast<std::uint32_t>(from[2]) << 16;
  return data.corner_bytes == 3 ? low : low | static_cast<std::uint32_t>(from[3]) << 24;
}
inline void store_corners(ModelData& data, std::span<const CornerId> corners) {
  std::array<std::uint8_t, 4 * std::size_t{RecordShape::corner_mask}> bytes;
  std::uint8_t* to = bytes.data();
  for (const CornerId corner : corners) {
    for (std::uint32_t b = 0; b < 3; ++b) *to++ = static_cast<std::uint8_t>(corner >> (8 * b));
    if (data.corner_bytes == 4) *to++ = static_cast<std::uint8_t>(corner >> 24);
  }
  data.fan_corners.insert(data.fan_corners.end(), bytes.data(), to);
}

[[nodiscard]] inline RecordKind kind_of(std::uint8_t shape) noexcept {
  return static_cast<RecordKind>((shape >> RecordShape::kind_shift) & 3U);
}

// One block of `edits`. `Word` is std::uint32_t or const std::uint32_t.
template <class Word>
class EditWords {
 public:
  static constexpr std::uint32_t head_words = 6;
  explicit EditWords(Word* block) noexcept : block_(block) {}

  [[nodiscard]] std::uint32_t length() const noexcept { return block_[0]; }
  // Everything between head and tail.
  [[nodiscard]] std::span<Word> body() const noexcept { return {block_ + head_words, block_ + length() - 1}; }
  [[nodiscard]] std::span<Word> merges() const noexcept { return {block_ + head_words, block_[1]}; }
  // Groups: material, count, 3 vertices per face.
  [[nodiscard]] std::span<Word> groups() const noexcept {
    return {merges().data() + merges().size(), 2 * std::size_t{block_[3]} + 3 * std::size_t{block_[2]}};
  }
  // Pairs: corner, old vertex XOR new vertex.
  [[nodiscard]] std::span<Word> corners() const noexcept {
    return {groups().data() + groups().size(), 2 * std::size_t{block_[4]}};
  }
  [[nodiscard]] std::span<Word> moved() const noexcept { return {corners().data() + corners().size(), block_[5]}; }

  // Calls visit(material, vertices of its faces).
  template <class Visit>
  void for_each_group(Visit&& visit) const {
    Word* word = groups().data();
    for (std::uint32_t g = 0; g < block_[3]; ++g) {
      const std::span<Word> faces{word + 2, 3 * std::size_t{word[1]}};
      visit(MaterialId{word[0]}, faces);
      word = faces.data() + faces.size();
    }
  }

 private:
  Word* block_;
};
template <class Word>
EditWords(Word*) -> EditWords<Word>;

}  // namespace lodestone::model_file

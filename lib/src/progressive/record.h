// SPDX-License-Identifier: MIT
// How records lie in the arrays of ModelData, to the byte. docs/FILE_FORMAT.md repeats this.
//
// One `shapes` byte per record (RecordShape): bits 0..4 corner count, bits 5..6 RecordKind, bit 7 moves_flag.
//
// Fan record. `fan_corners` holds `corner count` (1..31) corner slots of `corner_bytes` little-endian bytes each; with
// more than one material `fan_materials` holds the material of the faces added. With moves_flag one value follows in
// `value_xor`, that of v.
//
// Edit record. The shape byte is Edit << 5, all other bits 0. `edits` holds one block of 32-bit words:
//
//   word 0            n, words in the block, ends included
//   word 1            nv, vertices added by refining: slots [vertex count, vertex count + nv)
//   word 2            nf, faces added
//   word 3            ng, materials they belong to
//   word 4            nc, corners re-pointed
//   word 5            nm, vertices whose value changes; their values follow in `value_xor` in the same order
//   nv words          per added vertex the slot it lies upon when it goes; its own slot or a lower one
//   ng groups         material, face count (> 0), then 3 vertex slots per face; materials ascend
//   nc pairs          corner slot, vertex slot before XOR vertex slot after
//   nm words          slots of vertices that both levels use
//   last word         n again, so that the stack can be walked downwards
//
// Value. `value_words()` 32-bit words: the bits of position x y z, then (where present) normal x y z, uv u v, colour
// r g b a from the low byte; before XOR after, so that adding it twice changes nothing.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include <lodestone/progressive_model.h>

#include "base/corners.h"

namespace lodestone::progressive {

inline constexpr std::uint8_t edit_shape =
    static_cast<std::uint8_t>(static_cast<unsigned>(RecordKind::Edit) << RecordShape::kind_shift);
inline constexpr std::uint32_t edit_head_words = 6;

[[nodiscard]] inline RecordKind kind_of(std::uint8_t shape) noexcept {
  return static_cast<RecordKind>((shape >> RecordShape::kind_shift) & 3U);
}
[[nodiscard]] inline std::uint32_t corners_of(std::uint8_t shape) noexcept { return shape & RecordShape::corner_mask; }
[[nodiscard]] inline bool moves(std::uint8_t shape) noexcept { return (shape & RecordShape::moves_flag) != 0; }
[[nodiscard]] inline std::uint32_t fan_faces(RecordKind kind) noexcept { return kind == RecordKind::FanBoth ? 2 : 1; }

// Element `at` of fan_corners.
template <unsigned Bytes>
[[nodiscard]] inline CornerId load_corner(const std::uint8_t* at) noexcept {
  if constexpr (Bytes == 4) {
    std::uint32_t word = 0;
    std::memcpy(&word, at, 4);
    return word;
  } else {
    std::uint16_t low = 0;
    std::memcpy(&low, at, 2);
    return low | static_cast<std::uint32_t>(at[2]) << 16;
  }
}
static_assert(std::endian::native == std::endian::little, "packed arrays are read in place");

[[nodiscard]] inline CornerId load_corner(const ModelData& data, std::uint64_t at) noexcept {
  return data.corner_bytes == 3 ? load_corner<3>(&data.fan_corners[3 * at]) : load_corner<4>(&data.fan_corners[4 * at]);
}

// A view of one block of `edits`. Precondition: checked by from_data().
struct EditBlock {
  const std::uint32_t* words;

  [[nodiscard]] std::uint32_t length() const noexcept { return words[0]; }
  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return words[1]; }
  [[nodiscard]] std::uint32_t face_count() const noexcept { return words[2]; }
  [[nodiscard]] std::uint32_t group_count() const noexcept { return words[3]; }
  [[nodiscard]] std::uint32_t corner_count() const noexcept { return words[4]; }
  [[nodiscard]] std::uint32_t move_count() const noexcept { return words[5]; }
  [[nodiscard]] const std::uint32_t* merges() const noexcept { return words + edit_head_words; }
  [[nodiscard]] const std::uint32_t* groups() const noexcept { return merges() + vertex_count(); }
  [[nodiscard]] const std::uint32_t* corners() const noexcept {
    return groups() + 2 * static_cast<std::size_t>(group_count()) + 3 * static_cast<std::size_t>(face_count());
  }
  [[nodiscard]] const std::uint32_t* moved() const noexcept {
    return corners() + 2 * static_cast<std::size_t>(corner_count());
  }
};

// Words that a block with these counts takes.
[[nodiscard]] inline std::uint64_t edit_length(std::uint64_t vertices, std::uint64_t faces, std::uint64_t groups,
                                               std::uint64_t corners, std::uint64_t moved) noexcept {
  return edit_head_words + vertices + 2 * groups + 3 * faces + 2 * corners + moved + 1;
}

}  // namespace lodestone::progressive

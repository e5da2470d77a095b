// SPDX-License-Identifier: MIT
#include "header.h"

#include "fields.h"

namespace lodestone::model_file {

template <class F>
void describe(F& fields, NamedLevel& n) {
  fields.all(n.name, n.level);
}

template <class F>
void describe(F& fields, BlockEntry& b) {
  fields.all(b.kind, b.compressed, b.count, b.stored_bytes, b.raw_bytes, b.checksum);
}

template <class F>
void describe(F& fields, Header& h) {
  Surroundings& s = h.surroundings;
  fields.all(h.generator, s.origin.x, s.origin.y, s.origin.z, s.crs, h.method);
  fields.all(h.normals, h.uvs, h.colors, h.features);
  fields.all(h.grid.bits, h.grid.corner.x, h.grid.corner.y, h.grid.corner.z, h.grid.step_m, h.grid.normal_bits,
             h.grid.uv_step);
  fields.all(h.records, h.vertices, h.faces);
  fields.all(s.materials, s.textures, s.features, h.named_levels, h.blocks);
}

namespace {

// Counts and parameters that later code relies on.
const char* check(const Header& h) {
  std::uint64_t records = 0;
  for (const BlockEntry& block : h.blocks) {
    if (block.kind > BlockKind::Texture) return "a block is of no known kind";
    if (!unpack_is_sane(block.raw_bytes, block.stored_bytes)) return "a block claims to unpack to too much";
    if (!block.compressed && block.raw_bytes != block.stored_bytes) return "the sizes of a block disagree";
    if (block.kind == BlockKind::Records) records += block.count;
    if (block.kind == BlockKind::Texture && block.count >= h.surroundings.textures.size())
      return "a block names no texture";
  }
  if (h.blocks.empty() || h.blocks.front().kind != BlockKind::Base) return "there is no base";
  if (records != h.records) return "the blocks do not hold all records";
  if (h.grid.bits > 24 || h.grid.normal_bits > 16) return "the grid is too fine";
  if (h.grid.bits > 0 && !(h.grid.step_m > 0.0 && h.grid.uv_step > 0.0)) return "the grid has no step";
  return nullptr;
}

}  // namespace

Bytes write_header(const Header& header) { return seal(lode_file, archived(header)); }

std::optional<HeaderFault> header_size(std::span<const std::uint8_t> prologue, std::uint64_t& bytes) {
  return sealed_size(lode_file, prologue, bytes);
}

std::optional<HeaderFault> read_header(std::span<const std::uint8_t> bytes, Header& header) {
  Bytes raw;
  if (auto fault = unseal(bytes, raw)) return fault;
  if (!unarchive(raw, header)) return HeaderFault{ErrorCode::BadData, damaged_header};
  if (const char* fault = check(header); fault != nullptr) return HeaderFault{ErrorCode::BadData, fault};
  return std::nullopt;
}

}  // namespace lodestone::model_file

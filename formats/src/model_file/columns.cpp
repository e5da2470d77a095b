// SPDX-License-Identifier: MIT
#include "columns.h"

#ifndef __clang_analyzer__  // it would look for faults in the header's code
#define XXH_INLINE_ALL
#endif
#include <xxhash.h>
#include <zstd.h>

#include <cassert>
#include <memory>
#include <new>

namespace lodestone::model_file {
namespace {

// Residuals hold no repeats worth a search; what counts is the entropy stage, which every level shares.
constexpr int zstd_level = 3;

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
};

void put_u32(Bytes& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

std::uint32_t get_u32(const std::uint8_t* at) noexcept {
  return static_cast<std::uint32_t>(at[0]) | static_cast<std::uint32_t>(at[1]) << 8 |
         static_cast<std::uint32_t>(at[2]) << 16 | static_cast<std::uint32_t>(at[3]) << 24;
}

PackedBlock as_it_is(std::span<const Bytes> parts, std::uint64_t raw_bytes) {
  PackedBlock block{.bytes = {}, .raw_bytes = raw_bytes, .compressed = false};
  block.bytes.reserve(raw_bytes);
  for (const Bytes& part : parts) block.bytes.insert(block.bytes.end(), part.begin(), part.end());
  return block;
}

}  // namespace

Bytes ColumnWriter::extra() const {
  Bytes all = extra_;
  if (pending_count_ > 0) all.push_back(static_cast<std::uint8_t>(pending_));
  return all;
}

void ColumnWriter::clear() noexcept {
  tokens_.clear();
  extra_.clear();
  pending_ = 0;
  pending_count_ = 0;
}

PackedBlock pack(std::span<const Bytes> parts) {
  std::uint64_t raw_bytes = 0;
  for (const Bytes& part : parts) raw_bytes += part.size();
  const std::unique_ptr<ZSTD_CCtx, FreeContext> context{ZSTD_createCCtx()};
  if (!context) throw std::bad_alloc{};
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, zstd_level);
  ZSTD_CCtx_setPledgedSrcSize(context.get(), raw_bytes);
  PackedBlock block{
      .bytes = Bytes(ZSTD_compressBound(raw_bytes) + 16 * parts.size()), .raw_bytes = raw_bytes, .compressed = true};
  ZSTD_outBuffer out{block.bytes.data(), block.bytes.size(), 0};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool last = i + 1 == parts.size();
    if (parts[i].empty() && !last) continue;
    ZSTD_inBuffer in{parts[i].data(), parts[i].size(), 0};
    const std::size_t left = ZSTD_compressStream2(context.get(), &out, &in, last ? ZSTD_e_end : ZSTD_e_flush);
    if (left != 0) return as_it_is(parts, raw_bytes);
  }
  block.bytes.resize(out.pos);
  if (out.pos >= raw_bytes || !unpack_is_sane(raw_bytes, out.pos)) return as_it_is(parts, raw_bytes);
  return block;
}

bool unpack(std::span<const std::uint8_t> stored, std::span<std::uint8_t> raw) noexcept {
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), stored.data(), stored.size());
  return ZSTD_isError(size) == 0 && size == raw.size();
}

std::uint64_t checksum(std::span<const std::uint8_t> bytes) noexcept { return XXH64(bytes.data(), bytes.size(), 0); }

PackedBlock pack_columns(std::span<const ColumnWriter> columns) {
  std::vector<Bytes> parts(1);
  for (const ColumnWriter& column : columns) {
    parts.push_back(column.tokens());
    parts.push_back(column.extra());
    put_u32(parts.front(), static_cast<std::uint32_t>(parts[parts.size() - 2].size()));
    put_u32(parts.front(), static_cast<std::uint32_t>(parts.back().size()));
  }
  return pack(parts);
}

bool split_columns(std::span<const std::uint8_t> raw, std::span<ColumnReader> columns) noexcept {
  const std::size_t table_bytes = columns.size() * 8;
  if (raw.size() < table_bytes) return false;
  std::uint64_t at = table_bytes;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::uint64_t token_bytes = get_u32(raw.data() + 8 * i);
    const std::uint64_t extra_bytes = get_u32(raw.data() + 8 * i + 4);
    if (at + token_bytes + extra_bytes > raw.size()) return false;
    columns[i] = ColumnReader{raw.subspan(at, token_bytes), raw.subspan(at + token_bytes, extra_bytes)};
    at += token_bytes + extra_bytes;
  }
  return at == raw.size();
}

}  // namespace lodestone::model_file

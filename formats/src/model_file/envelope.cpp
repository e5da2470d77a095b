// SPDX-License-Identifier: MIT
#include "envelope.h"

#include <cstring>

namespace lodestone::model_file {
namespace {

constexpr std::uint64_t max_header_bytes = 1ULL << 30;

void put(Bytes& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

std::uint64_t get(std::span<const std::uint8_t> from, std::size_t at, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint64_t>(from[at + i]) << (8 * i);
  return value;
}

}  // namespace

Bytes seal(const FileKind& kind, const Bytes& header) {
  const PackedBlock packed = pack({&header, 1});
  Bytes out(std::begin(kind.magic), std::end(kind.magic));
  put(out, kind.version, 4);
  put(out, packed.bytes.size(), 4);
  put(out, packed.raw_bytes, 4);
  put(out, packed.compressed ? 1 : 0, 4);
  Bytes guarded(out.begin() + 8, out.end());
  guarded.insert(guarded.end(), packed.bytes.begin(), packed.bytes.end());
  put(out, checksum(guarded), 8);
  out.insert(out.end(), packed.bytes.begin(), packed.bytes.end());
  return out;
}

std::optional<HeaderFault> sealed_size(const FileKind& kind, std::span<const std::uint8_t> prologue,
                                       std::uint64_t& bytes) {
  if (prologue.size() < sizeof(kind.magic) || std::memcmp(prologue.data(), kind.magic, sizeof(kind.magic)) != 0) {
    return HeaderFault{ErrorCode::BadData, std::string{"this is not a "} + kind.name + " file"};
  }
  if (prologue.size() < prologue_bytes) return HeaderFault{ErrorCode::BadData, "the file ends inside its header"};
  const std::uint64_t version = get(prologue, 8, 4);
  if (version > kind.version) {
    return HeaderFault{ErrorCode::Unsupported, "the file is of version " + std::to_string(version) +
                                                   ", this program reads up to " + std::to_string(kind.version) +
                                                   "; use a newer one"};
  }
  if (version == 0) return HeaderFault{ErrorCode::BadData, damaged_header};
  bytes = prologue_bytes + get(prologue, 12, 4);
  return std::nullopt;
}

std::optional<HeaderFault> unseal(std::span<const std::uint8_t> bytes, Bytes& header) {
  const std::uint64_t raw_bytes = get(bytes, 16, 4);
  const std::uint64_t compressed = get(bytes, 20, 4);
  const auto stored = bytes.subspan(prologue_bytes);
  Bytes guarded(bytes.begin() + 8, bytes.begin() + 24);
  guarded.insert(guarded.end(), stored.begin(), stored.end());
  if (checksum(guarded) != get(bytes, 24, 8) || compressed > 1) return HeaderFault{ErrorCode::BadData, damaged_header};
  if (raw_bytes > max_header_bytes || !unpack_is_sane(raw_bytes, stored.size())) {
    return HeaderFault{ErrorCode::TooLarge, "the header claims to unpack to too much"};
  }
  if (compressed == 0) {
    if (raw_bytes != stored.size()) return HeaderFault{ErrorCode::BadData, damaged_header};
    header.assign(stored.begin(), stored.end());
    return std::nullopt;
  }
  header.resize(raw_bytes);
  if (!unpack(stored, header)) return HeaderFault{ErrorCode::BadData, damaged_header};
  return std::nullopt;
}

}  // namespace lodestone::model_file

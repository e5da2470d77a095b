// SPDX-License-Identifier: MIT
// The only file that names cereal.
#include "header.h"

#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/string.hpp>
#include <cstring>
#include <sstream>
#include <type_traits>

namespace lodestone::model_file {
namespace {

constexpr std::uint64_t max_header_bytes = 1ULL << 30;

// cereal's own loaders trust counts; these let nothing grow beyond what the bytes left could fill.
template <class Archive>
class Fields {
 public:
  static constexpr bool loading = Archive::is_loading::value;
  Fields(Archive& archive, std::uint64_t bytes) : archive_(archive), bytes_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(T& value) { archive_(value); }
  void operator()(bool& value) {
    auto byte = static_cast<std::uint8_t>(value ? 1 : 0);
    archive_(byte);
    value = byte != 0;
  }
  template <class T>
  requires std::is_enum_v<T>
  void operator()(T& value) {
    auto number = static_cast<std::underlying_type_t<T>>(value);
    archive_(number);
    value = static_cast<T>(number);
  }
  void operator()(std::string& text) {
    const std::size_t size = count(text.size());
    if constexpr (loading) text.resize(size);
    archive_(cereal::binary_data(text.data(), size));
  }
  void operator()(Material& m) {
    all(m.name, m.base_color.r, m.base_color.g, m.base_color.b, m.base_color.a, m.texture, m.alpha_cutoff,
        m.double_sided);
  }
  void operator()(Texture& t) { all(t.name, t.path, t.mime_type); }
  void operator()(Feature& f) { all(f.id, f.semantic_class, f.parent); }
  void operator()(NamedLevel& n) { all(n.name, n.level); }
  void operator()(BlockEntry& b) { all(b.kind, b.compressed, b.count, b.stored_bytes, b.raw_bytes, b.checksum); }
  template <class T>
  void operator()(std::vector<T>& list) {
    const std::size_t size = count(list.size());
    if constexpr (loading) {
      // One by one: elements are larger in memory than in the file, and the bytes may end long before the count.
      for (std::size_t i = 0; i < size; ++i) (*this)(list.emplace_back());
    } else {
      for (T& item : list) (*this)(item);
    }
  }
  void operator()(Header& h) {
    Surroundings& s = h.surroundings;
    all(h.generator, s.origin.x, s.origin.y, s.origin.z, s.crs, h.method);
    all(h.normals, h.uvs, h.colors, h.features);
    all(h.grid.bits, h.grid.corner.x, h.grid.corner.y, h.grid.corner.z, h.grid.step_m, h.grid.normal_bits,
        h.grid.uv_step);
    all(h.records, h.vertices, h.faces);
    all(s.materials, s.textures, s.features, h.named_levels, h.blocks);
  }

 private:
  template <class... T>
  void all(T&... values) {
    ((*this)(values), ...);
  }
  std::size_t count(std::size_t size) {
    auto number = static_cast<std::uint32_t>(size);
    archive_(number);
    if (loading && number > bytes_) throw cereal::Exception("a count is larger than the header");
    return number;
  }

  Archive& archive_;
  std::uint64_t bytes_;
};

void put(Bytes& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

std::uint64_t get(std::span<const std::uint8_t> from, std::size_t at, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint64_t>(from[at + i]) << (8 * i);
  return value;
}

constexpr const char* damaged = "the header is damaged; copy the file again";

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

Bytes write_header(const Header& header) {
  std::ostringstream stream;
  {
    cereal::PortableBinaryOutputArchive archive{stream, cereal::PortableBinaryOutputArchive::Options::LittleEndian()};
    Fields fields{archive, max_header_bytes};
    fields(const_cast<Header&>(header));  // one text for both directions; writing changes nothing
  }
  const std::string text = stream.str();
  const Bytes raw(text.begin(), text.end());
  const PackedBlock packed = pack({&raw, 1});
  Bytes out(std::begin(magic), std::end(magic));
  put(out, format_version, 4);
  put(out, packed.bytes.size(), 4);
  put(out, packed.raw_bytes, 4);
  put(out, packed.compressed ? 1 : 0, 4);
  Bytes guarded(out.begin() + 8, out.end());
  guarded.insert(guarded.end(), packed.bytes.begin(), packed.bytes.end());
  put(out, checksum(guarded), 8);
  out.insert(out.end(), packed.bytes.begin(), packed.bytes.end());
  return out;
}

std::optional<HeaderFault> header_size(std::span<const std::uint8_t> prologue, std::uint64_t& bytes) {
  if (prologue.size() < sizeof(magic) || std::memcmp(prologue.data(), magic, sizeof(magic)) != 0) {
    return HeaderFault{ErrorCode::BadData, "this is not a .lode file"};
  }
  if (prologue.size() < prologue_bytes) return HeaderFault{ErrorCode::BadData, "the file ends inside its header"};
  const std::uint64_t version = get(prologue, 8, 4);
  if (version > format_version) {
    return HeaderFault{ErrorCode::Unsupported, "the file is of version " + std::to_string(version) +
                                                   ", this program reads up to " + std::to_string(format_version) +
                                                   "; use a newer one"};
  }
  if (version == 0) return HeaderFault{ErrorCode::BadData, damaged};
  bytes = prologue_bytes + get(prologue, 12, 4);
  return std::nullopt;
}

std::optional<HeaderFault> read_header(std::span<const std::uint8_t> bytes, Header& header) {
  const std::uint64_t raw_bytes = get(bytes, 16, 4);
  const std::uint64_t compressed = get(bytes, 20, 4);
  const auto stored = bytes.subspan(prologue_bytes);
  Bytes guarded(bytes.begin() + 8, bytes.begin() + 24);
  guarded.insert(guarded.end(), stored.begin(), stored.end());
  if (checksum(guarded) != get(bytes, 24, 8) || compressed > 1) return HeaderFault{ErrorCode::BadData, damaged};
  if (raw_bytes > max_header_bytes || !unpack_is_sane(raw_bytes, stored.size())) {
    return HeaderFault{ErrorCode::TooLarge, "the header claims to unpack to too much"};
  }
  std::string text(raw_bytes, '\0');
  if (compressed == 0 ? raw_bytes != stored.size()
                      : !unpack(stored, {reinterpret_cast<std::uint8_t*>(text.data()), text.size()})) {
    return HeaderFault{ErrorCode::BadData, damaged};
  }
  if (compressed == 0) text.assign(stored.begin(), stored.end());
  try {
    std::istringstream stream{text};
    cereal::PortableBinaryInputArchive archive{stream};
    Fields fields{archive, raw_bytes};
    fields(header);
  } catch (const cereal::Exception&) {
    return HeaderFault{ErrorCode::BadData, damaged};
  }
  if (const char* fault = check(header); fault != nullptr) return HeaderFault{ErrorCode::BadData, fault};
  return std::nullopt;
}

}  // namespace lodestone::model_file

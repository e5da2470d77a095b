// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <random>

#include "data.h"
#include "model_file/header.h"
#include "model_file/stack_codec.h"
#include "shapes.h"
#include "support.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

// A spoilt file must give one clear error, or what the whole file gives at some level.
void check_one(const std::filesystem::path& file, const ProgressiveModel& whole) {
  const auto result = read_model(file);
  if (!result.ok()) {
    CHECK_FALSE(result.error().message.empty());
    return;
  }
  const Level level = result.value()->record_count();
  REQUIRE(level <= whole.record_count());
  CHECK(same_mesh(result.value()->extract(level), whole.extract(level)));
}

// Replaces the block `index` of a file and mends every size and checksum, as a hostile writer would.
Bytes with_block(const Bytes& bytes, std::size_t index, const Bytes& raw) {
  using namespace model_file;
  std::uint64_t front = 0;
  REQUIRE_FALSE(header_size(std::span{bytes}.first(prologue_bytes), front).has_value());
  Header header;
  REQUIRE_FALSE(read_header(std::span{bytes}.first(front), header).has_value());
  std::vector<Bytes> blocks;
  std::size_t at = front;
  for (const BlockEntry& entry : header.blocks) {
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    blocks.emplace_back(first, first + static_cast<std::ptrdiff_t>(entry.stored_bytes));
    at += entry.stored_bytes;
  }
  const PackedBlock packed = pack({&raw, 1});
  BlockEntry& entry = header.blocks[index];
  entry.compressed = packed.compressed;
  entry.stored_bytes = packed.bytes.size();
  entry.raw_bytes = packed.raw_bytes;
  entry.checksum = checksum(packed.bytes);
  blocks[index] = packed.bytes;
  Bytes out = write_header(header);
  for (const Bytes& block : blocks) out.insert(out.end(), block.begin(), block.end());
  return out;
}

Bytes raw_block(const Bytes& bytes, std::size_t index) {
  using namespace model_file;
  std::uint64_t at = 0;
  REQUIRE_FALSE(header_size(std::span{bytes}.first(prologue_bytes), at).has_value());
  Header header;
  REQUIRE_FALSE(read_header(std::span{bytes}.first(at), header).has_value());
  for (std::size_t i = 0; i < index; ++i) at += header.blocks[i].stored_bytes;
  const auto stored = std::span{bytes}.subspan(at, header.blocks[index].stored_bytes);
  Bytes raw(header.blocks[index].raw_bytes);
  if (!header.blocks[index].compressed) return Bytes(stored.begin(), stored.end());
  REQUIRE(unpack(stored, raw));
  return raw;
}

}  // namespace

TEST_CASE("every single flipped bit and every truncation of a small file is an error or a correct result") {
  const auto folder = scratch_folder("lode-flip");
  const Model model = build(test::cube(), Placement::Optimal);
  const Bytes good = written(*model, folder / "a.lode");
  const auto file = folder / "spoilt.lode";
  std::size_t accepted = 0;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes bytes = good;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    spill(file, bytes);
    check_one(file, *model);
    accepted += read_model(file).ok() ? 1 : 0;
  }
  CHECK(accepted == 0);
  for (std::size_t size = 0; size < good.size(); ++size) {
    spill(file, Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)));
    check_one(file, *model);
  }
}

TEST_CASE("blocks with wrong contents and right checksums never crash") {
  const auto folder = scratch_folder("lode-hostile");
  std::mt19937 random{7};
  for (const bool grid : {false, true}) {
    const Model model = rich_model();
    const Bytes good = written(*model, folder / "a.lode", {.quantize_bits = grid ? 12U : 0U});
    for (std::size_t block = 0; block < 2; ++block) {
      const Bytes raw = raw_block(good, block);
      for (int i = 0; i < 400; ++i) {
        Bytes spoilt = raw;
        const std::size_t table = i % 4 == 0 ? 0 : 8 * model_file::ColumnCount;
        const std::size_t changes = 1 + random() % 4;
        for (std::size_t c = 0; c < changes; ++c) {
          spoilt[table + random() % (spoilt.size() - table)] = static_cast<std::uint8_t>(random());
        }
        spill(folder / "b.lode", with_block(good, block, spoilt));
        const auto result = read_model(folder / "b.lode");
        if (!result.ok()) CHECK_FALSE(result.error().message.empty());
      }
    }
  }
}

TEST_CASE("a newer version is refused with a clear line, another file as well") {
  const auto folder = scratch_folder("lode-version");
  Bytes bytes = written(*rich_model(), folder / "a.lode");
  bytes[8] = 2;
  spill(folder / "newer.lode", bytes);
  const auto newer = read_model(folder / "newer.lode");
  REQUIRE_FALSE(newer.ok());
  CHECK(newer.error().code == ErrorCode::Unsupported);
  CHECK(newer.error().message.find("version 2") != std::string::npos);
  spill(folder / "other.lode", Bytes{'s', 'o', 'l', 'i', 'd', ' ', 'x', 'y', 'z'});
  CHECK_FALSE(is_model_file(folder / "other.lode"));
  CHECK_FALSE(read_model(folder / "other.lode").ok());
  spill(folder / "empty.lode", {});
  CHECK_FALSE(read_model(folder / "empty.lode").ok());
}

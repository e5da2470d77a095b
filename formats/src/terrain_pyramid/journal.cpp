// SPDX-License-Identifier: MIT
#include "terrain_pyramid/journal.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cinttypes>
#include <cstring>
#include <fstream>
#include <string>

#include "output_file.h"

namespace lodestone {
namespace {

constexpr const char* manifest_name = "lodestone-terrain.txt";
constexpr const char* journal_name = "lodestone-terrain.unfinished";
constexpr const char* title = "lodestone terrain 2";

std::string line_of(const TileRecord& r) {
  char text[320];
  const int length = std::snprintf(
      text, sizeof text,
      "%u %u %u %" PRIu64 " %u %u %.17g %.17g %.17g %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n",
      r.id.zoom, r.id.x, r.id.y, r.bytes, r.vertices, r.triangles, r.max_error_m, r.border_detail_m, r.hausdorff_m,
      r.borders[0], r.borders[1], r.borders[2], r.borders[3]);
  return {text, static_cast<std::size_t>(length)};
}

bool parse(const std::string& line, TileRecord& r) {
  return std::sscanf(line.c_str(),
                     "%u %u %u %" SCNu64 " %u %u %lg %lg %lg %" SCNx64 " %" SCNx64 " %" SCNx64 " %" SCNx64, &r.id.zoom,
                     &r.id.x, &r.id.y, &r.bytes, &r.vertices, &r.triangles, &r.max_error_m, &r.border_detail_m,
                     &r.hausdorff_m, &r.borders[0], &r.borders[1], &r.borders[2], &r.borders[3]) == 13;
}

std::string heading(std::uint64_t fingerprint) {
  char text[64];
  std::snprintf(text, sizeof text, "%s %016" PRIx64 "\n", title, fingerprint);
  return text;
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  return (std::rotl(hash, 5) ^ value) * 0x9e3779b97f4a7c15ULL;
}

// Of the vertices along a border, by place, height and normal; 0 if its edges leave part of it free.
std::uint64_t border_hash(const TerrainTile& tile, const std::vector<std::uint32_t>& border,
                          const std::vector<std::uint16_t>& across, const std::vector<std::uint16_t>& along) {
  if (border.empty()) return 0;
  const int side = across[border.front()];
  int covered = 0;
  for (std::size_t e = 0; e < tile.triangles.size(); ++e) {
    const std::uint32_t a = tile.triangles[e], b = tile.triangles[e % 3 == 2 ? e - 2 : e + 1];
    if (across[a] == side && across[b] == side) covered += std::abs(along[a] - along[b]);
  }
  if (covered != quantized_max) return 0;
  std::uint64_t hash = 1;
  for (const std::uint32_t i : border) {
    hash = mixed(hash, along[i]);
    hash = mixed(hash, std::bit_cast<std::uint64_t>(tile.height_m(i) + 0.0));
    for (int k = 0; k < 3; ++k) hash = mixed(hash, std::bit_cast<std::uint32_t>(tile.normals[i][k] + 0.0F));
  }
  return std::max<std::uint64_t>(hash, 1);
}

}  // namespace

TileRecord record_of(const TerrainTile& tile, std::uint64_t bytes) {
  return {tile.id,
          bytes,
          tile.vertex_count(),
          tile.triangle_count(),
          tile.max_error_m,
          tile.border_detail_m,
          -1.0,
          {border_hash(tile, tile.west, tile.u, tile.v), border_hash(tile, tile.south, tile.v, tile.u),
           border_hash(tile, tile.east, tile.u, tile.v), border_hash(tile, tile.north, tile.v, tile.u)}};
}

TileJournal::~TileJournal() {
  if (stream_ != nullptr) std::fclose(stream_);
}

Status TileJournal::read(const std::filesystem::path& file) {
  std::ifstream stream{file};
  std::string line;
  if (!std::getline(stream, line)) return Done{};  // ended before its first line
  if (line + "\n" != heading(fingerprint_)) {
    return Error{ErrorCode::BadArgument, "it was made from other heights or with other options, use another folder",
                 file.string()};
  }
  while (std::getline(stream, line)) {
    TileRecord record;
    if (!stream.eof() && parse(line, record)) records_[key_of(record.id)] = record;  // the last line may be cut
  }
  return Done{};
}

Status TileJournal::open(const std::filesystem::path& folder, std::uint64_t fingerprint, bool resume) {
  folder_ = folder;
  fingerprint_ = fingerprint;
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  if (fault) return Error{ErrorCode::Unreadable, "the folder cannot be made: " + fault.message(), folder.string()};
  const auto manifest = folder / manifest_name, journal = folder / journal_name;
  const bool ours = std::filesystem::exists(manifest, fault) || std::filesystem::exists(journal, fault);
  if (!ours && !std::filesystem::is_empty(folder, fault)) {
    return Error{ErrorCode::BadArgument, "the folder holds something else, give an empty one", folder.string()};
  }
  if (ours && !resume) {
    return Error{ErrorCode::BadArgument, "the folder holds terrain already, use --resume to go on or give an empty one",
                 folder.string()};
  }
  for (const auto& file : {manifest, journal}) {
    if (!std::filesystem::exists(file, fault)) continue;
    if (Status status = read(file); !status) return status;
  }
  stream_ = std::fopen(journal.c_str(), "w");
  if (stream_ == nullptr)
    return Error{ErrorCode::Unreadable, std::string{"cannot be written: "} + std::strerror(errno), journal.string()};
  std::string text = heading(fingerprint_);
  for (const auto& [key, record] : records_) text += line_of(record);
  if (std::fwrite(text.data(), 1, text.size(), stream_) != text.size() || std::fflush(stream_) != 0) {
    return Error{ErrorCode::Unreadable, std::string{"cannot be written: "} + std::strerror(errno), journal.string()};
  }
  std::filesystem::remove(manifest, fault);
  return Done{};
}

Status TileJournal::add(const TileRecord& record) {
  const std::string line = line_of(record);
  const std::lock_guard lock{mutex_};
  records_[key_of(record.id)] = record;
  if (std::fwrite(line.data(), 1, line.size(), stream_) != line.size() || std::fflush(stream_) != 0) {
    return Error{ErrorCode::Unreadable, std::string{"cannot be written: "} + std::strerror(errno),
                 (folder_ / journal_name).string()};
  }
  return Done{};
}

Status TileJournal::finish() {
  std::string text = heading(fingerprint_);
  for (const auto& [key, record] : records_) text += line_of(record);
  Status written =
      write_whole_file(folder_ / manifest_name, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  if (!written) return written;
  std::error_code fault;
  std::filesystem::remove(folder_ / journal_name, fault);
  return Done{};
}

}  // namespace lodestone

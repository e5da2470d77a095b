// SPDX-License-Identifier: MIT
#define XXH_INLINE_ALL  // header only
#include "tiles3d/tile_cache.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "output_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
constexpr const char* ending = ".tile";
constexpr std::size_t head_bytes = 8;  // a checksum of what follows

struct Copy {
  fs::file_time_type used;
  std::uint64_t bytes = 0;
  fs::path file;
};

// Of all tilesets in the folder, the one not used for longest first.
std::vector<Copy> copies_in(const fs::path& folder) {
  std::vector<Copy> copies;
  std::error_code fault;
  for (const auto& entry : fs::directory_iterator{folder, fault}) {
    if (entry.path().extension() != ending) continue;
    std::error_code gone;
    const Copy copy{entry.last_write_time(gone), entry.file_size(gone), entry.path()};
    if (!gone) copies.push_back(copy);
  }
  std::sort(copies.begin(), copies.end(),
            [](const Copy& a, const Copy& b) { return std::tie(a.used, a.file) < std::tie(b.used, b.file); });
  return copies;
}

}  // namespace

Result<std::unique_ptr<TileCache>> TileCache::open(const TileCacheOptions& options, std::uint64_t source) {
  std::error_code fault;
  fs::create_directories(options.folder, fault);
  if (fault) {
    return Error{ErrorCode::Unreadable, "the folder for copies of tiles cannot be made: " + fault.message(),
                 options.folder.string()};
  }
  std::unique_ptr<TileCache> cache{new TileCache{options, source}};
  cache->make_room();
  return cache;
}

fs::path TileCache::file_of(const std::string& name) const {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx",
                static_cast<unsigned long long>(XXH64(name.data(), name.size(), source_)));
  return options_.folder / (std::string{text} + ending);
}

std::optional<std::vector<std::uint8_t>> TileCache::find(const std::string& name) {
  const fs::path file = file_of(name);
  std::ifstream stream{file, std::ios::binary};
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>{stream}, {}};
  std::uint64_t sum = 0;
  const bool whole = bytes.size() >= head_bytes;
  if (whole) std::memcpy(&sum, bytes.data(), head_bytes);
  const bool good = whole && sum == XXH64(bytes.data() + head_bytes, bytes.size() - head_bytes, 0);
  std::error_code fault;
  if (good) fs::last_write_time(file, fs::file_time_type::clock::now(), fault);
  const std::scoped_lock lock{mutex_};
  ++(good ? status_.hits : status_.misses);
  if (!good) return std::nullopt;
  bytes.erase(bytes.begin(), bytes.begin() + head_bytes);
  return bytes;
}

void TileCache::keep(const std::string& name, std::span<const std::uint8_t> bytes) {
  if (bytes.size() + head_bytes > options_.max_bytes) return;
  auto out = OutputFile::create(file_of(name));
  if (!out) return;
  const std::uint64_t sum = XXH64(bytes.data(), bytes.size(), 0);
  out->write(&sum, sizeof sum);
  out->write(bytes.data(), bytes.size());
  if (!out->commit()) return;
  const std::scoped_lock lock{mutex_};
  status_.bytes += bytes.size() + head_bytes;
  if (status_.bytes > options_.max_bytes) make_room();
}

// Leaves a tenth free, so that not every tile must look at all of the folder.
void TileCache::make_room() {
  const std::vector<Copy> copies = copies_in(options_.folder);
  std::uint64_t bytes = 0;
  for (const Copy& copy : copies) bytes += copy.bytes;
  const std::uint64_t aim = options_.max_bytes - options_.max_bytes / 10;
  if (bytes > options_.max_bytes) {
    for (const Copy& copy : copies) {
      if (bytes <= aim) break;
      std::error_code fault;
      fs::remove(copy.file, fault);
      bytes -= copy.bytes;
    }
  }
  status_.bytes = bytes;
}

TileCacheStatus TileCache::status() const {
  const std::scoped_lock lock{mutex_};
  return status_;
}

}  // namespace lodestone

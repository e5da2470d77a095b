// SPDX-License-Identifier: MIT
// What is known of tiles that are written: one line each, appended as they are done, sorted into a manifest at the end.
#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <tuple>

#include <lodestone/terrain.h>

namespace lodestone {

struct TileRecord {
  TileId id;
  std::uint64_t bytes = 0;
  std::uint32_t vertices = 0;
  std::uint32_t triangles = 0;
  double max_error_m = 0.0;
  double border_detail_m = 0.0;
  double hausdorff_m = -1.0;  // below 0: not measured, or a tile without data
  // Hashes of the vertices along the borders: west, south, east, north; 0 where triangles leave part of it free.
  std::array<std::uint64_t, 4> borders{};
};
[[nodiscard]] TileRecord record_of(const TerrainTile& tile, std::uint64_t bytes);

class TileJournal {
 public:
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // zoom, y, x
  using Records = std::map<Key, TileRecord>;
  [[nodiscard]] static Key key_of(const TileId& id) { return {id.zoom, id.y, id.x}; }

  TileJournal() = default;
  TileJournal(const TileJournal&) = delete;
  TileJournal& operator=(const TileJournal&) = delete;
  ~TileJournal();

  // Begins a pyramid, or goes on with one where `resume` says so and it was made of the same posts with the same
  // options.
  [[nodiscard]] Status open(const std::filesystem::path& folder, std::uint64_t fingerprint, bool resume);
  [[nodiscard]] const Records& records() const noexcept { return records_; }
  void forget(const TileId& id) { records_.erase(key_of(id)); }
  // From any thread.
  [[nodiscard]] Status add(const TileRecord& record);
  // Puts the sorted manifest in the place of the journal.
  [[nodiscard]] Status finish();

 private:
  [[nodiscard]] Status read(const std::filesystem::path& file);

  std::filesystem::path folder_;
  std::uint64_t fingerprint_ = 0;
  std::FILE* stream_ = nullptr;
  std::mutex mutex_;
  Records records_;
};

}  // namespace lodestone

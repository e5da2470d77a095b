// SPDX-License-Identifier: MIT
// Copies of tiles on a fast disk.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/tile_loader.h>

namespace lodestone {

// Any thread. What cannot be written or read is as if it had never been kept: a cache must not fail a picture.
class TileCache {
 public:
  // Copies are told apart by `source`, whatever else lies in the folder. Unreadable if the folder cannot be made.
  [[nodiscard]] static Result<std::unique_ptr<TileCache>> open(const TileCacheOptions& options, std::uint64_t source);

  // Nothing if there is no copy, or it is damaged.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> find(const std::string& name);
  // Then removes what was not used for longest until all copies together are within the limit.
  void keep(const std::string& name, std::span<const std::uint8_t> bytes);
  [[nodiscard]] TileCacheStatus status() const;

 private:
  TileCache(TileCacheOptions options, std::uint64_t source) : options_(std::move(options)), source_(source) {}
  [[nodiscard]] std::filesystem::path file_of(const std::string& name) const;
  void make_room();

  TileCacheOptions options_;
  std::uint64_t source_;
  mutable std::mutex mutex_;  // guards what follows
  TileCacheStatus status_;
};

}  // namespace lodestone

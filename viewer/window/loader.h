// SPDX-License-Identifier: MIT
// Opens files beside the frame loop: .lode files, cluster graphs and tilesets as they are, anything else is read and
// made into a model on the fly.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include <lodestone/cluster_file.h>
#include <lodestone/progressive_model.h>
#include <lodestone/result.h>
#include <lodestone/tile_loader.h>

namespace lodestone::render {

class Loader {
 public:
  using Model = std::shared_ptr<const ProgressiveModel>;
  using Tiles = std::shared_ptr<const TilePyramid>;
  using Clusters = std::shared_ptr<const ClusterFile>;
  using Opened = std::variant<Model, Tiles, Clusters>;
  ~Loader();

  /// A folder for copies of tiles; empty: none. From the next start() on.
  void keep_tiles_in(const std::filesystem::path& folder) { tile_cache_ = folder; }
  /// Gives up what is under way and starts on `file`.
  void start(const std::filesystem::path& file);
  /// The result, once, when it is there.
  [[nodiscard]] std::optional<Result<Opened>> take();

  [[nodiscard]] bool busy() const { return busy_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] std::string stage() const;
  [[nodiscard]] float fraction() const { return fraction_; }

 private:
  void stop();
  void load();

  std::filesystem::path file_;
  std::filesystem::path tile_cache_;
  std::thread worker_;
  std::atomic<bool> cancel_ = false;
  std::atomic<bool> busy_ = false;
  std::atomic<float> fraction_ = 0.0F;
  mutable std::mutex mutex_;  ///< guards the two below
  std::string stage_;
  std::optional<Result<Opened>> result_;
};

}  // namespace lodestone::render

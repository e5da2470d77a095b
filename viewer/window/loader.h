// SPDX-License-Identifier: MIT
// Opens files beside the frame loop: .lode files, cluster graphs and tilesets as they are, anything else is read and
// made into a model on the fly. Makes the street, too.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
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

#include "street.h"

namespace lodestone::render {

class Loader {
 public:
  using Model = std::shared_ptr<const ProgressiveModel>;
  using Tiles = std::shared_ptr<const TilePyramid>;
  using Clusters = std::shared_ptr<const ClusterFile>;
  using StreetOfHouses = std::shared_ptr<const Street>;
  using Opened = std::variant<Model, Tiles, Clusters, StreetOfHouses>;
  ~Loader();

  /// A folder for copies of tiles; empty: none. From the next start() on.
  void keep_tiles_in(const std::filesystem::path& folder) { tile_cache_ = folder; }
  /// Gives up what is under way and starts on `file`.
  void start(const std::filesystem::path& file);
  /// The same with a street of so many generated houses; file() is empty then.
  void start_street(unsigned house_count);
  /// The result, once, when it is there.
  [[nodiscard]] std::optional<Result<Opened>> take();

  [[nodiscard]] bool busy() const { return busy_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// What to call it: the file's name, or "Street".
  [[nodiscard]] const std::string& title() const { return title_; }
  [[nodiscard]] std::string stage() const;
  [[nodiscard]] float fraction() const { return fraction_; }

 private:
  using Work = std::function<Result<Opened>(const Context&)>;
  void stop();
  void begin(const std::string& title, const Work& work);
  void load(const Work& work);

  std::filesystem::path file_;
  std::string title_;
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

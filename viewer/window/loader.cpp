// SPDX-License-Identifier: MIT
#include "loader.h"

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>

namespace lodestone::render {
namespace {

Result<Loader::Opened> open(const std::filesystem::path& file, const std::filesystem::path& tile_cache,
                            const Context& context) {
  if (is_tileset_file(file)) {
    std::optional<TileCacheOptions> cache;
    if (!tile_cache.empty()) cache = TileCacheOptions{.folder = tile_cache};
    auto tiles = TilePyramid::open(file, cache);
    if (!tiles) return tiles.error();
    return Loader::Opened{std::move(*tiles)};
  }
  if (is_cluster_file(file)) {
    auto clusters = ClusterFile::open(file);
    if (!clusters) return clusters.error();
    return Loader::Opened{std::move(*clusters)};
  }
  if (is_model_file(file)) {
    auto model = read_model(file, {}, context);
    if (!model) return model.error();
    return {Loader::Opened{std::move(*model)}, std::move(model.warnings())};
  }
  auto loaded = read_mesh(file, {}, context);
  if (!loaded) return loaded.error();
  Mesh& mesh = loaded->mesh;
  if (mesh.triangle_count() == 0) {
    return Error{ErrorCode::BadData, "there are no triangles in it to show", file.string()};
  }
  auto built = build_by_edge_collapse(mesh, {}, context);
  if (!built) return built.error();
  return {Loader::Opened{std::move(built->model)}, std::move(loaded.warnings())};
}

}  // namespace

Loader::~Loader() { stop(); }

void Loader::stop() {
  cancel_ = true;
  if (worker_.joinable()) worker_.join();
  cancel_ = false;
}

void Loader::start(const std::filesystem::path& file) {
  stop();
  file_ = file;
  begin(file.filename().string(),
        [file, cache = tile_cache_](const Context& context) { return open(file, cache, context); });
}

void Loader::start_street(unsigned house_count) {
  stop();
  file_.clear();
  begin("Street", [house_count](const Context& context) -> Result<Opened> {
    auto street = make_street({.house_count = house_count}, context);
    if (!street) return street.error();
    return Opened{std::move(*street)};
  });
}

void Loader::begin(const std::string& title, const Work& work) {
  title_ = title;
  fraction_ = 0.0F;
  {
    const std::lock_guard lock{mutex_};
    stage_ = file_.empty() ? "building houses" : "reading";
    result_.reset();
  }
  busy_ = true;
  worker_ = std::thread{[this, work] { load(work); }};
}

void Loader::load(const Work& work) {
  Context context;
  context.cancel = &cancel_;
  context.progress = [this](std::string_view stage, double fraction) {
    fraction_ = static_cast<float>(fraction);
    const std::lock_guard lock{mutex_};
    stage_ = stage;
  };
  auto result = work(context);
  const std::lock_guard lock{mutex_};
  result_ = std::move(result);
  busy_ = false;
}

std::string Loader::stage() const {
  const std::lock_guard lock{mutex_};
  return stage_;
}

std::optional<Result<Loader::Opened>> Loader::take() {
  if (busy_) return std::nullopt;
  const std::lock_guard lock{mutex_};
  return std::exchange(result_, std::nullopt);
}

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
#include "loader.h"

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>

namespace lodestone::render {
namespace {

Result<Loader::Model> open_model(const std::filesystem::path& file, const Context& context) {
  if (is_model_file(file)) return read_model(file, {}, context);
  auto loaded = read_mesh(file, {}, context);
  if (!loaded) return loaded.error();
  Mesh& mesh = loaded->mesh;
  if (mesh.triangle_count() == 0) {
    return Error{ErrorCode::BadData, "there are no triangles in it to show", file.string()};
  }
  auto built = build_by_edge_collapse(mesh, {}, context);
  if (!built) return built.error();
  return {std::move(built->model), std::move(loaded.warnings())};
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
  fraction_ = 0.0F;
  {
    const std::lock_guard lock{mutex_};
    stage_ = "reading";
    result_.reset();
  }
  busy_ = true;
  worker_ = std::thread{[this] { load(); }};
}

void Loader::load() {
  Context context;
  context.cancel = &cancel_;
  context.progress = [this](std::string_view stage, double fraction) {
    fraction_ = static_cast<float>(fraction);
    const std::lock_guard lock{mutex_};
    stage_ = stage;
  };
  auto result = open_model(file_, context);
  const std::lock_guard lock{mutex_};
  result_ = std::move(result);
  busy_ = false;
}

std::string Loader::stage() const {
  const std::lock_guard lock{mutex_};
  return stage_;
}

std::optional<Result<Loader::Model>> Loader::take() {
  if (busy_) return std::nullopt;
  const std::lock_guard lock{mutex_};
  return std::exchange(result_, std::nullopt);
}

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
#include <lodestone/cluster_file.h>
#include <lodestone/tile_loader.h>

#include <chrono>

#include "camera_options.h"
#include "level_choice.h"
#include "mesh_input.h"
#include "verbs.h"
#include "viewer/headless/headless_clusters.h"

namespace lodestone::cli {
namespace {

constexpr double default_error_px = 1.0;

class Render final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "render"; }
  [[nodiscard]] std::string summary() const override { return "Draw a mesh or a level of a model, without a window"; }
  [[nodiscard]] std::string example() const override {
    return "lodestone render house.lode --ratio 0.2 --wireframe -o house.png";
  }
  void declare(Arguments& arguments) override;
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] Status check_error_px() const;
  [[nodiscard]] Result<render::Picture> draw(Session& session, const render::RenderOptions& options) const;
  [[nodiscard]] Result<render::Picture> draw_model(Session& session, const render::RenderOptions& options) const;
  [[nodiscard]] Result<render::Picture> draw_tiles(Session& session, const render::RenderOptions& options) const;
  [[nodiscard]] Result<render::Picture> draw_clusters(const render::RenderOptions& options) const;
  [[nodiscard]] Result<render::Picture> draw_sheet(const std::shared_ptr<const ProgressiveModel>& model,
                                                   const render::RenderOptions& options, const Context& context) const;

  MeshInput input_;
  std::filesystem::path output_;
  LevelChoice level_;
  std::filesystem::path plan_;
  CameraOptions camera_;
  bool wireframe_ = false;
  bool lod_colors_ = false;
  bool cluster_colors_ = false;
  std::optional<double> error_px_;
  bool untextured_ = false;
  bool white_ = false;
  bool unlit_ = false;
  bool lit_ = false;
  std::uint32_t sheet_levels_ = 0;
  std::filesystem::path cache_;
  std::uint64_t cache_bytes_ = TileCacheOptions{}.max_bytes;
};

void Render::declare(Arguments& arguments) {
  input_.declare(arguments, "FILE",
                 "Mesh, .lode or .lodg file, tileset.json (its address, if it is on the web) or .osgb root");
  arguments.file("-o,--output", output_, "Picture to write: .png, .jpg or .webp", Need::Required);
  level_.declare(arguments);
  arguments.file("--plan", plan_, "With --perceptual: the level that a plan made by 'distances' needs", Need::Optional);
  camera_.declare(arguments);
  arguments.flag("--wireframe", wireframe_, "Draw triangle edges over the surface");
  arguments.flag("--lod-colors", lod_colors_, "Colour by triangle size: blue is fine, red is coarse");
  arguments.flag("--cluster-colors", cluster_colors_, "A colour for each cluster of a .lodg file");
  arguments.number("--error-px", error_px_, 1e-3, 1e6,
                   "Error on the screen that is allowed, in pixels, of a .lodg file or tiles; 1 if not given");
  arguments.flag("--untextured", untextured_, "Leave textures out");
  arguments.flag("--unlit", unlit_, "Colours as they are, without lamps; how tilesets with photographs are drawn");
  arguments.flag("--lit", lit_, "Under lamps, how everything else is drawn");
  arguments.flag("--white", white_, "White background");
  arguments.file("--tile-cache", cache_, "Folder for copies of tiles, of a tileset on the web or a slow disk",
                 Need::Optional);
  arguments.bytes("--tile-cache-bytes", cache_bytes_, "Most bytes of all copies in that folder");
  arguments.count("--sheet", sheet_levels_, 0, 64,
                  "A sheet of so many levels of a model, each --size large, 0 = one picture");
}

Result<render::Picture> Render::draw_sheet(const std::shared_ptr<const ProgressiveModel>& model,
                                           const render::RenderOptions& options, const Context& context) const {
  if (level_.ways() > 0) return Error{ErrorCode::BadArgument, "--sheet shows many levels, do not name one", ""};
  const auto start = std::chrono::steady_clock::now();
  auto sheet = render::picture_sheet(model, {.levels = sheet_levels_, .render = options}, context);
  if (!sheet) return Error{sheet.error().code, sheet.error().message, input_.file().string()};
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return render::Picture{std::move(*sheet), model->face_slot_count(), seconds / sheet_levels_};
}

Result<render::Picture> Render::draw_model(Session& session, const render::RenderOptions& options) const {
  auto model = read_model(input_.file(), {}, session.context());
  session.keep(model);
  if (!model) return model.error();
  if (sheet_levels_ > 0) return draw_sheet(*model, options, session.context());
  if (level_.ways() == 0) return render::render_level(*model, (*model)->record_count(), options);
  const auto level = level_.in(**model, plan_);
  if (!level) return level.error();
  return render::render_level(*model, *level, options);
}

// Refused where nothing is chosen by it. A file that is not there is left to those that read it.
Status Render::check_error_px() const {
  const std::filesystem::path& file = input_.file();
  if (!error_px_ || is_tileset_file(file) || is_cluster_file(file)) return Done{};
  std::error_code fault;
  if (!std::filesystem::exists(file, fault)) return Done{};
  return Error{ErrorCode::BadArgument, "--error-px needs a .lodg file, tileset.json or .osgb root, leave it out",
               file.string()};
}

// The tiles that this camera needs.
Result<render::Picture> Render::draw_tiles(Session& session, const render::RenderOptions& options) const {
  std::optional<TileCacheOptions> cache;
  if (!cache_.empty()) cache = TileCacheOptions{.folder = cache_, .max_bytes = cache_bytes_};
  const auto pyramid = TilePyramid::open(input_.file(), cache);
  if (!pyramid) return pyramid.error();
  auto picture = render::render_tiles(*pyramid, options, {.error_px = error_px_.value_or(default_error_px)});
  if (!picture) return Error{picture.error().code, picture.error().message, input_.file().string()};
  session.report().set("tiles", picture->tiles);
  if (cache) session.report().set("cached_tiles", (*pyramid)->cache_status().hits);
  return picture;
}

// The clusters that this camera needs, streamed in, where their morph stands.
Result<render::Picture> Render::draw_clusters(const render::RenderOptions& options) const {
  const auto file = ClusterFile::open(input_.file());
  if (!file) return file.error();
  return render::render_clusters(*file, options, error_px_.value_or(default_error_px));
}

Result<render::Picture> Render::draw(Session& session, const render::RenderOptions& options) const {
  if (level_.ways() > 1) {
    return Error{ErrorCode::BadArgument,
                 "name the level by one of --triangles, --ratio, --error, --level and --perceptual", ""};
  }
  if (!plan_.empty() && !level_.is_perceptual()) {
    return Error{ErrorCode::BadArgument, "--plan needs --perceptual, which says from how far away", ""};
  }
  if (auto meant = check_error_px(); !meant) return meant.error();
  if (is_model_file(input_.file())) return draw_model(session, options);
  if (level_.ways() > 0 || sheet_levels_ > 0) {
    return Error{ErrorCode::BadArgument, "levels are chosen from a .lode file, build one first",
                 input_.file().string()};
  }
  if (is_tileset_file(input_.file())) return draw_tiles(session, options);
  if (is_cluster_file(input_.file())) return draw_clusters(options);
  const auto loaded = input_.read(session);
  if (!loaded) return loaded.error();
  return render::render_mesh(loaded->mesh, options);
}

Status Render::run(Session& session) {
  if (auto writable = check_output(output_); !writable) return writable;
  if (unlit_ && lit_) return Error{ErrorCode::BadArgument, "it is either --unlit or --lit", ""};
  render::RenderOptions options;
  camera_.apply(options);
  options.look.wireframe = wireframe_;
  if (untextured_) options.look.coloring = render::Coloring::Untextured;
  if (lod_colors_) options.look.coloring = render::Coloring::Lod;
  if (cluster_colors_) options.look.coloring = render::Coloring::Clusters;
  if (unlit_) options.look.lighting = render::Lighting::Photograph;
  if (lit_) options.look.lighting = render::Lighting::Lamps;
  if (white_) options.look.background = render::Background::White;
  auto picture = draw(session, options);
  session.keep(picture);
  if (!picture) return picture.error();
  session.report().set("triangles", picture->triangles);
  session.report().set("frame_seconds", picture->frame_seconds);
  return write_image(picture->image, output_);
}

}  // namespace

std::unique_ptr<Verb> make_render() { return std::make_unique<Render>(); }

}  // namespace lodestone::cli

// SPDX-License-Identifier: MIT
// Pictures without a window: what the verbs `render`, `sweep`, `compare --images` and the picture sheets call. Software
// OpenGL (OSMesa), so it runs anywhere; no GL name is visible here.
//
//     auto picture = lodestone::render::render_mesh(mesh, {.width_px = 800, .height_px = 600});
//     if (picture) lodestone::write_image(picture->image, "house.png");
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/cursor.h>
#include <lodestone/discrete_levels.h>
#include <lodestone/image.h>
#include <lodestone/mesh.h>
#include <lodestone/progressive_model.h>
#include <lodestone/result.h>
#include <lodestone/tile_loader.h>
#include <lodestone/view.h>

#include "../render/options.h"

namespace lodestone::render {

/// Where the camera stands. Without an eye the whole model is framed in a three-quarter view.
struct Camera {
  std::optional<glm::dvec3> eye_m;     ///< in world coordinates (with the model's origin)
  std::optional<glm::dvec3> target_m;  ///< looked at; the middle of the model if not given
  double fov_y_rad = 0.6;              ///< full vertical angle, 0.01..3
  /// Of the framed view: 0 looks north, negative moves the eye to the west; not given: the side most triangles face.
  std::optional<double> yaw_rad;
  double pitch_rad = 0.38;  ///< of the framed view: above the horizon, -1.5..1.5
};

struct RenderOptions {
  std::uint32_t width_px = 1280;
  std::uint32_t height_px = 720;
  /// Shaded samples per pixel and axis, 1..4, on top of 4 coverage samples: 2 for pictures, 1 for speed.
  std::uint32_t supersample = 2;
  Look look{};
  Camera camera{};
};

struct Picture {
  Image image;  ///< RGB
  std::uint32_t triangles = 0;
  double frame_seconds = 0.0;            ///< one frame, drawn again after a first one: without uploads and reading back
  double frame_processor_seconds = 0.0;  ///< the same, of all threads together
  std::uint32_t tiles = 0;               ///< of a tileset
};

/// Errors: BadArgument for a picture size or angle out of range, Unsupported where OSMesa is missing or too old.
[[nodiscard]] Result<Picture> render_mesh(const Mesh& mesh, const RenderOptions& options = {});
[[nodiscard]] Result<Picture> render_level(std::shared_ptr<const ProgressiveModel> model, Level level,
                                           const RenderOptions& options = {});

/// A tileset, with all tiles that the view needs at `pager.error_px`. What could not be read is told in warnings.
[[nodiscard]] Result<Picture> render_tiles(std::shared_ptr<const TilePyramid> pyramid,
                                           const RenderOptions& options = {}, const PagerOptions& pager = {});

/// The view that render_mesh() takes of a mesh, relative to its origin: to choose tiles or clusters by, before drawing.
[[nodiscard]] Result<View> view_of_mesh(const Mesh& mesh, const RenderOptions& options = {});

/// How a sweep goes from level to level.
enum class SweepStyle : std::uint8_t {
  Morph,     ///< continuous, geomorph; what facet shifts draw anew fades (Motion::MorphFade)
  Hard,      ///< continuous, records snap
  Discrete,  ///< a few fixed levels, switched half way between them
  Fade,      ///< the same, cross-faded over `fade_seconds` (both are drawn)
};
[[nodiscard]] Result<SweepStyle> sweep_style(const std::string& name);

/// A sweep shows `frames` pictures, 1/60 s apart. The wanted triangle count moves from `from_ratio` to `to_ratio` of
/// the source's in equal *factors* per frame, the same for every style: a frame always loses the same share of what is
/// on the screen, as under a camera that backs away steadily. (Equal numbers of records per frame would spend nearly
/// all frames where no change can be seen and rush through the coarse levels.)
struct SweepOptions {
  std::uint32_t frames = 600;
  double from_ratio = 1.0;
  double to_ratio = 0.02;
  bool and_back = false;  ///< half of the frames there, half back
  /// If given, the levels are what an eye needs (equation 17 of perception.h, at the size and field of view of the
  /// pictures) from where the model just fills them to so many metres away, in equal factors of distance; the two
  /// ratios do not count.
  std::optional<double> perceptual_m;
  /// With `perceptual_m`: the levels that this plan has measured to be needed, instead of equation 17's.
  std::optional<LevelPlan> plan;
  SweepStyle style = SweepStyle::Morph;
  std::uint32_t discrete_levels = 5;  ///< Discrete, Fade: from `from_ratio` to `to_ratio` in equal factors
  double morph_seconds = 2.0;         ///< Morph: time that a record takes
  double fade_seconds = 0.5;          ///< Fade: time that a switch takes
  /// Supersampled by default: where it is not, an edge that glides over a column of pixels jumps by a quarter of the
  /// contrast, and that counts as a pop.
  RenderOptions render{.width_px = 960, .height_px = 540};
  /// Called with every picture, in order; an error ends the sweep.
  std::function<Status(const Image& image, std::uint32_t frame)> on_frame;
};

struct SweepReport {
  std::uint32_t frames = 0;
  double pop_max = 0.0;             ///< largest block_pop() of successive pictures
  double pop_mean = 0.0;            ///< its mean
  std::uint32_t pop_max_frame = 0;  ///< the later picture of the pair with pop_max
  double frame_seconds_p50 = 0.0;   ///< step, upload and drawing; without reading back and comparing
  double frame_seconds_p99 = 0.0;
  std::size_t memory_bytes = 0;  ///< geometry held: model and cursor, or all discrete levels; no textures
};
[[nodiscard]] Result<SweepReport> sweep(std::shared_ptr<const ProgressiveModel> model, const SweepOptions& options,
                                        const Context& context = {});

/// Root mean square colour difference (0..255) over pictures of both meshes from the six axis directions, each framed
/// by a's box, over the pixels that either mesh covers. World coordinates: different origins are taken into account.
[[nodiscard]] Result<double> six_direction_rms(const Mesh& a, const Mesh& b, std::uint32_t size_px = 512,
                                               const Look& look = {});

/// A sheet of `levels` pictures (columns x rows as square as it gets) from the finest to `coarsest_ratio` in equal
/// factors, each with its triangles, error and level written below.
struct SheetOptions {
  std::uint32_t levels = 8;
  std::uint32_t columns = 4;
  double coarsest_ratio = 0.01;
  RenderOptions render{.width_px = 480, .height_px = 360};
};
[[nodiscard]] Result<Image> picture_sheet(const std::shared_ptr<const ProgressiveModel>& model,
                                          const SheetOptions& options, const Context& context = {});

}  // namespace lodestone::render

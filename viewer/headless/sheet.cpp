// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "caption.h"
#include "stage.h"

namespace lodestone::render {
namespace {

constexpr std::uint32_t gap_px = 6;
constexpr std::uint32_t caption_band_px = caption_height_px + 6;

std::string length_text(double length_m) {
  char text[32];
  if (length_m <= 0.0) {
    return "exact";
  }
  if (length_m < 0.01) {
    std::snprintf(text, sizeof text, "error %.2g mm", length_m * 1e3);
  } else if (length_m < 1.0) {
    std::snprintf(text, sizeof text, "error %.3g cm", length_m * 1e2);
  } else {
    std::snprintf(text, sizeof text, "error %.3g m", length_m);
  }
  return text;
}

std::string caption_of(const LevelInfo& info, std::uint32_t finest_triangles) {
  char text[96];
  std::snprintf(text, sizeof text, "%u triangles (%.3g %%), %s", info.triangles,
                100.0 * info.triangles / std::max(1U, finest_triangles), length_text(info.error_m).c_str());
  return text;
}

void paste(Image& sheet, const Image& picture, std::uint32_t x_px, std::uint32_t y_px) {
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    std::copy_n(picture.at(0, y), static_cast<std::size_t>(picture.width) * 3, sheet.at(x_px, y_px + y));
  }
}

}  // namespace

Result<Image> picture_sheet(const std::shared_ptr<const ProgressiveModel>& model, const SheetOptions& options,
                            const Context& context) {
  const RenderOptions& render = options.render;
  if (options.levels == 0 || options.levels > 100 || options.columns == 0 || !(options.coarsest_ratio > 0.0) ||
      options.coarsest_ratio > 1.0) {
    return Error{ErrorCode::BadArgument, "a sheet has 1 to 100 levels and ends at a share above 0 and up to 1", ""};
  }
  Cursor cursor{model, {.motion = Motion::Hard, .start_level = model->record_count()}};
  const auto view = view_of(render, model->bounds(), model->data().origin, arrays_of(cursor));
  if (!view) return view.error();
  auto stage = Stage::create();
  if (!stage) return stage.error();
  Stage& on = **stage;
  const auto frame = Frame::create(on.gl(), frame_size(render));
  if (!frame) return frame.error();

  const Surfaces surfaces{on.gl(), model->data()};
  Geometry geometry{on.gl(), arrays_of(cursor)};
  const Item item{.geometry = &geometry, .surfaces = &surfaces, .size_m = model->bounds().diagonal_m()};

  const std::uint32_t columns = std::min(options.columns, options.levels);
  const std::uint32_t rows = (options.levels + columns - 1) / columns;
  const std::uint32_t step_x = render.width_px + gap_px;
  const std::uint32_t step_y = render.height_px + caption_band_px + gap_px;
  Image sheet{.width = columns * step_x + gap_px, .height = rows * step_y + gap_px, .channels = 3, .pixels = {}};
  sheet.pixels.assign(static_cast<std::size_t>(sheet.width) * sheet.height * 3, 255);

  const std::uint32_t finest = model->info(model->record_count()).triangles;
  const double base_ratio = static_cast<double>(model->info(0).triangles) / std::max(1U, finest);
  const double end_ratio = std::max({options.coarsest_ratio, base_ratio, 1e-9});
  for (std::uint32_t i = 0; i < options.levels; ++i) {
    if (context.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", ""};
    context.report("pictures", double(i) / options.levels);
    const double ratio = options.levels == 1 ? 1.0 : std::pow(end_ratio, double(i) / (options.levels - 1));
    const Level level = model->level_of_triangles(static_cast<std::uint32_t>(std::lround(ratio * finest)));
    cursor.jump(level);
    geometry.update(cursor);
    on.renderer().draw(*frame, *view, model->bounds(), {&item, 1}, render.look);
    const std::uint32_t x = gap_px + (i % columns) * step_x;
    const std::uint32_t y = gap_px + (i / columns) * step_y;
    paste(sheet, on.presenter().read(*frame), x, y);
    draw_caption(sheet, x + 4, y + render.height_px + 5, x + render.width_px, caption_of(model->info(level), finest));
  }
  return {std::move(sheet), surfaces.warnings()};
}

}  // namespace lodestone::render

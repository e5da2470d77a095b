// SPDX-License-Identifier: MIT
/// \file
/// A few fixed levels of a progressive model with the distances at which they switch: the plan as a file, and the
/// levels as GLBs, as one GLB with MSFT_lod, and as a 3D Tiles tileset. For engines that cannot take a continuous
/// model.
///
///     auto plan = lodestone::read_level_plan("plan.json");
///     if (plan) lodestone::write_levels(*model, *plan, "levels");
#pragma once

#include <filesystem>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/progressive_model.h>
#include <lodestone/result.h>

namespace lodestone {

/// One level, shown from its distance on to that of the next.
struct PlannedLevel {
  double from_m = 0.0;          ///< from the camera to the middle of the model
  Level level = 0;              ///< of the model
  std::uint32_t triangles = 0;  ///< of that level; with `level` it tells whether a plan belongs to a model
  double error_m = 0.0;
};

/// The level that a continuous model needs from a distance: coarser ones were seen to differ.
struct NeededLevel {
  double distance_m = 0.0;  ///< from the camera to the middle of the model
  Level level = 0;
};

struct LevelPlan {
  std::vector<PlannedLevel> levels;  ///< ascending distances; the first from 0: the finest level
  double last_m = 0.0;               ///< beyond it the model is smaller than a pixel
  double radius_m = 0.0;             ///< of the sphere about the middle of the model
  double focal_px = 0.0;             ///< pixels that a metre across covers at a distance of a metre
  double height_px = 0.0;            ///< of the screen
  double width_px = 0.0;
  std::vector<NeededLevel> needed;  ///< ascending distances, never finer; may be empty
};

/// Where a continuous model should be from a distance, on the screen of the plan (for another one multiply the distance
/// by the plan's focal_px over the other's): `cursor.set_target(Target::level(needed_level(plan, distance_m)))`.
/// Between the distances of `plan.needed` evenly in the logarithm of the distance, in full detail before the first;
/// without `needed` the discrete level that is shown there. Precondition: as read_level_plan gives it.
[[nodiscard]] Level needed_level(const LevelPlan& plan, double distance_m) noexcept;

/// Whether the plan was made for this model, by its levels and their triangles; else BadArgument.
[[nodiscard]] Status check_level_plan(const LevelPlan& plan, const ProgressiveModel& model);

/// JSON; numbers are written so that they read back the same. Errors: BadData with what is missing or out of order.
[[nodiscard]] Status write_level_plan(const LevelPlan& plan, const std::filesystem::path& file);
[[nodiscard]] Result<LevelPlan> read_level_plan(const std::filesystem::path& file);

/// Writes into the folder (made if it is not there) `level_0.glb` (finest), `level_1.glb`, ...; `levels.glb`, all of
/// them with MSFT_lod and the screen coverage at each switch; and `tileset.json` (3D Tiles 1.1, refinement REPLACE),
/// whose geometric errors make a client with the default maximum screen-space error of 16 pixels switch at the
/// distances of the plan. Z up; the tileset carries the model's own coordinates (give it a transform to place it on the
/// globe). Errors: BadArgument if the plan does not belong to the model. O(sum of the levels).
[[nodiscard]] Status write_levels(const ProgressiveModel& model, const LevelPlan& plan,
                                  const std::filesystem::path& folder, const Context& context = {});

}  // namespace lodestone

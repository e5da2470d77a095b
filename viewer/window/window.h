// SPDX-License-Identifier: MIT
// The window: slider over levels, orbit, wireframe, LOD colours, sweep, automatic level. No GL, GLFW or Dear ImGui name
// is visible here.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <lodestone/result.h>

#include "../render/options.h"

namespace lodestone::render {

struct WindowOptions {
  std::filesystem::path file;  ///< opened first; empty: the window waits for a file to be dropped on it
  /// Instead of a file, so many generated houses along a street, each at the level that its distance asks for; 0: none.
  unsigned street_houses = 0;
  std::uint32_t width_px = 1280;
  std::uint32_t height_px = 800;
  /// Share of the triangles to go to once the model is there; the slider moves with it.
  std::optional<double> ratio;
  std::string level;  ///< name of a level to go to ("lod2"), as `ratio`; empty: none
  /// Written, panel and all, once the model has arrived at its level; the window closes then.
  std::filesystem::path screenshot;
  bool play = false;  ///< start the sweep
  /// Start with the level that the camera's distance asks for: what `plan` has measured to be needed, without one at
  /// most half a pixel off (equation 17 of perception.h).
  bool perceptual = false;
  std::filesystem::path plan;        ///< plan.json of `lodestone distances` for `file`
  std::filesystem::path tile_cache;  ///< folder for copies of tiles (TileCacheOptions); empty: none
  bool fly = false;                  ///< the camera flies over the model, round and round, until it is taken by hand
  Lighting lighting = Lighting::Automatic;
  bool wireframe = false;
  bool lod_colors = false;
  bool cluster_colors = false;  ///< of a cluster graph
};

/// Shows the window until it is closed. Errors: Unsupported without a display or OpenGL 3.3; what reading `file` gave
/// (a file dropped later that cannot be read is reported in the window).
[[nodiscard]] Status run_window(const WindowOptions& options);

}  // namespace lodestone::render

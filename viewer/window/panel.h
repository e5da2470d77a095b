// SPDX-License-Identifier: MIT
// The panel of controls, with Dear ImGui. The only file of the window that names it.
#pragma once

#include <string>

#include "../render/cluster_scene.h"
#include "../render/options.h"
#include "../render/tile_scene.h"
#include "level_control.h"
#include "street_scene.h"

struct GLFWwindow;

namespace lodestone::render {

/// What the panel shows and what it may change.
struct PanelState {
  LevelControl& control;
  Look& look;
  float& morph_seconds;
  const FrameTimes& frame_times;
  const Cursor* cursor = nullptr;          ///< null while there is no model
  const TileScene* tiles = nullptr;        ///< null while there is no tileset
  const ClusterScene* clusters = nullptr;  ///< null while there is no cluster graph
  const StreetScene* street = nullptr;     ///< null while there is no street
  ClusterFrame cluster_frame;              ///< of `clusters`
  bool& flies;
  std::string title;    ///< file shown
  std::string message;  ///< what went wrong last, or a hint; may be empty
  std::string loading;  ///< stage, empty when nothing loads
  float loading_fraction = 0.0F;
  double screen_error_px = 0.0;
  double uploaded_kb = 0.0;
};

/// What the user asked for that is not a setting.
struct PanelResult {
  bool frame_model = false;     ///< put the camera back
  bool restart_cursor = false;  ///< morph_seconds changed
  bool changed = false;         ///< a control is in use: draw on
};

class Panel {
 public:
  explicit Panel(GLFWwindow* window);
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;
  ~Panel();

  /// Lays the panel out; the mouse and keys that it uses are not for the camera.
  [[nodiscard]] PanelResult layout(const PanelState& state);
  [[nodiscard]] bool wants_mouse() const;
  /// Draws it into the current framebuffer.
  void draw();
};

}  // namespace lodestone::render

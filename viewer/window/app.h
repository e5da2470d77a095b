// SPDX-License-Identifier: MIT
// The window's frame loop and everything that lives in it.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "../render/cluster_scene.h"
#include "../render/frame.h"
#include "../render/renderer.h"
#include "../render/tile_scene.h"
#include "glfw_window.h"
#include "level_control.h"
#include "loader.h"
#include "orbit_camera.h"
#include "panel.h"
#include "street_scene.h"
#include "window.h"

namespace lodestone::render {

class App {
 public:
  [[nodiscard]] static Result<std::unique_ptr<App>> create(const WindowOptions& options);
  /// Until the window is closed, or the screenshot is written.
  [[nodiscard]] Status run();

 private:
  // A model on the screen.
  struct Shown {
    Shown(const Gl& gl, std::shared_ptr<const ProgressiveModel> model, double morph_seconds, Level level);
    std::shared_ptr<const ProgressiveModel> model;
    Cursor cursor;
    Geometry geometry;
    std::optional<Geometry> beside;
  };

  App(const WindowOptions& options, std::unique_ptr<GlfwWindow> window, std::unique_ptr<Gl> gl, Renderer renderer,
      Presenter presenter);
  [[nodiscard]] Status take_loaded();
  [[nodiscard]] Status take_plan();
  [[nodiscard]] Status take_level();
  void clear();
  void show(const Loader::Model& model);
  void show(const Loader::Tiles& tiles);
  void show(const Loader::Clusters& clusters);
  void show(const Loader::StreetOfHouses& street);
  [[nodiscard]] bool shows_something() const { return shown_ || tiles_ || clusters_ || street_; }
  [[nodiscard]] Box bounds() const;
  [[nodiscard]] View view() const;
  void frame(const Box& bounds, double yaw_rad);
  void stand_in_street();
  void move_on(double dt_s);
  void use_input(double dt_s);
  void use_keys();
  void draw_frame();
  [[nodiscard]] bool draw_second(Item item, const Box& box);
  void obey(const PanelResult& asked);
  [[nodiscard]] Status fit_frame_to_window();
  [[nodiscard]] PanelResult lay_out_panel(const View& view);
  [[nodiscard]] bool settled() const;
  [[nodiscard]] Status write_screenshot();

  WindowOptions options_;
  std::unique_ptr<GlfwWindow> window_;  // holds the context: first in, last out
  std::unique_ptr<Gl> gl_;
  Renderer renderer_;
  Presenter presenter_;
  std::optional<Frame> frame_;
  std::optional<Frame> second_;  ///< made when a model first fades
  Panel panel_;
  Loader loader_;
  std::unique_ptr<Surfaces> surfaces_;
  std::unique_ptr<Shown> shown_;            ///< a model,
  std::unique_ptr<TileScene> tiles_;        ///< or a tileset,
  std::unique_ptr<ClusterScene> clusters_;  ///< or a cluster graph
  std::unique_ptr<StreetScene> street_;     ///< or a street
  ClusterFrame cluster_frame_;
  OrbitCamera camera_;
  LevelControl control_;
  FrameTimes frame_times_;
  Look look_;
  bool flies_ = false;
  double flown_s_ = 0.0;
  float morph_seconds_ = 0.5F;
  std::string title_;
  std::string message_;
  double uploaded_kb_ = 0.0;
  int still_frames_ = 0;  ///< drawn since the model arrived at its level
};

}  // namespace lodestone::render

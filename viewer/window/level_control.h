// SPDX-License-Identifier: MIT
// What decides the level: a slider, a sweep that plays, or the camera's distance.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/cursor.h>
#include <lodestone/discrete_levels.h>

namespace lodestone::render {

enum class LevelMode : std::uint8_t { Slider, Sweep, Automatic };

/// Slider positions are logarithmic in triangles: equal moves change the count by equal factors. 1 = finest,
/// 0 = base (a dozen triangles where the base has fewer).
class LevelControl {
 public:
  /// A level of the model that has a name, or several.
  struct Mark {
    std::string name;  ///< as shown: "LoD2", or "LoD1, block"
    Level level = 0;
    float slider = 0.0F;
  };

  void attach(const ProgressiveModel& model);

  /// Finest first; empty where the model names no levels.
  [[nodiscard]] const std::vector<Mark>& marks() const { return marks_; }
  /// The name that a level goes by: that of the finest mark which is not finer than it. Empty where there is none, and
  /// below the coarsest.
  [[nodiscard]] std::string name_of(Level level) const;
  /// Puts the slider on exactly this level, although others may have as many triangles.
  void go_to(Level level, const ProgressiveModel& model);

  LevelMode mode = LevelMode::Slider;
  float slider = 1.0F;        ///< 0..1
  float max_error_px = 1.0F;  ///< Automatic
  /// Automatic: instead of `max_error_px`, the levels that a plan of the model has measured to be needed from the
  /// camera's distance.
  std::optional<LevelPlan> plan;
  float sweep_s = 12.0F;  ///< Sweep: time from one end to the other and back

  [[nodiscard]] float slider_of(std::uint32_t triangles) const;
  [[nodiscard]] std::uint32_t triangles_of(float slider) const;

  /// Sets the cursor's target for this frame. Sweep moves the slider; Automatic takes the camera.
  void drive(Cursor& cursor, const View& view, double dt_s);

 private:
  [[nodiscard]] Level needed_from(const View& view, const ProgressiveModel& model) const;

  struct ExactPlace {
    float slider;
    Level level;
  };

  std::vector<Mark> marks_;
  std::optional<ExactPlace> exact_;  ///< since go_to(), for as long as the slider stays there
  double finest_log_ = 0.0;
  double base_log_ = 0.0;
  double direction_ = -1.0;
};

/// The last few seconds of frame times, for the graph.
class FrameTimes {
 public:
  void add(double seconds) {
    ms_[next_] = static_cast<float>(seconds * 1e3);
    next_ = (next_ + 1) % ms_.size();
  }
  [[nodiscard]] const std::array<float, 240>& ms() const { return ms_; }
  [[nodiscard]] std::size_t oldest() const { return next_; }
  [[nodiscard]] float latest_ms() const { return ms_[(next_ + ms_.size() - 1) % ms_.size()]; }

 private:
  std::array<float, 240> ms_{};
  std::size_t next_ = 0;
};

}  // namespace lodestone::render

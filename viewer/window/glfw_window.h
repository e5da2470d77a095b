// SPDX-License-Identifier: MIT
// The operating system's window, its input and its OpenGL context.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <lodestone/result.h>

struct GLFWwindow;

namespace lodestone::render {

struct MouseDrag {
  double dx_px = 0.0;
  double dy_px = 0.0;
  bool left = false;
  bool other = false;  ///< middle or right, or left with shift
};

class GlfwWindow {
 public:
  /// Unsupported without a display or OpenGL 3.3. The context is current.
  [[nodiscard]] static Result<std::unique_ptr<GlfwWindow>> create(const std::string& title, int width_px,
                                                                  int height_px);
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;
  ~GlfwWindow();

  [[nodiscard]] static void* address(const char* name);
  [[nodiscard]] GLFWwindow* handle() const { return window_; }
  [[nodiscard]] bool closing() const;
  void set_title(const std::string& title);
  void swap();
  /// Waits for input no longer than `seconds`; 0 only polls.
  void gather_input(double seconds);
  /// Since the last call.
  [[nodiscard]] MouseDrag take_drag();
  [[nodiscard]] double take_wheel_notches();
  [[nodiscard]] std::filesystem::path take_dropped_file();  ///< empty: none
  [[nodiscard]] std::string take_typed();                   ///< characters
  void framebuffer_size(int& width_px, int& height_px) const;

 private:
  GlfwWindow() = default;
  GLFWwindow* window_ = nullptr;
  double last_x_ = 0.0;
  double last_y_ = 0.0;
  bool pressed_ = false;
  double wheel_ = 0.0;
  std::filesystem::path dropped_;
  std::string typed_;
};

}  // namespace lodestone::render

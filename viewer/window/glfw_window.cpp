// SPDX-License-Identifier: MIT
#include "glfw_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <utility>

namespace lodestone::render {
namespace {

Error no_window() {
  const char* reason = nullptr;
  glfwGetError(&reason);
  const std::string why = reason != nullptr ? reason : "unknown reason";
  return Error{ErrorCode::Unsupported,
               "cannot open a window (" + why + "); without a display use `lodestone render` or `lodestone sweep`", ""};
}

}  // namespace

Result<std::unique_ptr<GlfwWindow>> GlfwWindow::create(const std::string& title, int width_px, int height_px) {
  if (glfwInit() == GLFW_FALSE) return no_window();
  std::unique_ptr<GlfwWindow> made{new GlfwWindow};
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  made->window_ = glfwCreateWindow(width_px, height_px, title.c_str(), nullptr, nullptr);
  if (made->window_ == nullptr) return no_window();
  GlfwWindow* self = made.get();
  glfwSetWindowUserPointer(self->window_, self);
  glfwMakeContextCurrent(self->window_);
  glfwSwapInterval(1);
  glfwGetCursorPos(self->window_, &self->last_x_, &self->last_y_);
  glfwSetScrollCallback(self->window_, [](GLFWwindow* w, double, double notches) {
    static_cast<GlfwWindow*>(glfwGetWindowUserPointer(w))->wheel_ += notches;
  });
  glfwSetCharCallback(self->window_, [](GLFWwindow* w, unsigned character) {
    if (character < 128) static_cast<GlfwWindow*>(glfwGetWindowUserPointer(w))->typed_ += static_cast<char>(character);
  });
  glfwSetDropCallback(self->window_, [](GLFWwindow* w, int count, const char** paths) {
    if (count > 0) static_cast<GlfwWindow*>(glfwGetWindowUserPointer(w))->dropped_ = paths[count - 1];
  });
  return made;
}

GlfwWindow::~GlfwWindow() {
  if (window_ != nullptr) glfwDestroyWindow(window_);
  glfwTerminate();
}

void* GlfwWindow::address(const char* name) { return reinterpret_cast<void*>(glfwGetProcAddress(name)); }

bool GlfwWindow::closing() const { return glfwWindowShouldClose(window_) != GLFW_FALSE; }

void GlfwWindow::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void GlfwWindow::swap() { glfwSwapBuffers(window_); }

void GlfwWindow::gather_input(double seconds) {
  if (seconds > 0.0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
}

MouseDrag GlfwWindow::take_drag() {
  double x = 0.0;
  double y = 0.0;
  glfwGetCursorPos(window_, &x, &y);
  const auto down = [this](int button) { return glfwGetMouseButton(window_, button) == GLFW_PRESS; };
  const bool shift = glfwGetKey(window_, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS;
  const bool left = down(GLFW_MOUSE_BUTTON_LEFT);
  const bool other = down(GLFW_MOUSE_BUTTON_MIDDLE) || down(GLFW_MOUSE_BUTTON_RIGHT);
  // A press is not yet a drag: the way to where it happened does not count.
  const bool held = (left || other) && pressed_;
  pressed_ = left || other;
  const MouseDrag drag{
      .dx_px = x - last_x_, .dy_px = y - last_y_, .left = held && left && !shift, .other = held && (other || shift)};
  last_x_ = x;
  last_y_ = y;
  return drag;
}

double GlfwWindow::take_wheel_notches() { return std::exchange(wheel_, 0.0); }

std::filesystem::path GlfwWindow::take_dropped_file() { return std::exchange(dropped_, {}); }

std::string GlfwWindow::take_typed() { return std::exchange(typed_, {}); }

void GlfwWindow::framebuffer_size(int& width_px, int& height_px) const {
  glfwGetFramebufferSize(window_, &width_px, &height_px);
}

}  // namespace lodestone::render

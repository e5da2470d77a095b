// SPDX-License-Identifier: MIT
// A picture being made: antialiased, in linear light, off screen in every back-end.
#pragma once

#include <lodestone/image.h>
#include <lodestone/result.h>

#include "gl.h"
#include "program.h"

namespace lodestone::render {

struct FrameSize {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  /// Shaded texels per pixel and axis, 1..4; on top of the driver's multisampling.
  std::uint32_t supersample = 1;
  /// Coverage samples per texel, as many as the driver has up to this; 1 = edges are not smoothed.
  std::uint32_t coverage_samples = 4;
  friend bool operator==(const FrameSize&, const FrameSize&) = default;
};

/// What the renderer draws into: a multisampled buffer, resolved to a texture.
class Frame {
 public:
  /// Unsupported if the driver refuses a buffer of this size.
  [[nodiscard]] static Result<Frame> create(const Gl& gl, const FrameSize& size);
  Frame(Frame&& other) noexcept;
  Frame& operator=(Frame&& other) noexcept;
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;
  ~Frame();

  [[nodiscard]] const FrameSize& size() const { return size_; }
  /// Binds it for drawing, viewport set.
  void begin() const;
  /// Resolves what was drawn into texture().
  void end() const;
  [[nodiscard]] GLuint texture() const { return texture_; }
  /// What texture() holds, as an upright RGB image of all samples.
  [[nodiscard]] Image read() const;

 private:
  Frame(const Gl& gl, const FrameSize& size) noexcept : gl_(&gl), size_(size) {}
  const Gl* gl_;
  FrameSize size_;
  GLuint draw_framebuffer_ = 0;
  GLuint resolve_framebuffer_ = 0;
  GLuint color_ = 0;  ///< 0 where the texture is drawn into
  GLuint depth_ = 0;
  GLuint texture_ = 0;
};

/// The framebuffer bound for reading, as an upright RGB image.
[[nodiscard]] Image read_framebuffer(const Gl& gl, std::uint32_t width_px, std::uint32_t height_px);

/// Turns frames into the picture shown or kept.
class Presenter {
 public:
  [[nodiscard]] static Result<Presenter> create(const Gl& gl);
  Presenter(Presenter&& other) noexcept;
  Presenter& operator=(Presenter&&) = delete;
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;
  ~Presenter();

  /// Reduces and encodes `frame` into the framebuffer `target` (0 = the window), over its whole size.
  void present(const Frame& frame, GLuint target) const;
  /// A cross-fade of two frames of one size; `share` 0..1 of the second.
  void present_blend(const Frame& first, const Frame& second, double share, GLuint target) const;
  /// The picture as RGB, through a framebuffer of its own.
  [[nodiscard]] Image read(const Frame& frame);
  [[nodiscard]] Image read_blend(const Frame& first, const Frame& second, double share);

 private:
  Presenter(const Gl& gl, Program program);
  void draw(const Frame& first, const Frame& second, double share, GLuint target) const;

  const Gl* gl_;
  Program program_;
  GLuint vertex_array_ = 0;
  GLuint framebuffer_ = 0;
  GLuint color_ = 0;
  std::uint32_t width_px_ = 0;
  std::uint32_t height_px_ = 0;
};

}  // namespace lodestone::render

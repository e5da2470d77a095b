// SPDX-License-Identifier: MIT
#include "frame.h"

#include <algorithm>
#include <string>
#include <utility>

#include "shaders.h"

namespace lodestone::render {

Result<Frame> Frame::create(const Gl& gl, const FrameSize& size) {
  GLint max_px = 0;
  GLint max_samples = 0;
  gl.get_integer_v(GL_MAX_RENDERBUFFER_SIZE, &max_px);
  gl.get_integer_v(GL_MAX_SAMPLES, &max_samples);
  const std::uint32_t width = size.width_px * size.supersample;
  const std::uint32_t height = size.height_px * size.supersample;
  if (width == 0 || height == 0 || width > static_cast<std::uint32_t>(max_px) ||
      height > static_cast<std::uint32_t>(max_px)) {
    return Error{ErrorCode::BadArgument,
                 "a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                     " is outside what the graphics driver takes (1 to " + std::to_string(max_px) + ")",
                 ""};
  }
  const auto w = static_cast<GLsizei>(width);
  const auto h = static_cast<GLsizei>(height);
  const GLint samples =
      size.coverage_samples > 1 ? std::min(static_cast<GLint>(size.coverage_samples), max_samples) : 0;
  Frame frame{gl, size};
  gl.gen_textures(1, &frame.texture_);
  gl.bind_texture(GL_TEXTURE_2D, frame.texture_);
  gl.tex_image_2d(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, w, h, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl.tex_parameter_i(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.tex_parameter_i(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.gen_framebuffers(1, &frame.resolve_framebuffer_);
  gl.bind_framebuffer(GL_FRAMEBUFFER, frame.resolve_framebuffer_);
  gl.framebuffer_texture_2d(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, frame.texture_, 0);
  const bool readable = gl.check_framebuffer_status(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;

  gl.gen_renderbuffers(1, &frame.depth_);
  gl.bind_renderbuffer(GL_RENDERBUFFER, frame.depth_);
  gl.renderbuffer_storage_multisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, w, h);
  gl.gen_framebuffers(1, &frame.draw_framebuffer_);
  gl.bind_framebuffer(GL_FRAMEBUFFER, frame.draw_framebuffer_);
  gl.framebuffer_renderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, frame.depth_);
  if (samples == 0) {  // nothing to resolve: straight into the texture
    gl.framebuffer_texture_2d(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, frame.texture_, 0);
  } else {
    gl.gen_renderbuffers(1, &frame.color_);
    gl.bind_renderbuffer(GL_RENDERBUFFER, frame.color_);
    gl.renderbuffer_storage_multisample(GL_RENDERBUFFER, samples, GL_SRGB8_ALPHA8, w, h);
    gl.framebuffer_renderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, frame.color_);
  }
  if (!readable || gl.check_framebuffer_status(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return Error{ErrorCode::Unsupported, "the graphics driver refused a multisampled sRGB framebuffer", ""};
  }
  return frame;
}

Frame::Frame(Frame&& other) noexcept
    : gl_(other.gl_),
      size_(other.size_),
      draw_framebuffer_(std::exchange(other.draw_framebuffer_, 0)),
      resolve_framebuffer_(std::exchange(other.resolve_framebuffer_, 0)),
      color_(std::exchange(other.color_, 0)),
      depth_(std::exchange(other.depth_, 0)),
      texture_(std::exchange(other.texture_, 0)) {}

Frame& Frame::operator=(Frame&& other) noexcept {
  std::swap(gl_, other.gl_);
  std::swap(size_, other.size_);
  std::swap(draw_framebuffer_, other.draw_framebuffer_);
  std::swap(resolve_framebuffer_, other.resolve_framebuffer_);
  std::swap(color_, other.color_);
  std::swap(depth_, other.depth_);
  std::swap(texture_, other.texture_);
  return *this;
}

Frame::~Frame() {
  // Names that are 0 are ignored.
  gl_->delete_framebuffers(1, &draw_framebuffer_);
  gl_->delete_framebuffers(1, &resolve_framebuffer_);
  gl_->delete_renderbuffers(1, &color_);
  gl_->delete_renderbuffers(1, &depth_);
  gl_->delete_textures(1, &texture_);
}

Image Frame::read() const {
  gl_->bind_framebuffer(GL_FRAMEBUFFER, resolve_framebuffer_);
  return read_framebuffer(*gl_, size_.width_px * size_.supersample, size_.height_px * size_.supersample);
}

void Frame::begin() const {
  gl_->bind_framebuffer(GL_FRAMEBUFFER, draw_framebuffer_);
  gl_->viewport(0, 0, static_cast<GLsizei>(size_.width_px * size_.supersample),
                static_cast<GLsizei>(size_.height_px * size_.supersample));
  gl_->enable(GL_FRAMEBUFFER_SRGB);
}

void Frame::end() const {
  const auto w = static_cast<GLint>(size_.width_px * size_.supersample);
  const auto h = static_cast<GLint>(size_.height_px * size_.supersample);
  if (color_ != 0) {
    gl_->bind_framebuffer(GL_READ_FRAMEBUFFER, draw_framebuffer_);
    gl_->bind_framebuffer(GL_DRAW_FRAMEBUFFER, resolve_framebuffer_);
    gl_->blit_framebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
  gl_->disable(GL_FRAMEBUFFER_SRGB);
}

Image read_framebuffer(const Gl& gl, std::uint32_t width_px, std::uint32_t height_px) {
  const std::size_t row_bytes = static_cast<std::size_t>(width_px) * 3;
  Image image{.width = width_px, .height = height_px, .channels = 3, .pixels = {}};
  image.pixels.resize(row_bytes * height_px);
  gl.pixel_store_i(GL_PACK_ALIGNMENT, 1);
  gl.read_pixels(0, 0, static_cast<GLsizei>(width_px), static_cast<GLsizei>(height_px), GL_RGB, GL_UNSIGNED_BYTE,
                 image.pixels.data());
  for (std::uint32_t y = 0; y < height_px / 2; ++y) {  // GL's rows go upwards
    std::swap_ranges(image.at(0, y), image.at(0, y) + row_bytes, image.at(0, height_px - 1 - y));
  }
  return image;
}

Result<Presenter> Presenter::create(const Gl& gl) {
  auto program = Program::create(gl, picture_vertex_shader, nullptr, present_fragment_shader);
  if (!program) return program.error();
  return Presenter{gl, std::move(program).value()};
}

Presenter::Presenter(const Gl& gl, Program program) : gl_(&gl), program_(std::move(program)) {
  gl.gen_vertex_arrays(1, &vertex_array_);
}

Presenter::Presenter(Presenter&& other) noexcept
    : gl_(other.gl_),
      program_(std::move(other.program_)),
      vertex_array_(std::exchange(other.vertex_array_, 0)),
      framebuffer_(std::exchange(other.framebuffer_, 0)),
      color_(std::exchange(other.color_, 0)),
      width_px_(other.width_px_),
      height_px_(other.height_px_) {}

Presenter::~Presenter() {
  gl_->delete_vertex_arrays(1, &vertex_array_);
  gl_->delete_framebuffers(1, &framebuffer_);
  gl_->delete_renderbuffers(1, &color_);
}

void Presenter::draw(const Frame& first, const Frame& second, double share, GLuint target) const {
  const FrameSize& size = first.size();
  gl_->bind_framebuffer(GL_FRAMEBUFFER, target);
  gl_->viewport(0, 0, static_cast<GLsizei>(size.width_px), static_cast<GLsizei>(size.height_px));
  gl_->disable(GL_DEPTH_TEST);
  gl_->disable(GL_BLEND);
  gl_->disable(GL_CULL_FACE);
  program_.use();
  gl_->uniform_1i(program_.uniform("first"), 0);
  gl_->uniform_1i(program_.uniform("second"), 1);
  gl_->uniform_1f(program_.uniform("second_share"), static_cast<float>(share));
  gl_->uniform_1i(program_.uniform("samples"), static_cast<GLint>(size.supersample));
  gl_->active_texture(GL_TEXTURE1);
  gl_->bind_texture(GL_TEXTURE_2D, second.texture());
  gl_->active_texture(GL_TEXTURE0);
  gl_->bind_texture(GL_TEXTURE_2D, first.texture());
  gl_->bind_vertex_array(vertex_array_);
  gl_->draw_arrays(GL_TRIANGLES, 0, 3);
}

void Presenter::present(const Frame& frame, GLuint target) const { draw(frame, frame, 0.0, target); }

void Presenter::present_blend(const Frame& first, const Frame& second, double share, GLuint target) const {
  draw(first, second, share, target);
}

// A frame with one sample a pixel holds the picture as it is.
Image Presenter::read(const Frame& frame) {
  return frame.size().supersample == 1 ? frame.read() : read_blend(frame, frame, 0.0);
}

Image Presenter::read_blend(const Frame& first, const Frame& second, double share) {
  const FrameSize& size = first.size();
  if (framebuffer_ == 0) {
    gl_->gen_framebuffers(1, &framebuffer_);
    gl_->gen_renderbuffers(1, &color_);
  }
  if (width_px_ != size.width_px || height_px_ != size.height_px) {
    width_px_ = size.width_px;
    height_px_ = size.height_px;
    gl_->bind_renderbuffer(GL_RENDERBUFFER, color_);
    gl_->renderbuffer_storage(GL_RENDERBUFFER, GL_RGBA8, static_cast<GLsizei>(width_px_),
                              static_cast<GLsizei>(height_px_));
    gl_->bind_framebuffer(GL_FRAMEBUFFER, framebuffer_);
    gl_->framebuffer_renderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  }
  draw(first, second, share, framebuffer_);
  return read_framebuffer(*gl_, width_px_, height_px_);
}

}  // namespace lodestone::render

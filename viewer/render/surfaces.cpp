// SPDX-License-Identifier: MIT
#include "surfaces.h"

#include <algorithm>
#include <cmath>

#include <lodestone/formats.h>

namespace lodestone::render {
namespace {

float to_linear(float c) { return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F); }

// Shared where they are decoded already.
Result<std::shared_ptr<const Image>> pixels_of(const Texture& texture) {
  if (texture.image) return texture.image;
  const bool inside = texture.encoded && !texture.encoded->empty();
  if (!inside && texture.path.empty()) {
    return Error{ErrorCode::NotFound, "texture has no pixels, it is drawn white", texture.name};
  }
  auto image = inside ? decode_image(*texture.encoded, texture.name) : read_image(texture.path);
  if (!image) return image.error();
  return std::make_shared<const Image>(std::move(*image));
}

// A row of any channel count as RGBA.
void write_rgba(const Image& image, std::uint32_t row, std::uint8_t* to) {
  for (std::uint32_t x = 0; x < image.width; ++x, to += 4) {
    const std::uint8_t* from = image.at(x, row);
    const bool grey = image.channels < 3;
    to[0] = from[0];
    to[1] = from[grey ? 0 : 1];
    to[2] = from[grey ? 0 : 2];
    to[3] = image.channels == 2 ? from[1] : image.channels == 4 ? from[3] : 255;
  }
}

// Rows bottom up as GL wants them, some at a time: a copy of a whole photograph would be its largest.
void upload_rows(const Gl& gl, const Image& image) {
  constexpr std::uint32_t most_bytes = 1U << 18;
  const std::uint32_t strip = std::clamp(most_bytes / (4 * image.width), 1U, image.height);
  std::vector<std::uint8_t> rows(std::size_t{4} * image.width * strip);
  for (std::uint32_t done = 0; done < image.height; done += strip) {
    const std::uint32_t count = std::min(strip, image.height - done);
    for (std::uint32_t i = 0; i < count; ++i) {
      write_rgba(image, image.height - 1 - done - i, rows.data() + std::size_t{4} * image.width * i);
    }
    gl.tex_sub_image_2d(GL_TEXTURE_2D, 0, 0, static_cast<GLint>(done), static_cast<GLsizei>(image.width),
                        static_cast<GLsizei>(count), GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
  }
}

// Halves an image that is larger than the driver takes.
Image halved(const Image& image) {
  Image out{.width = std::max(1U, image.width / 2),
            .height = std::max(1U, image.height / 2),
            .channels = image.channels,
            .pixels = {}};
  out.pixels.resize(static_cast<std::size_t>(out.width) * out.height * out.channels);
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      for (std::uint32_t c = 0; c < out.channels; ++c) {
        const std::uint32_t x1 = std::min(2 * x + 1, image.width - 1);
        const std::uint32_t y1 = std::min(2 * y + 1, image.height - 1);
        out.at(x, y)[c] = static_cast<std::uint8_t>(
            (image.at(2 * x, 2 * y)[c] + image.at(x1, 2 * y)[c] + image.at(2 * x, y1)[c] + image.at(x1, y1)[c] + 2) /
            4);
      }
    }
  }
  return out;
}

GLuint upload(const Gl& gl, const Image& image) {
  GLuint id = 0;
  gl.gen_textures(1, &id);
  gl.bind_texture(GL_TEXTURE_2D, id);
  gl.pixel_store_i(GL_UNPACK_ALIGNMENT, 1);
  gl.tex_image_2d(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, static_cast<GLsizei>(image.width),
                  static_cast<GLsizei>(image.height), 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  upload_rows(gl, image);
  gl.generate_mipmap(GL_TEXTURE_2D);
  gl.tex_parameter_i(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl.tex_parameter_i(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.tex_parameter_i(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  gl.tex_parameter_i(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
  return id;
}

GLuint upload_white(const Gl& gl) { return upload(gl, Image{.width = 1, .height = 1, .channels = 1, .pixels = {255}}); }

}  // namespace

Surfaces::Surfaces(const Gl& gl, const Surroundings& source) : gl_(gl) {
  textures_.push_back(upload_white(gl));
  GLint max_size_px = 0;
  gl.get_integer_v(GL_MAX_TEXTURE_SIZE, &max_size_px);
  for (const Texture& texture : source.textures) {
    auto image = pixels_of(texture);
    if (!image || (*image)->empty()) {
      if (!image) warnings_.push_back({image.error().message, image.error().where});
      textures_.push_back(upload_white(gl));
      continue;
    }
    std::shared_ptr<const Image> pixels = std::move(*image);
    while (std::max(pixels->width, pixels->height) > static_cast<std::uint32_t>(max_size_px)) {
      pixels = std::make_shared<const Image>(halved(*pixels));
    }
    textures_.push_back(upload(gl, *pixels));
  }
  for (const Material& material : source.materials) {
    const glm::vec4 c = material.base_color;
    surfaces_.push_back({.base_color = {to_linear(c.r), to_linear(c.g), to_linear(c.b), c.a},
                         .texture = textures_[material.texture == none ? 0 : material.texture + 1],
                         .alpha_cutoff = material.alpha_cutoff,
                         .double_sided = material.double_sided,
                         .transparent = material.transparent()});
  }
  if (surfaces_.empty()) surfaces_.push_back({.texture = white()});
}

Surfaces::~Surfaces() { gl_.delete_textures(static_cast<GLsizei>(textures_.size()), textures_.data()); }

}  // namespace lodestone::render

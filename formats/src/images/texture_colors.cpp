// SPDX-License-Identifier: MIT
#include <lodestone/texture_colors.h>

#include <algorithm>

#include <lodestone/formats.h>

#include "codecs.h"
#include "reader.h"

namespace lodestone {
namespace {

constexpr std::uint64_t max_pixels = 1ULL << 26;
constexpr std::uint32_t most_samples = 64;  // of an image's width and height

glm::vec3 mean_of(const Image& image) {
  const std::uint32_t step_x = std::max(1U, image.width / most_samples);
  const std::uint32_t step_y = std::max(1U, image.height / most_samples);
  glm::dvec3 sum{0.0};
  double count = 0.0;
  for (std::uint32_t y = 0; y < image.height; y += step_y) {
    for (std::uint32_t x = 0; x < image.width; x += step_x) {
      const std::uint8_t* texel = image.at(x, y);
      const bool grey = image.channels < 3;
      sum += glm::dvec3{texel[0], texel[grey ? 0 : 1], texel[grey ? 0 : 2]} / 255.0;
      count += 1.0;
    }
  }
  return glm::vec3{sum / count};
}

Result<Image> small_copy(const Bytes& bytes, const std::string& source) {
  return image_mime_type(bytes) == "image/jpeg" ? decode_jpeg(bytes, max_pixels, most_samples)
                                                : decode_image(bytes, source, max_pixels);
}

Result<Image> pixels_of(const Texture& texture) {
  if (texture.encoded) return small_copy(*texture.encoded, texture.name);
  auto input = Input::open(texture.path, ReadOptions{}.max_file_bytes);
  if (!input) return input.error();
  auto bytes = input->read_all();
  return bytes ? small_copy(*bytes, texture.path) : Result<Image>{bytes.error()};
}

}  // namespace

std::vector<glm::vec3> mean_texture_colors(const Surroundings& source) {
  std::vector<glm::vec3> colors;
  for (const Texture& texture : source.textures) {
    const Result<Image> image = texture.image ? Result<Image>{*texture.image} : pixels_of(texture);
    colors.push_back(image && !image->empty() ? mean_of(*image) : glm::vec3{1.0F});
  }
  return colors;
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include <lodestone/texture_colors.h>

#include <lodestone/formats.h>
#include <lodestone/metrics.h>

#include "codecs.h"
#include "reader.h"

namespace lodestone {
namespace {

constexpr std::uint64_t max_pixels = 1ULL << 26;
constexpr std::uint32_t enough_pixels = 64;  // of width and height, for a mean

Result<Image> small_copy(const Bytes& bytes, const std::string& source) {
  return image_mime_type(bytes) == "image/jpeg" ? decode_jpeg(bytes, max_pixels, enough_pixels)
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
    colors.push_back(image && !image->empty() ? mean_color(*image) : glm::vec3{1.0F});
  }
  return colors;
}

}  // namespace lodestone

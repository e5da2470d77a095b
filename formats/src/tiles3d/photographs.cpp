// SPDX-License-Identifier: MIT
#include "tiles3d/photographs.h"

#include <algorithm>

#include "images/codecs.h"
#include "reader.h"

namespace lodestone {
namespace {

constexpr std::uint64_t most_file_bytes = 1ULL << 31;
constexpr std::size_t head_bytes = 1U << 18;  // where a header is looked for first

std::uint32_t big_endian(ByteSpan bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} << 24U | std::uint32_t{bytes[at + 1]} << 16U | std::uint32_t{bytes[at + 2]} << 8U |
         bytes[at + 3];
}

// Nothing for kinds whose header is not looked into, or if the head is too short.
std::optional<glm::uvec2> size_from_head(ByteSpan bytes) {
  const std::string type = image_mime_type(bytes);
  constexpr std::size_t png_head = 24;
  if (type == "image/png" && bytes.size() >= png_head) return glm::uvec2{big_endian(bytes, 16), big_endian(bytes, 20)};
  if (type != "image/jpeg") return {};
  const auto size = jpeg_size(bytes);
  return size ? std::optional{*size} : std::nullopt;
}

Result<glm::uvec2> size_by_decoding(ByteSpan bytes, const std::string& name) {
  const auto image = decode_image(bytes, name);
  if (!image) return image.error();
  return glm::uvec2{image->width, image->height};
}

TextureInfo known(const glm::uvec2& size, std::uint64_t bytes) { return {size.x, size.y, bytes}; }

Result<TextureInfo> measure(const Texture& texture) {
  if (texture.image) return known({texture.image->width, texture.image->height}, 0);
  if (texture.encoded && !texture.encoded->empty()) {
    if (const auto size = size_from_head(*texture.encoded)) return known(*size, texture.encoded->size());
    const auto size = size_by_decoding(*texture.encoded, name_of(texture));
    if (!size) return size.error();
    return known(*size, texture.encoded->size());
  }
  if (texture.path.empty()) return Error{ErrorCode::NotFound, "a texture has neither pixels nor a file", texture.name};
  const auto input = Input::open(texture.path, most_file_bytes);
  if (!input) return input.error();
  Bytes head(std::min<std::uint64_t>(head_bytes, input->size()));
  head.resize(input->read(0, head));
  if (const auto size = size_from_head(head)) return known(*size, input->size());
  const auto bytes = input->read_all();
  if (!bytes) return bytes.error();
  if (const auto size = size_from_head(*bytes)) return known(*size, input->size());
  const auto size = size_by_decoding(*bytes, texture.path);
  if (!size) return size.error();
  return known(*size, input->size());
}

}  // namespace

std::string name_of(const Texture& texture) { return texture.path.empty() ? texture.name : texture.path; }

Warning plain_warning(const std::string& reason, const std::string& name) {
  return {"a texture cannot be used, its faces stay plain: " + reason, name};
}

TextureInfo measure_texture(const Texture& texture, std::vector<Warning>& warnings) {
  auto info = measure(texture);
  if (info && info->width_px > 0 && info->height_px > 0) return *info;
  warnings.push_back(plain_warning(info ? "it has no pixels" : info.error().message, name_of(texture)));
  return {};
}

Result<Image> decode_texture(const Texture& texture) {
  if (texture.image) return *texture.image;
  if (texture.encoded && !texture.encoded->empty()) return decode_image(*texture.encoded, name_of(texture));
  const auto input = Input::open(texture.path, most_file_bytes);
  if (!input) return input.error();
  const auto bytes = input->read_all();
  if (!bytes) return bytes.error();
  return decode_image(*bytes, texture.path);
}

}  // namespace lodestone

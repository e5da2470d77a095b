// SPDX-License-Identifier: MIT
#include "tiles3d/photographs.h"

#include <algorithm>

#include "images/codecs.h"
#include "reader.h"

namespace lodestone {
namespace {

constexpr std::uint64_t most_file_bytes = 1ULL << 31;
constexpr std::size_t head_bytes = 1U << 18;  // where a header is looked for first

Result<Photograph> from_head(ByteSpan bytes, std::uint64_t file_bytes, const std::string& name) {
  const auto head = image_head(bytes, file_bytes, name, ReadOptions{}.max_texture_pixels);
  if (!head) return head.error();
  return Photograph{{head->size.x, head->size.y, file_bytes}, head->decode_bytes};
}

Result<Photograph> measure(const Texture& texture) {
  if (texture.image) {
    const Image& image = *texture.image;
    return Photograph{{image.width, image.height, 0}, static_cast<double>(image.channels), image.pixels.size()};
  }
  if (texture.encoded && !texture.encoded->empty()) {
    const Bytes& bytes = *texture.encoded;
    auto found = from_head(bytes, bytes.size(), name_of(texture));
    if (!found) return found.error();
    found->kept_bytes = bytes.size();
    return *found;
  }
  if (texture.path.empty()) return Error{ErrorCode::NotFound, "a texture has neither pixels nor a file", texture.name};
  const auto input = Input::open(texture.path, most_file_bytes);
  if (!input) return input.error();
  Bytes head(std::min<std::uint64_t>(head_bytes, input->size()));
  head.resize(input->read(0, head));
  if (const auto found = from_head(head, input->size(), texture.path)) return *found;
  const auto bytes = input->read_all();
  if (!bytes) return bytes.error();
  return from_head(*bytes, input->size(), texture.path);
}

}  // namespace

std::string name_of(const Texture& texture) { return texture.path.empty() ? texture.name : texture.path; }

Warning plain_warning(const std::string& reason, const std::string& name) {
  return {"a texture cannot be used, its faces stay plain: " + reason, name};
}

Photograph look_at(const Texture& texture, std::vector<Warning>& warnings) {
  auto found = measure(texture);
  if (found && found->info.width_px > 0 && found->info.height_px > 0) return *found;
  warnings.push_back(plain_warning(found ? "it has no pixels" : found.error().message, name_of(texture)));
  return {};
}

Photograph look_inside(const Input& input, std::uint64_t offset, std::uint64_t size_bytes) {
  Photograph photograph;
  for (const std::uint64_t most : {std::uint64_t{head_bytes}, size_bytes}) {
    if (photograph.info.width_px > 0 || offset > input.size()) break;
    Bytes head(std::min({most, size_bytes, input.size() - offset}));
    head.resize(input.read(offset, head));
    if (const auto found = from_head(head, size_bytes, {})) photograph = *found;
  }
  photograph.kept_bytes = size_bytes;
  return photograph;
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

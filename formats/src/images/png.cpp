// SPDX-License-Identifier: MIT
// The only file that names libspng.
#include <spng.h>

#include <cstdlib>
#include <memory>

#include <lodestone/formats.h>

#include "codecs.h"

namespace lodestone {
namespace {

struct Closer {
  void operator()(spng_ctx* context) const noexcept { spng_ctx_free(context); }
};
using Handle = std::unique_ptr<spng_ctx, Closer>;

Error png_error(const char* what, int code) {
  return Error{ErrorCode::BadData, std::string{what} + " (" + spng_strerror(code) + ")", {}};
}

// spng unpacks to RGB or RGBA; grey images keep one channel less of each.
Image narrowed_to_grey(const Image& image) {
  Image out{image.width, image.height, image.channels - 2, {}};
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  out.pixels.resize(count * out.channels);
  for (std::size_t i = 0; i < count; ++i) {
    out.pixels[i * out.channels] = image.pixels[i * image.channels];
    if (out.channels == 2) out.pixels[2 * i + 1] = image.pixels[4 * i + 3];
  }
  return out;
}

Result<spng_ihdr> read_header(spng_ctx* handle, ByteSpan bytes) {
  if (handle == nullptr) return Error{ErrorCode::Unreadable, "the PNG decoder could not be started", {}};
  constexpr std::size_t max_chunk_bytes = 64U << 20;
  spng_set_chunk_limits(handle, max_chunk_bytes, max_chunk_bytes);
  spng_set_crc_action(handle, SPNG_CRC_ERROR, SPNG_CRC_DISCARD);
  if (const int code = spng_set_png_buffer(handle, bytes.data(), bytes.size()); code != 0) {
    return png_error("the PNG cannot be read", code);
  }
  spng_ihdr header{};
  if (const int code = spng_get_ihdr(handle, &header); code != 0) return png_error("the PNG header is broken", code);
  return header;
}

}  // namespace

Result<ImageHead> png_head(ByteSpan bytes) {
  const Handle handle{spng_ctx_new(0)};
  const auto header = read_header(handle.get(), bytes);
  if (!header) return header.error();
  const bool deep = header->bit_depth > 8;
  const bool plain_rgb = header->color_type == SPNG_COLOR_TYPE_TRUECOLOR;
  constexpr double samples[] = {1.0, 0.0, 3.0, 1.0, 2.0, 0.0, 4.0};  // by type of colours
  constexpr double most_inflation = 1032.0;                          // of what deflate packed
  const double pixel_bits = samples[header->color_type] * header->bit_depth;
  return ImageHead{.size = {header->width, header->height},
                   .decode_bytes = deep        ? 8.0
                                   : plain_rgb ? 3.0
                                               : 4.0,  // deep: two copies with alpha
                   .byte_pixels = most_inflation * 8.0 / pixel_bits};
}

Result<Image> decode_png(ByteSpan bytes, std::uint64_t max_pixels) {
  const Handle handle{spng_ctx_new(0)};
  const auto found = read_header(handle.get(), bytes);
  if (!found) return found.error();
  const spng_ihdr& header = *found;
  if (auto fits = check_image_size(header.width, header.height, max_pixels); !fits) return fits.error();
  spng_trns transparency{};
  const bool grey =
      header.color_type == SPNG_COLOR_TYPE_GRAYSCALE || header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA;
  const bool alpha = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA ||
                     header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
                     spng_get_trns(handle.get(), &transparency) == 0;
  const int format = alpha ? SPNG_FMT_RGBA8 : SPNG_FMT_RGB8;
  std::size_t size = 0;
  if (const int code = spng_decoded_image_size(handle.get(), format, &size); code != 0) {
    return png_error("the PNG header is broken", code);
  }
  Image image{header.width, header.height, alpha ? 4U : 3U, {}};
  image.pixels.resize(size);
  if (const int code = spng_decode_image(handle.get(), image.pixels.data(), size, format, SPNG_DECODE_TRNS);
      code != 0) {
    if (code == SPNG_EMEM) return no_memory_for(header.width, header.height);
    return png_error("the PNG data is damaged or cut off", code);
  }
  // The checksum of the last rows, and the mark of the end, lie behind what the pixels need.
  if (const int code = spng_decode_chunks(handle.get()); code != 0) {
    return png_error("the PNG data is damaged or cut off", code);
  }
  if (grey) image = narrowed_to_grey(image);
  return image;
}

Result<std::vector<std::uint8_t>> encode_png(const Image& image) {
  const Handle handle{spng_ctx_new(SPNG_CTX_ENCODER)};
  if (!handle) return Error{ErrorCode::Unreadable, "the PNG encoder could not be started", {}};
  constexpr std::uint8_t color_types[] = {SPNG_COLOR_TYPE_GRAYSCALE, SPNG_COLOR_TYPE_GRAYSCALE_ALPHA,
                                          SPNG_COLOR_TYPE_TRUECOLOR, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA};
  spng_ihdr header{};
  header.width = image.width;
  header.height = image.height;
  header.bit_depth = 8;
  header.color_type = color_types[image.channels - 1];
  spng_set_option(handle.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(handle.get(), SPNG_IMG_COMPRESSION_LEVEL, 6);
  int code = spng_set_ihdr(handle.get(), &header);
  if (code == 0) {
    code =
        spng_encode_image(handle.get(), image.pixels.data(), image.pixels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  }
  if (code != 0) return png_error("the image cannot be written as PNG", code);
  std::size_t size = 0;
  void* buffer = spng_get_png_buffer(handle.get(), &size, &code);
  if (buffer == nullptr) return png_error("the image cannot be written as PNG", code);
  const auto* first = static_cast<const std::uint8_t*>(buffer);
  Bytes bytes(first, first + size);
  std::free(buffer);
  return bytes;
}

}  // namespace lodestone

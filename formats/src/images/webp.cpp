// SPDX-License-Identifier: MIT
// The only file that names libwebp.
#include <webp/decode.h>
#include <webp/encode.h>

#include <algorithm>

#include <lodestone/formats.h>

#include "codecs.h"

namespace lodestone {

namespace {

Result<WebPBitstreamFeatures> read_head(ByteSpan bytes) {
  WebPBitstreamFeatures features{};
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK) {
    return Error{ErrorCode::BadData, "the WebP header is broken", {}};
  }
  if (features.has_animation != 0) return Error{ErrorCode::Unsupported, "is an animated WebP", {}};
  return features;
}

}  // namespace

Result<ImageHead> webp_head(ByteSpan bytes) {
  const auto features = read_head(bytes);
  if (!features) return features.error();
  // Beside the pixels a lossless picture as whole words; a lossy one has only rows, and its transparency as such a
  // picture and plain.
  constexpr int lossy = 1;
  const bool alpha = features->has_alpha != 0;
  const double pixel = features->format == lossy ? (alpha ? 9.0 : 3.1) : (alpha ? 8.1 : 7.1);
  return ImageHead{{static_cast<std::uint32_t>(features->width), static_cast<std::uint32_t>(features->height)}, pixel};
}

Result<Image> decode_webp(ByteSpan bytes, std::uint64_t max_pixels) {
  const auto features = read_head(bytes);
  if (!features) return features.error();
  if (auto fits = check_image_size(features->width, features->height, max_pixels); !fits) return fits.error();
  Image image{static_cast<std::uint32_t>(features->width),
              static_cast<std::uint32_t>(features->height),
              features->has_alpha != 0 ? 4U : 3U,
              {}};
  const std::size_t stride = static_cast<std::size_t>(image.width) * image.channels;
  image.pixels.resize(stride * image.height);
  WebPDecoderConfig config{};
  WebPInitDecoderConfig(&config);
  config.output.colorspace = image.channels == 4 ? MODE_RGBA : MODE_RGB;
  config.output.is_external_memory = 1;
  config.output.u.RGBA = {image.pixels.data(), static_cast<int>(stride), image.pixels.size()};
  const VP8StatusCode status = WebPDecode(bytes.data(), bytes.size(), &config);
  if (status == VP8_STATUS_OUT_OF_MEMORY) return no_memory_for(image.width, image.height);
  if (status != VP8_STATUS_OK) return Error{ErrorCode::BadData, "the WebP data is damaged or cut off", {}};
  return image;
}

Result<std::vector<std::uint8_t>> encode_webp(const Image& image, int quality) {
  const Image source = widened_to_rgb(image);
  std::uint8_t* buffer = nullptr;
  const auto encode = source.channels == 4 ? WebPEncodeRGBA : WebPEncodeRGB;
  const std::size_t size = encode(source.pixels.data(), static_cast<int>(source.width), static_cast<int>(source.height),
                                  static_cast<int>(source.width * source.channels),
                                  static_cast<float>(std::clamp(quality, 1, 100)), &buffer);
  if (size == 0) return Error{ErrorCode::BadArgument, "the image cannot be written as WebP (16383 pixels a side)", {}};
  Bytes bytes(buffer, buffer + size);
  WebPFree(buffer);
  return bytes;
}

}  // namespace lodestone

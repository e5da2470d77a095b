// SPDX-License-Identifier: MIT
// The only file that names libjpeg-turbo. Its TurboJPEG interface returns errors instead of jumping out of C code.
#include <turbojpeg.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>

#include <lodestone/formats.h>

#include "codecs.h"

namespace lodestone {
namespace {

struct Closer {
  void operator()(void* handle) const noexcept { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, Closer>;

// What the markers before the picture say.
struct Markers {
  int orientation = 1;
  bool adobe = false;  // Adobe writes CMYK inverted: 255 is no ink
  bool progressive = false;
  bool arithmetic = false;
};

unsigned u16(ByteSpan b, std::size_t at, bool little) {
  return little ? b[at] | (b[at + 1] << 8) : (b[at] << 8) | b[at + 1];
}

std::size_t u32(ByteSpan b, std::size_t at, bool little) {
  const std::size_t first = u16(b, at, little);
  const std::size_t second = u16(b, at + 2, little);
  return little ? first | (second << 16) : (first << 16) | second;
}

// Tag 0x0112 of the first image directory; 1 if it is not there or makes no sense.
int exif_orientation(ByteSpan exif) {
  if (exif.size() < 14) return 1;
  const ByteSpan tiff = exif.subspan(6);
  const bool little = tiff[0] == 'I';
  const std::size_t directory = u32(tiff, 4, little);
  if (directory > tiff.size() || tiff.size() - directory < 2) return 1;
  const std::size_t entries = u16(tiff, directory, little);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t at = directory + 2 + 12 * i;
    if (at + 12 > tiff.size()) return 1;
    if (u16(tiff, at, little) != 0x0112) continue;
    const unsigned orientation = u16(tiff, at + 8, little);
    constexpr unsigned last = 8;
    return orientation >= 1 && orientation <= last ? static_cast<int>(orientation) : 1;
  }
  return 1;
}

Markers read_markers(ByteSpan bytes) {
  Markers markers;
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && bytes[at] == 0xFF) {
    const unsigned marker = bytes[at + 1];
    if (marker == 0xFF) {  // a fill byte
      ++at;
      continue;
    }
    if (marker == 0xDA) break;
    const std::size_t length = u16(bytes, at + 2, false);
    if (length < 2 || at + 2 + length > bytes.size()) break;
    const ByteSpan body = bytes.subspan(at + 4, length - 2);
    if (marker == 0xE1 && body.size() > 6 && std::memcmp(body.data(), "Exif\0\0", 6) == 0) {
      markers.orientation = exif_orientation(body);
    }
    if (marker == 0xEE && body.size() >= 5 && std::memcmp(body.data(), "Adobe", 5) == 0) markers.adobe = true;
    if (marker == 0xC2 || marker == 0xC6) markers.progressive = true;
    if (marker >= 0xC9 && marker <= 0xCF && marker != 0xCC) markers.arithmetic = true;
    at += 2 + length;
  }
  return markers;
}

Image cmyk_to_rgb(const Image& cmyk, bool inverted) {
  Image out{cmyk.width, cmyk.height, 3, {}};
  const std::size_t count = static_cast<std::size_t>(cmyk.width) * cmyk.height;
  out.pixels.resize(count * 3);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* ink = &cmyk.pixels[4 * i];
    const auto light = [&](int c) { return inverted ? ink[c] : 255 - ink[c]; };
    for (int c = 0; c < 3; ++c) out.pixels[3 * i + c] = static_cast<std::uint8_t>((light(c) * light(3) + 127) / 255);
  }
  return out;
}

Error jpeg_error(void* handle, std::string_view what) {
  return Error{ErrorCode::BadData, std::string{what} + " (" + tjGetErrorStr2(handle) + ")", {}};
}

// Shrinks a size as far as the decoder can for nothing and `at_least` allows.
void shrink(int& width, int& height, std::uint32_t at_least) {
  for (const int eighths : {1, 2, 4}) {
    const tjscalingfactor factor{eighths, 8};
    if (static_cast<std::uint32_t>(TJSCALED(std::max(width, height), factor)) < at_least) continue;
    width = TJSCALED(width, factor);
    height = TJSCALED(height, factor);
    return;
  }
}

struct Header {
  int width = 0;
  int height = 0;
  int space = 0;  // of colours: TJCS
};

Result<Header> read_header(tjhandle handle, ByteSpan bytes) {
  if (handle == nullptr) return Error{ErrorCode::Unreadable, "the JPEG decoder could not be started", {}};
  Header header;
  int subsampling = 0;
  if (tjDecompressHeader3(handle, bytes.data(), static_cast<unsigned long>(bytes.size()), &header.width, &header.height,
                          &subsampling, &header.space) != 0) {
    return jpeg_error(handle, "the JPEG header is broken");
  }
  return header;
}

}  // namespace

Result<Image> decode_jpeg(ByteSpan bytes, std::uint64_t max_pixels, std::uint32_t at_least) {
  const Handle handle{tjInitDecompress()};
  const auto header = read_header(handle.get(), bytes);
  if (!header) return header.error();
  auto [width, height, space] = *header;
  if (auto fits = check_image_size(width, height, max_pixels); !fits) return fits.error();
  if (at_least > 0) shrink(width, height, at_least);
  const bool cmyk = space == TJCS_CMYK || space == TJCS_YCCK;
  const int format = cmyk ? TJPF_CMYK : (space == TJCS_GRAY ? TJPF_GRAY : TJPF_RGB);
  Image image{static_cast<std::uint32_t>(width),
              static_cast<std::uint32_t>(height),
              static_cast<std::uint32_t>(tjPixelSize[format]),
              {}};
  image.pixels.resize(static_cast<std::size_t>(width) * height * image.channels);
  // LIMITSCANS: a small file of very many progressive scans would take minutes.
  if (tjDecompress2(handle.get(), bytes.data(), static_cast<unsigned long>(bytes.size()), image.pixels.data(), width, 0,
                    height, format, TJFLAG_LIMITSCANS) != 0) {
    const std::string_view what = tjGetErrorStr2(handle.get());
    const bool harmless = tjGetErrorCode(handle.get()) == TJERR_WARNING && what.find("extraneous") != what.npos;
    if (what.find("Insufficient memory") != what.npos) return no_memory_for(image.width, image.height);
    if (!harmless) return jpeg_error(handle.get(), "the JPEG data is damaged or cut off");
  }
  const Markers markers = read_markers(bytes);
  if (cmyk) image = cmyk_to_rgb(image, markers.adobe);
  return upright(std::move(image), markers.orientation);
}

Result<ImageHead> jpeg_head(ByteSpan bytes) {
  const Handle handle{tjInitDecompress()};
  const auto header = read_header(handle.get(), bytes);
  if (!header) return header.error();
  const glm::uvec2 stored{header->width, header->height};
  const bool cmyk = header->space == TJCS_CMYK || header->space == TJCS_YCCK;
  const double components = cmyk ? 4.0 : (header->space == TJCS_GRAY ? 1.0 : 3.0);
  const double pixel = cmyk ? 3.0 : components;
  const Markers markers = read_markers(bytes);
  constexpr double coefficient = 2.0;
  // One after the other: all coefficients of a progressive file, CMYK beside RGB, the picture beside the upright one.
  const double decoding = components + (markers.progressive ? coefficient * components : 0.0);
  ImageHead head{.size = markers.orientation >= 5 ? glm::uvec2{stored.y, stored.x} : stored};
  head.decode_bytes =
      std::max({decoding, cmyk ? components + pixel : 0.0, markers.orientation != 1 ? 2.0 * pixel : 0.0});
  constexpr double blocks = 8.0;  // a Huffman code has a bit or more, and each block one code
  constexpr double block_pixels = 64.0;
  if (!markers.arithmetic) head.byte_pixels = blocks * block_pixels;
  return head;
}

Result<std::vector<std::uint8_t>> encode_jpeg(const Image& image, int quality) {
  const Handle handle{tjInitCompress()};
  if (!handle) return Error{ErrorCode::Unreadable, "the JPEG encoder could not be started", {}};
  const Image wide = image.channels == 2 ? widened_to_rgb(image) : Image{};
  const Image& source = image.channels == 2 ? wide : image;
  const int format = source.channels == 1 ? TJPF_GRAY : (source.channels == 3 ? TJPF_RGB : TJPF_RGBX);
  const int subsampling = source.channels == 1 ? TJSAMP_GRAY : (quality >= 90 ? TJSAMP_444 : TJSAMP_420);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const int failed =
      tjCompress2(handle.get(), source.pixels.data(), static_cast<int>(source.width), 0,
                  static_cast<int>(source.height), format, &buffer, &size, subsampling, std::clamp(quality, 1, 100), 0);
  Bytes bytes;
  if (failed == 0) bytes.assign(buffer, buffer + size);
  tjFree(buffer);
  if (failed != 0) return jpeg_error(handle.get(), "the image cannot be written as JPEG");
  return bytes;
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>
#include <string_view>

#include "codecs.h"
#include "output_file.h"
#include "reader.h"

namespace lodestone {
namespace {

bool begins_with(ByteSpan bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

bool named(const std::string& source, std::string_view extension) {
  return Input::from_bytes({}, source).extension() == extension;
}

bool is_valid(const Image& image) {
  return image.width > 0 && image.height > 0 && image.channels >= 1 && image.channels <= 4 &&
         image.pixels.size() == static_cast<std::size_t>(image.width) * image.height * image.channels;
}

}  // namespace

std::string image_mime_type(std::span<const std::uint8_t> bytes) {
  if (begins_with(bytes, "\xFF\xD8\xFF")) return "image/jpeg";
  if (begins_with(bytes, "\x89PNG\r\n\x1A\n")) return "image/png";
  if (bytes.size() >= 12 && begins_with(bytes, "RIFF") && begins_with(bytes.subspan(8), "WEBP")) return "image/webp";
  if (begins_with(bytes, "GIF87a") || begins_with(bytes, "GIF89a")) return "image/gif";
  if (begins_with(bytes, "BM")) return "image/bmp";
  return {};
}

Status check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t max_pixels) {
  constexpr std::uint64_t max_side = 1U << 24;
  if (width == 0 || height == 0) return Error{ErrorCode::BadData, "the image has no pixels", {}};
  if (width > max_side || height > max_side || width * height > max_pixels) {
    return Error{ErrorCode::TooLarge,
                 "the image has " + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels, more than the limit of " + std::to_string(max_pixels),
                 {}};
  }
  return Done{};
}

Error no_memory_for(std::uint64_t width, std::uint64_t height) {
  return {ErrorCode::TooLarge,
          "there is no memory to decode its " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
          {}};
}

Image widened_to_rgb(const Image& image) {
  if (image.channels >= 3) return image;
  Image out{image.width, image.height, image.channels + 2, {}};
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  out.pixels.resize(count * out.channels);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* from = &image.pixels[i * image.channels];
    std::uint8_t* to = &out.pixels[i * out.channels];
    to[0] = to[1] = to[2] = from[0];
    if (image.channels == 2) to[3] = from[1];
  }
  return out;
}

Image upright(Image image, int exif_orientation) {
  if (exif_orientation < 2 || exif_orientation > 8) return image;
  const bool turned = exif_orientation >= 5;
  Image out{turned ? image.height : image.width, turned ? image.width : image.height, image.channels, {}};
  out.pixels.resize(image.pixels.size());
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      std::uint32_t sx = turned ? y : x;
      std::uint32_t sy = turned ? x : y;
      const bool mirror_x =
          exif_orientation == 2 || exif_orientation == 3 || exif_orientation == 7 || exif_orientation == 8;
      const bool mirror_y =
          exif_orientation == 3 || exif_orientation == 4 || exif_orientation == 6 || exif_orientation == 7;
      if (mirror_x) sx = image.width - 1 - sx;
      if (mirror_y) sy = image.height - 1 - sy;
      std::memcpy(out.at(x, y), image.at(sx, sy), image.channels);
    }
  }
  return out;
}

namespace {

// Of JPEG, PNG and WebP each has its own, the others are stb's.
enum class Decoder : std::uint8_t { None, Jpeg, Png, Webp, Stb };

Decoder decoder_of(ByteSpan bytes, const std::string& source) {
  const std::string type = image_mime_type(bytes);
  if (type == "image/jpeg") return Decoder::Jpeg;
  if (type == "image/png") return Decoder::Png;
  if (type == "image/webp") return Decoder::Webp;
  return !type.empty() || named(source, ".tga") ? Decoder::Stb : Decoder::None;
}

Result<ImageHead> plain_head(ByteSpan bytes, Decoder decoder) {
  switch (decoder) {
    case Decoder::Jpeg:
      return jpeg_head(bytes);
    case Decoder::Png:
      return png_head(bytes);
    case Decoder::Webp:
      return webp_head(bytes);
    case Decoder::Stb:
      return stb_head(bytes);
    case Decoder::None:
      break;
  }
  return Error{ErrorCode::Unsupported, "is not a JPEG, PNG, WebP, GIF, BMP or TGA image", {}};
}

Status check_head(const ImageHead& head, std::uint64_t file_bytes, std::uint64_t max_pixels) {
  const double pixels = static_cast<double>(head.size.x) * head.size.y;
  if (pixels <= head.byte_pixels * static_cast<double>(file_bytes)) {
    return check_image_size(head.size.x, head.size.y, max_pixels);
  }
  return Error{ErrorCode::BadData,
               "its " + std::to_string(head.size.x) + " x " + std::to_string(head.size.y) + " pixels are more than " +
                   std::to_string(file_bytes) + " bytes can hold, it is damaged or cut off",
               {}};
}

Error in_source(Error error, const std::string& source) {
  error.where = source;
  return error;
}

}  // namespace

Result<ImageHead> image_head(ByteSpan bytes, std::uint64_t file_bytes, const std::string& source,
                             std::uint64_t max_pixels) {
  auto head = plain_head(bytes, decoder_of(bytes, source));
  if (!head) return in_source(head.error(), source);
  if (auto fits = check_head(*head, file_bytes, max_pixels); !fits) return in_source(fits.error(), source);
  return head;
}

Result<Image> decode_image(std::span<const std::uint8_t> bytes, const std::string& source, std::uint64_t max_pixels) {
  if (auto head = image_head(bytes, bytes.size(), source, max_pixels); !head) return head.error();
  auto result = [&]() -> Result<Image> {
    switch (decoder_of(bytes, source)) {
      case Decoder::Jpeg:
        return decode_jpeg(bytes, max_pixels);
      case Decoder::Png:
        return decode_png(bytes, max_pixels);
      case Decoder::Webp:
        return decode_webp(bytes, max_pixels);
      default:
        return decode_stb(bytes, max_pixels);
    }
  }();
  if (result) return result;
  return in_source(result.error(), source);
}

Result<Image> read_image(const std::filesystem::path& file) {
  constexpr std::uint64_t max_bytes = 1ULL << 30;
  auto input = Input::open(file, max_bytes);
  if (!input) return input.error();
  auto bytes = input->read_all();
  if (!bytes) return bytes.error();
  return decode_image(*bytes, file.string());
}

Status write_image(const Image& image, const std::filesystem::path& file, int quality) {
  const std::string extension = Input::from_bytes({}, file.string()).extension();
  auto bytes = [&]() -> Result<Bytes> {
    if (!is_valid(image)) return Error{ErrorCode::BadArgument, "the image to write has no pixels", {}};
    if (extension == ".png") return encode_png(image);
    if (extension == ".jpg" || extension == ".jpeg") return encode_jpeg(image, quality);
    if (extension == ".webp") return encode_webp(image, quality);
    return Error{ErrorCode::BadArgument, "images are written as .png, .jpg or .webp", {}};
  }();
  if (!bytes) {
    Error error = bytes.error();
    error.where = file.string();
    return error;
  }
  return write_whole_file(file, *bytes);
}

}  // namespace lodestone

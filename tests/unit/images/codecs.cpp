// SPDX-License-Identifier: MIT
#include <turbojpeg.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include <lodestone/formats.h>

#include "data.h"
#include "images/codecs.h"

using namespace lodestone;

namespace {

// A picture whose four quarters differ and that has gradients in each.
Image picture(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image{width, height, channels, {}};
  image.pixels.resize(static_cast<std::size_t>(width) * height * channels);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      for (std::uint32_t c = 0; c < channels; ++c) {
        const std::uint32_t value =
            (x * 200) / width + (c == 0 && y > height / 2 ? 55 : 0) + (c == 1 ? (y * 50) / height : 0);
        image.at(x, y)[c] = static_cast<std::uint8_t>(value);
      }
    }
  }
  return image;
}

double mean_difference(const Image& a, const Image& b) {
  REQUIRE(a.width == b.width);
  REQUIRE(a.height == b.height);
  REQUIRE(a.channels == b.channels);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(int{a.pixels[i]} - int{b.pixels[i]});
  return sum / static_cast<double>(a.pixels.size());
}

using Bytes = std::vector<std::uint8_t>;

// JPEG data with an Exif block that states `orientation`, in either byte order.
Bytes with_orientation(const Bytes& jpeg, int orientation, bool little) {
  Bytes exif = {0xFF, 0xE1, 0, 34, 'E', 'x', 'i', 'f', 0, 0};
  const auto o = static_cast<std::uint8_t>(orientation);
  const Bytes tiff = little
                         ? Bytes{'I', 'I', 42, 0, 8, 0, 0, 0, 1, 0, 0x12, 1, 3, 0, 1, 0, 0, 0, o, 0, 0, 0, 0, 0, 0, 0}
                         : Bytes{'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, o, 0, 0, 0, 0, 0, 0};
  exif.insert(exif.end(), tiff.begin(), tiff.end());
  Bytes out = jpeg;
  out.insert(out.begin() + 2, exif.begin(), exif.end());
  return out;
}

Bytes cmyk_jpeg(const Bytes& cmyk, int width, int height) {
  const tjhandle handle = tjInitCompress();
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  REQUIRE(tjCompress2(handle, cmyk.data(), width, 0, height, TJPF_CMYK, &buffer, &size, TJSAMP_444, 98, 0) == 0);
  Bytes bytes(buffer, buffer + size);
  tjFree(buffer);
  tjDestroy(handle);
  return bytes;
}

}  // namespace

TEST_CASE("PNG keeps every pixel of 1 to 4 channels") {
  for (std::uint32_t channels = 1; channels <= 4; ++channels) {
    const Image image = picture(37, 23, channels);
    const auto bytes = encode_png(image);
    REQUIRE(bytes.ok());
    const auto back = decode_image(*bytes, "made.png");
    REQUIRE(back.ok());
    CHECK(back->channels == channels);
    CHECK(back->pixels == image.pixels);
  }
}

TEST_CASE("JPEG and WebP keep the picture nearly") {
  for (std::uint32_t channels = 1; channels <= 4; ++channels) {
    const Image image = picture(64, 48, channels);
    const auto jpeg = encode_jpeg(image, 95);
    REQUIRE(jpeg.ok());
    const auto from_jpeg = decode_image(*jpeg, "made.jpg");
    REQUIRE(from_jpeg.ok());
    CHECK(from_jpeg->channels == (channels == 1 ? 1 : 3));
    if (channels == 1 || channels == 3) CHECK(mean_difference(*from_jpeg, image) < 3.0);
    const auto webp = encode_webp(image, 95);
    REQUIRE(webp.ok());
    const auto from_webp = decode_image(*webp, "made.webp");
    REQUIRE(from_webp.ok());
    if (channels >= 3) CHECK(mean_difference(*from_webp, image) < 4.0);
  }
}

TEST_CASE("EXIF orientation is undone for all eight values and both byte orders") {
  const Image image = picture(48, 32, 3);
  const auto plain = encode_jpeg(image, 98);
  REQUIRE(plain.ok());
  // Where the top left pixel of the stored picture belongs: EXIF 2.3, tag 0x0112.
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const auto turned = decode_image(with_orientation(*plain, orientation, orientation % 2 == 0), "turned.jpg");
    REQUIRE(turned.ok());
    const bool swapped = orientation >= 5;
    REQUIRE(turned->width == (swapped ? 32U : 48U));
    const bool right[] = {false, true, true, false, false, true, true, false};
    const bool bottom[] = {false, false, true, true, false, false, true, true};
    const std::uint32_t x = right[orientation - 1] ? turned->width - 1 : 0;
    const std::uint32_t y = bottom[orientation - 1] ? turned->height - 1 : 0;
    CAPTURE(orientation, x, y);
    for (int c = 0; c < 3; ++c) CHECK(std::abs(int{turned->at(x, y)[c]} - int{image.at(0, 0)[c]}) < 12);
    // The stored top right pixel follows along the stored row.
    const std::uint32_t x2 = swapped ? x : turned->width - 1 - x;
    const std::uint32_t y2 = swapped ? turned->height - 1 - y : y;
    for (int c = 0; c < 3; ++c) CHECK(std::abs(int{turned->at(x2, y2)[c]} - int{image.at(47, 0)[c]}) < 12);
  }
}

TEST_CASE("an EXIF orientation that does not exist leaves the picture as it is stored") {
  const Image image = picture(48, 32, 3);
  const auto plain = encode_jpeg(image, 98);
  REQUIRE(plain.ok());
  const auto upright = decode_image(*plain, "plain.jpg");
  REQUIRE(upright.ok());
  for (const int orientation : {0, 9, 10, 200}) {
    for (const bool little : {false, true}) {
      CAPTURE(orientation, little);
      const Bytes odd = with_orientation(*plain, orientation, little);
      const auto head = image_head(odd, odd.size(), "odd.jpg", 1U << 20);
      REQUIRE(head.ok());
      CHECK(head->size == glm::uvec2{48, 32});
      const auto read = decode_image(odd, "odd.jpg");
      REQUIRE(read.ok());
      CHECK(read->width == 48);
      CHECK(read->pixels == upright->pixels);
    }
  }
}

TEST_CASE("CMYK JPEG becomes RGB") {
  // Adobe's inverted ink (TurboJPEG writes the Adobe marker): 255, 0, 0, 255 is full magenta and yellow: red.
  Bytes ink;
  for (int i = 0; i < 16 * 16; ++i) ink.insert(ink.end(), {255, 0, 0, 255});
  const auto image = decode_image(cmyk_jpeg(ink, 16, 16), "ink.jpg");
  REQUIRE(image.ok());
  REQUIRE(image->channels == 3);
  CHECK(int{image->at(8, 8)[0]} > 245);
  CHECK(int{image->at(8, 8)[1]} < 10);
  CHECK(int{image->at(8, 8)[2]} < 10);
}

TEST_CASE("a 16 bit and a palette PNG are read as 8 bit") {
  const Bytes grey16 = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44,
                        0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x00, 0x00, 0x00, 0x00, 0x81,
                        0xD9, 0xFC, 0x15, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x44, 0x41, 0x54, 0x78, 0xDA, 0x63, 0x68,
                        0x10, 0xFA, 0xFF, 0x1F, 0x00, 0x05, 0x38, 0x02, 0x91, 0x15, 0xC8, 0xBD, 0xE4, 0x00, 0x00,
                        0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};  // 2 x 1: 0x8012, 0xFFFF
  const auto grey = decode_image(grey16, "grey16.png");
  REQUIRE(grey.ok());
  CHECK(grey->channels == 1);
  CHECK(grey->pixels == Bytes{0x80, 0xFF});
  // 2 x 1, two palette entries, the second half transparent.
  const Bytes indexed = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44,
                         0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x03, 0x00, 0x00, 0x00, 0xC3,
                         0xFC, 0x8F, 0xB8, 0x00, 0x00, 0x00, 0x06, 0x50, 0x4C, 0x54, 0x45, 0x0A, 0x14, 0x1E, 0x28,
                         0x32, 0x3C, 0xD5, 0x1B, 0xB4, 0xE9, 0x00, 0x00, 0x00, 0x02, 0x74, 0x52, 0x4E, 0x53, 0xFF,
                         0x80, 0x08, 0x0F, 0xB3, 0x6A, 0x00, 0x00, 0x00, 0x0B, 0x49, 0x44, 0x41, 0x54, 0x78, 0xDA,
                         0x63, 0x60, 0x60, 0x04, 0x00, 0x00, 0x04, 0x00, 0x02, 0x2C, 0xDE, 0x48, 0xAD, 0x00, 0x00,
                         0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};
  const auto palette = decode_image(indexed, "palette.png");
  REQUIRE(palette.ok());
  CHECK(palette->pixels == Bytes{10, 20, 30, 255, 40, 50, 60, 128});
}

TEST_CASE("cut or damaged images are errors that name the file") {
  const Image image = picture(64, 64, 3);
  const auto check_all_cuts = [](const Bytes& bytes, const std::string& name) {
    for (std::size_t size = 0; size + 24 < bytes.size(); size += 1 + bytes.size() / 97) {
      const auto cut = decode_image(std::span{bytes}.first(size), name);
      CAPTURE(name, size, bytes.size());
      REQUIRE_FALSE(cut.ok());
      CHECK(cut.error().where == name);
      CHECK_FALSE(cut.error().message.empty());
    }
    Bytes broken = bytes;
    for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 211) {
      broken[at] ^= 0x5A;
      const auto result = decode_image(broken, name);  // must come back, either way
      if (result)
        CHECK(result->pixels.size() == static_cast<std::size_t>(result->width) * result->height * result->channels);
      broken[at] ^= 0x5A;
    }
  };
  check_all_cuts(encode_png(image).value(), "cut.png");
  check_all_cuts(encode_jpeg(image).value(), "cut.jpg");
  check_all_cuts(encode_webp(image).value(), "cut.webp");
}

TEST_CASE("a PNG with any byte of its pixels changed, or without its end, is damaged") {
  for (const std::uint32_t channels : {1U, 4U}) {
    Bytes bytes = encode_png(picture(64, 64, channels)).value();
    const std::string marks(bytes.begin(), bytes.end());
    const std::size_t first = marks.find("IDAT");
    const std::size_t end = marks.rfind("IEND") - 4;
    REQUIRE(first < end);
    for (std::size_t at = first + 4; at < end; ++at) {  // the checksum behind the pixels, too
      bytes[at] ^= 0x40;
      CAPTURE(channels, at);
      CHECK(decode_image(bytes, "flipped.png").error().code == ErrorCode::BadData);
      bytes[at] ^= 0x40;
    }
    for (const std::size_t size : {end, end + 4, end + 7}) {
      CAPTURE(channels, size, end);
      CHECK_FALSE(decode_image(std::span{bytes}.first(size), "endless.png").ok());
    }
    bytes.insert(bytes.end(), 100, std::uint8_t{7});  // of no chunk
    CHECK(decode_image(bytes, "trail.png").ok());
  }
}

TEST_CASE("an image over the pixel limit is refused before it is unpacked") {
  const Image image = picture(64, 64, 3);
  for (const auto& bytes : {encode_png(image).value(), encode_jpeg(image).value(), encode_webp(image).value()}) {
    const auto refused = decode_image(bytes, "large", 64 * 64 - 1);
    REQUIRE_FALSE(refused.ok());
    CHECK(refused.error().code == ErrorCode::TooLarge);
    CHECK(decode_image(bytes, "fits", 64 * 64).ok());
  }
}

TEST_CASE("image files are written by extension and read by content") {
  const auto folder = test::scratch_folder("image_files");
  const Image image = picture(20, 10, 3);
  for (const char* name : {"a.png", "a.jpg", "a.webp"}) {
    REQUIRE(write_image(image, folder / name).ok());
    const auto back = read_image(folder / name);
    REQUIRE(back.ok());
    CHECK(back->width == 20);
  }
  std::filesystem::rename(folder / "a.png", folder / "liar.jpg");
  CHECK(read_image(folder / "liar.jpg")->pixels == image.pixels);
  CHECK(write_image(image, folder / "a.xyz").error().code == ErrorCode::BadArgument);
  CHECK(write_image({}, folder / "b.png").error().code == ErrorCode::BadArgument);
  CHECK(read_image(folder / "nothing.png").error().code == ErrorCode::NotFound);
  CHECK(write_image(image, folder / "no" / "such" / "folder.png").error().code == ErrorCode::Unreadable);
}

TEST_CASE("a BMP and a TGA are read") {
  // 2 x 2, 24 bit, rows from the bottom: blue, green / red, white.
  const Bytes bmp = {'B', 'M', 70, 0, 0,  0, 0,   0, 0, 0, 54,  0, 0, 0, 40, 0, 0,   0,   2,   0,   0, 0, 2, 0,
                     0,   0,   1,  0, 24, 0, 0,   0, 0, 0, 16,  0, 0, 0, 0,  0, 0,   0,   0,   0,   0, 0, 0, 0,
                     0,   0,   0,  0, 0,  0, 255, 0, 0, 0, 255, 0, 0, 0, 0,  0, 255, 255, 255, 255, 0, 0};
  const auto from_bmp = decode_image(bmp, "a.bmp");
  REQUIRE(from_bmp.ok());
  CHECK(from_bmp->pixels == Bytes{255, 0, 0, 255, 255, 255, 0, 0, 255, 0, 255, 0});
  const Bytes tga = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0x20, 1, 2, 3};
  const auto from_tga = decode_image(tga, "a.TGA");
  REQUIRE(from_tga.ok());
  CHECK(from_tga->pixels == Bytes{3, 2, 1});
  CHECK(decode_image(tga, "a.dat").error().code == ErrorCode::Unsupported);
}

TEST_CASE("an animated GIF begins with its first frame and holds them all") {
  const auto folder = test::scratch_folder("gif");
  std::vector<Image> frames;
  for (std::uint32_t i = 0; i < 5; ++i) {
    frames.push_back(picture(60, 40, 3));
    for (std::uint32_t y = 0; y < 8; ++y) {
      for (std::uint32_t x = 0; x < 8; ++x) frames[i].at(x + 8 * i, y + 10)[2] = 250;
    }
  }
  REQUIRE(write_gif(frames, folder / "film.gif", 0.04).ok());
  const auto first = read_image(folder / "film.gif");
  REQUIRE(first.ok());
  Image rgb{first->width, first->height, 3, {}};
  for (std::size_t i = 0; i < static_cast<std::size_t>(rgb.width) * rgb.height; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rgb.pixels.push_back(first->pixels[i * first->channels + c]);
  }
  CHECK(mean_difference(rgb, frames[0]) < 3.0);
  std::ifstream file{folder / "film.gif", std::ios::binary};
  const std::string bytes{std::istreambuf_iterator<char>{file}, {}};
  std::size_t descriptors = 0;
  for (std::size_t at = bytes.find("\x21\xF9\x04"); at != std::string::npos; at = bytes.find("\x21\xF9\x04", at + 1))
    ++descriptors;
  CHECK(descriptors == 5);
  CHECK(bytes.find("NETSCAPE2.0") != std::string::npos);
}

TEST_CASE("a GIF that is not finished leaves nothing behind") {
  const auto folder = test::scratch_folder("gif_unfinished");
  {
    auto writer = GifWriter::create(folder / "film.gif", 0.1);
    REQUIRE(writer.ok());
    REQUIRE(writer->add(picture(8, 8, 3)).ok());
    CHECK(writer->add(picture(9, 8, 3)).error().code == ErrorCode::BadArgument);
  }
  CHECK(std::filesystem::is_empty(folder));
}

TEST_CASE("the photographs of the real data decode") {
  LODESTONE_REQUIRE_DATA(root);
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.path().extension() != ".jpg" && entry.path().extension() != ".png") continue;
    if (entry.path().string().find("street_all") != std::string::npos) continue;  // the same pictures again
    const auto image = read_image(entry.path());
    CAPTURE(entry.path().string());
    CHECK(image.ok());
    ++count;
  }
  CHECK(count > 100);
}

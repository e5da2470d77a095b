// SPDX-License-Identifier: MIT
// The only file that names giflib.
// Based on: Heckbert 1982, Color image quantization for frame buffer display (median cut).
// Differs: boxes are cut on a histogram of 5 bits a channel, at the mean of the longest side of the box whose squared
// error is largest.
#include <gif_lib.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <lodestone/formats.h>

#include "codecs.h"
#include "output_file.h"

namespace lodestone {
namespace {

constexpr int bin_count = 1 << 15;
constexpr int palette_size = 255;  // entry 255 is "as before"
constexpr int transparent = 255;

struct Bin {
  std::array<std::uint32_t, 3> sum{};
  std::uint32_t count = 0;
};

int bin_of(const std::uint8_t* p) { return ((p[0] >> 3) << 10) | ((p[1] >> 3) << 5) | (p[2] >> 3); }

// A run of the list of used bins.
struct ColorBox {
  int begin = 0;
  int end = 0;
  double error = 0.0;
  int axis = 0;
  std::array<double, 3> mean{};
};

struct Palette {
  std::array<GifColorType, 256> colors{};
  std::vector<std::uint8_t> entry_of_bin = std::vector<std::uint8_t>(bin_count);
};

int coordinate(int bin, int axis) { return (bin >> (10 - 5 * axis)) & 31; }

ColorBox measure(const std::vector<int>& used, const std::vector<Bin>& bins, int begin, int end) {
  ColorBox box{.begin = begin, .end = end};
  std::array<double, 3> sum{};
  std::array<double, 3> square{};
  double count = 0.0;
  for (int i = begin; i < end; ++i) {
    const Bin& bin = bins[used[i]];
    count += bin.count;
    for (int a = 0; a < 3; ++a) {
      const double mean = static_cast<double>(bin.sum[a]) / bin.count;
      sum[a] += bin.sum[a];
      square[a] += mean * mean * bin.count;
    }
  }
  double widest = -1.0;
  for (int a = 0; a < 3; ++a) {
    box.mean[a] = sum[a] / count;
    const double spread = std::max(0.0, square[a] - sum[a] * sum[a] / count);
    box.error += spread;
    if (spread > widest) {
      widest = spread;
      box.axis = a;
    }
  }
  return box;
}

Palette make_palette(const std::vector<Bin>& bins) {
  std::vector<int> used;
  for (int b = 0; b < bin_count; ++b) {
    if (bins[b].count > 0) used.push_back(b);
  }
  Palette palette;
  if (used.empty()) return palette;
  std::vector<ColorBox> boxes{measure(used, bins, 0, static_cast<int>(used.size()))};
  while (static_cast<int>(boxes.size()) < palette_size) {
    const auto worst = std::max_element(boxes.begin(), boxes.end(), [](const ColorBox& a, const ColorBox& b) {
      return (a.end - a.begin > 1 ? a.error : -1.0) < (b.end - b.begin > 1 ? b.error : -1.0);
    });
    const ColorBox box = *worst;
    if (box.end - box.begin < 2) break;
    const auto first = used.begin() + box.begin;
    const auto last = used.begin() + box.end;
    const int cut = static_cast<int>(box.mean[box.axis] / 8.0);
    auto middle = std::stable_partition(first, last, [&](int b) { return coordinate(b, box.axis) <= cut; });
    if (middle == first || middle == last) middle = first + (last - first) / 2;
    const int split = static_cast<int>(middle - used.begin());
    *worst = measure(used, bins, box.begin, split);
    boxes.push_back(measure(used, bins, split, box.end));
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto byte = [&](int a) { return static_cast<GifByteType>(std::lround(boxes[i].mean[a])); };
    palette.colors[i] = {byte(0), byte(1), byte(2)};
    for (int u = boxes[i].begin; u < boxes[i].end; ++u) {
      palette.entry_of_bin[used[u]] = static_cast<std::uint8_t>(i);
    }
  }
  return palette;
}

int write_bytes(GifFileType* gif, const GifByteType* data, int size) {
  static_cast<OutputFile*>(gif->UserData)->write(data, static_cast<std::size_t>(size));
  return size;
}

}  // namespace

struct GifWriter::State {
  OutputFile out;
  std::string name;
  int delay_cs = 4;
  GifFileType* gif = nullptr;
  Image previous;

  State(OutputFile file, std::string file_name, int delay)
      : out{std::move(file)}, name{std::move(file_name)}, delay_cs{delay} {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    int code = 0;
    if (gif != nullptr) EGifCloseFile(gif, &code);
  }

  [[nodiscard]] Error error(const char* what) const { return Error{ErrorCode::Unreadable, what, name}; }

  [[nodiscard]] bool begin(const Image& frame) {
    int code = 0;
    gif = EGifOpen(&out, write_bytes, &code);
    if (gif == nullptr) return false;
    EGifSetGifVersion(gif, true);
    const GifByteType forever[] = {1, 0, 0};
    return EGifPutScreenDesc(gif, static_cast<int>(frame.width), static_cast<int>(frame.height), 8, 0, nullptr) ==
               GIF_OK &&
           EGifPutExtensionLeader(gif, APPLICATION_EXT_FUNC_CODE) == GIF_OK &&
           EGifPutExtensionBlock(gif, 11, "NETSCAPE2.0") == GIF_OK &&
           EGifPutExtensionBlock(gif, 3, forever) == GIF_OK && EGifPutExtensionTrailer(gif) == GIF_OK;
  }

  // Pixels equal to those before are left as they are: it packs better, and still parts do not flicker.
  [[nodiscard]] bool put(const Image& frame) {
    const std::size_t count = static_cast<std::size_t>(frame.width) * frame.height;
    std::vector<Bin> bins(bin_count);
    std::vector<bool> same(count, false);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t* p = &frame.pixels[3 * i];
      if (!previous.empty() && std::equal(p, p + 3, &previous.pixels[3 * i])) {
        same[i] = true;
        continue;
      }
      Bin& bin = bins[bin_of(p)];
      ++bin.count;
      for (int a = 0; a < 3; ++a) bin.sum[a] += p[a];
    }
    const Palette palette = make_palette(bins);
    const GraphicsControlBlock control{DISPOSE_DO_NOT, false, delay_cs, transparent};
    GifByteType packed[4];
    EGifGCBToExtension(&control, packed);
    ColorMapObject* map = GifMakeMapObject(256, palette.colors.data());
    if (map == nullptr) return false;
    bool good = EGifPutExtension(gif, GRAPHICS_EXT_FUNC_CODE, 4, packed) == GIF_OK &&
                EGifPutImageDesc(gif, 0, 0, static_cast<int>(frame.width), static_cast<int>(frame.height), false,
                                 map) == GIF_OK;
    GifFreeMapObject(map);
    std::vector<GifPixelType> line(frame.width);
    for (std::uint32_t y = 0; good && y < frame.height; ++y) {
      for (std::uint32_t x = 0; x < frame.width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * frame.width + x;
        line[x] = same[i] ? transparent : palette.entry_of_bin[bin_of(&frame.pixels[3 * i])];
      }
      good = EGifPutLine(gif, line.data(), static_cast<int>(frame.width)) == GIF_OK;
    }
    return good;
  }
};

GifWriter::GifWriter(std::unique_ptr<State> state) noexcept : state_{std::move(state)} {}
GifWriter::GifWriter(GifWriter&&) noexcept = default;
GifWriter& GifWriter::operator=(GifWriter&&) noexcept = default;
GifWriter::~GifWriter() = default;

Result<GifWriter> GifWriter::create(const std::filesystem::path& file, double frame_s) {
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  const int delay_cs = static_cast<int>(std::clamp(std::round(frame_s * 100.0), 1.0, 65535.0));
  return GifWriter{std::make_unique<State>(std::move(*out), file.string(), delay_cs)};
}

Status GifWriter::add(const Image& frame) {
  constexpr std::uint32_t max_side = 65535;
  const Image& before = state_->previous;
  if (frame.empty() || frame.width > max_side || frame.height > max_side ||
      (!before.empty() && (frame.width != before.width || frame.height != before.height))) {
    return Error{ErrorCode::BadArgument, "the frames of a GIF must all have one size, at most 65535 a side",
                 state_->name};
  }
  Image rgb = widened_to_rgb(frame);
  if (rgb.channels == 4) {
    const std::size_t count = static_cast<std::size_t>(rgb.width) * rgb.height;
    for (std::size_t i = 1; i < count; ++i) std::copy_n(&rgb.pixels[4 * i], 3, &rgb.pixels[3 * i]);
    rgb.pixels.resize(3 * count);
    rgb.channels = 3;
  }
  if (state_->gif == nullptr && !state_->begin(rgb)) return state_->error("the GIF cannot be begun");
  if (!state_->put(rgb)) return state_->error("the GIF frame cannot be written");
  state_->previous = std::move(rgb);
  return Done{};
}

Status GifWriter::finish() {
  if (state_->gif == nullptr) return Error{ErrorCode::BadArgument, "a GIF needs at least one frame", state_->name};
  int code = 0;
  const bool closed = EGifCloseFile(std::exchange(state_->gif, nullptr), &code) == GIF_OK;
  if (!closed) return state_->error("the GIF cannot be ended");
  return state_->out.commit();
}

Status write_gif(std::span<const Image> frames, const std::filesystem::path& file, double frame_s) {
  auto writer = GifWriter::create(file, frame_s);
  if (!writer) return writer.error();
  for (const Image& frame : frames) {
    if (auto added = writer->add(frame); !added) return added;
  }
  return writer->finish();
}

}  // namespace lodestone

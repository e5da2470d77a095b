// SPDX-License-Identifier: MIT
// Based on: Ao et al. 2025, section 3.4 (downsampling by the ratio of the levels).
// Differs: whole level images are made, and tiles cut out of them, so that neighbours agree in every texel; the filter
// works in linear light; what no triangle shows is filled before, so that it bleeds into nothing.
#include <lodestone/outcrop.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <iterator>

#include "image/area_filter.h"
#include "image/fill.h"
#include "outcrop/segments.h"

namespace lodestone {
namespace {

// Marks every pixel that the triangle touches.
void cover(const glm::dvec2 (&p)[3], std::uint32_t width, std::uint32_t height, std::vector<bool>& known) {
  const double top = std::min({p[0].y, p[1].y, p[2].y});
  const double bottom = std::max({p[0].y, p[1].y, p[2].y});
  const auto clamped = [](double value, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(value), 0.0, size - 1.0));
  };
  for (std::uint32_t y = clamped(top, height); y <= clamped(bottom, height); ++y) {
    // The part of the triangle between the lines y and y + 1.
    double low = width;
    double high = -1.0;
    const auto take = [&](double x) {
      low = std::min(low, x);
      high = std::max(high, x);
    };
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2& a = p[k];
      const glm::dvec2& b = p[(k + 1) % 3];
      if (a.y >= y && a.y <= y + 1.0) take(a.x);
      for (const double line : {double(y), y + 1.0}) {
        if ((a.y < line) != (b.y < line)) take(a.x + (b.x - a.x) * ((line - a.y) / (b.y - a.y)));
      }
    }
    if (high < low) continue;
    const std::size_t row = static_cast<std::size_t>(y) * width;
    for (std::uint32_t x = clamped(low, width); x <= clamped(high, width); ++x) known[row + x] = true;
  }
}

// A part that lies inside, in the memory of the whole.
Image crop(Image image, std::uint32_t left, std::uint32_t top, std::uint32_t width, std::uint32_t height) {
  const std::size_t row_bytes = static_cast<std::size_t>(width) * image.channels;
  for (std::uint32_t y = 0; y < height; ++y) {  // rows move towards the front only
    std::memmove(&image.pixels[y * row_bytes], image.at(left, top + y), row_bytes);
  }
  image.width = width;
  image.height = height;
  image.pixels.resize(height * row_bytes);
  return image;
}

// The used part of a photograph, which repeats beyond its borders.
Image used_part(const OutcropSegment& segment, Image photograph) {
  if (segment.left_px == 0 && segment.top_px == 0 && segment.width_px == photograph.width &&
      segment.height_px == photograph.height) {
    return photograph;
  }
  if (segment.left_px >= 0 && segment.top_px >= 0 && segment.left_px + segment.width_px <= photograph.width &&
      segment.top_px + segment.height_px <= photograph.height) {
    const auto left = static_cast<std::uint32_t>(segment.left_px);
    return crop(std::move(photograph), left, static_cast<std::uint32_t>(segment.top_px), segment.width_px,
                segment.height_px);
  }
  Image out{segment.width_px, segment.height_px, photograph.channels, {}};
  out.pixels.resize(static_cast<std::size_t>(out.width) * out.height * out.channels);
  const auto wrapped = [](std::int64_t at, std::uint32_t size) {
    const std::int64_t rest = at % size;
    return static_cast<std::uint32_t>(rest < 0 ? rest + size : rest);
  };
  for (std::uint32_t y = 0; y < out.height; ++y) {
    const std::uint32_t from_y = wrapped(std::int64_t{segment.top_px} + y, photograph.height);
    for (std::uint32_t x = 0; x < out.width;) {
      const std::uint32_t from_x = wrapped(std::int64_t{segment.left_px} + x, photograph.width);
      const std::uint32_t run = std::min(out.width - x, photograph.width - from_x);
      std::memcpy(out.at(x, y), photograph.at(from_x, from_y), static_cast<std::size_t>(run) * out.channels);
      x += run;
    }
  }
  return out;
}

// RGB or RGBA from grey.
Image with_channels(const Image& image, std::uint32_t channels) {
  if (image.channels == channels) return image;
  Image out{image.width, image.height, channels, {}};
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  out.pixels.resize(count * channels);
  const bool grey = image.channels <= 2;
  const bool has_alpha = image.channels == 2 || image.channels == 4;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* from = &image.pixels[i * image.channels];
    std::uint8_t* to = &out.pixels[i * channels];
    const std::uint32_t colors = channels <= 2 ? 1 : 3;
    for (std::uint32_t c = 0; c < colors; ++c) to[c] = from[grey ? 0 : c];
    if (channels > colors) to[colors] = has_alpha ? from[image.channels - 1] : 255;
  }
  return out;
}

const Image& level_image(std::span<const SegmentImages* const> images, const TexturePiece& piece,
                         [[maybe_unused]] std::uint32_t level) {
  const auto at = std::find_if(images.begin(), images.end(),
                               [&](const SegmentImages* one) { return one->segment() == piece.segment; });
  assert(at != images.end() && (*at)->level() == level);
  return (*at)->image();
}

// A level is made from the coarsest one that still has about two pixels for one, so that errors of rounding and blur do
// not add up.
bool enough_for(const glm::uvec2& image_size, const glm::uvec2& size) {
  constexpr double least = 1.9;
  return image_size.x >= least * size.x && image_size.y >= least * size.y;
}

}  // namespace

std::vector<bool> OutcropPyramid::coverage(std::uint32_t segment) const {
  const OutcropSegment& s = segments_[segment];
  std::vector<bool> known(static_cast<std::size_t>(s.width_px) * s.height_px, false);
  const LevelMesh& level = meshes_.front();
  for (std::size_t f = 0; f < level.face_materials.size(); ++f) {
    if (segment_of_material_[level.face_materials[f]] != segment) continue;
    glm::dvec2 p[3];
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = outcrop::to_pixels(level.vertices.uvs[level.indices[3 * f + k]], image_px_[segment]) -
             glm::dvec2{s.left_px, s.top_px};
    }
    cover(p, s.width_px, s.height_px, known);
  }
  widen(known, s.width_px, s.height_px, 1);
  return known;
}

SegmentImages::SegmentImages(const OutcropPyramid& pyramid, std::uint32_t segment, Image photograph)
    : segment_(segment) {
  images_.push_back(used_part(pyramid.segments()[segment], std::move(photograph)));
  fill_unknown(images_.front(), pyramid.coverage(segment));
}

void SegmentImages::go_to(const OutcropPyramid& pyramid, std::uint32_t wanted) {
  assert(wanted >= level());
  while (level() < wanted) coarsen(pyramid);
}

// All that is to be made of the present level is made before it goes, the largest in its own memory.
void SegmentImages::coarsen(const OutcropPyramid& pyramid) {
  Image source = std::move(images_.front());
  images_.erase(images_.begin());
  ++level_;
  const auto size_of = [&](std::uint32_t level) {
    return glm::min(pyramid.image_size(segment_, level), glm::uvec2{source.width, source.height});
  };
  const glm::uvec2 next = images_.empty() ? size_of(level_) : glm::uvec2{images_.front().width, images_.front().height};
  const std::uint32_t first = level_ + static_cast<std::uint32_t>(images_.size());
  std::uint32_t end = first;
  while (end < pyramid.levels().size() && (end == level_ || !enough_for(next, pyramid.image_size(segment_, end))))
    ++end;
  if (first == end) return;
  std::vector<Image> smaller;
  for (std::uint32_t level = first + 1; level < end; ++level) {
    smaller.push_back(shrink(source, size_of(level).x, size_of(level).y));
  }
  const glm::uvec2 size = size_of(first);
  images_.push_back(shrink_in_place(std::move(source), size.x, size.y));
  std::move(smaller.begin(), smaller.end(), std::back_inserter(images_));
}

SegmentImages::SegmentImages(std::uint32_t segment, std::uint32_t level, Image image)
    : segment_(segment), level_(level) {
  images_.push_back(std::move(image));
}

Image compose(const TileTexture& texture, std::span<const SegmentImages* const> images) {
  std::uint32_t colors = 1;
  std::uint32_t alpha = 0;
  for (const TexturePiece& piece : texture.pieces) {
    const std::uint32_t channels = level_image(images, piece, texture.level).channels;
    if (channels >= 3) colors = 3;
    if (channels % 2 == 0) alpha = 1;
  }
  Image out{texture.width, texture.height, colors + alpha, {}};
  out.pixels.resize(static_cast<std::size_t>(out.width) * out.height * out.channels);
  const bool gaps = texture.pieces.size() > 1;
  std::vector<bool> known(gaps ? static_cast<std::size_t>(out.width) * out.height : 0, false);
  for (const TexturePiece& piece : texture.pieces) {
    const Image& level = level_image(images, piece, texture.level);
    Image widened;
    if (level.channels != out.channels) widened = with_channels(level, out.channels);
    const Image& from = level.channels != out.channels ? widened : level;
    for (std::uint32_t y = 0; y < std::min(piece.height, out.height - piece.to_y); ++y) {
      const auto from_y = std::clamp<std::int64_t>(std::int64_t{piece.from_y} + y, 0, from.height - 1);
      for (std::uint32_t x = 0; x < std::min(piece.width, out.width - piece.to_x); ++x) {
        const auto from_x = std::clamp<std::int64_t>(std::int64_t{piece.from_x} + x, 0, from.width - 1);
        std::memcpy(out.at(piece.to_x + x, piece.to_y + y),
                    from.at(static_cast<std::uint32_t>(from_x), static_cast<std::uint32_t>(from_y)), out.channels);
        if (gaps) known[static_cast<std::size_t>(piece.to_y + y) * out.width + piece.to_x + x] = true;
      }
    }
  }
  if (gaps) fill_unknown(out, known);
  return out;
}

}  // namespace lodestone

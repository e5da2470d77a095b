// SPDX-License-Identifier: MIT
// Based on: "enforcing the borders at different pyramid levels to match", which Campos et al. 2020, section 6, leave to
// the future.
// Differs: no viewer has to help. A line is the chain of the finest zoom on all zooms. Its vertices lie in places that
// the coarsest tile along it can write, which the finer ones then can as well: u there is 2u or 2u - 32767 in a half.
// Only the corners of finer tiles cannot be written in coarser ones, because 32767 is odd: there the line is level
// between the two places beside the corner.
#include "terrain/shared_borders.h"

#include <bit>

namespace lodestone::terrain {
namespace {

class Line {
 public:
  Line(const HeightSource& source, const TileId& tile, Side side, const SharedBorderOptions& options)
      : source_{source}, tile_{tile}, side_{side}, options_{options} {
    upwards_ = side == Side::West || side == Side::East;
    const bool far = side == Side::East || side == Side::North;
    const std::uint32_t around = 2U << tile.zoom;
    line_ = upwards_ ? (tile.x + (far ? 1 : 0)) % around : tile.y + (far ? 1 : 0);
    place_ = upwards_ ? tile.y : tile.x;
    const auto even = line_ == 0
                          ? tile.zoom
                          : std::min<std::uint32_t>(tile.zoom, static_cast<std::uint32_t>(std::countr_zero(line_)));
    first_zoom_ = std::max(options.from_zoom, tile.zoom - even);
    below_ = tile.zoom - first_zoom_;
    finer_ = options.to_zoom - first_zoom_;
  }

  [[nodiscard]] Result<std::optional<std::vector<Tin::Vertex>>> vertices() {
    for (std::uint32_t zoom = first_zoom_; zoom <= options_.to_zoom; ++zoom) {
      const auto complete = read(zoom);
      if (!complete) return complete.error();
      if (!*complete) return std::optional<std::vector<Tin::Vertex>>{};
    }
    std::vector<Tin::Vertex> made;
    const std::int64_t edges = std::int64_t{1} << (options_.to_zoom - tile_.zoom);
    const std::int64_t first = (place_ & ((1U << below_) - 1)) * edges;
    for (std::int64_t edge = first; edge < first + edges; ++edge)
      add_edge(edge, edge == first, edge + 1 == first + edges, made);
    return std::optional{std::move(made)};
  }

 private:
  // The heights along the line, and whether everything is there that cells beside it need.
  [[nodiscard]] Result<bool> read(std::uint32_t zoom) {
    const std::int64_t across = std::int64_t{line_} * size << zoom >> tile_.zoom;
    const std::int64_t begin = std::int64_t{place_ >> below_} * size << (zoom - first_zoom_);
    const auto length = static_cast<std::uint32_t>((std::uint32_t{size} << (zoom - first_zoom_)) + 1);
    const std::int64_t top = std::int64_t{size} << zoom;
    std::int64_t low = across - 1, high = across + 1;
    if (!upwards_) low = std::max<std::int64_t>(low, 0), high = std::min(high, top);
    const auto width = static_cast<std::uint32_t>(high - low + 1);
    const PostWindow window =
        upwards_ ? PostWindow{zoom, low, begin, width, length} : PostWindow{zoom, begin, low, length, width};
    std::vector<float> heights(std::size_t{width} * length);
    if (Status status = source_.read(window, heights); !status) return status.error();
    for (const float height_m : heights) {
      if (std::isnan(height_m)) return false;
    }
    posts_m_.resize(length);
    for (std::uint32_t i = 0; i < length; ++i) {
      const auto row = static_cast<std::size_t>(upwards_ ? i : across - low),
                 column = static_cast<std::size_t>(upwards_ ? across - low : i);
      posts_m_[i] = heights[row * window.width + column];
    }
    const auto level = [&](std::int64_t row, float height_m) {
      if (std::isnan(height_m)) return;
      if (!upwards_ && across == row) std::fill(posts_m_.begin(), posts_m_.end(), height_m);
      if (upwards_ && begin == row) posts_m_.front() = height_m;
      if (upwards_ && begin + length - 1 == row) posts_m_.back() = height_m;
    };
    level(0, options_.polar_height_m[0]);
    level(top, options_.polar_height_m[1]);
    return true;
  }

  // Where a post of the finest zoom would be on the coarsest, in its quantised units times 2^(8 + finer).
  [[nodiscard]] std::int64_t exact(std::int64_t post) const { return post * quantized_max; }
  [[nodiscard]] std::int64_t unit() const { return std::int64_t{size} << finer_; }
  [[nodiscard]] double in_posts(std::int64_t place) const {
    return static_cast<double>(place * unit()) / quantized_max;
  }

  // One edge of the finest zoom.
  void add_edge(std::int64_t edge, bool first, bool last, std::vector<Tin::Vertex>& made) const {
    const std::int64_t begin = edge * size;
    ChainLine line;
    std::array<std::int64_t, size + 1> place{};
    for (int t = 0; t <= size; ++t) {
      const auto i = static_cast<std::size_t>(t);
      const std::int64_t post = begin + t;
      const double height_m = posts_m_[static_cast<std::size_t>(post)];
      // Of a corner the place on this side.
      place[i] = t == 0      ? (exact(post) + unit() - 1) / unit()
                 : t == size ? exact(post) / unit()
                             : (2 * exact(post) + unit()) / (2 * unit());
      const double shift = in_posts(place[i]) - static_cast<double>(post);
      line.post_m[i] = height_m;
      line.place[i] = t + shift;
      const bool corner = t == 0 || t == size;
      const double behind_m = corner ? height_m : posts_m_[static_cast<std::size_t>(shift > 0.0 ? post - 1 : post + 1)];
      line.vertex_m[i] = snapped_m(height_m + std::fabs(shift) * (height_m - behind_m), options_.chain.step_m);
    }
    const std::vector<int> chain = divided_chain(line, options_.chain);
    if (first) add(0, line.vertex_m.front(), made);
    for (const int t : chain) {
      const auto i = static_cast<std::size_t>(t);
      const std::int64_t at = (place[i] << below_) - std::int64_t{place_ & ((1U << below_) - 1)} * quantized_max;
      add(static_cast<int>(at), line.vertex_m[i], made);
    }
    if (last) add(quantized_max, line.vertex_m.back(), made);
  }

  void add(int along, double height_m, std::vector<Tin::Vertex>& made) const {
    switch (side_) {
      case Side::West:
        made.push_back({0, along, height_m});
        return;
      case Side::East:
        made.push_back({quantized_max, along, height_m});
        return;
      case Side::South:
        made.push_back({along, 0, height_m});
        return;
      case Side::North:
        made.push_back({along, quantized_max, height_m});
        return;
    }
  }

  const HeightSource& source_;
  TileId tile_;
  Side side_;
  const SharedBorderOptions& options_;
  bool upwards_ = true;
  std::uint32_t line_ = 0;        // its number at the tile's zoom
  std::uint32_t place_ = 0;       // the tile's number along it
  std::uint32_t first_zoom_ = 0;  // the coarsest that has it and shares it
  std::uint32_t below_ = 0;       // zooms from there to the tile
  std::uint32_t finer_ = 0;       // zooms from there to the finest
  std::vector<float> posts_m_;    // of the finest zoom, along the coarsest tile
};

}  // namespace

Result<std::optional<std::vector<Tin::Vertex>>> shared_border(const HeightSource& source, const TileId& tile, Side side,
                                                              const SharedBorderOptions& options) {
  return Line{source, tile, side, options}.vertices();
}

}  // namespace lodestone::terrain

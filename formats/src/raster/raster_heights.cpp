// SPDX-License-Identifier: MIT
// Posts from a raster: linear between sample centres, by windows or, where posts are far apart, by pairs of rows, so
// that memory does not grow with the raster.
#include <lodestone/terrain_files.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "raster/raster_file.h"

namespace lodestone {
namespace {

constexpr float no_data = std::numeric_limits<float>::quiet_NaN();
// Posts closer than this to a sample take that sample alone: they were meant to coincide.
constexpr double coincide = 1e-6;

// Two samples and how far it is from the first to the second.
struct Between {
  std::int64_t first = -1;  // below 0: outside the raster
  float share = 0.0F;
};

Between between(double place, std::int64_t count, bool around) {
  const double last = static_cast<double>(count) - 1.0;
  // Half a sample beyond the outermost centres still belongs to them.
  if (place < -0.5 - coincide || place > last + 0.5 + coincide) return {};
  if (!around) place = std::clamp(place, 0.0, last);
  double first = std::floor(place + coincide);
  double share = place - first;
  if (share < coincide) share = 0.0;
  if (share > 1.0 - coincide) first += 1.0, share = 0.0;
  if (first < 0.0) first += static_cast<double>(count);
  return {static_cast<std::int64_t>(first), static_cast<float>(share)};
}

// A rectangle of samples; columns may run past both ends of a raster that goes around the globe.
struct Block {
  std::int64_t column = 0;
  std::int64_t row = 0;
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::vector<float> samples;
  [[nodiscard]] float at(std::int64_t x, std::int64_t y) const {
    return samples[static_cast<std::size_t>((y - row) * width + (x - column))];
  }
};

class RasterHeights final : public HeightSource {
 public:
  RasterHeights(std::unique_ptr<RasterFile> file, const RasterOptions& options)
      : file_{std::move(file)}, frame_{file_->frame()}, options_{options} {}

  [[nodiscard]] Status read(const PostWindow& window, std::span<float> heights_m) const override;
  [[nodiscard]] GeoBox bounds() const override;
  [[nodiscard]] std::uint32_t native_zoom() const override;

 private:
  using Places = std::vector<Between>;
  [[nodiscard]] Between column_of(double longitude_deg) const;
  [[nodiscard]] Between row_of(double latitude_deg) const;
  [[nodiscard]] Result<Block> load(std::int64_t first_column, std::int64_t last_column, std::int64_t first_row,
                                   std::int64_t last_row) const;
  void fill_voids(Block& block, std::int64_t first_column, std::int64_t last_column, std::int64_t first_row,
                  std::int64_t last_row) const;
  [[nodiscard]] float interpolated(const Block& block, std::int64_t x, std::int64_t y) const;
  [[nodiscard]] Status sample(const Places& columns, std::size_t begin, std::size_t end, const Places& rows,
                              std::span<float> heights_m) const;
  [[nodiscard]] float post(const Block& block, const Between& x, const Between& y) const;

  std::unique_ptr<RasterFile> file_;
  RasterFrame frame_;
  RasterOptions options_;
};

GeoBox RasterHeights::bounds() const {
  const double half_x = 0.5 * frame_.step_x_deg, half_y = 0.5 * std::fabs(frame_.step_y_deg);
  const double other_deg = frame_.north_deg + static_cast<double>(frame_.height - 1) * frame_.step_y_deg;
  const double west_deg = frame_.around ? frame_.west_deg : frame_.west_deg - half_x;
  const double east_deg = frame_.around
                              ? west_deg + 360.0
                              : frame_.west_deg + static_cast<double>(frame_.width - 1) * frame_.step_x_deg + half_x;
  return {west_deg, std::max(-90.0, std::min(frame_.north_deg, other_deg) - half_y), east_deg,
          std::min(90.0, std::max(frame_.north_deg, other_deg) + half_y)};
}

// Posts no farther apart than samples, but for a tenth of a zoom.
std::uint32_t RasterHeights::native_zoom() const {
  const double step_deg = std::min(frame_.step_x_deg, std::fabs(frame_.step_y_deg));
  const double zoom = std::ceil(std::log2(180.0 / tile_intervals / step_deg) - 0.1);
  return static_cast<std::uint32_t>(std::clamp(zoom, 0.0, static_cast<double>(max_terrain_zoom)));
}

Between RasterHeights::column_of(double longitude_deg) const {
  // The turn of the globe in which the raster, or its outer half sample, begins.
  const double from_deg = frame_.west_deg - (frame_.around ? 0.0 : (0.5 + coincide) * frame_.step_x_deg);
  double turned_deg = longitude_deg + 360.0 * std::ceil((from_deg - longitude_deg) / 360.0 - 1e-12);
  if (turned_deg - 360.0 >= from_deg) turned_deg -= 360.0;
  return between((turned_deg - frame_.west_deg) / frame_.step_x_deg, frame_.width, frame_.around);
}

Between RasterHeights::row_of(double latitude_deg) const {
  return between((latitude_deg - frame_.north_deg) / frame_.step_y_deg, frame_.height, false);
}

Result<Block> RasterHeights::load(std::int64_t first_column, std::int64_t last_column, std::int64_t first_row,
                                  std::int64_t last_row) const {
  Block block{first_column, first_row, last_column - first_column + 1, last_row - first_row + 1, {}};
  block.samples.resize(static_cast<std::size_t>(block.width * block.height));
  std::vector<float> part;
  // In one part, or in several on both sides of the seam.
  for (std::int64_t at = first_column; at <= last_column;) {
    const std::int64_t column = (at % frame_.width + frame_.width) % frame_.width;
    const std::int64_t width = std::min(frame_.width - column, last_column - at + 1);
    if (width == block.width) {
      if (Status status = file_->read(column, first_row, width, block.height, block.samples); !status) {
        return status.error();
      }
      return block;
    }
    part.resize(static_cast<std::size_t>(width * block.height));
    if (Status status = file_->read(column, first_row, width, block.height, part); !status) return status.error();
    for (std::int64_t y = 0; y < block.height; ++y) {
      std::copy_n(part.begin() + y * width, width, block.samples.begin() + y * block.width + (at - first_column));
    }
    at += width;
  }
  return block;
}

// By inverse distance from the nearest samples in eight directions.
float RasterHeights::interpolated(const Block& block, std::int64_t x, std::int64_t y) const {
  double sum = 0.0, weights = 0.0;
  for (int direction = 0; direction < 9; ++direction) {
    const int dx = direction % 3 - 1, dy = direction / 3 - 1;
    if (dx == 0 && dy == 0) continue;
    for (std::int64_t step = 1; step <= options_.interpolate_reach; ++step) {
      const std::int64_t px = x + dx * step, py = y + dy * step;
      if (px < block.column || py < block.row || px >= block.column + block.width || py >= block.row + block.height)
        break;
      const float sample = block.at(px, py);
      if (std::isnan(sample)) continue;
      const double weight = 1.0 / (static_cast<double>(step) * (dx != 0 && dy != 0 ? std::sqrt(2.0) : 1.0));
      sum += weight * sample;
      weights += weight;
      break;
    }
  }
  return weights > 0.0 ? static_cast<float>(sum / weights) : no_data;
}

// Replaces the missing samples of a window inside a larger block that reaches as far as interpolation may look.
void RasterHeights::fill_voids(Block& block, std::int64_t first_column, std::int64_t last_column,
                               std::int64_t first_row, std::int64_t last_row) const {
  std::vector<std::pair<std::size_t, float>> found;
  for (std::int64_t y = first_row; y <= last_row; ++y) {
    for (std::int64_t x = first_column; x <= last_column; ++x) {
      if (!std::isnan(block.at(x, y))) continue;
      const auto index = static_cast<std::size_t>((y - block.row) * block.width + (x - block.column));
      found.emplace_back(index, interpolated(block, x, y));
    }
  }
  for (const auto& [index, value] : found) block.samples[index] = value;
}

float RasterHeights::post(const Block& block, const Between& x, const Between& y) const {
  const auto along = [&](std::int64_t row) {
    const float a = block.at(x.first, row);
    return x.share == 0.0F ? a : a + x.share * (block.at(x.first + 1, row) - a);
  };
  const float low = along(y.first);
  return y.share == 0.0F ? low : low + y.share * (along(y.first + 1) - low);
}

// Posts of columns begin..end-1, which ascend in the raster.
Status RasterHeights::sample(const Places& columns, std::size_t begin, std::size_t end, const Places& rows,
                             std::span<float> heights_m) const {
  const std::int64_t first = columns[begin].first;
  const std::int64_t last = columns[end - 1].first + (columns[end - 1].share > 0.0F ? 1 : 0);
  // Rows that are near to each other are read in one go.
  constexpr std::int64_t most_samples = 1 << 20;
  for (std::size_t j = 0; j < rows.size();) {
    if (rows[j].first < 0) {
      ++j;
      continue;
    }
    std::int64_t low = rows[j].first, high = low + (rows[j].share > 0.0F ? 1 : 0);
    std::size_t stop = j + 1;
    for (; stop < rows.size() && rows[stop].first >= 0; ++stop) {
      const std::int64_t from = std::min(low, rows[stop].first);
      const std::int64_t to = std::max(high, rows[stop].first + (rows[stop].share > 0.0F ? 1 : 0));
      if (std::abs(rows[stop].first - rows[stop - 1].first) > 4 || (to - from + 1) * (last - first + 1) > most_samples)
        break;
      low = from;
      high = to;
    }
    auto block = load(first, last, low, high);
    if (!block) return block.error();
    const auto is_void = [](float sample) { return std::isnan(sample); };
    if (options_.voids == Voids::Interpolate && std::any_of(block->samples.begin(), block->samples.end(), is_void)) {
      const std::int64_t reach = options_.interpolate_reach;
      // Around the globe there is no outermost column: a sample must not depend on the window that asks for it.
      const std::int64_t west = frame_.around ? first - reach : std::max<std::int64_t>(0, first - reach);
      const std::int64_t east = frame_.around ? last + reach : std::max(last, std::min(last + reach, frame_.width - 1));
      block = load(west, east, std::max<std::int64_t>(0, low - reach), std::min(high + reach, frame_.height - 1));
      if (!block) return block.error();
      fill_voids(*block, first, last, low, high);
    }
    for (; j < stop; ++j) {
      for (std::size_t i = begin; i < end; ++i) heights_m[j * columns.size() + i] = post(*block, columns[i], rows[j]);
    }
  }
  return Done{};
}

Status RasterHeights::read(const PostWindow& window, std::span<float> heights_m) const {
  const std::int64_t around = std::int64_t{2 * tile_intervals} << window.zoom, top = around / 2;
  Places columns, rows;
  for (std::int64_t i = 0; i < window.width; ++i) {
    const std::int64_t column = ((window.column + i) % around + around) % around;
    columns.push_back(column_of(post_longitude_deg(window.zoom, column)));
  }
  for (std::int64_t j = 0; j < window.height; ++j) {
    const std::int64_t row = window.row + j;
    rows.push_back(row < 0 || row > top ? Between{} : row_of(post_latitude_deg(window.zoom, row)));
  }
  std::fill(heights_m.begin(), heights_m.end(), no_data);
  constexpr std::int64_t most_columns = 1 << 16;
  for (std::size_t begin = 0; begin < columns.size();) {
    if (columns[begin].first < 0) {
      ++begin;
      continue;
    }
    std::size_t end = begin + 1;
    while (end < columns.size() && columns[end].first >= columns[end - 1].first &&
           columns[end].first - columns[begin].first < most_columns) {
      ++end;
    }
    if (Status status = sample(columns, begin, end, rows, heights_m); !status) return status;
    begin = end;
  }
  const bool fill = options_.voids == Voids::Fill;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const bool on_globe =
        window.row + static_cast<std::int64_t>(j) >= 0 && window.row + static_cast<std::int64_t>(j) <= top;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      float& height_m = heights_m[j * columns.size() + i];
      if (!std::isnan(height_m)) {
        height_m = static_cast<float>(height_m * options_.scale + options_.offset_m);
        if (!std::isfinite(height_m)) height_m = no_data;  // more than a float holds
      } else if (fill && on_globe) {
        height_m = static_cast<float>(options_.fill_m);
      }
    }
  }
  return Done{};
}

}  // namespace

Result<std::unique_ptr<HeightSource>> open_raster(const std::filesystem::path& file, const RasterOptions& options) {
  for (const double number : {options.scale, options.offset_m, options.fill_m}) {
    if (!std::isfinite(number))
      return Error{ErrorCode::BadArgument, "scale, offset and fill must be finite", file.string()};
  }
  if (options.scale == 0.0)
    return Error{ErrorCode::BadArgument, "a scale of 0 would flatten everything", file.string()};
  auto raster = RasterFile::open(file, options.nodata);
  if (!raster) return raster.error();
  auto warnings = std::move(raster.warnings());
  std::unique_ptr<HeightSource> source = std::make_unique<RasterHeights>(std::move(*raster), options);
  return {std::move(source), std::move(warnings)};
}

}  // namespace lodestone

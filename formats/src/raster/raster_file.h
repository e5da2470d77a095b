// SPDX-License-Identifier: MIT
// A raster with its samples in longitude and latitude, behind a few plain calls, so that one file names GDAL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/result.h>

namespace lodestone {

// Sample (column, row) has its centre at (west + column * step_x, north + row * step_y) degrees; step_y may be below 0.
struct RasterFrame {
  std::int64_t width = 0;
  std::int64_t height = 0;
  double west_deg = 0.0;
  double north_deg = 0.0;
  double step_x_deg = 1.0;
  double step_y_deg = -1.0;
  bool around = false;  // the column after the last is the first
};

class RasterFile {
 public:
  [[nodiscard]] static Result<std::unique_ptr<RasterFile>> open(const std::filesystem::path& file,
                                                                const std::optional<double>& nodata);
  ~RasterFile();
  RasterFile(const RasterFile&) = delete;
  RasterFile& operator=(const RasterFile&) = delete;

  [[nodiscard]] const RasterFrame& frame() const noexcept { return frame_; }
  // Heights of a window inside the raster, row by row, in metres: unpacked by the file's own scale and offset, feet
  // converted; NaN where there is no data. From any thread.
  [[nodiscard]] Status read(std::int64_t column, std::int64_t row, std::int64_t width, std::int64_t height,
                            std::span<float> samples) const;

 private:
  struct Handle;
  class Lease;
  RasterFile() = default;
  [[nodiscard]] Result<std::unique_ptr<Handle>> open_handle() const;
  [[nodiscard]] Status read_frame(const Handle& handle);

  std::filesystem::path file_;
  std::optional<double> nodata_;
  RasterFrame frame_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Handle>> free_;  // a handle belongs to one thread at a time
};

}  // namespace lodestone

// SPDX-License-Identifier: MIT
// Words of the command line turned into numbers: lengths with a unit, byte sizes, points, picture sizes.
#pragma once

#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include <lodestone/result.h>

namespace lodestone::cli {

// "2mm", "3cm", "0.5m", "1km"; a plain number is metres.
[[nodiscard]] Result<double> parse_length_m(const std::string& text);

// "4096", "512KB", "512MB", "2GB" (powers of 1000), "64KiB", "2GiB" (powers of 1024), in letters of any case.
[[nodiscard]] Result<std::uint64_t> parse_bytes(const std::string& text);

// A whole number without sign: "50000", "50k", "2M".
[[nodiscard]] Result<std::uint64_t> parse_count(const std::string& text);

// A plain decimal number.
[[nodiscard]] Result<double> parse_number(const std::string& text);

// "X,Y,Z", each a length.
[[nodiscard]] Result<glm::dvec3> parse_point_m(const std::string& text);

struct PictureSize {
  std::uint32_t width_px = 1280;
  std::uint32_t height_px = 720;
};
// "1280x720", each 1..16384.
[[nodiscard]] Result<PictureSize> parse_picture_size(const std::string& text);

}  // namespace lodestone::cli

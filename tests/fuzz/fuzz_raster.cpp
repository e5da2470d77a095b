// SPDX-License-Identifier: MIT
// The raster door: bytes as a file, a few posts out.
#include <lodestone/terrain_files.h>

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  static const std::string file =
      (std::filesystem::temp_directory_path() / ("lodestone-fuzz-raster-" + std::to_string(::getpid()))).string();
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  if (stream == nullptr) return 0;
  std::fwrite(data, 1, size, stream);
  std::fclose(stream);
  const auto source = open_raster(file, {.voids = Voids::Interpolate, .interpolate_reach = 4});
  if (source.ok()) {
    const GeoBox box = (*source)->bounds();
    if (!(box.west_deg <= box.east_deg) || !(box.south_deg <= box.north_deg)) __builtin_trap();
    std::vector<float> heights(64);
    const auto column = static_cast<std::int64_t>((box.west_deg + 180.0) / 180.0 * 256.0);
    const auto row = static_cast<std::int64_t>((box.south_deg + 90.0) / 180.0 * 256.0);
    const Status status = (*source)->read({0, column, row, 8, 8}, heights);
    if (!status.ok() && status.error().message.empty()) __builtin_trap();
  } else if (source.error().message.empty()) {
    __builtin_trap();
  }
  std::filesystem::remove(file);
  return 0;
}

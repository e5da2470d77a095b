// SPDX-License-Identifier: MIT
// From a raster of heights to tiles that CesiumJS shows: terrain_to_quantized_mesh HEIGHTS.tif FOLDER [ERROR_M]
#include <lodestone/terrain_files.h>

#include <cstdio>
#include <cstdlib>
#include <string>

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: terrain_to_quantized_mesh HEIGHTS.tif FOLDER [ERROR_M]\n");
    return 1;
  }
  const auto fail = [](const lodestone::Error& error) {
    std::fprintf(stderr, "%s\n", lodestone::to_line(error).c_str());
    return 2;
  };
  const auto source = lodestone::open_raster(argv[1], {.voids = lodestone::Voids::Interpolate});
  if (!source) return fail(source.error());

  lodestone::TerrainOptions options;
  if (argc > 3) options.max_error_m = {std::strtod(argv[3], nullptr)};
  const auto pyramid = lodestone::TerrainPyramid::plan(**source, options);
  if (!pyramid) return fail(pyramid.error());

  const auto written = lodestone::write_terrain(*pyramid, argv[2], {.resume = true});
  if (!written) return fail(written.error());
  for (const auto& zoom : written->zooms) {
    std::printf("zoom %2u: %llu tiles, %.0f triangles each, off by at most %.2f m\n", zoom.zoom,
                static_cast<unsigned long long>(zoom.tiles), zoom.mean_triangles, zoom.max_error_m);
  }
  return 0;
}

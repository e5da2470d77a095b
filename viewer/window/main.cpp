// SPDX-License-Identifier: MIT
// Program lodestone-view.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "window.h"

namespace {

constexpr int wrong_arguments = 1;
constexpr int bad_data = 2;

}  // namespace

int main(int argc, char** argv) {
  lodestone::render::WindowOptions options;
  CLI::App app{
      "Shows a model at any level of detail; any mesh is made into a progressive model on opening.\n"
      "Example: lodestone-view house.lode"};
  double ratio = 0.0;
  auto* file_option = app.add_option(
      "file", options.file,
      "model (.lode), cluster graph (.lodg), tileset.json or mesh (OBJ, PLY, glTF, 3DS, CityJSON, CityGML, ...)");
  app.add_option("--street", options.street_houses,
                 "instead of a file: so many generated houses along a street (24 if no number is given), each built by "
                 "facet shift and as coarse as its distance allows; --fly flies along")
      ->expected(0, 1)
      ->default_str("24")
      ->check(CLI::Range(1, 200))
      ->excludes(file_option);
  const auto* ratio_option =
      app.add_option("--ratio", ratio, "go to this share of the triangles")->check(CLI::Range(0.0, 1.0));
  app.add_option("--level", options.level, "go to the level of this name: lod3, lod2, lod1 or block");
  app.add_option("--width", options.width_px, "window's width in pixels")->check(CLI::Range(200, 16384));
  app.add_option("--height", options.height_px, "window's height in pixels")->check(CLI::Range(200, 16384));
  app.add_option("--screenshot", options.screenshot, "write the window as PNG once the level is reached, and close");
  app.add_flag("--play", options.play, "start sweeping through the levels");
  app.add_flag("--perceptual", options.perceptual, "level by the camera's distance: at most half a pixel off");
  app.add_option("--plan", options.plan,
                 "level by the camera's distance: what 'lodestone distances' measured to be seen");
  app.add_option("--tile-cache", options.tile_cache, "folder for copies of tiles that lie on the web or a slow disk");
  app.add_flag("--fly", options.fly, "fly over the model, round and round");
  auto* unlit = app.add_flag_callback(
      "--unlit", [&] { options.lighting = lodestone::render::Lighting::Photograph; },
      "colours as they are, without lamps: what tilesets with photographs start with");
  app.add_flag_callback(
         "--lit", [&] { options.lighting = lodestone::render::Lighting::Lamps; }, "under lamps, always")
      ->excludes(unlit);
  app.add_flag("--wireframe", options.wireframe, "draw triangle edges");
  app.add_flag("--lod-colors", options.lod_colors, "colour by triangle size");
  app.add_flag("--cluster-colors", options.cluster_colors, "a colour for each cluster of a .lodg file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : wrong_arguments;
  }
  if (*ratio_option) options.ratio = ratio;
  if (!options.plan.empty()) options.perceptual = true;
  const auto status = lodestone::render::run_window(options);
  if (status) return 0;
  std::fprintf(stderr, "lodestone-view: %s\n", lodestone::to_line(status.error()).c_str());
  return bad_data;
}

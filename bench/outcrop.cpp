// SPDX-License-Identifier: MIT
// Tables 2 and 3 and Figures 13 and 16 of Ao et al. 2025 on a mesh at hand.
//
//     bench_outcrop build MESH FOLDER RATIO [THREADS]   processor seconds, memory, bytes of a pyramid (0 = automatic)
//     bench_outcrop load MESH FOLDER                    ten distances: monolith beside pyramid
//     bench_outcrop error MESH [FOLDER]                 error over simplification, beside libmeshoptimizer and the
//     meshes
//                                                       FOLDER/{vtk,meshlab}_PERCENT.obj (outcrop_vtk.py,
//                                                       outcrop_meshlab.sh)
//
// One JSON object per line.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>
#include <lodestone/tile_loader.h>
#include <lodestone/tileset_writer.h>

#include "meshoptimizer_peer.h"
#include "processor_clock.h"
#include "viewer/headless/headless.h"

namespace {

using namespace lodestone;

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

Mesh read(const char* file, LoadTextures textures) {
  auto loaded = read_mesh(file, {.textures = textures});
  if (!loaded) {
    std::fprintf(stderr, "%s\n", to_line(loaded.error()).c_str());
    std::exit(2);
  }
  return std::move(loaded->mesh);
}

int build(const char* file, const char* folder, double ratio, unsigned threads) {
  const double start = wall_seconds();
  Mesh mesh = read(file, LoadTextures::Reference);
  const std::size_t images = mesh.textures.size();
  const auto written = write_outcrop(std::move(mesh), folder, {.pyramid = {.ratio = ratio}}, {.max_workers = threads});
  if (!written) {
    std::fprintf(stderr, "%s\n", to_line(written.error()).c_str());
    return 2;
  }
  const double processor = processor_seconds();
  std::printf(
      "{\"ratio\": %g, \"triangles\": %u, \"images\": %zu, \"megapixels\": %.0f, \"tiles\": %u, \"levels\": %zu, "
      "\"megabytes\": %.0f, \"wall_seconds\": %.1f, \"processor_seconds\": %.1f, "
      "\"decode_megapixels_per_second\": %.0f, \"resample_megapixels_per_second\": %.0f, "
      "\"encode_megapixels_per_second\": %.0f, \"geometry_seconds\": %.1f, \"peak_megabytes\": %.0f}\n",
      ratio, written->source_triangles, images, written->decoded_megapixels, written->tiles, written->levels.size(),
      1e-6 * static_cast<double>(written->bytes), wall_seconds() - start, processor,
      written->decoded_megapixels / written->decode_seconds, written->decoded_megapixels / written->resample_seconds,
      written->encoded_megapixels / written->encode_seconds, written->geometry_seconds, peak_mb());
  return 0;
}

// Ten distances between nearly touching and all of it small, seen from the south.
int load(const char* file, const char* folder) {
  const auto pyramid = TilePyramid::open(std::filesystem::path{folder} / "tileset.json");
  if (!pyramid) return 2;
  const Box& box = (*pyramid)->bounds();
  std::vector<render::Picture> tiled;
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  render::RenderOptions options{.width_px = 1280, .height_px = 720, .supersample = 1};
  options.look.lighting = render::Lighting::Photograph;
  const auto place = [&](int step) {
    options.camera.target_m = (*pyramid)->origin() + box.center();
    options.camera.eye_m = *options.camera.target_m - glm::dvec3{0.0, 0.5 * box.diagonal_m() * (0.3 + 0.5 * step), 0.0};
  };
  for (int step = 1; step <= 10; ++step) {
    place(step);
    auto picture = render::render_tiles(*pyramid, options);
    if (!picture) return 2;
    std::printf(
        "{\"distance\": %d, \"tiles\": %u, \"triangles\": %u, \"frame_seconds\": %.4f, \"frame_processor_seconds\": "
        "%.4f}\n",
        step, picture->tiles, picture->triangles, picture->frame_seconds, picture->frame_processor_seconds);
    tiled.push_back(std::move(*picture));
  }
  std::printf("{\"peak_megabytes\": %.0f}\n", peak_mb());
  const double start = wall_seconds();
  const double before = processor_seconds();
  const Mesh mesh = read(file, LoadTextures::Decoded);
  std::printf("{\"monolith_load_seconds\": %.2f, \"monolith_load_processor_seconds\": %.2f}\n", wall_seconds() - start,
              processor_seconds() - before);
  for (int step = 1; step <= 10; ++step) {
    place(step);
    const auto picture = render::render_mesh(mesh, options);
    if (!picture) return 2;
    std::printf(
        "{\"distance\": %d, \"monolith_frame_seconds\": %.4f, \"monolith_frame_processor_seconds\": %.4f, "
        "\"picture_rms\": %.2f}\n",
        step, picture->frame_seconds, picture->frame_processor_seconds,
        image_rms(picture->image, tiled[static_cast<std::size_t>(step - 1)].image));
  }
  std::printf("{\"peak_megabytes\": %.0f}\n", peak_mb());
  return 0;
}

void print_error(const char* name, const Mesh& source, const Mesh& result) {
  const auto distance = compare(source, result, {.samples = 200'000});
  const auto lit = render::six_direction_rms(source, result, 384);
  const auto plain = render::six_direction_rms(source, result, 384, {.lighting = render::Lighting::Photograph});
  if (!distance || !lit || !plain) return;
  const double ppm = 1e6 / distance->diagonal_m;
  std::printf(
      ", \"%s\": {\"triangles\": %u, \"hausdorff_ppm\": %.0f, \"rms_ppm\": %.1f, \"texture_rms\": %.3f, \"lit_rms\": "
      "%.3f}",
      name, result.triangle_count(), distance->hausdorff_m * ppm, distance->rms_m * ppm, *plain, *lit);
}

// What another program made of the mesh, with the looks of the mesh itself.
void print_peer(const char* folder, const char* name, int percent, const Mesh& mesh) {
  const std::filesystem::path file =
      std::filesystem::path{folder} / (std::string{name} + '_' + std::to_string(percent) + ".obj");
  if (!std::filesystem::exists(file)) return;
  Mesh result = read(file.c_str(), LoadTextures::Reference);
  result.materials = mesh.materials;
  result.textures = mesh.textures;
  result.face_materials.clear();
  result.vertices.normals.clear();
  print_error(name, mesh, result);
}

int error(const char* file, const char* peers) {
  const Mesh mesh = read(file, LoadTextures::Decoded);
  for (int percent = 10; percent <= 95; percent += percent < 90 ? 10 : 5) {
    const auto target = static_cast<std::uint32_t>(mesh.triangle_count() * (100 - percent) / 100);
    std::printf("{\"simplified_percent\": %d", percent);
    // As outcrops are simplified, and as anything else is.
    EdgeCollapseOptions options{.target_triangles = target, .uv_weight = 0.2, .sharpness_power = 2.0};
    for (const char* name : {"ours", "positions_only"}) {
      const auto simplified = simplify(mesh, options);
      if (simplified) print_error(name, mesh, simplified->mesh);
      options = {.attributes = Attributes::None, .target_triangles = target};
    }
    // Its index buffer knows no materials: only where there is one.
    if (mesh.materials.size() == 1) {
      print_error("libmeshoptimizer", mesh, by_meshoptimizer(mesh, target));
      for (const char* name : {"vtk", "meshlab"}) print_peer(peers, name, percent, mesh);
    }
    std::printf("}\n");
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (mode == "build" && argc >= 5) {
    return build(argv[2], argv[3], std::atof(argv[4]), argc > 5 ? static_cast<unsigned>(std::atoi(argv[5])) : 0);
  }
  if (mode == "load" && argc == 4) return load(argv[2], argv[3]);
  if (mode == "error" && (argc == 3 || argc == 4)) return error(argv[2], argc == 4 ? argv[3] : "");
  std::fprintf(stderr,
               "usage: bench_outcrop build MESH FOLDER RATIO [THREADS] | load MESH FOLDER | error MESH "
               "[FOLDER]\n");
  return 1;
}

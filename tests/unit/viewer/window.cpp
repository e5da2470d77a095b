// SPDX-License-Identifier: MIT
// The window program, driven with mouse and keys on a virtual display, and its own screenshot.
#include <lodestone/cluster_file.h>
#include <lodestone/facet_shift.h>
#include <lodestone/formats.h>
#include <lodestone/generate.h>
#include <lodestone/tileset_writer.h>

#include <sys/wait.h>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "data.h"

using namespace lodestone;

namespace {

// Bumps of 6,962 triangles as an OBJ, so that the window builds the model itself.
std::filesystem::path bumps_file(const std::filesystem::path& folder) {
  constexpr int side = 60;
  const auto file = folder / "bumps.obj";
  std::ofstream out{file};
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i)
      out << "v " << i * 0.1 << ' ' << j * 0.1 << ' ' << 0.3 * std::sin(i * 0.5) * std::cos(j * 0.4) << '\n';
  }
  for (int j = 0; j + 1 < side; ++j) {
    for (int i = 0; i + 1 < side; ++i) {
      const int a = j * side + i + 1;
      out << "f " << a << ' ' << a + 1 << ' ' << a + side + 1 << "\nf " << a << ' ' << a + side + 1 << ' ' << a + side
          << '\n';
    }
  }
  return file;
}

int run(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// Four large triangles, to be dropped on the window.
std::filesystem::path tent_file(const std::filesystem::path& folder) {
  const auto file = folder / "tent.obj";
  std::ofstream{file} << "v 0 0 0\nv 6 0 0\nv 6 6 0\nv 0 6 0\nv 3 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
  return file;
}

// Runs drive_window.sh once; what it printed goes to `log`.
int drive(const std::string& program, const std::filesystem::path& folder, std::string& log) {
  const auto file = folder / "log";
  const int code =
      run(std::string{"sh " LODESTONE_DRIVE_WINDOW " "} + program + " " + bumps_file(folder).string() + " " +
          folder.string() + " " LODESTONE_DROP_FILE " " + tent_file(folder).string() + " > " + file.string() + " 2>&1");
  std::ifstream in{file};
  log.assign(std::istreambuf_iterator<char>{in}, {});
  return code;
}

// Mean red less mean green and blue of pixels right of the panel that are not background grey.
double redness(const Image& image) {
  double sum = 0.0;
  double count = 0.0;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 360; x < image.width; ++x) {
      const auto* p = image.at(x, y);
      const int spread = std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]});
      if (spread < 40) continue;
      sum += p[0] - std::max(p[1], p[2]);
      count += 1.0;
    }
  }
  REQUIRE(count > 1000.0);
  return sum / count;
}

// Columns of the panel's graph of frame times that differ.
int changed_columns(const Image& a, const Image& b) {
  int columns = 0;
  for (std::uint32_t x = 24; x < 328; ++x) {
    bool differs = false;
    for (std::uint32_t y = 312; y < 352; ++y) differs = differs || a.at(x, y)[0] != b.at(x, y)[0];
    columns += differs ? 1 : 0;
  }
  return columns;
}

Image picture(const std::filesystem::path& file) {
  auto image = read_image(file);
  INFO(file);
  REQUIRE(image.ok());
  return std::move(*image);
}

// The window program on a display of its own, with these arguments.
// Exit code of the viewer on a display of its own. When xvfb-run cannot remove its own folder, because the X server has
// not let go of it yet, it ends with 5 whatever the program ended with: worth another try.
int run_on_display(const std::string& arguments, const std::string& standard_error) {
  constexpr int display_left_its_folder = 5;
  // The driver of the display leaks and is gone before leaks are looked for, so that no suppression can name it.
  const std::string command =
      std::string{"ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 xvfb-run -a -s '-screen 0 1024x700x24' "} +
      LODESTONE_VIEW_PROGRAM + " " + arguments + " --width 1000 --height 600 2> " + standard_error;
  int code = run(command);
  for (int again = 0; code == display_left_its_folder && again < 2; ++again) code = run(command);
  return code;
}

// What it shows once it has come to rest.
Image shown(const std::filesystem::path& folder, const std::string& arguments) {
  const auto file = folder / "shown.png";
  INFO(arguments);
  REQUIRE(run_on_display(arguments + " --screenshot " + file.string(), "/dev/null") == 0);
  return picture(file);
}

bool display_is_missing() {
  if (run("command -v xvfb-run > /dev/null") == 0) return false;
  WARN("SKIPPED: xvfb-run is missing");
  return true;
}

}  // namespace

TEST_CASE(
    "the window: the slider coarsens what is drawn, keys refine it, frame times are drawn, a dropped file is shown") {
  const auto folder = test::scratch_folder("window_driven");
  std::string log;
  int code = drive(LODESTONE_VIEW_PROGRAM, folder, log);
  if (code == 78) {
    WARN("Only the X server failed, once more: " << log);
    code = drive(LODESTONE_VIEW_PROGRAM, folder, log);
  }
  if (code == 77) {
    WARN("SKIPPED: Xvfb, xdotool or ImageMagick is missing");
    return;
  }
  INFO(log);
  REQUIRE(code == 0);
  const Image fine = picture(folder / "fine.png");
  const Image coarse = picture(folder / "coarse.png");
  const Image again = picture(folder / "again.png");
  // Coloured by triangle size: small ones are green and blue, large ones red.
  CHECK(redness(fine) < -20.0);
  CHECK(redness(coarse) > 20.0);
  CHECK(redness(again) == Approx(redness(fine)).margin(5.0));
  CHECK(changed_columns(fine, again) > 20);                 // the times of frames move on
  CHECK(redness(picture(folder / "dropped.png")) > 100.0);  // all of it, where the coarse one had a mean
}

TEST_CASE("the window opens a tileset or a cluster graph and loads what its camera needs") {
  if (display_is_missing()) return;
  const auto folder = test::scratch_folder("window_tiles");
  auto cliff = generate_outcrop({.triangles = 12'000, .textures = 2, .texture_size_px = 128, .seed = 5});
  REQUIRE(cliff);
  REQUIRE(write_outcrop(*cliff, folder, {.pyramid = {.tile_bytes = 12'000}}));
  // Most of the cliff is fine enough for its distance to be blue and green: the root alone would be red.
  CHECK(redness(shown(folder, (folder / "tileset.json").string() + " --lod-colors")) < 0.0);
  const auto graph = build_cluster_graph(*cliff);
  REQUIRE(graph);
  REQUIRE(write_cluster_graph(*graph, folder / "cliff.lodg"));
  CHECK(redness(shown(folder, (folder / "cliff.lodg").string() + " --lod-colors")) < 0.0);
}

TEST_CASE("the window goes to a level by its name") {
  if (display_is_missing()) return;
  const auto folder = test::scratch_folder("window_names");
  const auto house = generate_house({{.triangles = 3'000, .texture_size_px = 16}, Roof::Hip});
  REQUIRE(house);
  const auto built = build_by_facet_shift(*house);
  REQUIRE(built);
  const auto file = folder / "house.lode";
  REQUIRE(write_model(*built->model, file));
  const double lod3 = redness(shown(folder, file.string() + " --lod-colors --level lod3"));
  CHECK(redness(shown(folder, file.string() + " --lod-colors --level block")) > lod3 + 10.0);
  CHECK(run_on_display(file.string() + " --level lod9", (folder / "log").string()) == 2);
  std::ifstream in{folder / "log"};
  const std::string log{std::istreambuf_iterator<char>{in}, {}};
  CHECK(log.find("there are lod3, lod2, lod1, block") != std::string::npos);
}

TEST_CASE("the window shows a street with a house on each side") {
  if (display_is_missing()) return;
  const Image street = shown(test::scratch_folder("window_street"), "--street 2");
  const auto* roadway = street.at(500, 590);
  CHECK(roadway[1] < 150);  // asphalt: the sky behind it is twice as light
  // Houses are colourful, left of the roadway and right of it.
  std::array<int, 2> colourful{0, 0};
  for (std::uint32_t y = 320; y < 500; ++y) {
    for (std::uint32_t x = 0; x < street.width; ++x) {
      const auto* p = street.at(x, y);
      if (p[0] > p[2] + 20 && p[0] > p[1]) ++colourful[x < street.width / 2 ? 0 : 1];
    }
  }
  CHECK(colourful[0] > 1000);
  CHECK(colourful[1] > 1000);
}

TEST_CASE("the driver tells a viewer that dies from a display that does") {
  const auto folder = test::scratch_folder("window_deaths");
  const auto program = folder / "viewer";
  const auto drive_script = [&](const std::string& body, std::string& log) {
    std::ofstream{program} << "#!/bin/sh\n" << body << '\n';
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return drive(program.string(), folder, log);
  };
  std::string log;
  const int crashed = drive_script("kill -SEGV $$", log);
  if (crashed == 77) {
    WARN("SKIPPED: Xvfb, xdotool or ImageMagick is missing");
    return;
  }
  INFO(log);
  CHECK(crashed == 1);
  CHECK(log.find("signal 11") != std::string::npos);
  CHECK(drive_script("exit 3", log) == 1);
  CHECK(log.find("code 3") != std::string::npos);
  CHECK(drive_script("kill $xvfb_pid; sleep 1; exit 2", log) == 78);
  CHECK(log.find("the X server died") != std::string::npos);
}

TEST_CASE("without a display the window program says so in one line") {
  const auto folder = test::scratch_folder("window_no_display");
  const auto log = folder / "log";
  const int code = run(std::string{"env -u DISPLAY -u WAYLAND_DISPLAY "} + LODESTONE_VIEW_PROGRAM +
                       " nothing.lode 2> " + log.string());
  CHECK(code == 2);
  std::ifstream in{log};
  std::string line;
  REQUIRE(std::getline(in, line));
  CHECK(line.find("lodestone-view: cannot open a window") == 0);
  CHECK_FALSE(std::getline(in, line));
}

// SPDX-License-Identifier: MIT
// The program itself, ended from outside or short of room: what it leaves, what it says, how much it takes.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <fstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <lodestone/formats.h>

#include "data.h"
#include "fixture.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

struct Room {
  std::uint64_t most_file_bytes = 0;  // 0 = no limit
};

// The program's words go to `log`.
pid_t start(const std::vector<std::string>& words, const fs::path& log, const Room& room = {}) {
  std::vector<std::string> all{LODESTONE_PROGRAM};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int file = ::open(log.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644);
  ::dup2(file, STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  if (room.most_file_bytes > 0) {
    const rlimit limit{room.most_file_bytes, room.most_file_bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::signal(SIGXFSZ, SIG_IGN);
  }
  ::execv(arguments.front(), arguments.data());
  ::_exit(127);
}

int end(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

std::string text_of(const fs::path& file) {
  std::ifstream stream{file};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

}  // namespace

TEST_CASE("A build that is killed goes on with --resume to the same bytes") {
  const fs::path folder = scratch_folder("stopped_killed");
  REQUIRE(write_mesh(small_cliff(), folder / "cliff.obj"));
  const auto words = [&](const char* to) {
    return std::vector<std::string>{"outcrop",      (folder / "cliff.obj").string(),
                                    "-o",           (folder / to).string(),
                                    "--tile-bytes", "12000",
                                    "--threads",    "1",
                                    "--image",      "png"};
  };
  REQUIRE(end(start(words("whole"), folder / "log")) == 0);
  bool killed = false;
  for (int attempt = 0; attempt < 5 && !killed; ++attempt) {
    fs::remove_all(folder / "cut");
    const pid_t child = start(words("cut"), folder / "log");
    while (!fs::exists(folder / "cut/tiles/L0_3.glb") && ::waitpid(child, nullptr, WNOHANG) == 0) ::usleep(200);
    ::kill(child, SIGKILL);
    static_cast<void>(end(child));
    killed = !fs::exists(folder / "cut/tileset.json");
  }
  REQUIRE(killed);
  auto again = words("cut");
  again.insert(again.end(), {"--resume", "--json"});
  REQUIRE(end(start(again, folder / "log")) == 0);
  CHECK(nlohmann::json::parse(text_of(folder / "log"))["kept_tiles"].get<int>() > 0);
  CHECK(files_of(folder / "cut") == files_of(folder / "whole"));

  // Damage inside a tile that was kept is not mended, but told, with what to do.
  std::fstream tile{folder / "cut/tiles/L0_0.glb", std::ios::binary | std::ios::in | std::ios::out};
  tile.seekp(24) << "no json";
  tile.close();
  CHECK(end(start(again, folder / "log")) == 2);
  CHECK(text_of(folder / "log").find("without --resume") != std::string::npos);
}

TEST_CASE("Where there is no room for a tile the program says so, leaves nothing half-written, and can go on") {
  const fs::path folder = scratch_folder("stopped_full");
  REQUIRE(write_mesh(small_cliff(), folder / "cliff.obj"));
  std::vector<std::string> words{
      "outcrop", (folder / "cliff.obj").string(), "-o", (folder / "tiles").string(), "--tile-bytes", "24000",
      "--quiet"};
  CHECK(end(start(words, folder / "log", {.most_file_bytes = 9'000})) == 2);
  const std::string said = text_of(folder / "log");
  INFO(said);
  CHECK(said.find("lodestone: ") == 0);
  CHECK(said.find("tiles/") != std::string::npos);  // which file
  CHECK(std::count(said.begin(), said.end(), '\n') == 1);
  CHECK(!fs::exists(folder / "tiles/tileset.json"));
  for (const auto& [name, content] : files_of(folder / "tiles")) CHECK(name.find(".part") == std::string::npos);
  words.insert(words.end(), {"--resume"});
  CHECK(end(start(words, folder / "log")) == 0);
  CHECK(fs::exists(folder / "tiles/tileset.json"));
}

TEST_CASE("What cannot become a pyramid is refused, and leaves nothing behind") {
  const fs::path folder = scratch_folder("stopped_refused");
  std::ofstream{folder / "wall.obj"} << "v 0 0 0\nv 9 0 0\nv 0 0 9\nf 1 2 3\n";
  const auto words = [&](const fs::path& to) {
    return std::vector<std::string>{"outcrop", (folder / "wall.obj").string(), "-o", to.string(), "--quiet"};
  };
  auto tiny = words(folder / "tiles");
  tiny.insert(tiny.end(), {"--tile-bytes", "100"});
  CHECK(end(start(tiny, folder / "log")) == 1);
  CHECK(text_of(folder / "log").find("tiles below 4 kB") != std::string::npos);
  CHECK(!fs::exists(folder / "tiles"));

  // Where no folder can be made, that is said.
  CHECK(end(start(words(folder / "log"), folder / "said")) == 2);
  CHECK(text_of(folder / "said").find("log") != std::string::npos);
}

#ifndef __SANITIZE_ADDRESS__  // which keeps freed memory
namespace {

// Patches of 200 triangles, each with its own photograph (one file under many names).
fs::path patches(const fs::path& folder, int images, std::uint32_t size) {
  constexpr int side = 10;
  Image noisy{size, size, 3, {}};
  noisy.pixels.resize(std::size_t{size} * size * 3);
  for (std::size_t i = 0; i < noisy.pixels.size(); ++i) {
    noisy.pixels[i] = static_cast<std::uint8_t>(128 + i % 61 + (i / 4096) % 31);
  }
  REQUIRE(write_image(noisy, folder / "0.jpg"));
  std::ofstream obj{folder / "patches.obj"};
  std::ofstream mtl{folder / "patches.mtl"};
  obj << "mtllib patches.mtl\n";
  for (int i = 0; i < images; ++i) {
    const std::string name = std::to_string(i);
    if (i > 0) fs::create_hard_link(folder / "0.jpg", folder / (name + ".jpg"));
    mtl << "newmtl " << name << "\nmap_Kd " << name << ".jpg\n";
    obj << "usemtl " << name << '\n';
    for (int y = 0; y <= side; ++y) {
      for (int x = 0; x <= side; ++x) {
        obj << "v " << i * side + x << ' ' << (x * y) % 3 * 0.1 << ' ' << y << "\nvt " << x * 0.1 << ' ' << y * 0.1
            << '\n';
      }
    }
    const int first = i * (side + 1) * (side + 1) + 1;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const int a = first + y * (side + 1) + x;
        const int c = a + side + 2;
        const auto corner = [&](int v) { obj << ' ' << v << '/' << v; };
        for (const int b : {a + 1, c - 1}) {
          obj << 'f';
          corner(a);
          corner(b == a + 1 ? b : c);
          corner(b == a + 1 ? c : b);
          obj << '\n';
        }
      }
    }
  }
  return folder / "patches.obj";
}

double peak_mb(const fs::path& source, const std::vector<std::string>& more) {
  const fs::path folder = scratch_folder("stopped_memory");
  std::vector<std::string> words{"outcrop", source.string(), "-o", (folder / "tiles").string(), "--json", "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  const int code = end(start(words, folder / "log"));
  INFO(text_of(folder / "log"));
  REQUIRE(code == 0);
  return nlohmann::json::parse(text_of(folder / "log"))["peak_rss_bytes"].get<double>() / 1e6;
}

// What a build under a limit came to: its peak, and the limit that it named where it refused.
struct Limited {
  int code = 0;
  double peak_mb = 0.0;
  int named_mb = 0;
};

Limited build_within(const fs::path& source, int limit_mb, const std::string& threads,
                     const std::vector<std::string>& more) {
  const fs::path folder = scratch_folder("stopped_limit");
  Limited result;
  std::vector<std::string> words{
      "outcrop",   source.string(), "-o",           (folder / "tiles").string(),    "--json", "--quiet", "--strict",
      "--threads", threads,         "--max-memory", std::to_string(limit_mb) + "MB"};
  words.insert(words.end(), more.begin(), more.end());
  result.code = end(start(words, folder / "log"));
  const std::string said = text_of(folder / "log");
  INFO(said);
  if (result.code != 0) CHECK(said.find(source.string() + ": a limit of") != std::string::npos);
  const auto report = nlohmann::json::parse(said.substr(said.find('{')));
  result.peak_mb = report["peak_rss_bytes"].get<double>() / 1e6;
  const std::size_t at = said.find("MB will do");
  if (at != std::string::npos) result.named_mb = std::stoi(said.substr(said.rfind(' ', at - 1)));
  CHECK(fs::exists(folder / "tiles") == (result.code == 0));
  return result;
}

// The words of a case, and the limits it is tried with.
struct Ladder {
  fs::path source;
  std::vector<int> limits_mb;
  std::string threads = "4";
  std::vector<std::string> more{};
  bool joined = false;
  double least_share = 0.7;  // of the limit that it names, taken: not far more than is needed is asked for
};

void check_ladder(const Ladder& ladder) {
  INFO(ladder.source.filename());
  int named_mb = 0;
  for (const int limit_mb : ladder.limits_mb) {
    const Limited limited = build_within(ladder.source, limit_mb, ladder.threads, ladder.more);
    INFO(limit_mb);
    CHECK(limited.peak_mb < 1.2 * limit_mb);
    CHECK(((limited.code == 0) != (limited.named_mb > limit_mb)));
    named_mb = std::max(named_mb, limited.named_mb);
  }
  REQUIRE(named_mb > ladder.limits_mb.front());
  Limited enough = build_within(ladder.source, named_mb, ladder.threads, ladder.more);
  if (ladder.joined) {  // tiles of several images are known once levels are built
    REQUIRE(enough.named_mb > named_mb);
    named_mb = enough.named_mb;
    enough = build_within(ladder.source, named_mb, ladder.threads, ladder.more);
  }
  CHECK(enough.code == 0);
  CHECK(enough.peak_mb < 1.2 * named_mb);
  CHECK(enough.peak_mb > ladder.least_share * named_mb);
}

// With image data that nothing damages.
void write_tga(const fs::path& file, std::uint16_t side) {
  std::vector<char> bytes(18 + std::size_t{side} * side * 3, 'x');
  std::fill_n(bytes.begin(), 18, '\0');
  bytes[2] = 2;  // colours, not packed
  for (const std::size_t at : {12U, 14U}) {
    bytes[at] = static_cast<char>(side & 0xFFU);
    bytes[at + 1] = static_cast<char>(side >> 8U);
  }
  bytes[16] = 24;
  std::ofstream{file, std::ios::binary}.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

TEST_CASE("Every limit on memory is kept within a fifth or refused at once, with one that does") {
  const fs::path folder = scratch_folder("stopped_ladder");
  const auto generate = [&](const char* name, const char* triangles, const char* textures, const char* size) {
    REQUIRE(end(start({"generate", "outcrop", "-o", (folder / name).string(), "--triangles", triangles, "--textures",
                       textures, "--texture-size", size, "--quiet"},
                      folder / "log")) == 0);
    return folder / name;
  };
  const auto cliff = [&] { return generate("cliff.obj", "40000", "2", "256"); };
  SECTION("of triangles") { check_ladder({cliff(), {40, 50, 80}}); }
  SECTION("of kinds that are counted by what their head says") {
    auto loaded = read_mesh(cliff(), {.textures = LoadTextures::Reference});
    REQUIRE(loaded);
    REQUIRE(write_mesh(loaded->mesh, folder / "cliff.ply"));
    check_ladder({folder / "cliff.ply", {48, 90}});
  }
  SECTION("of photographs inside a file") {
    // As those of a camera: hardly to be packed, so that they are most of the file.
    Mesh mesh = small_cliff();
    Image noise{1024, 1024, 3, {}};
    noise.pixels.resize(std::size_t{noise.width} * noise.height * 3);
    std::uint32_t state = 1;
    for (std::uint8_t& value : noise.pixels) value = static_cast<std::uint8_t>((state = state * 1664525U + 7U) >> 24U);
    const auto png = encode_png(noise);
    REQUIRE(png);
    mesh.textures.clear();
    mesh.materials.clear();
    constexpr std::uint32_t images = 8;
    for (std::uint32_t i = 0; i < images; ++i) {
      const std::string name = std::to_string(i);
      mesh.textures.push_back({.name = name, .encoded = std::make_shared<const std::vector<std::uint8_t>>(*png)});
      mesh.textures.back().mime_type = "image/png";
      mesh.materials.push_back({.name = name, .texture = i});
    }
    mesh.face_materials.resize(mesh.triangle_count());
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) mesh.face_materials[f] = f * images / mesh.triangle_count();
    REQUIRE(write_mesh(mesh, folder / "inside.glb"));
    check_ladder({folder / "inside.glb", {55, 75}, "2"});
  }
  SECTION("of photographs of every kind") {
    const fs::path wall = generate("wall.obj", "1000", "1", "64");
    write_tga(folder / "large.tga", 2000);
    Image grey{2400, 2400, 3, {}};
    grey.pixels.assign(std::size_t{grey.width} * grey.height * 3, 99);
    REQUIRE(write_image(grey, folder / "large.webp"));
    for (const auto& [image, limits_mb] : {std::pair{"large.tga", std::vector{52, 60, 75}}, {"large.webp", {52}}}) {
      INFO(image);
      std::ofstream{folder / "wall.mtl"} << "newmtl outcrop_000\nmap_Kd " << image << '\n';
      check_ladder({wall, limits_mb, "1"});
    }
  }
  SECTION("of tiles that show several photographs") {
    check_ladder({patches(folder, 24, 512), {58}, "4", {"--ratio", "0.9", "--tile-bytes", "2MB"}, true});
  }
}

TEST_CASE("Memory does not grow with the number of images, and --max-memory holds") {
  const fs::path few = scratch_folder("stopped_few");
  const fs::path many = scratch_folder("stopped_many");
  constexpr double image_mb = 1024.0 * 1024.0 * 3.0 / 1e6;
  const fs::path source = patches(many, 24, 1024);
  const double of_few = peak_mb(patches(few, 4, 1024), {"--threads", "1"});
  const double of_many = peak_mb(source, {"--threads", "1"});
  CHECK(of_many < of_few + 3.0 * image_mb);  // twenty more are 63 MB
  const double limit_mb = 1.3 * of_many;     // room for one photograph and the triangles, not for eight
  const double limited =
      peak_mb(source, {"--threads", "8", "--max-memory", std::to_string(static_cast<int>(limit_mb)) + "MB"});
  CHECK(limited < 1.2 * limit_mb);
}
#endif

}  // namespace lodestone::test

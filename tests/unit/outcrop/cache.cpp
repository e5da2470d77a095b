// SPDX-License-Identifier: MIT
// Tiles from the web, and copies of tiles on the disk.
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include <lodestone/tile_loader.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "data.h"
#include "fixture.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

// Each test damages its own.
fs::path tiles(const std::string& name) {
  static const fs::path made = [] {
    fs::path folder = scratch_folder("cache_tiles");
    REQUIRE(write_outcrop(small_cliff(), folder, {.pyramid = small_tiles()}));
    return folder;
  }();
  fs::path copy = scratch_folder(name);
  fs::copy(made, copy, fs::copy_options::recursive);
  return copy;
}

std::uint64_t bytes_in(const fs::path& folder) {
  std::uint64_t bytes = 0;
  for (const auto& [name, content] : files_of(folder)) bytes += content.size();
  return bytes;
}

// Loads all tiles; how many could be.
std::size_t load_all(const TilePyramid& pyramid) {
  std::size_t loaded = 0;
  for (NodeId n = 0; n < pyramid.graph().nodes.size(); ++n) {
    if (pyramid.load(n, LoadTextures::Reference)) ++loaded;
  }
  return loaded;
}

// A web server for a folder on the loopback interface, as long as it lives; it has no port where there is no Python.
class Server {
 public:
  // `certificate`, with its key in the same file, makes it https.
  Server(const fs::path& folder, const fs::path& log, const fs::path& certificate = {})
      : scheme_(certificate.empty() ? "http" : "https") {
    child_ = ::fork();
    if (child_ == 0) {
      if (std::freopen(log.c_str(), "w", stdout) == nullptr || std::freopen(log.c_str(), "a", stderr) == nullptr) {
        ::_exit(1);
      }
      ::execlp("python3", "python3", "-u", "-c", serve, folder.c_str(), certificate.c_str(), nullptr);
      ::_exit(127);
    }
    for (int wait = 0; wait < 400 && port_.empty(); ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds{25});
      std::ifstream stream{log};
      const std::string text{std::istreambuf_iterator<char>{stream}, {}};
      const std::size_t at = text.find(" port ");
      if (at != std::string::npos) port_ = text.substr(at + 6, text.find('\n', at + 6) - at - 6);
    }
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server() { stop(); }
  void stop() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    child_ = 0;
  }
  [[nodiscard]] bool runs() const { return !port_.empty(); }
  [[nodiscard]] std::string address() const { return scheme_ + "://127.0.0.1:" + port_; }

 private:
  static constexpr const char* serve = R"(
import functools, http.server, ssl, sys
handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=sys.argv[1])
server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
if sys.argv[2]:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(sys.argv[2])
    server.socket = context.wrap_socket(server.socket, server_side=True)
print("serving on port", server.server_port, flush=True)
server.serve_forever()
)";
  std::string scheme_;
  pid_t child_ = 0;
  std::string port_;
};

}  // namespace

TEST_CASE("Tiles come from their copies the second time, whatever became of where they were") {
  const fs::path folder = tiles("cache_source");
  const TileCacheOptions cache{.folder = scratch_folder("cache_copies") / "deeper"};
  const auto first = TilePyramid::open(folder / "tileset.json", cache);
  REQUIRE(first);
  const std::size_t count = (*first)->graph().nodes.size();
  CHECK(load_all(**first) == count);
  CHECK((*first)->cache_status().hits == 0);
  CHECK((*first)->cache_status().misses == count);
  CHECK((*first)->cache_status().bytes == bytes_in(cache.folder));
  const auto second = TilePyramid::open(folder / "tileset.json", cache);
  REQUIRE(second);
  fs::remove_all(folder / "tiles");
  CHECK(load_all(**second) == count);
  CHECK((*second)->cache_status().hits == count);
  // Another build in the same place has other copies.
  std::ofstream{folder / "build.json"} << "another";
  const auto other = TilePyramid::open(folder / "tileset.json", cache);
  REQUIRE(other);
  CHECK(load_all(**other) == 0);
}

TEST_CASE("Copies stay within their bytes, and those used last stay") {
  const fs::path folder = tiles("cache_small_source");
  const std::uint64_t all = bytes_in(folder / "tiles");
  const TileCacheOptions cache{.folder = scratch_folder("cache_small"), .max_bytes = all / 3};
  const auto pyramid = TilePyramid::open(folder / "tileset.json", cache);
  REQUIRE(pyramid);
  for (NodeId n = 0; n < (*pyramid)->graph().nodes.size(); ++n) {
    REQUIRE((*pyramid)->load(n, LoadTextures::Reference));
    REQUIRE((*pyramid)->load(0, LoadTextures::Reference));  // as a root is wanted again and again
    CHECK(bytes_in(cache.folder) <= cache.max_bytes);
  }
  CHECK((*pyramid)->cache_status().bytes == bytes_in(cache.folder));
  CHECK(bytes_in(cache.folder) > all / 6);
  CHECK((*pyramid)->cache_status().hits >= (*pyramid)->graph().nodes.size());  // the root, every time but the first
}

TEST_CASE("Copies that are damaged or cannot be written cost nothing but time") {
  const fs::path folder = tiles("cache_damaged_source");
  const TileCacheOptions cache{.folder = scratch_folder("cache_damaged")};
  const auto pyramid = TilePyramid::open(folder / "tileset.json", cache);
  REQUIRE(pyramid);
  const std::size_t count = load_all(**pyramid);
  for (const auto& [name, content] : files_of(cache.folder)) {
    std::ofstream{cache.folder / name, std::ios::binary} << content.substr(0, content.size() - 1);
  }
  CHECK(load_all(**pyramid) == count);
  CHECK((*pyramid)->cache_status().hits == 0);
  fs::remove_all(cache.folder);
  std::ofstream{cache.folder} << "a file in the way";
  CHECK(load_all(**pyramid) == count);
  CHECK(TilePyramid::open(folder / "tileset.json", cache).error().code == ErrorCode::Unreadable);
}

TEST_CASE("A tileset on the web is shown, and from its copies when the server is gone") {
  const fs::path folder = tiles("cache_web_source");
  Server server{folder, scratch_folder("cache_web_log") / "log"};
  if (!server.runs()) {
    WARN("SKIPPED: python3 does not serve");
    return;
  }
  const fs::path address = server.address() + "/tileset.json";
  CHECK(is_tileset_file(address));
  const TileCacheOptions cache{.folder = scratch_folder("cache_web")};
  const auto pyramid = TilePyramid::open(address, cache);
  if (!pyramid) FAIL(to_line(pyramid.error()));
  TilePager pager{*pyramid, {.workers = 3, .error_px = 1e-6}};
  View view;
  view.eye = (*pyramid)->bounds().center() - glm::dvec3{0.0, 2.0 * (*pyramid)->bounds().diagonal_m(), 0.0};
  std::uint32_t triangles = 0;
  for (const NodeId n : pager.settle(view)) triangles += surface_triangle_count(*pager.content(n));
  CHECK(triangles == small_cliff().triangle_count());
  CHECK(pager.status().failures.empty());
  const std::size_t count = load_all(**pyramid);

  CHECK(TilePyramid::open(server.address() + "/nothing.json").error().code == ErrorCode::NotFound);
  fs::remove(folder / "tiles/L0_0.glb");
  const auto plain = TilePyramid::open(address);
  REQUIRE(plain);
  CHECK(load_all(**plain) == count - 1);
  server.stop();
  CHECK(load_all(**pyramid) == count);
  CHECK(load_all(**plain) == 0);
  CHECK(TilePyramid::open(address).error().code == ErrorCode::Unreadable);
}

TEST_CASE("A tileset is fetched over https from whom the certificates vouch for, and from nobody else") {
  const fs::path folder = tiles("cache_https_source");
  const fs::path place = scratch_folder("cache_https");
  const std::string file = (place / "own.pem").string();
  const std::string command =
      "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=127.0.0.1 -addext subjectAltName=IP:127.0.0.1 "
      "-keyout '" +
      file + "' -out '" + file + ".crt' 2>/dev/null && cat '" + file + ".crt' >>'" + file + "'";
  if (std::system(command.c_str()) != 0) {
    WARN("SKIPPED: openssl makes no certificate");
    return;
  }
  const Server server{folder, place / "log", file};
  if (!server.runs()) {
    WARN("SKIPPED: python3 does not serve");
    return;
  }
  const fs::path address = server.address() + "/tileset.json";
  const auto stranger = TilePyramid::open(address);
  REQUIRE(!stranger);
  CHECK(stranger.error().code == ErrorCode::Unreadable);
  REQUIRE(::setenv("CURL_CA_BUNDLE", (file + ".crt").c_str(), 1) == 0);
  const auto known = TilePyramid::open(address);
  if (!known) FAIL(to_line(known.error()));
  CHECK(load_all(**known) == (*known)->graph().nodes.size());
  REQUIRE(::unsetenv("CURL_CA_BUNDLE") == 0);
  CHECK(TilePyramid::open(address).error().code == ErrorCode::Unreadable);
}

}  // namespace lodestone::test

// SPDX-License-Identifier: MIT
#include "tiles3d/osgb_files.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <cerrno>

#include "reader.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
constexpr const char* program = "lodestone-osgb";

// Beside the program that runs, as installed and in the build tree; else left to the PATH.
std::string helper() {
  std::error_code fault;
  const fs::path here = fs::read_symlink("/proc/self/exe", fault).parent_path();
  for (const fs::path& place : {here / program, here / "../../cli" / program}) {
    if (fs::exists(place, fault)) return place.string();
  }
  return program;
}

// Textures come as bytes, or as pixels where the file has them so.
Status finish(Mesh& mesh, LoadTextures textures, const std::string& where) {
  for (Texture& texture : mesh.textures) {
    if (texture.encoded) texture.mime_type = image_mime_type(*texture.encoded);
    if (textures == LoadTextures::Reference) {
      texture.encoded = nullptr;
      texture.image = nullptr;
    }
    if (textures != LoadTextures::Decoded || texture.image || !texture.encoded) continue;
    auto image = decode_image(*texture.encoded, where);
    if (!image) return image.error();
    texture.image = std::make_shared<const Image>(std::move(*image));
  }
  Status valid = validate(mesh);
  if (!valid) return Error{ErrorCode::BadData, valid.error().message, where};
  return Done{};
}

}  // namespace

class OsgbFiles::Process {
 public:
  // Null if it cannot be started.
  static std::unique_ptr<Process, Ender> start(const fs::path& root);
  ~Process() {
    ::close(socket_);
    ::kill(child_, SIGKILL);  // it holds nothing that could be lost
    while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  [[nodiscard]] bool ask(const std::string& line) const {
    const std::string text = line + '\n';
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }
  [[nodiscard]] bool answer(OsgbAnswer& answer) const {
    std::uint64_t length = 0;
    constexpr std::uint64_t most_bytes = 1ULL << 32;
    if (!receive(&length, sizeof length) || length == 0 || length > most_bytes) return false;
    std::vector<std::uint8_t> bytes(length);
    if (!receive(bytes.data(), bytes.size())) return false;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file{::fmemopen(bytes.data(), bytes.size(), "rb"),
                                                               &std::fclose};
    if (!file) return false;
    Unpacker unpacker{file.get(), length};
    answer_fields(unpacker, answer);
    return unpacker.good();
  }

 private:
  Process(pid_t child, int socket) : child_(child), socket_(socket) {}
  [[nodiscard]] bool receive(void* to, std::size_t size) const {
    constexpr int patience_ms = 60'000;
    for (std::size_t done = 0; done < size;) {
      pollfd waiting{socket_, POLLIN, 0};
      const int ready = ::poll(&waiting, 1, patience_ms);
      if (ready < 0 && errno == EINTR) continue;
      if (ready <= 0) return false;
      const ssize_t got = ::recv(socket_, static_cast<char*>(to) + done, size - done, 0);
      if (got <= 0) return false;
      done += static_cast<std::size_t>(got);
    }
    return true;
  }
  pid_t child_;
  int socket_;
};

void OsgbFiles::Ender::operator()(Process* process) const { delete process; }

std::unique_ptr<OsgbFiles::Process, OsgbFiles::Ender> OsgbFiles::Process::start(const fs::path& root) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return nullptr;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  for (const int said : {STDOUT_FILENO, STDERR_FILENO}) {  // OpenSceneGraph is talkative
    ::posix_spawn_file_actions_addopen(&actions, said, "/dev/null", O_WRONLY, 0);
  }
  std::string name = helper();
  std::string mode = "--serve";
  std::string file = root.string();
  char* words[] = {name.data(), mode.data(), file.data(), nullptr};
  pid_t child = 0;
  const int fault = ::posix_spawnp(&child, name.c_str(), &actions, nullptr, words, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (fault == 0) return std::unique_ptr<Process, Ender>{new Process{child, ends[0]}};
  ::close(ends[0]);
  return nullptr;
}

Result<OsgbAnswer> OsgbFiles::ask(const std::string& line) {
  std::unique_ptr<Process, Ender> process;
  {
    const std::scoped_lock lock{mutex_};
    if (!idle_.empty()) {
      process = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!process) process = Process::start(root_);
  if (!process) {
    return Error{ErrorCode::Unsupported, "cannot be started, build it with OpenSceneGraph to open .osgb files",
                 program};
  }
  OsgbAnswer answer;
  if (!process->ask(line) || !process->answer(answer)) {
    return Error{ErrorCode::BadData, "OpenSceneGraph breaks down on it, or takes too long", root_.string()};
  }
  {
    const std::scoped_lock lock{mutex_};
    idle_.push_back(std::move(process));
  }
  if (!answer.ok) return std::move(answer.error);
  return answer;
}

Result<std::string> OsgbFiles::index() {
  auto answer = ask("index");
  if (!answer) return answer.error();
  return std::move(answer->index);
}

Result<Mesh> OsgbFiles::tile(const std::string& name, LoadTextures textures) {
  auto answer = ask("tile " + name);
  if (!answer) return answer.error();
  if (Status good = finish(answer->mesh, textures, name); !good) return good.error();
  return std::move(answer->mesh);
}

}  // namespace lodestone

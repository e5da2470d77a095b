// SPDX-License-Identifier: MIT
// The window is a program of its own, because the headless renderer in this one brings another OpenGL along.
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "verbs.h"

namespace lodestone::cli {
namespace {

class View final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "view"; }
  [[nodiscard]] std::string summary() const override {
    return "Open the window: slider, orbit, wireframe, frame graph";
  }
  [[nodiscard]] std::string example() const override { return "lodestone view house.lode"; }
  void declare(Arguments& arguments) override { arguments.file("FILE", file_, "Mesh or .lode file", Need::Required); }
  [[nodiscard]] Status run(Session& session) override;

 private:
  std::filesystem::path file_;
};

// lodestone-view beside this program, as installed; else in the build tree; else on the PATH.
std::filesystem::path find_viewer() {
  std::error_code fault;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", fault).parent_path();
  for (const auto& place : {here / "lodestone-view", here / ".." / "viewer" / "window" / "lodestone-view"}) {
    if (std::filesystem::exists(place, fault)) return place;
  }
  return "lodestone-view";
}

Status View::run(Session& session) {
  std::error_code fault;
  if (!std::filesystem::exists(file_, fault)) {
    return Error{ErrorCode::NotFound, "there is no such file", file_.string()};
  }
  std::string program = find_viewer().string();
  std::string file = file_.string();
  char* words[] = {program.data(), file.data(), nullptr};
  pid_t child = 0;
  int ended = 0;
  if (::posix_spawnp(&child, program.c_str(), nullptr, nullptr, words, environ) != 0) {
    return Error{ErrorCode::NotFound, "the viewer could not be started, install lodestone-view beside lodestone",
                 program};
  }
  while (::waitpid(child, &ended, 0) < 0 && errno == EINTR) {
  }
  if (session.context().cancelled()) return Error{ErrorCode::Cancelled, "cancelled", file};
  if (ended != 0) return Error{ErrorCode::BadData, "the viewer could not show it, see its message above", file};
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_view() { return std::make_unique<View>(); }

}  // namespace lodestone::cli

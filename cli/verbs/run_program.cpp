// SPDX-License-Identifier: MIT
#include "run_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace lodestone::cli {

std::filesystem::path find_program(const std::string& name, const std::string& in_build_tree) {
  std::error_code fault;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", fault).parent_path();
  for (const auto& place : {here / name, here / in_build_tree / name}) {
    if (std::filesystem::exists(place, fault)) return place;
  }
  return name;
}

std::optional<Ended> run_to_end(std::vector<std::string> command) {
  std::vector<char*> words;
  words.reserve(command.size() + 1);
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  int channel[2];
  if (::pipe2(channel, O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, channel[1], STDERR_FILENO);
  pid_t child = 0;
  const int fault = ::posix_spawnp(&child, words.front(), &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(channel[1]);
  std::FILE* said = ::fdopen(channel[0], "r");
  Ended ended;
  char line[1024];
  while (fault == 0 && std::fgets(line, sizeof line, said) != nullptr) ended.last_words = line;
  std::fclose(said);
  if (fault != 0) return std::nullopt;
  while (::waitpid(child, &ended.status, 0) < 0 && errno == EINTR) {
  }
  return ended;
}

}  // namespace lodestone::cli

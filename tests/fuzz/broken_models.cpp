// SPDX-License-Identifier: MIT
// Reads every file under a folder, each in a process of its own with a limit of time, and demands a mesh or an error:
// no crash, no hang, no flood of memory. Made for the deliberately broken models of assimp-testmodels.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include <lodestone/formats.h>

namespace {

constexpr rlim_t max_cpu_seconds = 60;
constexpr long max_rss_kib = 3L << 20;

// Child: 0 = read, 1 = refused with a message, else broken.
int read_one(const std::filesystem::path& file) {
  const rlimit limit{max_cpu_seconds, max_cpu_seconds + 1};
  ::setrlimit(RLIMIT_CPU, &limit);
  const auto mesh = lodestone::read_mesh(file);
  if (mesh.ok()) return lodestone::validate(mesh->mesh).ok() ? 0 : 3;
  return mesh.error().message.empty() ? 3 : 1;
}

// Empty if all is well; `counts` tells read from refused.
std::string try_one(const std::filesystem::path& file, int (&counts)[2]) {
  const pid_t child = ::fork();
  if (child == 0) std::_Exit(read_one(file));
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  if (WIFSIGNALED(status)) return "killed by signal " + std::to_string(WTERMSIG(status));
  const int code = WEXITSTATUS(status);
  if (code > 1) return "exit code " + std::to_string(code);
  if (usage.ru_maxrss > max_rss_kib) return std::to_string(usage.ru_maxrss >> 10) + " MiB of memory";
  ++counts[code];
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || !std::filesystem::is_directory(argv[1])) {
    std::puts("SKIPPED: no folder of test models (Debian package assimp-testmodels)");
    return 77;
  }
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[1])) {
    if (entry.is_regular_file()) files.insert(entry.path());
  }
  int counts[2] = {0, 0};
  int faults = 0;
  for (const auto& file : files) {
    if (const std::string fault = try_one(file, counts); !fault.empty()) {
      std::printf("%s: %s\n", file.c_str(), fault.c_str());
      ++faults;
    }
  }
  std::printf("%zu files: %d read, %d refused, %d faults\n", files.size(), counts[0], counts[1], faults);
  return faults == 0 ? 0 : 1;
}

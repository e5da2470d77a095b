// SPDX-License-Identifier: MIT
// Feeds every file under the folders named on the command line to the driver it is linked with: how the corpus is
// replayed in the normal test run, without libFuzzer.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  std::set<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[i])) {
      if (entry.is_regular_file()) files.insert(entry.path());
    }
  }
  for (const auto& file : files) {
    std::ifstream stream{file, std::ios::binary};
    const std::vector<char> bytes{std::istreambuf_iterator<char>{stream}, {}};
    std::printf("%s (%zu bytes)\n", file.filename().c_str(), bytes.size());
    std::fflush(stdout);
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    LLVMFuzzerTestOneInput(data, bytes.size());
    // Every prefix and every flipped byte of a small file, too.
    if (bytes.size() > 4096) continue;
    for (std::size_t cut = 0; cut < bytes.size(); cut += 1 + bytes.size() / 64) LLVMFuzzerTestOneInput(data, cut);
    for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 128) {
      std::vector<char> damaged = bytes;
      damaged[at] = static_cast<char>(~damaged[at]);
      LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(damaged.data()), damaged.size());
    }
  }
  std::printf("%zu files\n", files.size());
  return files.empty() ? 1 : 0;
}

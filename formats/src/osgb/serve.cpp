// SPDX-License-Identifier: MIT
#include "osgb/serve.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>

#include "osgb/read_tree.h"
#include "tiles3d/osgb_answer.h"

namespace lodestone::osgb {
namespace {

OsgbAnswer answer_to(TreeReader& reader, const std::string& line) {
  OsgbAnswer answer;
  const std::string tile = "tile ";
  if (line.starts_with(tile)) {
    auto mesh = reader.tile(line.substr(tile.size()));
    answer.ok = mesh.ok();
    if (mesh) answer.mesh = std::move(*mesh);
    if (!mesh) answer.error = mesh.error();
  } else {
    auto index = reader.index();
    answer.ok = index.ok();
    if (index) answer.index = std::move(*index);
    if (!index) answer.error = index.error();
  }
  return answer;
}

bool send(int socket, OsgbAnswer& answer) {
  char* bytes = nullptr;
  std::size_t size = 0;
  std::FILE* file = ::open_memstream(&bytes, &size);
  if (file == nullptr) return false;
  std::uint64_t length = 0;
  Packer packer{file};
  packer.plain(length);
  answer_fields(packer, answer);
  bool good = packer.good() && std::fclose(file) == 0;
  length = size - sizeof length;
  if (good) *reinterpret_cast<std::uint64_t*>(bytes) = length;  // malloc's alignment
  for (std::size_t done = 0; good && done < size;) {
    const ssize_t sent = ::write(socket, bytes + done, size - done);
    good = sent > 0;
    if (good) done += static_cast<std::size_t>(sent);
  }
  std::free(bytes);
  return good;
}

}  // namespace

int serve(const char* root) {
#ifndef __SANITIZE_ADDRESS__                      // whose shadow of memory counts
  constexpr rlim_t most_bytes = rlim_t{8} << 30;  // files are not trusted
  const rlimit limit{most_bytes, most_bytes};
  ::setrlimit(RLIMIT_DATA, &limit);
#endif
  TreeReader reader{root};
  std::string line;
  for (char c = 0; ::read(STDIN_FILENO, &c, 1) == 1;) {
    if (c != '\n') {
      line += c;
      continue;
    }
    OsgbAnswer answer = answer_to(reader, line);
    if (!send(STDIN_FILENO, answer)) return 1;
    line.clear();
  }
  return 0;
}

}  // namespace lodestone::osgb

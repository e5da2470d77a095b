// SPDX-License-Identifier: MIT
#include "tiles3d/kept_files.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>

namespace lodestone {

bool is_whole_file(const std::filesystem::path& file) {
  std::error_code fault;
  const std::uintmax_t size = std::filesystem::file_size(file, fault);
  std::uint32_t head[3] = {};
  if (fault || size <= sizeof head) return false;
  std::ifstream{file, std::ios::binary}.read(reinterpret_cast<char*>(head), sizeof head);
  const std::string kind = file.extension().string();
  if (kind != ".glb" && kind != ".b3dm") return size == sizeof head + std::uintmax_t{head[0]} * head[1] * head[2];
  const char* magic = kind == ".glb" ? "glTF" : "b3dm";
  return std::memcmp(head, magic, sizeof head[0]) == 0 && size == head[2];
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include <sys/mman.h>
#include <unistd.h>

#include "doors.h"

// A model that was read must stand a full sweep.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int file = ::memfd_create("fuzz.lode", 0);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) return 0;
  const auto model = lodestone::read_model("/proc/self/fd/" + std::to_string(file));
  ::close(file);
  if (model.ok() && !lodestone::validate(**model).exact) __builtin_trap();
  return 0;
}

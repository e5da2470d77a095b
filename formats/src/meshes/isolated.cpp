// SPDX-License-Identifier: MIT
#include "isolated.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "meshes/parcel.h"

namespace lodestone {
namespace {

constexpr std::uint64_t magic = 0x4C4F4445'49534F4CULL;

// What travels: the mesh and warnings, or the error.
struct Parcel {
  bool ok = false;
  Error error;
  LoadedMesh loaded;
  std::vector<Warning> warnings;
};

template <class Archive>
void parcel_fields(Archive& archive, Parcel& parcel) {
  archive.plain(parcel.ok);
  archive.plain(parcel.error.code);
  archive.array(parcel.error.message);
  archive.array(parcel.error.where);
  archive.list(parcel.warnings, [&](Warning& w) {
    archive.array(w.message);
    archive.array(w.where);
    archive.plain(w.count);
  });
  archive.array(parcel.loaded.info.format);
  archive.array(parcel.loaded.info.up_axis);
  archive.plain(parcel.loaded.info.unit_m);
  mesh_fields(archive, parcel.loaded.mesh);
  std::uint64_t end = magic;
  archive.plain(end);
}

[[noreturn]] void run_child(std::FILE* file, const std::string& name, const std::function<Result<LoadedMesh>()>& read) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  Parcel parcel;
  try {
    auto result = read();
    parcel.ok = result.ok();
    if (result)
      parcel.loaded = std::move(*result);
    else
      parcel.error = result.error();
    parcel.warnings = std::move(result.warnings());
  } catch (const std::bad_alloc&) {
    parcel = {.error = {ErrorCode::TooLarge, "asks for more memory than there is, or than a limit allows", name}};
  } catch (const std::exception&) {
    ::_exit(3);
  }
  Packer packer{file};
  parcel_fields(packer, parcel);
  const bool good = packer.good() && std::fflush(file) == 0;
  ::_exit(good ? 0 : 4);
}

std::uint64_t resident_bytes(pid_t child) {
  char path[64];
  std::snprintf(path, sizeof path, "/proc/%d/statm", static_cast<int>(child));
  std::FILE* file = std::fopen(path, "re");
  if (file == nullptr) return 0;
  unsigned long long total = 0;
  unsigned long long resident = 0;
  const int got = std::fscanf(file, "%llu %llu", &total, &resident);
  std::fclose(file);
  return got == 2 ? resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

// Waits for the child; an Error if it had to be ended.
Status watch(pid_t child, const Input& input, const Context& context) {
  using Clock = std::chrono::steady_clock;
  const auto limit_s = std::chrono::seconds{60 + static_cast<long>(input.size() >> 20)};
  const std::uint64_t before = resident_bytes(::getpid());
  const std::uint64_t limit_bytes =
      context.max_memory_bytes > 0 ? context.max_memory_bytes : (1ULL << 30) + 64 * input.size();
  const auto start = Clock::now();
  useconds_t pause_us = 200;
  for (;;) {
    const pid_t ended = ::waitpid(child, nullptr, WNOHANG);
    if (ended == child || (ended < 0 && errno == ECHILD)) return Done{};
    Status stop = Done{};
    if (context.cancelled()) stop = Error{ErrorCode::Cancelled, "reading was cancelled", input.name()};
    if (Clock::now() - start > limit_s) stop = Error{ErrorCode::BadData, "takes too long to read", input.name()};
    if (resident_bytes(child) > before + limit_bytes) {
      stop = Error{ErrorCode::TooLarge, "needs too much memory to read", input.name()};
    }
    if (!stop) {
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
      return stop;
    }
    ::usleep(pause_us);
    pause_us = std::min<useconds_t>(pause_us * 2, 20'000);
  }
}

}  // namespace

Result<LoadedMesh> run_isolated(const Input& input, const Context& context,
                                const std::function<Result<LoadedMesh>()>& read) {
  const int descriptor = ::memfd_create("lodestone", MFD_CLOEXEC);
  std::FILE* file = descriptor >= 0 ? ::fdopen(descriptor, "w+b") : nullptr;
  if (file == nullptr) {
    if (descriptor >= 0) ::close(descriptor);
    return Error{ErrorCode::Unreadable, std::string{"no room to read it in: "} + std::strerror(errno), input.name()};
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> closer{file, &std::fclose};
  const pid_t child = ::fork();
  if (child < 0) {
    return Error{ErrorCode::Unreadable, std::string{"no process to read it in: "} + std::strerror(errno), input.name()};
  }
  if (child == 0) run_child(file, input.name(), read);
  if (auto done = watch(child, input, context); !done) return done.error();
  std::fseek(file, 0, SEEK_END);
  const long size = std::ftell(file);
  std::rewind(file);
  Parcel parcel;
  Unpacker unpacker{file, size > 0 ? static_cast<std::uint64_t>(size) : 0};
  parcel_fields(unpacker, parcel);
  if (!unpacker.good()) {
    return Error{ErrorCode::BadData, "is damaged: the importer of its format breaks down on it", input.name()};
  }
  if (!parcel.ok) return std::move(parcel.error);
  return {std::move(parcel.loaded), std::move(parcel.warnings)};
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include "output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

namespace lodestone {
namespace {

Error write_error(const std::filesystem::path& file) {
  return Error{ErrorCode::Unreadable, std::string{"cannot be written: "} + std::strerror(errno), file.string()};
}

// The file that is to be replaced: where a link leads to, and never a device, a pipe or a folder, which a rename would
// put an end to.
Result<std::filesystem::path> place_of(const std::filesystem::path& file) {
  std::error_code error;
  const bool link = std::filesystem::is_symlink(file, error);
  auto place = link ? std::filesystem::canonical(file, error) : file;
  if (link && error)
    return Error{ErrorCode::Unreadable, "cannot be written: it is a link that leads nowhere", file.string()};
  const auto kind = std::filesystem::status(place, error).type();
  if (kind == std::filesystem::file_type::not_found || kind == std::filesystem::file_type::regular) return place;
  if (error) return Error{ErrorCode::Unreadable, "cannot be written: " + error.message(), file.string()};
  return Error{ErrorCode::Unreadable, "cannot be written: there is something of that name that is not a plain file",
               file.string()};
}

}  // namespace

Result<OutputFile> OutputFile::create(const std::filesystem::path& file) {
  static std::atomic<unsigned> serial{0};
  auto place = place_of(file);
  if (!place) return place.error();
  OutputFile out;
  out.file_ = std::move(*place);
  out.beside_ = out.file_;
  out.beside_ += ".part" + std::to_string(::getpid()) + '-' + std::to_string(serial++);
  const int descriptor = ::open(out.beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return write_error(file);
  out.stream_ = ::fdopen(descriptor, "wb");
  if (out.stream_ == nullptr) {
    ::close(descriptor);
    return write_error(file);
  }
  return out;
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : stream_{std::exchange(other.stream_, nullptr)},
      file_{std::move(other.file_)},
      beside_{std::move(other.beside_)},
      failed_{other.failed_} {}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  if (this != &other) {
    discard();
    stream_ = std::exchange(other.stream_, nullptr);
    file_ = std::move(other.file_);
    beside_ = std::move(other.beside_);
    failed_ = other.failed_;
  }
  return *this;
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::discard() noexcept {
  if (stream_ == nullptr) return;
  std::fclose(std::exchange(stream_, nullptr));
  ::unlink(beside_.c_str());
}

void OutputFile::write(const void* data, std::size_t size_bytes) noexcept {
  if (size_bytes > 0 && std::fwrite(data, 1, size_bytes, stream_) != size_bytes) failed_ = true;
}

Status OutputFile::commit() {
  if (std::fflush(stream_) != 0 || failed_) {
    Error error = write_error(file_);
    discard();
    return error;
  }
  std::FILE* stream = std::exchange(stream_, nullptr);
  if (std::fclose(stream) != 0 || ::rename(beside_.c_str(), file_.c_str()) != 0) {
    Error error = write_error(file_);
    ::unlink(beside_.c_str());
    return error;
  }
  return Done{};
}

Status check_output(const std::filesystem::path& file) {
  const auto out = OutputFile::create(file);
  if (!out) return out.error();
  return Done{};
}

Status write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  out->write(bytes.data(), bytes.size());
  return out->commit();
}

}  // namespace lodestone

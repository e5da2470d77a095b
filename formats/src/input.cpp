// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "reader.h"

namespace lodestone {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c); });
  return text;
}

// Follows `relative` from `folder`, part by part, whatever the case of its letters.
std::optional<std::filesystem::path> find_any_case(const std::filesystem::path& folder,
                                                   const std::filesystem::path& relative) {
  std::error_code error;
  if (std::filesystem::is_regular_file(folder / relative, error)) return folder / relative;
  std::filesystem::path at = folder;
  for (const auto& part : relative) {
    if (part.empty() || part == ".") continue;
    if (part == ".." || std::filesystem::exists(at / part, error)) {
      at /= part;
      continue;
    }
    const std::string wanted = lower(part.string());
    std::filesystem::path best;
    for (const auto& entry : std::filesystem::directory_iterator(at.empty() ? "." : at, error)) {
      const auto name = entry.path().filename();
      if (lower(name.string()) == wanted && (best.empty() || name < best)) best = name;
    }
    if (best.empty()) return std::nullopt;
    at /= best;
  }
  if (std::filesystem::is_regular_file(at, error)) return at;
  return std::nullopt;
}

// "file:///a%20b.jpg", or with a host's name before the third slash, is "/a b.jpg".
std::string without_scheme(std::string_view name) {
  constexpr std::string_view scheme = "file://";
  if (!name.starts_with(scheme)) return std::string{name};
  name.remove_prefix(std::min(name.find('/', scheme.size()), name.size()));
  std::string path;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned char code = 0;
    constexpr std::size_t digits = 2;
    constexpr int hexadecimal = 16;
    const char* first = name.data() + i + 1;
    if (name[i] == '%' && i + digits < name.size() &&
        std::from_chars(first, first + digits, code, hexadecimal).ptr == first + digits) {
      path.push_back(static_cast<char>(code));
      i += digits;
    } else {
      path.push_back(name[i]);
    }
  }
  return path;
}

}  // namespace

Result<Input> Input::open(const std::filesystem::path& file, std::uint64_t max_bytes) {
  Input input;
  input.name_ = file.string();
  input.file_ = file;
  input.folder_ = file.parent_path();
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    if (errno == ENOENT) return Error{ErrorCode::NotFound, "there is no such file", input.name_};
    return Error{ErrorCode::Unreadable, std::string{"cannot be opened: "} + std::strerror(errno), input.name_};
  }
  input.descriptor_ = std::shared_ptr<const int>(new int{descriptor}, [](const int* d) {
    ::close(*d);
    delete d;
  });
  struct stat info {};
  if (::fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode)) {
    return Error{ErrorCode::Unreadable, "is not a regular file", input.name_};
  }
  input.size_ = static_cast<std::uint64_t>(info.st_size);
  if (input.size_ > max_bytes) return too_large(input, "bytes", input.size_, max_bytes);
  return input;
}

Input Input::from_bytes(std::span<const std::uint8_t> bytes, std::string name, std::filesystem::path folder) {
  Input input;
  input.name_ = std::move(name);
  input.folder_ = std::move(folder);
  input.size_ = bytes.size();
  input.bytes_ = bytes;
  return input;
}

std::string Input::extension() const { return lower(std::filesystem::path{name_}.extension().string()); }

std::size_t Input::read(std::uint64_t offset, std::span<std::uint8_t> out) const {
  if (offset >= size_) return 0;
  if (!descriptor_) {
    const std::size_t count = std::min<std::uint64_t>(out.size(), size_ - offset);
    std::memcpy(out.data(), bytes_.data() + offset, count);
    return count;
  }
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t got = ::pread(*descriptor_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

Result<std::vector<std::uint8_t>> Input::read_all() const {
  std::vector<std::uint8_t> bytes(size_);
  if (read(0, bytes) != size_) return Error{ErrorCode::Unreadable, "could not be read to its end", name_};
  return bytes;
}

std::optional<std::filesystem::path> find_beside(const std::filesystem::path& folder, std::string_view name) {
  std::string clean = without_scheme(name);
  std::replace(clean.begin(), clean.end(), '\\', '/');
  while (!clean.empty() && (clean.back() == ' ' || clean.back() == '\r')) clean.pop_back();
  if (clean.empty() || clean.size() > 4096 || clean.find('\0') != std::string::npos) return std::nullopt;
  const std::filesystem::path path{clean};
  std::error_code error;
  if (path.is_absolute()) {
    if (std::filesystem::is_regular_file(path, error)) return path;
  } else if (auto found = find_any_case(folder, path)) {
    return found;
  }
  if (auto found = find_any_case(folder, path.parent_path().filename() / path.filename())) return found;
  if (auto found = find_any_case(folder, path.filename())) return found;
  return find_any_case(folder, std::filesystem::path{"textures"} / path.filename());
}

void Warnings::add(std::string message, std::string where) {
  constexpr std::size_t most = 200;
  if (const auto found = index_.find(message); found != index_.end()) {
    ++list_[found->second].count;
    return;
  }
  if (list_.size() >= most) message = "further warnings of other kinds were left out";
  if (const auto found = index_.find(message); found != index_.end()) {
    ++list_[found->second].count;
    return;
  }
  index_.emplace(message, list_.size());
  list_.push_back({std::move(message), std::move(where), 1});
}

void Warnings::add_all(std::vector<Warning> warnings) {
  for (auto& warning : warnings) {
    const std::size_t count = warning.count;
    const std::string message = warning.message;
    add(std::move(warning.message), std::move(warning.where));
    if (const auto found = index_.find(message); found != index_.end()) list_[found->second].count += count - 1;
  }
}

Error too_large(const Input& input, std::string_view what, std::uint64_t count, std::uint64_t cap) {
  return Error{ErrorCode::TooLarge,
               "holds " + std::to_string(count) + ' ' + std::string{what} + ", more than the limit of " +
                   std::to_string(cap) + "; raise the limit to read it",
               input.name()};
}

}  // namespace lodestone

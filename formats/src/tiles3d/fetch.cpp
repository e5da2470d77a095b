// SPDX-License-Identifier: MIT
// The only file that names libcurl.
#include "tiles3d/fetch.h"

#include <curl/curl.h>

#include <memory>
#include <string>

#include "reader.h"

namespace lodestone {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Closer {
  void operator()(CURL* handle) const noexcept { curl_easy_cleanup(handle); }
};

struct Sink {
  Bytes bytes;
  std::uint64_t most_bytes = 0;
  bool full = false;
};

// Called from C: what is thrown must not leave.
std::size_t take(const char* data, std::size_t size, std::size_t count, void* user) noexcept {
  auto& sink = *static_cast<Sink*>(user);
  const std::size_t length = size * count;
  sink.full = length > sink.most_bytes - sink.bytes.size();
  if (sink.full) return 0;
  try {
    sink.bytes.insert(sink.bytes.end(), data, data + length);
  } catch (...) {
    return 0;
  }
  return length;
}

// One per thread: connections are used again.
CURL* handle_of_thread() {
  static const bool started = curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
  static thread_local const std::unique_ptr<CURL, Closer> handle{started ? curl_easy_init() : nullptr};
  return handle.get();
}

// Not that a server sends us to a local file.
void allow_web_only(CURL* handle) {
#if LIBCURL_VERSION_NUM >= 0x075500  // the older names are deprecated since
  curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(handle, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
#else
  constexpr long web = CURLPROTO_HTTP | CURLPROTO_HTTPS;
  curl_easy_setopt(handle, CURLOPT_PROTOCOLS, web);
  curl_easy_setopt(handle, CURLOPT_REDIR_PROTOCOLS, web);
#endif
}

Result<Bytes> fetch_address(const std::string& address, std::uint64_t most_bytes) {
  CURL* handle = handle_of_thread();
  if (handle == nullptr) return Error{ErrorCode::Unreadable, "libcurl could not be started", address};
  curl_easy_reset(handle);
  Sink sink{{}, most_bytes};
  const auto set = [&](CURLoption option, auto value) { curl_easy_setopt(handle, option, value); };
  set(CURLOPT_URL, address.c_str());
  set(CURLOPT_NOSIGNAL, 1L);
  set(CURLOPT_FAILONERROR, 1L);
  set(CURLOPT_FOLLOWLOCATION, 1L);
  set(CURLOPT_MAXREDIRS, 5L);
  allow_web_only(handle);
  set(CURLOPT_ACCEPT_ENCODING, "");  // whatever it can undo
  set(CURLOPT_CONNECTTIMEOUT, 30L);
  set(CURLOPT_LOW_SPEED_LIMIT, 1024L);
  set(CURLOPT_LOW_SPEED_TIME, 30L);
  set(CURLOPT_WRITEFUNCTION, take);
  set(CURLOPT_WRITEDATA, &sink);
  const CURLcode code = curl_easy_perform(handle);
  long status = 0;
  curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
  if (sink.full) return Error{ErrorCode::TooLarge, "the answer is larger than " + std::to_string(most_bytes), address};
  if (code == CURLE_OK) return std::move(sink.bytes);
  constexpr long not_found = 404;
  if (status == not_found) return Error{ErrorCode::NotFound, "the server has no such file", address};
  return Error{ErrorCode::Unreadable, std::string{"it cannot be fetched: "} + curl_easy_strerror(code), address};
}

}  // namespace

bool is_address(const std::filesystem::path& file) {
  const std::string text = file.string();
  return text.starts_with("http://") || text.starts_with("https://");
}

Result<Bytes> fetch(const std::filesystem::path& file, std::uint64_t most_bytes) {
  if (is_address(file)) return fetch_address(file.string(), most_bytes);
  const auto input = Input::open(file, most_bytes);
  if (!input) return input.error();
  return input->read_all();
}

}  // namespace lodestone

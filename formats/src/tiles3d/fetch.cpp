// SPDX-License-Identifier: MIT
// The only file that names libcurl. It is loaded when something is first fetched: with what it needs it is 6 MB that a
// tileset on the disk should not pay.
#define CURL_DISABLE_TYPECHECK  // macros in the way of calls through pointers
#include "tiles3d/fetch.h"

#include <curl/curl.h>
#include <dlfcn.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "reader.h"

namespace lodestone {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Curl {
  decltype(&curl_global_init) global_init = nullptr;
  decltype(&curl_easy_init) init = nullptr;
  decltype(&curl_easy_reset) reset = nullptr;
  decltype(&curl_easy_setopt) setopt = nullptr;
  decltype(&curl_easy_perform) perform = nullptr;
  decltype(&curl_easy_getinfo) getinfo = nullptr;
  decltype(&curl_easy_strerror) strerror = nullptr;
  decltype(&curl_easy_cleanup) cleanup = nullptr;
  bool usable = false;
};

template <class Function>
bool load(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  return function != nullptr;
}

// Never unloaded: handles of threads outlive everything else.
const Curl& curl() {
  static const Curl loaded = [] {
    Curl found;
    void* library = nullptr;
    for (const char* name : {"libcurl.so.4", "libcurl-gnutls.so.4"}) {
      if (library == nullptr) library = ::dlopen(name, RTLD_LAZY | RTLD_LOCAL);
    }
    if (library == nullptr) return found;
    const bool whole =
        load(library, "curl_global_init", found.global_init) && load(library, "curl_easy_init", found.init) &&
        load(library, "curl_easy_reset", found.reset) && load(library, "curl_easy_setopt", found.setopt) &&
        load(library, "curl_easy_perform", found.perform) && load(library, "curl_easy_getinfo", found.getinfo) &&
        load(library, "curl_easy_strerror", found.strerror) && load(library, "curl_easy_cleanup", found.cleanup);
    found.usable = whole && found.global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
    return found;
  }();
  return loaded;
}

struct Closer {
  void operator()(CURL* handle) const noexcept { curl().cleanup(handle); }
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
  static thread_local const std::unique_ptr<CURL, Closer> handle{curl().usable ? curl().init() : nullptr};
  return handle.get();
}

// Not that a server sends us to a local file.
void allow_web_only(CURL* handle) {
#if LIBCURL_VERSION_NUM >= 0x075500  // the older names are deprecated since
  curl().setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
  curl().setopt(handle, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
#else
  constexpr long web = CURLPROTO_HTTP | CURLPROTO_HTTPS;
  curl().setopt(handle, CURLOPT_PROTOCOLS, web);
  curl().setopt(handle, CURLOPT_REDIR_PROTOCOLS, web);
#endif
}

Result<Bytes> fetch_address(const std::string& address, std::uint64_t most_bytes) {
  CURL* handle = handle_of_thread();
  if (handle == nullptr)
    return Error{ErrorCode::Unreadable, "libcurl (libcurl.so.4) is not there or cannot be started", address};
  curl().reset(handle);
  Sink sink{{}, most_bytes};
  const auto set = [&](CURLoption option, auto value) { curl().setopt(handle, option, value); };
  set(CURLOPT_URL, address.c_str());
  set(CURLOPT_NOSIGNAL, 1L);
  set(CURLOPT_FAILONERROR, 1L);
  set(CURLOPT_FOLLOWLOCATION, 1L);
  set(CURLOPT_MAXREDIRS, 5L);
  allow_web_only(handle);
  // As the program curl does: whom to trust instead of the system list, behind a proxy for instance.
  if (const char* trusted = std::getenv("CURL_CA_BUNDLE"); trusted != nullptr && *trusted != '\0') {
    set(CURLOPT_CAINFO, trusted);
  }
  set(CURLOPT_ACCEPT_ENCODING, "");  // whatever it can undo
  set(CURLOPT_CONNECTTIMEOUT, 30L);
  set(CURLOPT_LOW_SPEED_LIMIT, 1024L);
  set(CURLOPT_LOW_SPEED_TIME, 30L);
  set(CURLOPT_WRITEFUNCTION, take);
  set(CURLOPT_WRITEDATA, &sink);
  const CURLcode code = curl().perform(handle);
  long status = 0;
  curl().getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
  if (sink.full) return Error{ErrorCode::TooLarge, "the answer is larger than " + std::to_string(most_bytes), address};
  if (code == CURLE_OK) return std::move(sink.bytes);
  constexpr long not_found = 404;
  if (status == not_found) return Error{ErrorCode::NotFound, "the server has no such file", address};
  return Error{ErrorCode::Unreadable, std::string{"it cannot be fetched: "} + curl().strerror(code), address};
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

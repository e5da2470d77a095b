// SPDX-License-Identifier: MIT
// Based on: EXT_meshopt_compression, a vendor extension of glTF 2.0.
// Differs: the file is rewritten before it is parsed, so that no reader behind it need know of the extension.
#include "gltf_meshopt.h"

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::uint8_t>;
constexpr const char* meshopt = "EXT_meshopt_compression";
constexpr std::size_t head_bytes = 12;
constexpr std::size_t chunk_head_bytes = 8;
constexpr std::uint32_t json_chunk = 0x4E4F534AU;
constexpr std::uint32_t binary_chunk = 0x004E4942U;
constexpr std::uint64_t most_unpacked_bytes = 1ULL << 30;

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

void append_word(Bytes& bytes, std::size_t word) {
  const auto value = static_cast<std::uint32_t>(word);
  const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof value);
}

void pad(Bytes& bytes, std::uint8_t with) { bytes.resize((bytes.size() + 3) / 4 * 4, with); }

struct Chunks {
  std::span<const std::uint8_t> json, binary;
};

std::optional<Chunks> chunks_of(std::span<const std::uint8_t> file) {
  Chunks chunks;
  if (file.size() < head_bytes + chunk_head_bytes || std::memcmp(file.data(), "glTF", 4) != 0) return {};
  for (std::size_t at = head_bytes; at + chunk_head_bytes <= file.size();) {
    const std::size_t length = word_at(file, at);
    const std::uint32_t type = word_at(file, at + 4);
    at += chunk_head_bytes;
    if (length > file.size() - at) return {};
    if (type == json_chunk && chunks.json.empty()) chunks.json = file.subspan(at, length);
    if (type == binary_chunk && chunks.binary.empty()) chunks.binary = file.subspan(at, length);
    at += length;
  }
  return chunks;
}

bool names(std::span<const std::uint8_t> json, std::string_view word) {
  const std::string_view text{reinterpret_cast<const char*>(json.data()), json.size()};
  return text.find(word) != std::string_view::npos;
}

class Unpacker {
 public:
  Unpacker(Json root, std::span<const std::uint8_t> binary, std::string name)
      : root_(std::move(root)), packed_(binary), name_(std::move(name)) {}

  Result<Bytes> run() {
    binary_.assign(packed_.begin(), packed_.end());
    pad(binary_, 0);
    if (root_.contains("bufferViews")) {
      for (Json& view : root_.at("bufferViews")) {
        if (!view.contains("extensions") || !view.at("extensions").contains(meshopt)) continue;
        if (Status status = unpack_view(view); !status) return status.error();
      }
    }
    settle_buffers();
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
      if (!root_.contains(list)) continue;
      Json kept = Json::array();
      for (const Json& one : root_.at(list)) {
        if (one != meshopt) kept.push_back(one);
      }
      root_[list] = std::move(kept);
      if (root_[list].empty()) root_.erase(list);
    }
    return file();
  }

 private:
  [[nodiscard]] Error bad(const char* what) const { return {ErrorCode::BadData, what, name_}; }

  [[nodiscard]] Status unpack_view(Json& json) {
    const Json& from = json.at("extensions").at(meshopt);
    const std::uint64_t offset = from.value("byteOffset", std::uint64_t{0});
    const auto length = from.at("byteLength").get<std::uint64_t>();
    const packing::View view{from.at("count").get<std::uint64_t>(), from.at("byteStride").get<std::uint64_t>(),
                             from.at("mode").get<std::string>(), from.value("filter", std::string{})};
    if (from.at("buffer").get<std::uint64_t>() != 0) {
      return Error{ErrorCode::Unsupported, "has vertices packed in another file, which is not supported", name_};
    }
    if (offset > packed_.size() || length > packed_.size() - offset) return bad("has a packed view outside its buffer");
    // No codec packs more than some hundred to one: what claims to is not worth the memory.
    constexpr std::uint64_t most_ratio = 1024;
    if (view.stride == 0 || view.stride > 256 || view.count > most_ratio * (length + 1) ||
        view.count * view.stride > most_unpacked_bytes - std::min<std::uint64_t>(total_, most_unpacked_bytes)) {
      return Error{ErrorCode::TooLarge, "has a packed view larger than its bytes can hold", name_};
    }
    const Bytes bytes = packing::unpack(packed_.subspan(offset, length), view);
    if (bytes.empty() && view.count > 0) return bad("has a packed view that cannot be unpacked");
    total_ += bytes.size();
    json["buffer"] = 0;
    json["byteOffset"] = binary_.size();
    json["byteLength"] = bytes.size();
    json.at("extensions").erase(meshopt);
    binary_.insert(binary_.end(), bytes.begin(), bytes.end());
    pad(binary_, 0);
    return Done{};
  }

  // Buffers that stood in for what was packed are looked at no more.
  void settle_buffers() {
    if (!root_.contains("buffers") || root_.at("buffers").empty()) return;
    Json& buffers = root_.at("buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      if (buffers[i].contains("extensions")) buffers[i].at("extensions").erase(meshopt);
      if (i > 0 && !buffers[i].contains("uri")) buffers[i]["byteLength"] = 1;
    }
    buffers[0]["byteLength"] = binary_.size();
  }

  [[nodiscard]] Result<Bytes> file() const {
    const std::string text = root_.dump(-1, ' ', false, Json::error_handler_t::replace);
    Bytes json{text.begin(), text.end()};
    pad(json, ' ');
    const std::size_t size = head_bytes + 2 * chunk_head_bytes + json.size() + binary_.size();
    if (size > std::numeric_limits<std::uint32_t>::max()) return Error{ErrorCode::TooLarge, "is too large", name_};
    Bytes out{'g', 'l', 'T', 'F'};
    out.reserve(size);
    append_word(out, 2);
    append_word(out, size);
    append_word(out, json.size());
    append_word(out, json_chunk);
    out.insert(out.end(), json.begin(), json.end());
    append_word(out, binary_.size());
    append_word(out, binary_chunk);
    out.insert(out.end(), binary_.begin(), binary_.end());
    return out;
  }

  Json root_;
  std::span<const std::uint8_t> packed_;
  std::string name_;
  Bytes binary_;
  std::uint64_t total_ = 0;  // unpacked so far
};

}  // namespace

Result<std::vector<std::uint8_t>> without_meshopt(std::vector<std::uint8_t> file, const std::string& name) {
  const auto chunks = chunks_of(file);
  if (!chunks || !names(chunks->json, meshopt)) return file;
  try {
    return Unpacker{Json::parse(chunks->json.begin(), chunks->json.end()), chunks->binary, name}.run();
  } catch (const Json::exception&) {
    return Error{ErrorCode::BadData, "is not valid glTF 2.0 (a packed view is not described as it should be)", name};
  }
}

}  // namespace lodestone

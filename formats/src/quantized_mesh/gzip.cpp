// SPDX-License-Identifier: MIT
#include "quantized_mesh/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <new>

namespace lodestone {
namespace {

constexpr int gzip_window = 15 + 16;  // zlib: the largest window, in a gzip container
constexpr int memory_level = 9;

Bytef* bytes_of(std::span<const std::uint8_t> bytes) { return const_cast<Bytef*>(bytes.data()); }

}  // namespace

std::vector<std::uint8_t> to_gzip(std::span<const std::uint8_t> bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, gzip_window, memory_level, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc{};
  std::vector<std::uint8_t> out(deflateBound(&stream, static_cast<uLong>(bytes.size())) + 32);
  stream.next_in = bytes_of(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);  // cannot fail: the room is what deflateBound asked for
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

bool is_gzip(std::span<const std::uint8_t> bytes) { return bytes.size() > 2 && bytes[0] == 0x1f && bytes[1] == 0x8b; }

Result<std::vector<std::uint8_t>> from_gzip(std::span<const std::uint8_t> bytes, std::size_t max_bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, gzip_window) != Z_OK) throw std::bad_alloc{};
  stream.next_in = bytes_of(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::vector<std::uint8_t> out;
  int state = Z_OK;
  while (state == Z_OK && out.size() < max_bytes) {
    const std::size_t before = out.size();
    out.resize(std::min(max_bytes, std::max<std::size_t>(2 * before, 1 << 16)));
    stream.next_out = out.data() + before;
    stream.avail_out = static_cast<uInt>(out.size() - before);
    state = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  if (state == Z_STREAM_END) return out;
  if (state == Z_OK) return Error{ErrorCode::TooLarge, "it unpacks to more than a tile can hold", ""};
  return Error{ErrorCode::BadData, "the gzip stream is damaged or cut short", ""};
}

}  // namespace lodestone

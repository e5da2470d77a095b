// SPDX-License-Identifier: MIT
// Based on: Whang, Vander-Zanden and Taylor 1990, "A linear-time probabilistic counting algorithm" (distinct corners).
#include "mesh_count.h"

#define XXH_INLINE_ALL  // header only
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <string>

#include "line_reader.h"
#include "mtl.h"

namespace lodestone {
namespace {

// Counts the different words among those it is shown.
class DistinctWords {
 public:
  void add(std::string_view word) noexcept {
    const std::uint64_t hash = XXH3_64bits(word.data(), word.size());
    bits_[(hash >> 6U) % words] |= std::uint64_t{1} << (hash & 63U);
  }
  [[nodiscard]] double count() const noexcept {
    std::size_t free = 0;
    for (const std::uint64_t word : bits_) free += static_cast<std::size_t>(64 - std::popcount(word));
    constexpr double all = 64.0 * words;
    return -all * std::log(static_cast<double>(std::max<std::size_t>(free, 1)) / all);
  }

 private:
  static constexpr std::size_t words = std::size_t{1} << 17U;  // a megabyte: to 0.1 % up to 40 million
  std::vector<std::uint64_t> bits_ = std::vector<std::uint64_t>(words, 0);
};

class Counter {
 public:
  void take(std::string_view line) {
    Words words{line};
    const std::string_view key = words.next();
    if (key == "v") {
      ++positions_;
    } else if (key == "vt") {
      ++uvs_;
    } else if (key == "vn") {
      ++normals_;
    } else if (key == "f" || key == "fo") {
      take_face(words);
    } else if (key == "usemtl") {
      used_.emplace(words.rest());
    } else if (key == "mtllib") {
      libraries_.emplace(words.rest());
    }
  }
  [[nodiscard]] MeshCount result(const Input& input, const Context& context) const {
    const double listed = static_cast<double>(std::max({positions_, uvs_, normals_}));
    // Negative numbers count from where they stand, so the same word means many vertices.
    const double most = 3.0 * static_cast<double>(triangles_);
    const double found = relative_ ? 1.25 * listed : 1.002 * corners_.count() + 1.0;
    const std::uint32_t bytes = 12U + (uvs_ > 0 ? 8U : 0U) + (normals_ > 0 ? 12U : 0U);
    return {triangles_, static_cast<std::uint64_t>(std::min(most, found)), bytes, textures(input, context)};
  }

 private:
  void take_face(Words& words) {
    std::uint64_t corners = 0;
    for (std::string_view word = words.next(); !word.empty() && word.front() != '#'; word = words.next()) {
      ++corners;
      corners_.add(word);
      relative_ = relative_ || word.find('-') != std::string_view::npos;
    }
    if (corners >= 3) triangles_ += corners - 2;
  }
  [[nodiscard]] std::vector<std::filesystem::path> textures(const Input& input, const Context& context) const {
    MtlLibrary library;
    Warnings told_when_read;
    constexpr std::uint64_t most_bytes = 1U << 26U;
    for (const std::string& line : libraries_) {
      for (const std::string& name : library_names(input.folder(), line)) {
        const auto file = find_beside(input.folder(), name);
        if (!file) continue;
        const auto text = Input::open(*file, most_bytes);
        if (text) read_mtl(*text, input.folder(), context, library, told_when_read);
      }
    }
    std::set<std::filesystem::path> files;
    for (const auto& [name, material] : library) {
      if (material.texture.empty() || !used_.contains(name)) continue;
      if (auto file = find_beside(input.folder(), material.texture)) files.insert(std::move(*file));
    }
    return {files.begin(), files.end()};
  }

  std::uint64_t positions_ = 0, uvs_ = 0, normals_ = 0, triangles_ = 0;
  bool relative_ = false;
  DistinctWords corners_;
  std::set<std::string, std::less<>> used_, libraries_;
};

}  // namespace

Result<MeshCount> count_obj(const Input& input, const Context& context) {
  LineReader lines{input, context};
  Counter counter;
  std::string_view line;
  while (lines.next(line)) counter.take(line);
  if (const Status& status = lines.status(); !status) return status.error();
  return counter.result(input, context);
}

}  // namespace lodestone

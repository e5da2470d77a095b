// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include <lodestone/progressive_model.h>

#include "base/hash.h"
#include "progressive/pieces.h"
#include "progressive/values.h"

namespace lodestone {
namespace {

constexpr std::size_t most_words = 3 * 9 + 2;

// A triangle as words: the bits of its three corners from the smallest on, then material and feature.
using Key = std::array<std::uint32_t, most_words>;

class Triangles {
 public:
  explicit Triangles(const Mesh& mesh) : mesh_(mesh), words_(progressive::value_words(mesh.vertices)) {
    order_.resize(mesh.triangle_count());
    for (FaceId f = 0; f < order_.size(); ++f) order_[f] = {hash(f), f};
    std::sort(order_.begin(), order_.end());
  }

  [[nodiscard]] std::uint64_t hash_at(std::size_t i) const { return order_[i].first; }
  [[nodiscard]] FaceId face_at(std::size_t i) const { return order_[i].second; }
  [[nodiscard]] std::size_t size() const { return order_.size(); }

  [[nodiscard]] Key key(FaceId face) const {
    Key corners{};
    for (std::size_t c = 0; c < 3; ++c)
      value(mesh_.indices[3 * static_cast<std::size_t>(face) + c], &corners[c * words_]);
    std::size_t first = 0;
    for (std::size_t c = 1; c < 3; ++c) {
      if (rotation_less(corners, c, first)) first = c;
    }
    Key key{};
    for (std::size_t c = 0; c < 3; ++c) {
      std::copy_n(&corners[(first + c) % 3 * words_], words_, &key[c * words_]);
    }
    key[3 * words_] = mesh_.face_material(face);
    key[3 * words_ + 1] = mesh_.face_feature(face);
    return key;
  }

 private:
  void value(VertexId vertex, std::uint32_t* words) const {
    const VertexArrays& v = mesh_.vertices;
    const auto put = [&](const auto& array) {
      if (array.empty()) return;
      std::memcpy(words, &array[vertex], sizeof(array[0]));
      words += sizeof(array[0]) / 4;
    };
    put(v.positions);
    put(v.normals);
    put(v.uvs);
    put(v.colors);
  }

  // Whether the corners read from `a` on come before those read from `b` on.
  [[nodiscard]] bool rotation_less(const Key& corners, std::size_t a, std::size_t b) const {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t w = 0; w < words_; ++w) {
        const std::uint32_t x = corners[(a + c) % 3 * words_ + w];
        const std::uint32_t y = corners[(b + c) % 3 * words_ + w];
        if (x != y) return x < y;
      }
    }
    return false;
  }

  [[nodiscard]] std::uint64_t hash(FaceId face) const {
    std::uint64_t h = 0;
    for (const std::uint32_t word : key(face)) h = hash_combine(h, word);
    return h;
  }

  const Mesh& mesh_;
  std::size_t words_;
  std::vector<std::pair<std::uint64_t, FaceId>> order_;
};

}  // namespace

std::string compare_with_source(const ProgressiveModel& model, const Mesh& source) {
  const Mesh finest = model.extract(model.record_count());
  if (finest.origin != source.origin) return "the origins differ";
  if (finest.triangle_count() < source.triangle_count()) {
    return "the finest level has " + std::to_string(finest.triangle_count()) + " triangles, the source " +
           std::to_string(source.triangle_count());
  }
  if (finest.triangle_count() == 0) return {};
  if (progressive::value_words(finest.vertices) != progressive::value_words(source.vertices)) {
    return "the vertex attributes differ";
  }
  if (finest.materials.size() != source.materials.size()) return "the materials differ";
  const Triangles ours{finest};
  const Triangles theirs{source};
  std::vector<FaceId> missing, added;  // in the source only, in the finest level only
  for (std::size_t i = 0, k = 0; i < theirs.size() || k < ours.size();) {
    const bool both = i < theirs.size() && k < ours.size();
    if (both && ours.hash_at(k) == theirs.hash_at(i) && ours.key(ours.face_at(k)) == theirs.key(theirs.face_at(i))) {
      ++i;
      ++k;
    } else if (k == ours.size() || (both && theirs.hash_at(i) <= ours.hash_at(k))) {
      missing.push_back(theirs.face_at(i++));
    } else {
      added.push_back(ours.face_at(k++));
    }
  }
  std::sort(missing.begin(), missing.end());
  std::sort(added.begin(), added.end());
  const progressive::Uncovered uncovered = progressive::find_uncovered(source, missing, finest, added);
  if (uncovered.whole != none) {
    return "triangle " + std::to_string(uncovered.whole) + " of the source is not in the finest level";
  }
  if (uncovered.piece != none) {
    return "triangle " + std::to_string(uncovered.piece) + " of the finest level is not in the source";
  }
  return {};
}

}  // namespace lodestone

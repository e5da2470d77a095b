// SPDX-License-Identifier: MIT
#include "producer.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <random>

namespace lodestone::test {
namespace {

class Producer {
 public:
  Producer(const Mesh& source, const ProducerOptions& options)
      : source_(source), options_(options), indices_(source.indices), random_(options.seed), log_(words()) {
    faces_of_.resize(source.vertex_count());
    for (FaceId f = 0; f < source.triangle_count(); ++f) {
      faces_.push_back(f);
      for (std::size_t c = 0; c < 3; ++c) faces_of_[indices_[3 * f + c]].push_back(f);
    }
    gone_.assign(source.triangle_count(), 0);
    for (VertexId v = 0; v < source.vertex_count(); ++v) alive_.push_back(v);
    vertex_gone_.assign(source.vertex_count(), 0);
  }

  progressive::EditLog run() {
    const auto least = static_cast<std::size_t>(options_.keep_ratio * static_cast<double>(faces_.size()));
    float error_m = 0.0F;
    for (std::uint32_t i = 0; i < options_.records && faces_.size() > least; ++i) {
      log_.begin(error_m);
      const double kind = unit();
      if (kind < options_.vanish_share) {
        vanish();
      } else if (kind < options_.vanish_share + options_.nudge_share) {
        nudge();
      } else {
        collapse();
      }
      log_.end();
      if (unit() < 0.5) error_m += static_cast<float>(0.01 * unit());
    }
    return std::move(log_);
  }

 private:
  [[nodiscard]] std::uint32_t words() const {
    const VertexArrays& v = source_.vertices;
    return 3U + (v.normals.empty() ? 0U : 3U) + (v.uvs.empty() ? 0U : 2U) + (v.colors.empty() ? 0U : 1U);
  }
  [[nodiscard]] double unit() { return static_cast<double>(random_() >> 11U) * 0x1p-53; }
  [[nodiscard]] std::uint32_t below(std::size_t n) {
    return static_cast<std::uint32_t>(unit() * static_cast<double>(n));
  }

  // A face that is left.
  [[nodiscard]] FaceId pick_face() {
    while (true) {
      const std::uint32_t i = below(faces_.size());
      const FaceId face = faces_[i];
      if (gone_[face] == 0) return face;
      faces_[i] = faces_.back();
      faces_.pop_back();
    }
  }

  void remove(FaceId face) {
    log_.remove_face(face);
    gone_[face] = 1;
    faces_.erase(std::find(faces_.begin(), faces_.end(), face));
  }

  void collapse() {
    const FaceId face = pick_face();
    const std::uint32_t c = below(3);
    const VertexId u = indices_[3 * face + c];
    const VertexId v = indices_[3 * face + (c + 1) % 3];
    if (u == v) {
      remove(face);
      return;
    }
    const std::vector<FaceId> around = faces_of_[u];
    std::vector<FaceId> once = around;
    std::sort(once.begin(), once.end());
    once.erase(std::unique(once.begin(), once.end()), once.end());
    for (const FaceId f : once) {
      if (gone_[f] != 0) continue;
      VertexId* corner = &indices_[3 * static_cast<std::size_t>(f)];
      if (std::find(corner, corner + 3, v) != corner + 3) {
        remove(f);
        continue;
      }
      for (std::uint32_t i = 0; i < 3; ++i) {
        if (corner[i] != u) continue;
        log_.repoint(3 * f + i, v);
        corner[i] = v;
        faces_of_[v].push_back(f);
      }
    }
    log_.remove_vertex(u, v);
    vertex_gone_[u] = 1;
    if (unit() < options_.move_share) move(v);
  }

  // Takes away some faces; the vertices that lose their last one go too, drawn together in the first of them.
  void vanish() {
    std::vector<VertexId> corners;
    for (std::uint32_t n = 1 + below(6); n-- > 0 && faces_.size() > 1;) {
      const FaceId face = pick_face();
      for (std::uint32_t c = 0; c < 3; ++c) corners.push_back(indices_[3 * face + c]);
      remove(face);
    }
    VertexId center = none;
    for (const VertexId v : corners) {
      const auto left = [&](FaceId f) { return gone_[f] == 0; };
      if (vertex_gone_[v] != 0 || std::any_of(faces_of_[v].begin(), faces_of_[v].end(), left)) continue;
      if (center == none) center = v;
      log_.remove_vertex(v, center);
      vertex_gone_[v] = 1;
    }
  }

  void nudge() {
    for (std::uint32_t n = below(50); n-- > 0;) {
      const VertexId v = indices_[3 * pick_face() + below(3)];
      move(v);
    }
  }

  void move(VertexId v) {
    std::uint32_t bits[9] = {};
    std::uint32_t* word = bits;
    const auto put = [&](const auto& value) {
      std::memcpy(word, &value, sizeof(value));
      word += sizeof(value) / 4;
    };
    const auto jitter = [&] { return static_cast<float>(0.02 * (unit() - 0.5)); };
    const VertexArrays& a = source_.vertices;
    put(a.positions[v] + glm::vec3{jitter(), jitter(), jitter()});
    if (!a.normals.empty()) put(glm::normalize(a.normals[v] + glm::vec3{jitter(), jitter(), jitter()}));
    if (!a.uvs.empty()) put(a.uvs[v] + glm::vec2{jitter(), jitter()});
    if (!a.colors.empty())
      put(glm::u8vec4{a.colors[v].g, a.colors[v].r, static_cast<std::uint8_t>(random_() & 255U), 255});
    log_.move_vertex(v, {bits, word});
  }

  const Mesh& source_;
  ProducerOptions options_;
  std::vector<VertexId> indices_;
  std::vector<FaceId> faces_;  // those left
  std::vector<VertexId> alive_;
  std::vector<std::vector<FaceId>> faces_of_;
  std::vector<std::uint8_t> gone_, vertex_gone_;
  std::mt19937_64 random_;
  progressive::EditLog log_;
};

}  // namespace

progressive::EditLog random_log(const Mesh& source, const ProducerOptions& options) {
  return Producer{source, options}.run();
}

std::shared_ptr<const ProgressiveModel> random_model(const Mesh& source, const ProducerOptions& options) {
  auto model = ProgressiveModel::from_data(progressive::record(source, random_log(source, options), "test"));
  if (!model) FAIL(to_line(model.error()));
  return *model;
}

}  // namespace lodestone::test

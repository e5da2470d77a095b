// SPDX-License-Identifier: MIT
// Based on: Touma and Gotsman 1998 (parallelogram prediction), applied cluster by cluster.
#include "cluster_file/page_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lodestone::cluster_file {
namespace {

using model_file::unzigzag;
using model_file::zigzag;

constexpr double uv_step = 1.0 / 16384.0;
constexpr double most_uv_word = 2.0e9;
constexpr double normal_steps = 255.0;

std::uint32_t signed_word(double x) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(x)); }

// A unit vector folded onto a square, and back.
std::array<std::uint32_t, 2> fold(const glm::vec3& n) {
  const glm::dvec3 d{n};
  const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  if (!(sum > 0.0)) return {127, 127};
  double x = d.x / sum;
  double y = d.y / sum;
  if (d.z < 0.0) {
    const double fx = (1.0 - std::abs(y)) * (x < 0.0 ? -1.0 : 1.0);
    y = (1.0 - std::abs(x)) * (y < 0.0 ? -1.0 : 1.0);
    x = fx;
  }
  const auto word = [](double t) {
    return static_cast<std::uint32_t>(std::clamp(std::floor((t * 0.5 + 0.5) * normal_steps + 0.5), 0.0, normal_steps));
  };
  return {word(x), word(y)};
}

glm::vec3 unfold(const std::array<std::uint32_t, 2>& words) {
  double x = (words[0] & 255U) / normal_steps * 2.0 - 1.0;
  double y = (words[1] & 255U) / normal_steps * 2.0 - 1.0;
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z < 0.0) {
    const double fx = (1.0 - std::abs(y)) * (x < 0.0 ? -1.0 : 1.0);
    y = (1.0 - std::abs(x)) * (y < 0.0 ? -1.0 : 1.0);
    x = fx;
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  return glm::vec3{glm::dvec3{x, y, z} / length};
}

// How a vertex is guessed: a + b - c across an edge, or as it is.
Words across(const Words& a, const Words& b, const Words& c) {
  Words guess = a;
  for (std::size_t k = 0; k < 3; ++k) guess.position[k] = a.position[k] + b.position[k] - c.position[k];
  for (std::size_t k = 0; k < 2; ++k) guess.uv[k] = a.uv[k] + b.uv[k] - c.uv[k];
  return guess;
}

// The triangle among those from `first` on, most recent first, that has the edge b-a; how far back times three plus the
// corner where that edge begins, plus 1; 0 if none.
std::uint32_t find_neighbour(const std::vector<std::uint8_t>& indices, std::uint32_t first, std::uint32_t t) {
  const std::uint8_t a = indices[3 * t];
  const std::uint8_t b = indices[3 * t + 1];
  for (std::uint32_t p = t; p-- > first;) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (indices[3 * p + k] == b && indices[3 * p + (k + 1) % 3] == a) return 3 * (t - 1 - p) + k + 1;
    }
  }
  return 0;
}

// Both directions of the same walk: `Way` either writes what the piece says or reads it into the piece.
template <class Way>
bool walk(const Codec& codec, std::uint32_t vertex_count, Carry& carry, Way& way, Piece& piece) {
  std::uint32_t next = 0;
  const auto corner = [&](std::uint32_t at, const Words& guess) {
    std::uint32_t back = way.corner(at, next);
    if (back > next) return false;
    if (back != 0) {
      way.set(at, next - back);
      return true;
    }
    if (next >= vertex_count) return false;
    way.set(at, next);
    way.vertex(codec, next, guess);
    carry.vertex = piece.vertices[next];
    ++next;
    return true;
  };
  std::uint32_t first = 0;
  for (const std::uint32_t end : piece.section_ends) {
    for (std::uint32_t t = first; t != end; ++t) {
      const std::uint32_t code = way.neighbour(first, t);
      if (code == 0) {
        for (std::uint32_t k = 0; k < 3; ++k) {
          if (!corner(3 * t + k, carry.vertex)) return false;
        }
        continue;
      }
      const std::uint32_t k = (code - 1) % 3;
      const std::uint32_t back = (code - 1) / 3;
      if (back >= t - first) return false;
      const std::uint8_t* other = &piece.indices[3 * (t - 1 - back)];
      const std::uint8_t b = other[k];
      const std::uint8_t a = other[(k + 1) % 3];
      const std::uint8_t c = other[(k + 2) % 3];
      way.set(3 * t, a);
      way.set(3 * t + 1, b);
      if (!corner(3 * t + 2, across(piece.vertices[a], piece.vertices[b], piece.vertices[c]))) return false;
    }
    first = end;
  }
  return next == vertex_count;
}

struct Writing {
  const Piece& piece;
  WrittenColumns& columns;

  std::uint32_t neighbour(std::uint32_t first, std::uint32_t t) {
    const std::uint32_t code = find_neighbour(piece.indices, first, t);
    columns[Neighbour].put(code);
    return code;
  }
  std::uint32_t corner(std::uint32_t at, std::uint32_t next) {
    const std::uint32_t back = next - piece.indices[at];  // 0: the next new vertex
    columns[Corner].put(back);
    return back;
  }
  void set(std::uint32_t, std::uint32_t) {}
  void vertex(const Codec& codec, std::uint32_t v, const Words& guess) {
    const Words& words = piece.vertices[v];
    for (std::size_t k = 0; k < 3; ++k) columns[PositionX + k].put(zigzag(words.position[k] - guess.position[k]));
    for (std::size_t k = 0; codec.normals && k < 2; ++k) {
      columns[NormalX + k].put(zigzag(words.normal[k] - guess.normal[k]));
    }
    for (std::size_t k = 0; codec.uvs && k < 2; ++k) columns[UvX + k].put(zigzag(words.uv[k] - guess.uv[k]));
    for (std::uint32_t shift = 0; codec.colors && shift < 32; shift += 8) {
      columns[Color].put(((words.color >> shift) - (guess.color >> shift)) & 255U);
    }
  }
};

struct Reading {
  Piece& piece;
  ReadColumns& columns;

  std::uint32_t neighbour(std::uint32_t, std::uint32_t) { return columns[Neighbour].get(); }
  std::uint32_t corner(std::uint32_t, std::uint32_t) { return columns[Corner].get(); }
  void set(std::uint32_t at, std::uint32_t v) { piece.indices[at] = static_cast<std::uint8_t>(v); }
  void vertex(const Codec& codec, std::uint32_t v, const Words& guess) {
    Words& words = piece.vertices[v];
    for (std::size_t k = 0; k < 3; ++k) {
      words.position[k] = guess.position[k] + unzigzag(columns[PositionX + k].get());
    }
    for (std::size_t k = 0; codec.normals && k < 2; ++k) {
      words.normal[k] = guess.normal[k] + unzigzag(columns[NormalX + k].get());
    }
    for (std::size_t k = 0; codec.uvs && k < 2; ++k) words.uv[k] = guess.uv[k] + unzigzag(columns[UvX + k].get());
    for (std::uint32_t shift = 0; codec.colors && shift < 32; shift += 8) {
      words.color |= (((guess.color >> shift) + columns[Color].get()) & 255U) << shift;
    }
  }
};

}  // namespace

Words Codec::words_of(const VertexArrays& vertices, std::uint32_t v) const {
  Words words;
  const glm::dvec3 at = (glm::dvec3{vertices.positions[v]} - grid.corner) / grid.step_m;
  const double most = std::exp2(grid.bits) - 1.0;
  for (int k = 0; k < 3; ++k) {
    words.position[static_cast<std::size_t>(k)] =
        static_cast<std::uint32_t>(std::clamp(std::floor(at[k] + 0.5), 0.0, most));
  }
  if (normals) words.normal = fold(vertices.normals[v]);
  for (int k = 0; uvs && k < 2; ++k) {
    const double word = std::floor(double{vertices.uvs[v][k]} / uv_step + 0.5);
    words.uv[static_cast<std::size_t>(k)] = signed_word(std::clamp(word, -most_uv_word, most_uv_word));
  }
  if (colors) words.color = std::bit_cast<std::uint32_t>(vertices.colors[v]);
  return words;
}

void Codec::append(const Words& words, VertexArrays& out) const {
  glm::dvec3 at{0.0};
  for (int k = 0; k < 3; ++k) at[k] = grid.corner[k] + words.position[static_cast<std::size_t>(k)] * grid.step_m;
  out.positions.emplace_back(at);
  if (normals) out.normals.push_back(unfold(words.normal));
  if (uvs) {
    const auto value = [&](std::size_t k) {
      return static_cast<float>(static_cast<std::int32_t>(words.uv[k]) * uv_step);
    };
    out.uvs.emplace_back(value(0), value(1));
  }
  if (colors) out.colors.push_back(std::bit_cast<glm::u8vec4>(words.color));
}

void encode(const Codec& codec, const Piece& piece, Carry& carry, WrittenColumns& columns) {
  Writing way{piece, columns};
  walk(codec, static_cast<std::uint32_t>(piece.vertices.size()), carry, way, const_cast<Piece&>(piece));
  for (const std::uint32_t target : piece.targets) {
    columns[Target].put(zigzag(target - carry.target));
    carry.target = target;
  }
}

bool decode(const Codec& codec, std::uint32_t vertex_count, bool has_targets, Carry& carry, ReadColumns& columns,
            Piece& piece) {
  piece.vertices.assign(vertex_count, Words{});
  piece.indices.assign(piece.section_ends.empty() ? 0 : 3 * std::size_t{piece.section_ends.back()}, 0);
  Reading way{piece, columns};
  if (!walk(codec, vertex_count, carry, way, piece)) return false;
  piece.targets.clear();
  for (std::uint32_t v = 0; has_targets && v != vertex_count; ++v) {
    carry.target += unzigzag(columns[Target].get());
    piece.targets.push_back(carry.target);
  }
  return std::none_of(columns.begin(), columns.end(), [](const auto& column) { return column.overrun(); });
}

}  // namespace lodestone::cluster_file

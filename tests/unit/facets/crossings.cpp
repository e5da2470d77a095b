// SPDX-License-Identifier: MIT
#include "crossings.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace lodestone::test {
namespace {

struct Triangle {
  std::array<glm::dvec3, 3> at;
  glm::dvec3 normal;  // unit
  glm::dvec3 low, high;
  std::uint32_t part = 0;
};

// Parts hang together by equal positions.
std::vector<std::uint32_t> parts_of(const Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertex_count());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t v) {
    const glm::vec3& p = mesh.vertices.positions[v];
    return std::array<float, 3>{p.x, p.y, p.z};
  };
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) < key(b); });
  std::vector<std::uint32_t> root(mesh.vertex_count());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (key(order[i]) == key(order[i - 1])) root[find(order[i])] = find(order[i - 1]);
  }
  for (std::size_t c = 0; c < mesh.indices.size(); c += 3) {
    root[find(mesh.indices[c + 1])] = find(mesh.indices[c]);
    root[find(mesh.indices[c + 2])] = find(mesh.indices[c]);
  }
  std::vector<std::uint32_t> parts(mesh.triangle_count());
  for (std::size_t f = 0; f < parts.size(); ++f) parts[f] = find(mesh.indices[3 * f]);
  return parts;
}

// Whether the segment passes through the inside of the triangle.
bool pierces(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t, double touch_m) {
  const double hp = glm::dot(p - t.at[0], t.normal);
  const double hq = glm::dot(q - t.at[0], t.normal);
  if (std::min(hp, hq) > -touch_m || std::max(hp, hq) < touch_m) return false;
  const glm::dvec3 x = p + (q - p) * (hp / (hp - hq));
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 along = t.at[(k + 1) % 3] - t.at[k];
    if (glm::dot(glm::cross(along, x - t.at[k]), t.normal) < touch_m * glm::length(along)) return false;
  }
  return true;
}

bool cross(const Triangle& a, const Triangle& b, double touch_m) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (pierces(a.at[k], a.at[(k + 1) % 3], b, touch_m) || pierces(b.at[k], b.at[(k + 1) % 3], a, touch_m)) return true;
  }
  return false;
}

}  // namespace

std::uint32_t count_crossings(const Mesh& mesh, double touch_m) {
  const std::vector<std::uint32_t> parts = parts_of(mesh);
  std::vector<Triangle> triangles;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      t.at[k] = glm::dvec3{mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + k]]};
    }
    const glm::dvec3 n = glm::cross(t.at[1] - t.at[0], t.at[2] - t.at[0]);
    if (!(glm::length(n) > 1e-9)) continue;
    t.normal = glm::normalize(n);
    t.low = glm::min(t.at[0], glm::min(t.at[1], t.at[2]));
    t.high = glm::max(t.at[0], glm::max(t.at[1], t.at[2]));
    t.part = parts[f];
    triangles.push_back(t);
  }
  std::sort(triangles.begin(), triangles.end(), [](const Triangle& a, const Triangle& b) { return a.low.x < b.low.x; });
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& a = triangles[i];
    for (std::size_t j = i + 1; j < triangles.size() && triangles[j].low.x < a.high.x; ++j) {
      const Triangle& b = triangles[j];
      if (a.part != b.part) continue;
      if (b.low.y >= a.high.y || a.low.y >= b.high.y || b.low.z >= a.high.z || a.low.z >= b.high.z) continue;
      count += cross(a, b, touch_m) ? 1 : 0;
    }
  }
  return count;
}

}  // namespace lodestone::test

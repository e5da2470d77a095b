// SPDX-License-Identifier: MIT
// How far the faces of a level lean off the directions of the source.
#pragma once

#include <lodestone/facet_shift.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lodestone::test {

struct Leaning {
  double area_m2 = 0.0;    // of all faces
  double walls_m2 = 0.0;   // of those more than half a degree off the upright direction nearest to them
  double others_m2 = 0.0;  // of those more than a degree off any other direction nearest to them
};

inline Leaning leaning(const CharacteristicSurfaces& source, const Mesh& level) {
  Leaning found;
  for (FaceId f = 0; f < level.triangle_count(); ++f) {
    const auto at = [&](std::uint32_t k) {
      return glm::dvec3{level.vertices.positions[level.indices[3 * std::size_t{f} + k]]};
    };
    const glm::dvec3 n = glm::cross(at(1) - at(0), at(2) - at(0));
    const double length = glm::length(n);
    // A sliver has no direction.
    const double longest =
        std::max({glm::length(at(1) - at(0)), glm::length(at(2) - at(1)), glm::length(at(0) - at(2))});
    if (length < 1e-3 * longest) continue;
    found.area_m2 += 0.5 * length;
    double best = -1.0;
    bool upright = false;
    for (const CharacteristicSurface& s : source.surfaces) {
      const double cosine = glm::dot(s.normal, n) / length;
      if (cosine <= best) continue;
      best = cosine;
      upright = std::abs(s.normal.z) < 1e-3;
      if (best > 0.99999) break;
    }
    if (upright && best < 0.999962) found.walls_m2 += 0.5 * length;
    if (!upright && best < 0.999848) found.others_m2 += 0.5 * length;
  }
  return found;
}

// Whether the level reaches farther than the source does, by more than `error_m`, along any of 26 directions.
inline bool grows(const Mesh& source, const Mesh& level, double error_m) {
  for (int i = 0; i < 27; ++i) {
    const glm::dvec3 d{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    if (i == 13) continue;
    const glm::dvec3 along = glm::normalize(d);
    const auto reach = [&](const Mesh& mesh) {
      double most = -1e30;
      for (const VertexId v : mesh.indices)
        most = std::max(most, glm::dot(along, glm::dvec3{mesh.vertices.positions[v]}));
      return most;
    };
    if (reach(level) > reach(source) + error_m + 1e-3) return true;
  }
  return false;
}

}  // namespace lodestone::test

// SPDX-License-Identifier: MIT
#include "facets/crossing.h"

#include <algorithm>
#include <array>

namespace lodestone::facets {
namespace {

constexpr std::size_t small_part = 256;  // faces
constexpr double touch_m = 1e-3;         // that deep is no crossing yet

using Corners = std::array<glm::dvec3, 3>;

bool pierces(const glm::dvec3& p, const glm::dvec3& q, const Corners& t, const glm::dvec3& normal) {
  const double hp = glm::dot(p - t[0], normal);
  const double hq = glm::dot(q - t[0], normal);
  if (std::min(hp, hq) > -touch_m || std::max(hp, hq) < touch_m) return false;
  const glm::dvec3 x = p + (q - p) * (hp / (hp - hq));
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 along = t[k == 2 ? 0 : k + 1] - t[k];
    if (glm::dot(glm::cross(along, x - t[k]), normal) < touch_m * glm::length(along)) return false;
  }
  return true;
}

bool cross(const Corners& a, const Corners& b) {
  const auto low = [](const Corners& t) { return glm::min(t[0], glm::min(t[1], t[2])); };
  const auto high = [](const Corners& t) { return glm::max(t[0], glm::max(t[1], t[2])); };
  if (glm::any(glm::greaterThan(low(a), high(b))) || glm::any(glm::greaterThan(low(b), high(a)))) return false;
  const glm::dvec3 na = glm::cross(a[1] - a[0], a[2] - a[0]);
  const glm::dvec3 nb = glm::cross(b[1] - b[0], b[2] - b[0]);
  const double la = glm::length(na);
  const double lb = glm::length(nb);
  if (!(la > 1e-9) || !(lb > 1e-9)) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = k == 2 ? 0 : k + 1;
    if (pierces(a[k], a[next], b, nb / lb) || pierces(b[k], b[next], a, na / la)) return true;
  }
  return false;
}

}  // namespace

CrossingFinder::CrossingFinder(const FacetMesh& mesh, const PartFinder& parts)
    : mesh_(mesh), parts_(parts), index_(mesh) {
  start();
}

void CrossingFinder::start() {
  index_.clear();
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    if (mesh_.faces[f].live && parts_.part_of(f).size() > small_part) index_.put(f);
  }
}

void CrossingFinder::update(const std::vector<FaceId>& faces) {
  for (const FaceId f : faces) {
    if (!mesh_.faces[f].live) {
      index_.take(f);
    } else if (parts_.part_of(f).size() > small_part) {
      index_.put(f);
    }
  }
}

bool CrossingFinder::makes_crossing(const Moved& moved) const {
  const auto now = [&](const Face& f) {
    return Corners{mesh_.at(f.point[0]), mesh_.at(f.point[1]), mesh_.at(f.point[2])};
  };
  const auto then = [&](const Face& f) {
    return Corners{moved.at(f.point[0]), moved.at(f.point[1]), moved.at(f.point[2])};
  };
  for (const FaceId f : moved.faces()) {
    const Face& face = mesh_.faces[f];
    const Corners t = then(face);
    bool found = false;
    const auto meets = [&](FaceId g) {
      const Face& other = mesh_.faces[g];
      return g != f && other.live && cross(t, then(other)) && !cross(now(face), now(other));
    };
    const std::vector<FaceId>& part = parts_.part_of(f);
    if (part.size() <= small_part) {
      found = std::any_of(part.begin(), part.end(), meets);
    } else {
      // A face that moves itself is met where it is: two that move meet rarely, and where they end is near.
      index_.visit(glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2])), [&](FaceId g) {
        found = parts_.same_part(f, g) && meets(g);
        return !found;
      });
    }
    if (found) return true;
  }
  return false;
}

}  // namespace lodestone::facets

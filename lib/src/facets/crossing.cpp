// SPDX-License-Identifier: MIT
#include "facets/crossing.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

namespace lodestone::facets {
namespace {

constexpr std::size_t small_part = 1024;  // faces
constexpr double cell_work = 4.0;         // of a cell of the lattice, beside a face that is walked by
constexpr double touch_m = 1e-3;          // that deep is no crossing yet

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

// A triangle with what is asked of it again and again.
struct Piece {
  explicit Piece(const Corners& at)
      : corner(at), low(glm::min(at[0], glm::min(at[1], at[2]))), high(glm::max(at[0], glm::max(at[1], at[2]))) {}
  [[nodiscard]] bool touches(const glm::dvec3& l, const glm::dvec3& h) const {
    return low.x <= h.x && high.x >= l.x && low.y <= h.y && high.y >= l.y && low.z <= h.z && high.z >= l.z;
  }
  void add(const Piece& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  Corners corner;
  glm::dvec3 low, high;
};

bool cross(const Piece& a, const Piece& b) {
  if (!a.touches(b.low, b.high)) return false;
  const Corners& p = a.corner;
  const Corners& q = b.corner;
  const glm::dvec3 na = glm::cross(p[1] - p[0], p[2] - p[0]);
  const glm::dvec3 nb = glm::cross(q[1] - q[0], q[2] - q[0]);
  const double la = glm::length(na);
  const double lb = glm::length(nb);
  if (!(la > 1e-9) || !(lb > 1e-9)) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = k == 2 ? 0 : k + 1;
    if (pierces(p[k], p[next], q, nb / lb) || pierces(q[k], q[next], p, na / la)) return true;
  }
  return false;
}

}  // namespace

CrossingFinder::CrossingFinder(const FacetMesh& mesh, const PartFinder& parts)
    : mesh_(mesh), parts_(parts), index_(mesh), boxes_(mesh.faces.size()) {
  for (FaceId f = 0; f < mesh.faces.size(); ++f) measure(f);
  start();
}

void CrossingFinder::measure(FaceId f) {
  const Face& face = mesh_.faces[f];
  if (!face.live) {
    boxes_[f] = {};
    return;
  }
  const glm::vec3& a = mesh_.place[face.point[0]];
  const glm::vec3& b = mesh_.place[face.point[1]];
  const glm::vec3& c = mesh_.place[face.point[2]];
  boxes_[f] = {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
}

void CrossingFinder::start() {
  if (edits_ == mesh_.edits) return;
  edits_ = mesh_.edits;
  index_.clear();
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    if (mesh_.faces[f].live && parts_.part_of(f).size() > small_part) index_.put(f);
  }
}

void CrossingFinder::update(const std::vector<FaceId>& faces) {
  for (const FaceId f : faces) {
    measure(f);
    if (!mesh_.faces[f].live) {
      index_.take(f);
    } else if (parts_.part_of(f).size() > small_part) {
      index_.put(f);
    }
  }
}

bool CrossingFinder::makes_crossing(const Moved& moved) const {
  const auto now = [&](FaceId f) {
    const auto& p = mesh_.faces[f].point;
    return Piece{{mesh_.at(p[0]), mesh_.at(p[1]), mesh_.at(p[2])}};
  };
  const auto then = [&](FaceId f) {
    const auto& p = mesh_.faces[f].point;
    return Piece{{moved.at(p[0]), moved.at(p[1]), moved.at(p[2])}};
  };
  // What ends as a line crosses nothing.
  std::vector<std::pair<FaceId, Piece>> movers;
  for (const FaceId f : moved.faces()) {
    const auto& p = mesh_.faces[f].point;
    const std::array<std::uint32_t, 3> q{moved.point(p[0]), moved.point(p[1]), moved.point(p[2])};
    if (q[0] != q[1] && q[1] != q[2] && q[2] != q[0]) movers.emplace_back(f, then(f));
  }
  // A part at a time; nearly always there is only one.
  for (auto begin = movers.begin(); begin != movers.end();) {
    const FaceId first = begin->first;
    const auto end = std::stable_partition(begin, movers.end(),
                                           [&](const auto& mover) { return parts_.same_part(first, mover.first); });
    Piece all = begin->second;
    for (auto m = begin; m != end; ++m) all.add(m->second);
    // A face that moves itself is looked for where it was: two that move meet rarely, and where they end is near.
    const auto meets = [&](FaceId g) {
      const Piece other = then(g);
      return other.touches(all.low, all.high) && std::any_of(begin, end, [&](const auto& mover) {
               return g != mover.first && cross(mover.second, other) && !cross(now(mover.first), now(g));
             });
    };
    const FloatBox around{glm::vec3{all.low}, glm::vec3{all.high}};
    const auto is_near = [&](FaceId g) { return boxes_[g].touches(around); };
    bool found = false;
    const std::span<const FaceId> part = parts_.part_of(first);
    // What is large itself would look into more cells than there are faces.
    if (part.size() <= small_part || cell_work * index_.work(all.low, all.high) > static_cast<double>(part.size())) {
      found = std::any_of(part.begin(), part.end(), [&](FaceId g) { return is_near(g) && meets(g); });
    } else {
      index_.visit(all.low, all.high, [&](FaceId g) {
        found = mesh_.faces[g].live && parts_.same_part(first, g) && meets(g);
        return !found;
      });
    }
    if (found) return true;
    begin = end;
  }
  return false;
}

}  // namespace lodestone::facets

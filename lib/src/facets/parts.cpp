// SPDX-License-Identifier: MIT
#include "facets/parts.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/disjoint_sets.h"
#include "geometry/distance.h"

namespace lodestone::facets {
namespace {

constexpr std::size_t most_part_faces = 256;  // larger ones lose facets first
constexpr double held_m = 0.03;               // an outline nearer to the rest than this lies on it
constexpr double held_share = 0.9;            // of the corners of a pane that closes an opening
constexpr std::size_t most_queries = 16;      // in one walk
constexpr double long_edge_m = 0.6;           // over shorter ones the distance runs straight
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double look_ahead = 4096.0;  // times the price: so far costs are found, so that not each price asks anew

}  // namespace

PartFinder::PartFinder(const FacetMesh& mesh, const Pieces& pieces, Surroundings& around)
    : mesh_(mesh),
      pieces_(pieces),
      around_(around),
      part_of_(mesh.faces.size(), none),
      known_of_(mesh.faces.size(), none) {
  corners_.resize(mesh.point_count());
  middles_.resize(std::bit_ceil(mesh.point_count() / 2 + 1));
  measured_.resize(mesh.point_count(), 0);
  asked_.resize(mesh.point_count(), 0);
  split();
}

std::uint32_t split_by_points(const FacetMesh& mesh, std::vector<std::uint32_t>& part_of_face) {
  DisjointSets sets{mesh.point_count()};
  for (const Face& f : mesh.faces) {
    if (!f.live) continue;
    sets.join(f.point[0], f.point[1]);
    sets.join(f.point[0], f.point[2]);
  }
  std::vector<std::uint32_t> part_of_root(mesh.point_count(), none);
  part_of_face.assign(mesh.faces.size(), none);
  std::uint32_t count = 0;
  for (FaceId f = 0; f < mesh.faces.size(); ++f) {
    if (!mesh.faces[f].live) continue;
    std::uint32_t& part = part_of_root[sets.find(mesh.faces[f].point[0])];
    if (part == none) part = count++;
    part_of_face[f] = part;
  }
  return count;
}

void PartFinder::split() {
  if (edits_ == mesh_.edits) return;
  edits_ = mesh_.edits;
  const std::uint32_t count = split_by_points(mesh_, part_of_);
  parts_.sort(part_of_, count);
}

std::uint64_t PartFinder::state_of(std::span<const FaceId> faces) const {
  std::uint64_t sum = 0;
  for (const FaceId f : faces) sum += mesh_.state_of(f);
  return sum;
}

// A pane that closes an opening: its outline lies on the rest all around, and nothing is behind it. Without it one
// would look through the wall.
bool PartFinder::closes_opening(double limit_m) const {
  const auto area = [&](FaceId f) { return glm::length(mesh_.area_vector(mesh_.faces[f])); };
  const FaceId largest =
      *std::max_element(part_.faces.begin(), part_.faces.end(), [&](FaceId a, FaceId b) { return area(a) < area(b); });
  const glm::dvec3 across = mesh_.faces[largest].normal;
  const auto faces_across = [&](FaceId f) { return std::abs(glm::dot(mesh_.faces[f].normal, across)) >= 0.9; };
  std::uint32_t corners = 0;
  std::uint32_t held = 0;
  for (const FaceId f : part_.faces) {
    if (!faces_across(f)) continue;
    for (const std::uint32_t p : mesh_.faces[f].point) {
      ++corners;
      held += corners_[p].distance_m < held_m + double{mesh_.deviation_m[p]} ? 1 : 0;
    }
  }
  if (held < held_share * corners) return false;
  double open = 0.0;
  double whole = 0.0;
  for (const FaceId f : part_.faces) {
    if (!faces_across(f)) continue;
    const auto& p = mesh_.faces[f].point;
    whole += area(f);
    const std::array<FaceId, 3> hints{corners_[p[0]].face, corners_[p[1]].face, corners_[p[2]].face};
    const glm::dvec3 middle = (mesh_.at(p[0]) + mesh_.at(p[1]) + mesh_.at(p[2])) / 3.0;
    if (!around_.lies_behind(middle, across, id_, limit_m, hints)) open += area(f);
  }
  return 2.0 * open > whole;
}

// As long as neither the place nor what it is nearest to has moved, what was found before holds: what is left of the
// rest comes nearer rarely.
bool PartFinder::holds(const Sample& known, const glm::vec3& at, double limit_m) const {
  if (known.at != at) return false;
  if (known.face == none) return known.distance_m >= limit_m;
  return mesh_.faces[known.face].live && part_of_[known.face] != id_ && mesh_.shape_of(known.face) == known.shape;
}

// How far the place is from the rest, infinite if there is nothing within the limit.
double PartFinder::sample(const glm::vec3& at, double limit_m, std::span<const FaceId> hints, Sample& known) {
  if (!holds(known, at, limit_m)) {
    Surroundings::Query query{at, limit_m * limit_m};
    for (const FaceId hint : hints) {
      if (hint != none) around_.hint(query, hint);
    }
    around_.nearest({&query, 1}, id_);
    known = {at, query.face, query.face == none ? 0 : mesh_.shape_of(query.face), std::sqrt(query.squared_m)};
  }
  if (known.face == none) return infinity;
  last_nearest_ = known.face;
  if (known.distance_m > limit_m) return infinity;
  part_.error_m = std::max(part_.error_m, known.distance_m);
  const auto& support = mesh_.faces[known.face].point;
  if (part_.support.size() < 3 || !std::equal(support.begin(), support.end(), part_.support.end() - 3))
    part_.support.insert(part_.support.end(), support.begin(), support.end());
  return known.distance_m;
}

// Of all corners of faces of the part, in few walks through what is around.
void PartFinder::sample_corners(std::span<const FaceId> faces, double limit_m) {
  const auto ask = [&] {
    around_.nearest(queries_, id_);
    for (std::size_t i = 0; i < queries_.size(); ++i) {
      const auto& [at, squared_m, face] = queries_[i];
      corners_[query_points_[i]] = {at, face, face == none ? 0 : mesh_.shape_of(face), std::sqrt(squared_m)};
    }
    queries_.clear();
    query_points_.clear();
  };
  for (const FaceId f : faces) {
    for (const std::uint32_t p : mesh_.faces[f].point) {
      if (asked_[p] == measurement_) continue;
      asked_[p] = measurement_;
      const glm::vec3& at = mesh_.place[p];
      if (holds(corners_[p], at, limit_m)) continue;
      queries_.push_back({at, limit_m * limit_m});
      if (last_nearest_ != none) around_.hint(queries_.back(), last_nearest_);
      query_points_.push_back(p);
      if (queries_.size() == most_queries) ask();
    }
  }
  if (!queries_.empty()) ask();
}

double PartFinder::at_corner(std::uint32_t p, double limit_m) {
  if (measured_[p] != measurement_) {
    const double d = sample(mesh_.place[p], limit_m, {&last_nearest_, 1}, corners_[p]);
    if (std::isinf(d)) return d;
    measured_[p] = measurement_;
  }
  return corners_[p].distance_m;
}

double PartFinder::at_middle(std::uint32_t p, std::uint32_t q, double limit_m) {
  if (q < p) std::swap(p, q);
  if (const FaceId face = corners_[p].face; face == corners_[q].face) {
    // No more than the mean of both, as is the distance from one triangle; something else may be nearer.
    const auto& f = mesh_.faces[face].point;
    return std::sqrt(squared_distance_to_triangle(0.5 * (mesh_.at(p) + mesh_.at(q)), mesh_.at(f[0]), mesh_.at(f[1]),
                                                  mesh_.at(f[2])));
  }
  Middle& known = middles_[(p * 0x9E3779B1U ^ q * 0x85EBCA6BU) & (middles_.size() - 1)];
  if (known.low != p || known.high != q) known = {.low = p, .high = q};
  if (known.measurement != measurement_) {
    const std::array<FaceId, 2> hints{corners_[p].face, corners_[q].face};
    const double d = sample(glm::vec3{0.5 * (mesh_.at(p) + mesh_.at(q))}, limit_m, hints, known.sample);
    if (std::isinf(d)) return d;
    known.measurement = measurement_;
  }
  return known.sample.distance_m;
}

// What the face costs, infinite if that is more than `most`; from its corners alone it is what it costs at least. Looks
// from the middles of its edges too where one of them is long.
double PartFinder::cost_of(const Face& face, Look look, double limit_m, double most) {
  const double area_m2 = mesh_.area_m2(face);
  limit_m = std::min(limit_m, std::sqrt(6.0 * most / area_m2));
  const auto& p = face.point;
  std::array<double, 3> d{};
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    d[k] = at_corner(p[k], limit_m);
    if (std::isinf(d[k])) return d[k];
    longest = std::max(longest, glm::length(mesh_.at(p[k]) - mesh_.at(p[k == 2 ? 0 : k + 1])));
  }
  if (longest < long_edge_m) return area_m2 * mean_square(d[0], d[1], d[2]);
  double sum = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  for (std::size_t k = 0; k < 3 && look == Look::Everywhere; ++k) {
    const double middle = at_middle(p[k], p[k == 2 ? 0 : k + 1], limit_m);
    sum += middle * middle;
  }
  return area_m2 * sum / 6.0;
}

// How much more it stands for than there is of it.
double PartFinder::eroded() const {
  double whole_m2 = 0.0;
  double left_m2 = 0.0;
  for (const FaceId f : part_.faces) {
    const double area_m2 = mesh_.area_m2(mesh_.faces[f]);
    left_m2 += area_m2;
    whole_m2 += area_m2 * pieces_.ratio(f);
  }
  return left_m2 > 0.0 ? whole_m2 / left_m2 : 1.0;
}

// Its broad side shows what it lies upon instead.
double PartFinder::look_lost() const {
  const auto area = [&](FaceId f) { return mesh_.area_m2(mesh_.faces[f]); };
  const FaceId largest =
      *std::max_element(part_.faces.begin(), part_.faces.end(), [&](FaceId a, FaceId b) { return area(a) < area(b); });
  const glm::dvec3 across = mesh_.faces[largest].normal;
  const MaterialId behind = last_nearest_ == none ? none : mesh_.source->face_material(last_nearest_);
  if (behind == none) return 0.0;
  double front = 0.0;
  double back = 0.0;
  for (const FaceId f : part_.faces) {
    const double facing = glm::dot(mesh_.faces[f].normal, across);
    if (std::abs(facing) < 0.9) continue;
    (facing > 0.0 ? front : back) += mesh_.looks.cost(mesh_.source->face_material(f), behind, area(f));
  }
  return std::max(front, back);
}

// False as soon as the part is known to be too dear.
bool PartFinder::measure(double limit_m, double price, Known& known) {
  ++measurement_;
  // What is near to the part before is likely near to this one.
  if (last_nearest_ != none && (!mesh_.faces[last_nearest_].live || part_of_[last_nearest_] == id_))
    last_nearest_ = none;
  const auto count = static_cast<double>(part_.faces.size());
  const auto area = [&](FaceId f) { return glm::length(mesh_.area_vector(mesh_.faces[f])); };
  if (known.dearest == none) {
    known.dearest = *std::max_element(part_.faces.begin(), part_.faces.end(),
                                      [&](FaceId a, FaceId b) { return area(a) < area(b); });
  }
  // It is not looked at again before the price is what the dearest face alone costs.
  const double ahead = look_ahead * price * count;
  const double ahead_m = std::sqrt(look_ahead) * limit_m;
  sample_corners({&known.dearest, 1}, ahead_m);
  const double dearest = cost_of(mesh_.faces[known.dearest], Look::Everywhere, ahead_m, ahead);
  known.key = std::min(dearest, ahead) / count;
  if (known.key > price) return false;
  known.key = std::nextafter(price, 2.0 * price);
  sample_corners(part_.faces, ahead_m);
  double most = -1.0;
  for (const Look look : {Look::FromCorners, Look::Everywhere}) {
    part_.cost = 0.0;
    for (const FaceId f : part_.faces) {
      const double cost = cost_of(mesh_.faces[f], look, ahead_m, ahead - part_.cost);
      part_.cost += cost;
      if (cost > most) {
        most = cost;
        known.dearest = f;
      }
      if (part_.cost > ahead) return false;
    }
    if (part_.cost > 4.0 * price * count) {
      known.key = part_.cost / count;
      return false;
    }
  }
  part_.cost = part_.cost * eroded() + look_lost();
  known.key = part_.cost / count;
  std::sort(part_.support.begin(), part_.support.end());
  part_.support.erase(std::unique(part_.support.begin(), part_.support.end()), part_.support.end());
  for (const FaceId f : part_.faces) {
    for (const std::uint32_t p : mesh_.faces[f].point) {
      part_.deviation_m = std::max(part_.deviation_m, double{mesh_.deviation_m[p]});
    }
  }
  known.measured = true;
  known.support_state = support_state(part_);
  known.part = part_;
  known.part.faces.clear();
  return known.key <= price;
}

// Of what it lies upon.
std::uint64_t PartFinder::support_state(const Part& part) const {
  std::uint64_t sum = 0;
  for (const std::uint32_t p : part.support) sum += mesh_.version[p];
  return sum;
}

// The one of the most area, which is never the one to go.
std::uint32_t PartFinder::largest_part() const {
  std::uint32_t largest = none;
  double most = -1.0;
  for (std::uint32_t id = 0; id < parts_.size(); ++id) {
    double area = 0.0;
    for (const FaceId f : parts_[id]) area += glm::length(mesh_.area_vector(mesh_.faces[f]));
    if (area <= most) continue;
    most = area;
    largest = id;
  }
  return largest;
}

std::vector<Part> PartFinder::find(double limit_m, double price) {
  split();
  std::vector<Part> found;
  if (parts_.size() < 2) return found;
  std::uint32_t largest = none;  // told when the first part is to be measured
  for (std::uint32_t id = 0; id < parts_.size(); ++id) {
    const std::span<const FaceId> faces = parts_[id];
    if (faces.size() > most_part_faces) continue;
    std::uint32_t& known_of = known_of_[faces.front()];
    if (known_of == none) {
      known_of = static_cast<std::uint32_t>(known_.size());
      known_.emplace_back();
    }
    Known& known = known_[known_of];
    // A part that has lost faces since costs more for each of those left.
    if (known.key > price) continue;
    if (largest == none) {
      largest = largest_part();
      around_.update(parts_, part_of_);
    }
    if (id == largest) continue;
    const std::uint64_t state = state_of(faces);
    if (known.state != state) known = {.state = state, .key = known.key};
    id_ = id;
    if (known.measured && known.support_state == support_state(known.part)) {
      part_ = known.part;
      part_.faces.assign(faces.begin(), faces.end());
    } else {
      part_ = {};
      part_.faces.assign(faces.begin(), faces.end());
      if (!measure(limit_m, price, known)) continue;
    }
    if (part_.error_m > limit_m || closes_opening(limit_m)) continue;
    part_.error_m = std::hypot(part_.error_m, part_.deviation_m);
    found.push_back(std::move(part_));
  }
  std::stable_sort(found.begin(), found.end(), [](const Part& a, const Part& b) {
    return a.cost * static_cast<double>(b.faces.size()) < b.cost * static_cast<double>(a.faces.size());
  });
  return found;
}

}  // namespace lodestone::facets

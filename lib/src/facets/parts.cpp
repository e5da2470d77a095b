// SPDX-License-Identifier: MIT
#include "facets/parts.h"

#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.h"

namespace lodestone::facets {
namespace {

constexpr std::size_t most_part_faces = 256;  // larger ones lose facets first
constexpr double held_m = 0.03;               // an outline nearer to the rest than this lies on it
constexpr double held_share = 0.9;            // of the corners of a pane that closes an opening
constexpr double long_edge_m = 0.25;          // over shorter ones the distance runs straight

}  // namespace

PartFinder::PartFinder(const FacetMesh& mesh)
    : mesh_(mesh), around_(mesh), part_of_(mesh.faces.size(), none), known_(mesh.faces.size()) {
  distance_m_.resize(mesh.point_count());
}

// Faces that hang together by points.
void PartFinder::split() {
  DisjointSets sets{mesh_.point_count()};
  for (const Face& f : mesh_.faces) {
    if (!f.live) continue;
    sets.join(f.point[0], f.point[1]);
    sets.join(f.point[0], f.point[2]);
  }
  std::vector<std::uint32_t> part_of_root(mesh_.point_count(), none);
  parts_.clear();
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    part_of_[f] = none;
    if (!mesh_.faces[f].live) continue;
    std::uint32_t& part = part_of_root[sets.find(mesh_.faces[f].point[0])];
    if (part == none) {
      part = static_cast<std::uint32_t>(parts_.size());
      parts_.emplace_back();
    }
    part_of_[f] = part;
    parts_[part].push_back(f);
  }
}

std::uint64_t PartFinder::state_of(const std::vector<FaceId>& faces) const {
  std::uint64_t sum = 0;
  for (const FaceId f : faces) sum += mesh_.state_of(f);
  return sum;
}

// A pane that closes an opening: its outline lies on the rest all around, and nothing is behind it. Without it one
// would look through the wall.
bool PartFinder::closes_opening(std::uint32_t id, double limit_m, const Part& part) const {
  const auto area = [&](FaceId f) { return glm::length(mesh_.area_vector(mesh_.faces[f])); };
  const FaceId largest =
      *std::max_element(part.faces.begin(), part.faces.end(), [&](FaceId a, FaceId b) { return area(a) < area(b); });
  const glm::dvec3 across = mesh_.faces[largest].normal;
  const auto faces_across = [&](FaceId f) { return std::abs(glm::dot(mesh_.faces[f].normal, across)) >= 0.9; };
  std::uint32_t corners = 0;
  std::uint32_t held = 0;
  for (const FaceId f : part.faces) {
    if (!faces_across(f)) continue;
    for (const std::uint32_t p : mesh_.faces[f].point) {
      ++corners;
      held += distance_m_[p] < held_m + double{mesh_.deviation_m[p]} ? 1 : 0;
    }
  }
  if (held < held_share * corners) return false;
  double open = 0.0;
  double whole = 0.0;
  for (const FaceId f : part.faces) {
    if (!faces_across(f)) continue;
    const auto& p = mesh_.faces[f].point;
    whole += area(f);
    if (!around_.lies_behind((mesh_.at(p[0]) + mesh_.at(p[1]) + mesh_.at(p[2])) / 3.0, across, id, limit_m))
      open += area(f);
  }
  return 2.0 * open > whole;
}

bool PartFinder::add_sample(const glm::dvec3& p, std::uint32_t id, double limit_m, Part& part, double& distance) {
  const Surroundings::Nearest found = around_.nearest(p, id, limit_m);
  distance = found.distance_m;
  if (found.face == none) return false;
  part.error_m = std::max(part.error_m, distance);
  const auto& support = mesh_.faces[found.face].point;
  if (part.support.size() < 3 || !std::equal(support.begin(), support.end(), part.support.end() - 3))
    part.support.insert(part.support.end(), support.begin(), support.end());
  return true;
}

// Looks from corners, and from the middles of edges and of the face where it is large.
bool PartFinder::measure_face(const Face& face, std::uint32_t id, double limit_m, Part& part, double& cost) {
  std::array<double, 7> d{};
  std::array<glm::dvec3, 3> at{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t p = face.point[k];
    at[k] = mesh_.at(p);
    if (measured_[p] != id + 1) {
      // No farther than its neighbour and the way there.
      double bound = limit_m;
      if (k > 0) bound = std::min(bound, d[k - 1] + glm::length(at[k] - at[k - 1]) + 1e-6);
      if (!add_sample(at[k], id, bound, part, distance_m_[p])) return false;
      measured_[p] = id + 1;
    }
    d[k] = distance_m_[p];
  }
  const double area_m2 = 0.5 * glm::length(mesh_.area_vector(face));
  const double longest = std::max({glm::length(at[1] - at[0]), glm::length(at[2] - at[1]), glm::length(at[0] - at[2])});
  if (longest < long_edge_m) {
    cost = area_m2 * mean_square(d[0], d[1], d[2]);
    return true;
  }
  const std::array<glm::dvec3, 4> middles{0.5 * (at[0] + at[1]), 0.5 * (at[1] + at[2]), 0.5 * (at[2] + at[0]),
                                          (at[0] + at[1] + at[2]) / 3.0};
  double sum = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  for (std::size_t i = 0; i < middles.size(); ++i) {
    if (!add_sample(middles[i], id, limit_m, part, d[3 + i])) return false;
    sum += d[3 + i] * d[3 + i];
  }
  cost = area_m2 * sum / static_cast<double>(d.size());
  return true;
}

// False as soon as the part is known to be too dear.
bool PartFinder::measure(std::uint32_t id, double limit_m, double price, Part& part, Known& known) {
  const double affordable = price * static_cast<double>(part.faces.size());
  double most = -1.0;
  const FaceId first = known.dearest;
  known.key = std::nextafter(price, 2.0 * price);
  const auto add = [&](FaceId f) {
    double cost = 0.0;
    if (!measure_face(mesh_.faces[f], id, limit_m, part, cost)) {
      known.dearest = f;
      return false;
    }
    part.cost += cost;
    if (cost > most) {
      most = cost;
      known.dearest = f;
    }
    return part.cost <= affordable;
  };
  const bool again = first != none && part_of_[first] == id;
  bool within = !again || add(first);
  for (std::size_t i = 0; i < part.faces.size() && within; ++i) {
    within = (again && part.faces[i] == first) || add(part.faces[i]);
  }
  known.key = std::max(known.key, part.cost / static_cast<double>(part.faces.size()));
  return within;
}

std::vector<Part> PartFinder::find(double limit_m, double price) {
  split();
  std::vector<Part> found;
  if (parts_.size() < 2) return found;
  std::size_t most = 0;
  for (const auto& faces : parts_) most = std::max(most, faces.size());
  measured_.assign(mesh_.point_count(), 0);
  bool ready = false;
  for (std::uint32_t id = 0; id < parts_.size(); ++id) {
    const std::vector<FaceId>& faces = parts_[id];
    if (faces.size() == most || faces.size() > most_part_faces) continue;
    Known& known = known_[faces.front()];
    const std::uint64_t state = state_of(faces);
    if (known.state == state && known.key > price) continue;
    if (known.state != state) known = {.state = state};
    if (!ready) around_.update(part_of_);
    ready = true;
    Part part;
    part.faces = faces;
    if (!measure(id, limit_m, price, part, known)) continue;
    known.key = 0.0;
    if (closes_opening(id, limit_m, part)) continue;
    double deviation = 0.0;
    for (const FaceId f : part.faces) {
      for (const std::uint32_t q : mesh_.faces[f].point) deviation = std::max(deviation, double{mesh_.deviation_m[q]});
    }
    part.error_m = std::hypot(part.error_m, deviation);
    found.push_back(std::move(part));
  }
  std::stable_sort(found.begin(), found.end(), [](const Part& a, const Part& b) {
    return a.cost * static_cast<double>(b.faces.size()) < b.cost * static_cast<double>(a.faces.size());
  });
  return found;
}

}  // namespace lodestone::facets

// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019, section 3.2 (external appendages shift onto the plane that they are attached to).
// Differs: the plane is looked for among the faces that the part lies nearest to; what stands on a slope may go
// straight down instead of along the normal, or a pole on a ridge would lean over it. Where the part has a foot in the
// plane, as boxes do, its corners merge with those of the foot, and one record does it all.
#include "facets/appendages.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/bvh.h"
#include "progressive/values.h"

namespace lodestone::facets {
namespace {

constexpr double flush_m = 0.001;       // no higher over the plane counts as in it
constexpr double hidden_m = 0.002;      // so far behind the plane flat remains lie
constexpr double beside_m = 0.04;       // a corner of the foot may lie so far beside
constexpr double off_m = 0.05;          // and the foot so far off what carries it,
constexpr double off_share = 0.25;      // or this share of how far the part was
constexpr double most_way_ratio = 2.5;  // of the part's error: nothing flies across the building
constexpr double same_plane_cosine = 0.9998;
constexpr double same_plane_m = 0.005;
constexpr double least_slope = 0.2;     // of a plane that one can sink into from above
constexpr double level_slope = 0.99;    // there the normal leads down as well
constexpr std::size_t most_planes = 6;  // that are tried, the largest first
constexpr std::size_t most_faces = 64;  // that may carry the part, the largest first

// A plane to sink into and the way there.
struct Host {
  glm::dvec3 normal{0.0};  // towards the part
  double offset_m = 0.0;
  glm::dvec3 way{0.0};  // away from the plane, unit

  [[nodiscard]] double height_m(const glm::dvec3& p) const { return glm::dot(normal, p) - offset_m; }
  // Where p comes to lie, `behind_m` behind the plane.
  [[nodiscard]] glm::dvec3 foot(const glm::dvec3& p, double behind_m) const {
    return p - (height_m(p) + behind_m) / glm::dot(normal, way) * way;
  }
};

class HostFinder {
 public:
  HostFinder(const FacetMesh& mesh, const Part& part) : mesh_(mesh), part_(part) {
    for (const FaceId f : part.faces)
      points_.insert(points_.end(), mesh.faces[f].point.begin(), mesh.faces[f].point.end());
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    find_carriers();
  }

  [[nodiscard]] const std::vector<std::uint32_t>& points() const noexcept { return points_; }

  [[nodiscard]] std::optional<Host> find() const {
    for (const Host& plane : planes()) {
      Host host = towards_part(plane);
      if (carries(host)) return host;
      const double slope = std::abs(host.normal.z);
      if (slope < least_slope || slope > level_slope) continue;
      host.way = {0.0, 0.0, host.normal.z > 0.0 ? 1.0 : -1.0};
      if (carries(host)) return host;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] double area(FaceId f) const { return glm::length(mesh_.area_vector(mesh_.faces[f])); }

  // Faces of the rest that the part lies nearest to.
  void find_carriers() {
    const auto supports = [&](std::uint32_t p) {
      return std::binary_search(part_.support.begin(), part_.support.end(), p);
    };
    for (const std::uint32_t p : part_.support) {
      for (const FaceId f : mesh_.faces_of[p]) {
        const auto& q = mesh_.faces[f].point;
        if (std::min({q[0], q[1], q[2]}) == p && supports(q[0]) && supports(q[1]) && supports(q[2]) &&
            !std::binary_search(part_.faces.begin(), part_.faces.end(), f)) {
          carriers_.push_back(f);
        }
      }
    }
    std::sort(carriers_.begin(), carriers_.end(), [&](FaceId a, FaceId b) {
      const double area_a = area(a);
      const double area_b = area(b);
      return area_a != area_b ? area_a > area_b : a < b;
    });
    if (carriers_.size() > most_faces) carriers_.resize(most_faces);
  }

  [[nodiscard]] std::vector<Host> planes() const {
    std::vector<std::pair<double, Host>> found;
    for (const FaceId f : carriers_) {
      const Face& face = mesh_.faces[f];
      const double offset_m = glm::dot(face.normal, mesh_.at(face.point[0]));
      const auto at = std::find_if(found.begin(), found.end(), [&](const auto& known) {
        const double cosine = glm::dot(known.second.normal, face.normal);
        return std::abs(cosine) > same_plane_cosine &&
               std::abs(known.second.height_m(mesh_.at(face.point[0]))) < same_plane_m;
      });
      if (at != found.end()) {
        at->first += area(f);
      } else {
        found.push_back({area(f), {face.normal, offset_m, face.normal}});
      }
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Host> planes;
    for (std::size_t i = 0; i < std::min(found.size(), most_planes); ++i) planes.push_back(found[i].second);
    return planes;
  }

  [[nodiscard]] Host towards_part(Host host) const {
    double low = 0.0;
    double high = 0.0;
    for (const std::uint32_t p : points_) {
      low = std::min(low, host.height_m(mesh_.at(p)));
      high = std::max(high, host.height_m(mesh_.at(p)));
    }
    if (-low > high) host = {-host.normal, -host.offset_m, -host.way};
    return host;
  }

  // How far a place is from what carries the part.
  [[nodiscard]] double distance_m(const glm::dvec3& p) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const FaceId f : carriers_) {
      const auto& q = mesh_.faces[f].point;
      nearest = std::min(nearest, squared_distance_to_triangle(p, mesh_.at(q[0]), mesh_.at(q[1]), mesh_.at(q[2])));
    }
    return std::sqrt(nearest);
  }

  // Not what lies in the plane from the start: it would be gone from one picture to the next.
  [[nodiscard]] bool carries(const Host& host) const {
    bool stands_out = false;
    for (const std::uint32_t p : points_) {
      const glm::dvec3 from = mesh_.at(p);
      const glm::dvec3 foot = host.foot(from, 0.0);
      stands_out = stands_out || host.height_m(from) > flush_m;
      if (glm::length(foot - from) > most_way_ratio * part_.error_m + off_m ||
          distance_m(foot) > std::max(off_m, off_share * distance_m(from))) {
        return false;
      }
    }
    return stands_out;
  }

  const FacetMesh& mesh_;
  const Part& part_;
  std::vector<std::uint32_t> points_;  // of the part
  std::vector<FaceId> carriers_;
};

struct Wedge {
  VertexId vertex = none;
  std::uint32_t point = none;
};

std::vector<Wedge> wedges_of(const FacetMesh& mesh, const Part& part) {
  std::vector<Wedge> wedges;
  for (const FaceId f : part.faces) {
    for (std::size_t k = 0; k < 3; ++k) wedges.push_back({mesh.faces[f].vertex[k], mesh.faces[f].point[k]});
  }
  std::sort(wedges.begin(), wedges.end(), [](const Wedge& a, const Wedge& b) { return a.vertex < b.vertex; });
  wedges.erase(
      std::unique(wedges.begin(), wedges.end(), [](const Wedge& a, const Wedge& b) { return a.vertex == b.vertex; }),
      wedges.end());
  return wedges;
}

// For every vertex over the plane one of the part's own that lies at its foot already; empty if one has none.
std::vector<std::pair<VertexId, VertexId>> feet_of(const FacetMesh& mesh, const std::vector<Wedge>& wedges,
                                                   const Host& host) {
  std::vector<Wedge> low;
  std::copy_if(wedges.begin(), wedges.end(), std::back_inserter(low),
               [&](const Wedge& w) { return host.height_m(mesh.at(w.point)) <= flush_m; });
  std::vector<std::pair<VertexId, VertexId>> onto;
  for (const Wedge& w : wedges) {
    const glm::dvec3 from = mesh.at(w.point);
    if (host.height_m(from) <= flush_m) continue;
    const auto beside2 = [&](const Wedge& at) {
      const glm::dvec3 apart = host.foot(mesh.at(at.point), 0.0) - host.foot(from, 0.0);
      return glm::dot(apart, apart);
    };
    const auto nearest = std::min_element(low.begin(), low.end(),
                                          [&](const Wedge& a, const Wedge& b) { return beside2(a) < beside2(b); });
    if (nearest == low.end() || beside2(*nearest) > beside_m * beside_m) return {};
    onto.emplace_back(w.vertex, nearest->vertex);
  }
  return onto;
}

// Every vertex over the plane goes behind it.
void flatten(FacetMesh& mesh, const std::vector<Wedge>& wedges, const Host& host, double error_m,
             progressive::EditLog& log) {
  log.begin(static_cast<float>(error_m));
  std::array<std::uint32_t, 12> words{};
  const std::uint32_t count = progressive::value_words(mesh.values);
  for (const Wedge& w : wedges) {
    const glm::dvec3 from{mesh.values.positions[w.vertex]};
    if (host.height_m(from) <= flush_m) continue;
    mesh.values.positions[w.vertex] = glm::vec3{host.foot(from, hidden_m)};
    progressive::get_value(progressive::pointers(mesh.values), w.vertex, words.data());
    log.move_vertex(w.vertex, {words.data(), count});
  }
  log.end();
}

}  // namespace

bool sink(FacetMesh& mesh, const Part& part, progressive::EditLog& log) {
  const auto host = HostFinder{mesh, part}.find();
  if (!host) {
    vanish(mesh, part.faces, Going::Shrinking, part.error_m, log);
    return false;
  }
  const std::vector<Wedge> wedges = wedges_of(mesh, part);
  const auto onto = feet_of(mesh, wedges, *host);
  if (onto.empty()) flatten(mesh, wedges, *host, part.error_m, log);
  vanish(mesh, part.faces, onto, part.error_m, log);
  return true;
}

}  // namespace lodestone::facets

// SPDX-License-Identifier: MIT
// Based on: Catmull 1974 (depth buffer), drawn from directions spread evenly over the sphere (Vogel 1979, spiral).
#include "facets/hidden.h"

#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.h"
#include "facets/outline.h"
#include "facets/visibility.h"

namespace lodestone::facets {
namespace {

constexpr double least_price = 1e-6;  // m^4 a face: before, hardly anything has gone that could hide
constexpr int side_px = 512;
constexpr int direction_count = 32;
constexpr double most_pixel_m = 0.15;  // in larger pictures bars and their glass are one
constexpr std::size_t most_faces = 100'000;
constexpr double looked_again_share = 0.6;  // of the faces that were left
constexpr double furnished_share = 0.55;    // hidden, of the faces
constexpr double most_m = 0.2;              // from what is seen
constexpr double same_plane_cosine = 0.999;
constexpr std::uint32_t seen_group = 0;
constexpr std::uint32_t hidden_group = 1;

// One picture: which face is the nearest at each pixel.
class Picture {
 public:
  Picture(const FacetMesh& mesh, const FloatBox& box)
      : mesh_(mesh),
        middle_(0.5 * (glm::dvec3{box.low} + glm::dvec3{box.high})),
        pixel_m_(glm::length(glm::dvec3{box.high} - glm::dvec3{box.low}) / (side_px - 2)),
        depth_(std::size_t{side_px} * side_px),
        nearest_(depth_.size()) {}

  [[nodiscard]] double pixel_m() const noexcept { return pixel_m_; }

  void take(const glm::dvec3& along, const std::vector<FaceId>& faces, std::vector<std::uint8_t>& seen) {
    along_ = along;
    right_ = glm::normalize(glm::cross(along, std::abs(along.z) < 0.9 ? glm::dvec3{0, 0, 1} : glm::dvec3{1, 0, 0}));
    up_ = glm::cross(right_, along);
    std::fill(depth_.begin(), depth_.end(), std::numeric_limits<double>::infinity());
    std::fill(nearest_.begin(), nearest_.end(), none);
    for (const FaceId f : faces) {
      if (is_glass(f)) continue;
      draw(f, [&](std::size_t at, double depth) {
        if (depth >= depth_[at]) return;
        depth_[at] = depth;
        nearest_[at] = f;
      });
    }
    for (const FaceId f : nearest_) {
      if (f != none) seen[f] = 1;
    }
    // Glass hides nothing, and what covers no middle of a pixel is asked there.
    for (const FaceId f : faces) {
      if (seen[f] != 0) continue;
      if (is_glass(f))
        draw(f, [&](std::size_t at, double depth) {
          if (depth < depth_[at]) seen[f] = 1;
        });
      if (is_small(f) && shows_middle(f)) seen[f] = 1;
    }
  }

 private:
  [[nodiscard]] bool is_glass(FaceId f) const {
    return mesh_.source->materials[mesh_.source->face_material(f)].transparent();
  }
  [[nodiscard]] bool is_small(FaceId f) const {
    const auto& p = mesh_.faces[f].point;
    const auto short_side = [&](std::size_t a, std::size_t b) {
      return glm::length(mesh_.at(p[a]) - mesh_.at(p[b])) < pixel_m_;
    };
    return short_side(0, 1) && short_side(1, 2) && short_side(2, 0);
  }
  // In pixels, depth too.
  [[nodiscard]] glm::dvec3 project(const glm::dvec3& p) const {
    const glm::dvec3 d = (p - middle_) / pixel_m_;
    return {glm::dot(d, right_) + 0.5 * side_px, glm::dot(d, up_) + 0.5 * side_px, glm::dot(d, along_)};
  }
  [[nodiscard]] bool shows_middle(FaceId f) const {
    const auto& p = mesh_.faces[f].point;
    const glm::dvec3 at = project((mesh_.at(p[0]) + mesh_.at(p[1]) + mesh_.at(p[2])) / 3.0);
    const auto pixel = [](double x) { return static_cast<std::size_t>(std::clamp(x, 0.0, side_px - 1.0)); };
    return at.z <= depth_[pixel(at.y) * side_px + pixel(at.x)] + 1.0;
  }
  // Calls paint(pixel, depth).
  template <class Paint>
  void draw(FaceId f, Paint paint) const {
    const auto& p = mesh_.faces[f].point;
    const glm::dvec3 a = project(mesh_.at(p[0]));
    const glm::dvec3 b = project(mesh_.at(p[1]));
    const glm::dvec3 c = project(mesh_.at(p[2]));
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (std::abs(area) < 1e-9) return;
    // Each weight of a corner and the depth grow evenly along a row.
    const glm::dvec3 across{(b.y - c.y) / area, (c.y - a.y) / area, (a.y - b.y) / area};
    const double deeper = glm::dot(across, glm::dvec3{a.z, b.z, c.z});
    const int y_end = last_pixel(std::max({a.y, b.y, c.y}));
    for (int y = first_pixel(std::min({a.y, b.y, c.y})); y <= y_end; ++y) {
      const double up = y + 0.5;
      const double wb = ((0.5 - a.x) * (c.y - a.y) - (up - a.y) * (c.x - a.x)) / area;
      const double wc = ((b.x - a.x) * (up - a.y) - (b.y - a.y) * (0.5 - a.x)) / area;
      const glm::dvec3 weight{1.0 - wb - wc, wb, wc};
      double from = std::min({a.x, b.x, c.x}) - 0.5;
      double to = std::max({a.x, b.x, c.x}) - 0.5;
      for (int k = 0; k < 3; ++k) {
        if (across[k] > 0.0) from = std::max(from, -weight[k] / across[k]);
        if (across[k] < 0.0) to = std::min(to, -weight[k] / across[k]);
        if (across[k] == 0.0 && weight[k] < 0.0) to = -1.0;
      }
      const double depth = glm::dot(weight, glm::dvec3{a.z, b.z, c.z});
      const int x_end = last_pixel(to + 0.5);
      for (int x = first_pixel(from + 0.5); x <= x_end; ++x) {
        paint(static_cast<std::size_t>(y) * side_px + static_cast<std::size_t>(x), depth + x * deeper);
      }
    }
  }
  // Whose middles lie between.
  static int first_pixel(double from) { return std::max(0, static_cast<int>(std::ceil(from - 0.5))); }
  static int last_pixel(double to) { return std::min(side_px - 1, static_cast<int>(std::floor(to - 0.5))); }

  const FacetMesh& mesh_;
  glm::dvec3 middle_, along_{0.0}, right_{0.0}, up_{0.0};
  double pixel_m_;
  std::vector<double> depth_;
  std::vector<FaceId> nearest_;
};

}  // namespace

// Where one face of a plane is seen, all are that hang together with it and are of one material: a wall does not lose
// what ties its outline together.
void HiddenFinder::spread(std::vector<std::uint8_t>& seen) const {
  DisjointSets sets{static_cast<std::uint32_t>(mesh_.faces.size())};
  std::vector<std::uint8_t> sliver(mesh_.faces.size(), 0);
  for (const FaceId f : live_) sliver[f] = is_sliver(mesh_, mesh_.faces[f]) ? 1 : 0;
  const auto joined = [&](FaceId f, FaceId g) {
    if (mesh_.source->face_material(f) != mesh_.source->face_material(g)) return false;
    return sliver[f] != 0 || sliver[g] != 0 ||
           std::abs(glm::dot(mesh_.faces[f].normal, mesh_.faces[g].normal)) > same_plane_cosine;
  };
  for (const FaceId f : live_) {
    const auto& p = mesh_.faces[f].point;
    for (std::size_t k = 0; k < 3; ++k) {
      for (const FaceId g : mesh_.faces_of[p[k]]) {
        if (g > f && mesh_.faces[g].has_point(p[k == 2 ? 0 : k + 1]) && joined(f, g)) sets.join(f, g);
      }
    }
  }
  std::vector<std::uint8_t> shown(mesh_.faces.size(), 0);
  for (const FaceId f : live_) {
    if (seen[f] != 0) shown[sets.find(f)] = 1;
  }
  for (const FaceId f : live_) seen[f] = shown[sets.find(f)];
}

// False if it is too early, or there is too much to look at.
bool HiddenFinder::look() {
  if (mesh_.live_faces > most_faces || mesh_.live_faces > looked_again_share * looked_at_) return false;
  looked_at_ = mesh_.live_faces;
  FloatBox box;
  live_.clear();
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    if (!mesh_.faces[f].live) continue;
    live_.push_back(f);
    for (const std::uint32_t p : mesh_.faces[f].point) box.add(mesh_.place[p]);
  }
  Picture picture{mesh_, box};
  if (live_.empty() || !(picture.pixel_m() > 0.0) || picture.pixel_m() > most_pixel_m) return false;
  std::vector<std::uint8_t> seen(mesh_.faces.size(), 0);
  for (int i = 0; i < direction_count; ++i) picture.take(spiral_direction(i, direction_count), live_, seen);
  spread(seen);
  std::fill(group_of_.begin(), group_of_.end(), none);
  for (const FaceId f : live_) group_of_[f] = seen[f] != 0 ? seen_group : hidden_group;
  groups_.sort(group_of_, 2);
  return true;
}

std::optional<Scrap> HiddenFinder::measure(FaceId f, double price) const {
  const Face& face = mesh_.faces[f];
  const std::array<glm::dvec3, 3> p{mesh_.at(face.point[0]), mesh_.at(face.point[1]), mesh_.at(face.point[2])};
  const std::array<glm::dvec3, 7> places{
      p[0], p[1], p[2], 0.5 * (p[0] + p[1]), 0.5 * (p[1] + p[2]), 0.5 * (p[2] + p[0]), (p[0] + p[1] + p[2]) / 3.0};
  const double area_m2 = mesh_.area_m2(face);
  const double limit_m = std::min(most_m, std::sqrt(7.0 * price / std::max(area_m2, 1e-9)));
  std::array<Surroundings::Query, 7> queries;
  std::transform(places.begin(), places.end(), queries.begin(), [&](const glm::dvec3& at) {
    return Surroundings::Query{glm::vec3{at}, limit_m * limit_m};
  });
  around_.nearest(queries, hidden_group);
  Scrap hidden{.faces = {f}};
  double sum = 0.0;
  for (const Surroundings::Query& q : queries) {
    if (q.face == none) return std::nullopt;
    hidden.support.push_back(q.face);
    sum += q.squared_m;
    hidden.error_m = std::max(hidden.error_m, std::sqrt(q.squared_m));
  }
  double deviation_m = 0.0;
  for (const std::uint32_t q : face.point) deviation_m = std::max(deviation_m, double{mesh_.deviation_m[q]});
  hidden.error_m = std::hypot(hidden.error_m, deviation_m);
  hidden.cost = area_m2 * sum / 7.0;
  return hidden.cost <= price ? std::optional{std::move(hidden)} : std::nullopt;
}

std::vector<Scrap> HiddenFinder::find(double price) {
  if (price < least_price || furnished_ || !look()) return {};
  furnished_ = static_cast<double>(groups_[hidden_group].size()) > furnished_share * static_cast<double>(live_.size());
  if (furnished_) return {};
  around_.update(groups_, group_of_);
  std::vector<Scrap> found;
  for (const FaceId f : groups_[hidden_group]) {
    if (auto hidden = measure(f, price)) found.push_back(std::move(*hidden));
  }
  std::stable_sort(found.begin(), found.end(), [](const Scrap& a, const Scrap& b) { return a.cost < b.cost; });
  return found;
}

}  // namespace lodestone::facets

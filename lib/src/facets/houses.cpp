// SPDX-License-Identifier: MIT
#include "facets/houses.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "facets/parts.h"

namespace lodestone::facets {
namespace {

constexpr double cell_m = 0.5;
constexpr double least_box_m2 = 12.0;     // of the box around it, seen from above
constexpr double least_house_m = 2.0;     // high
constexpr double least_ground_m2 = 30.0;  // that it covers: less is a shed or a kiosk
constexpr double least_overlap = 0.5;     // of a part, over what covers it
constexpr double most_cells = 4e6;

std::vector<std::uint32_t> houses_by_feature(const Mesh& source, std::uint32_t& count) {
  std::vector<std::uint32_t> house_of_feature(source.features.size(), none);
  count = 0;
  for (FeatureId f = 0; f < source.features.size(); ++f) {
    FeatureId root = f;
    for (std::size_t i = 0; i < source.features.size() && source.features[root].parent < source.features.size(); ++i) {
      root = source.features[root].parent;
    }
    if (source.features[root].semantic_class != "Building") continue;
    if (house_of_feature[root] == none) house_of_feature[root] = count++;
    house_of_feature[f] = house_of_feature[root];
  }
  return house_of_feature;
}

// Parts that hang together by points, each with the box around it.
struct Site {
  std::vector<std::uint32_t> part_of_face;
  std::vector<Box> boxes;
};

Site survey(const FacetMesh& mesh) {
  Site site;
  site.boxes.resize(split_by_points(mesh, site.part_of_face));
  for (FaceId f = 0; f < mesh.faces.size(); ++f) {
    if (site.part_of_face[f] == none) continue;
    for (const std::uint32_t p : mesh.faces[f].point) site.boxes[site.part_of_face[f]].add(mesh.at(p));
  }
  return site;
}

// Which cells of the ground lie under what.
class Ground {
 public:
  Ground(const FacetMesh& mesh, const Site& site) : mesh_(mesh), site_(site) {
    Box box;
    for (const Box& b : site.boxes) {
      box.add(b.min);
      box.add(b.max);
    }
    low_ = {box.min.x, box.min.y};
    const glm::dvec2 size{box.max.x - box.min.x, box.max.y - box.min.y};
    step_m_ = std::max(cell_m, std::sqrt(size.x * size.y / most_cells));
    columns_ = static_cast<std::size_t>(size.x / step_m_) + 1;
    rows_ = static_cast<std::size_t>(size.y / step_m_) + 1;
  }

  // Under each of these parts, ascending.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> cells_of(const std::vector<std::uint32_t>& parts) const {
    std::vector<std::uint32_t> place(site_.boxes.size(), none);
    for (std::uint32_t i = 0; i < parts.size(); ++i) place[parts[i]] = i;
    std::vector<std::vector<std::uint32_t>> cells(parts.size());
    for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
      const std::uint32_t part = site_.part_of_face[f];
      if (part != none && place[part] != none) cover(mesh_.faces[f], cells[place[part]]);
    }
    for (auto& of_part : cells) {
      std::sort(of_part.begin(), of_part.end());
      of_part.erase(std::unique(of_part.begin(), of_part.end()), of_part.end());
    }
    return cells;
  }
  [[nodiscard]] std::uint32_t cell_at(const glm::dvec2& p) const {
    const auto index = [&](double at, double low, std::size_t count) {
      return std::min(static_cast<std::size_t>(std::max(0.0, (at - low) / step_m_)), count - 1);
    };
    return static_cast<std::uint32_t>(index(p.y, low_.y, rows_) * columns_ + index(p.x, low_.x, columns_));
  }
  [[nodiscard]] double cell_m2() const noexcept { return step_m_ * step_m_; }
  [[nodiscard]] std::size_t cell_count() const noexcept { return columns_ * rows_; }

 private:
  // Walls are lines from above, so edges are walked along as well.
  void cover(const Face& face, std::vector<std::uint32_t>& cells) const {
    std::array<glm::dvec2, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = glm::dvec2{mesh_.at(face.point[k])};
    const double size_m = std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[1]), glm::length(p[0] - p[2])});
    const int steps = static_cast<int>(size_m / (0.7 * step_m_)) + 1;
    for (int i = 0; i <= steps; ++i) {
      const glm::dvec2 a = glm::mix(p[0], p[1], double(i) / steps);
      const glm::dvec2 b = glm::mix(p[0], p[2], double(i) / steps);
      const int across = static_cast<int>(glm::length(b - a) / (0.7 * step_m_)) + 1;
      for (int j = 0; j <= across; ++j) cells.push_back(cell_at(glm::mix(a, b, double(j) / across)));
    }
  }

  const FacetMesh& mesh_;
  const Site& site_;
  glm::dvec2 low_{0.0};
  double step_m_ = cell_m;
  std::size_t columns_ = 1, rows_ = 1;
};

// House by part, over the ground.
std::vector<std::uint32_t> houses_by_ground(const FacetMesh& mesh, const Site& site, std::uint32_t& count) {
  std::vector<std::uint32_t> large;
  for (std::uint32_t i = 0; i < site.boxes.size(); ++i) {
    const glm::dvec3 size = site.boxes[i].size();
    if (size.x * size.y >= least_box_m2) large.push_back(i);
  }
  std::vector<std::uint32_t> house_of_part(site.boxes.size(), none);
  count = 0;
  if (large.size() < 2) return house_of_part;
  const Ground ground{mesh, site};
  const auto cells = ground.cells_of(large);
  std::vector<float> lowest(ground.cell_count(), std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < large.size(); ++i) {
    for (const std::uint32_t c : cells[i]) lowest[c] = std::min(lowest[c], float(site.boxes[large[i]].min.z));
  }
  std::vector<std::uint32_t> order(large.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return cells[a].size() > cells[b].size(); });
  std::vector<std::uint32_t> house_of_cell(ground.cell_count(), none);
  std::vector<std::size_t> size;  // per house, cells
  for (const std::uint32_t i : order) {
    float floor_m = std::numeric_limits<float>::infinity();
    for (const std::uint32_t c : cells[i]) floor_m = std::min(floor_m, lowest[c]);
    if (site.boxes[large[i]].max.z - floor_m < least_house_m) continue;  // a pavement, a lawn
    std::vector<std::size_t> under(size.size(), 0);
    for (const std::uint32_t c : cells[i]) {
      if (house_of_cell[c] != none) ++under[house_of_cell[c]];
    }
    const auto most = std::max_element(under.begin(), under.end());
    std::uint32_t house = static_cast<std::uint32_t>(most - under.begin());
    if (most == under.end() || double(*most) < least_overlap * double(cells[i].size())) {
      house = static_cast<std::uint32_t>(size.size());
      size.push_back(0);
    }
    house_of_part[large[i]] = house;
    for (const std::uint32_t c : cells[i]) {
      if (house_of_cell[c] != none) continue;
      house_of_cell[c] = house;
      ++size[house];
    }
  }
  // What is small is no house of its own.
  std::vector<std::uint32_t> name(size.size(), none);
  for (std::size_t h = 0; h < size.size(); ++h) {
    if (double(size[h]) * ground.cell_m2() >= least_ground_m2) name[h] = count++;
  }
  std::vector<std::uint8_t> is_large(site.boxes.size(), 0);
  for (const std::uint32_t i : large) is_large[i] = 1;
  for (std::uint32_t i = 0; i < site.boxes.size(); ++i) {
    if (is_large[i] == 0) {
      const glm::dvec3 middle = 0.5 * (site.boxes[i].min + site.boxes[i].max);
      house_of_part[i] = house_of_cell[ground.cell_at({middle.x, middle.y})];
    }
    if (house_of_part[i] != none) house_of_part[i] = name[house_of_part[i]];
  }
  return house_of_part;
}

}  // namespace

Houses tell_houses(const FacetMesh& mesh) {
  Houses houses;
  const Mesh& source = *mesh.source;
  houses.house_of_face.assign(mesh.faces.size(), 0);
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> of_feature = houses_by_feature(source, count);
  if (count > 1 && !source.face_features.empty()) {
    houses.count = count;
    for (FaceId f = 0; f < mesh.faces.size(); ++f) {
      const FeatureId feature = source.face_features[f];
      houses.house_of_face[f] = feature < of_feature.size() ? of_feature[feature] : none;
    }
    return houses;
  }
  const Site site = survey(mesh);
  const std::vector<std::uint32_t> of_part = houses_by_ground(mesh, site, count);
  if (count < 2) return houses;
  houses.count = count;
  for (FaceId f = 0; f < mesh.faces.size(); ++f) {
    const std::uint32_t part = site.part_of_face[f];
    houses.house_of_face[f] = part == none ? none : of_part[part];
  }
  return houses;
}

}  // namespace lodestone::facets

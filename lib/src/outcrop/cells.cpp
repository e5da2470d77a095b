// SPDX-License-Identifier: MIT
// Based on: Ao et al. 2025, section 3.2.1 (quadtree in texture space, equation 1) and 3.5.1 (grid along the major
// axis). Differs: a cell much above the threshold is cut once more than equation 1 says, because data is not spread
// evenly; images whose quadtree would tear space apart are halved in space instead, twice per level, across the longest
// side. The grid over the sub-models goes on upwards until one root is left, so that there is a first picture of the
// whole.
#include "outcrop/cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "mesh/weld.h"

namespace lodestone::outcrop {
namespace {

constexpr std::uint32_t least_faces = 128;  // a cell with fewer is never cut
constexpr int most_depth = 10;
constexpr double worth_a_cut = 2.0;   // of the threshold: cells above it are cut beyond equation 1
constexpr double spread_limit = 0.5;  // Space is taken where its tiles spread less than this share of Texture's

using Faces = std::vector<FaceId>;
using Groups = std::vector<Faces>;

struct Measure {
  Box box;
  double geometry = 0.0, texture = 0.0;  // bytes
};

class CellMaker {
 public:
  CellMaker(const Mesh& mesh, Segmentation& segmentation, const ByteModel& bytes)
      : mesh_(mesh), segmentation_(segmentation), bytes_(bytes) {}

  CellTree make(TileSplit split);

 private:
  [[nodiscard]] glm::dvec3 middle(FaceId f) const {
    const VertexId* v = &mesh_.indices[3 * std::size_t{f}];
    const auto& p = mesh_.vertices.positions;
    return (glm::dvec3{p[v[0]]} + glm::dvec3{p[v[1]]} + glm::dvec3{p[v[2]]}) / 3.0;
  }
  [[nodiscard]] glm::dvec2 middle_px(FaceId f) const {
    const VertexId* v = &mesh_.indices[3 * std::size_t{f}];
    glm::dvec2 sum{0.0};
    for (int k = 0; k < 3; ++k) sum += to_pixels(mesh_.vertices.uvs[v[k]], segmentation_.image_px[segment_]);
    const OutcropSegment& s = segmentation_.segments[segment_];
    return (sum / 3.0 - glm::dvec2{s.left_px, s.top_px}) / glm::dvec2{s.width_px, s.height_px};
  }
  [[nodiscard]] bool any_area(const Faces& faces) const;
  void pour_flat(Groups& groups) const;
  void house_flat_segments();
  [[nodiscard]] double texels(FaceId f) const;
  [[nodiscard]] Measure measure(const Faces& faces) const;
  [[nodiscard]] Groups quarters_of_image(const Faces& faces, const glm::dvec2& low, double size) const;
  [[nodiscard]] Groups quarters_of_space(const Faces& faces) const;
  [[nodiscard]] std::array<Faces, 2> halves(const Faces& faces) const;
  [[nodiscard]] int depth_of_equation_1(const Measure& whole) const;
  [[nodiscard]] double spread(TileSplit split, int depth) const;
  std::uint32_t add(std::vector<std::uint32_t> children);
  std::uint32_t make_cell(const Faces& faces, TileSplit split, int depth, const glm::dvec2& low, double size);
  std::uint32_t join(std::vector<std::pair<glm::dvec3, std::uint32_t>> parts);

  const Mesh& mesh_;
  Segmentation& segmentation_;
  const ByteModel& bytes_;
  CellTree tree_;
  std::uint32_t segment_ = 0;  // at hand
  int depth_wanted_ = 0;
};

double CellMaker::texels(FaceId f) const {
  const VertexId* v = &mesh_.indices[3 * std::size_t{f}];
  const glm::uvec2 size = segmentation_.image_px[segment_];
  const auto px = [&](int k) { return to_pixels(mesh_.vertices.uvs[v[k]], size); };
  return area_px2(px(0), px(1), px(2));
}

bool CellMaker::any_area(const Faces& faces) const {
  return std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return area_vector(mesh_, f) != glm::dvec3{0.0}; });
}

// Faces without area are in no coarser level: a cell of such alone would be a tile without content there.
void CellMaker::pour_flat(Groups& groups) const {
  const auto home = std::find_if(groups.begin(), groups.end(), [&](const Faces& group) { return any_area(group); });
  for (Faces& group : groups) {
    if (home == groups.end() || group.empty() || any_area(group)) continue;
    home->insert(home->end(), group.begin(), group.end());
    std::sort(home->begin(), home->end());
    group.clear();
  }
}

// Faces of images that nothing with an area shows lie in the cell of the first face that has one.
void CellMaker::house_flat_segments() {
  FaceId first = 0;
  while (tree_.leaf_of_face[first] == none || !any_area({first})) ++first;
  const std::uint32_t home = tree_.leaf_of_face[first];
  std::replace(tree_.leaf_of_face.begin(), tree_.leaf_of_face.end(), none, home);
}

Measure CellMaker::measure(const Faces& faces) const {
  Measure result;
  const bool textured = segmentation_.segments[segment_].texture != none;
  for (const FaceId f : faces) {
    result.box.add(middle(f));
    if (textured) result.texture += texels(f) * bytes_.per_texel[segment_];
  }
  result.geometry = static_cast<double>(faces.size()) * bytes_.per_triangle;
  return result;
}

// n - 1 of equation 1, the larger of what geometry and texture ask for.
int CellMaker::depth_of_equation_1(const Measure& whole) const {
  const auto cuts = [](double bytes, double aim) {
    return aim > 0.0 && bytes > aim ? static_cast<int>(std::ceil(std::log2(bytes / aim) / 2.0 - 1e-9)) : 0;
  };
  return std::min(most_depth,
                  std::max(cuts(whole.geometry, bytes_.tile_geometry), cuts(whole.texture, bytes_.tile_texture)));
}

Groups CellMaker::quarters_of_image(const Faces& faces, const glm::dvec2& low, double size) const {
  Groups quarters(4);
  const glm::dvec2 cut = low + 0.5 * size;
  for (const FaceId f : faces) {
    const glm::dvec2 at = middle_px(f);
    quarters[(at.x >= cut.x ? 1U : 0U) + (at.y >= cut.y ? 2U : 0U)].push_back(f);
  }
  return quarters;
}

// At the median across the longest side.
std::array<Faces, 2> CellMaker::halves(const Faces& faces) const {
  std::array<Faces, 2> result;
  if (faces.size() < 2) {
    result[0] = faces;
    return result;
  }
  const glm::dvec3 size = measure(faces).box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  std::vector<std::pair<double, FaceId>> order;
  order.reserve(faces.size());
  for (const FaceId f : faces) order.emplace_back(middle(f)[axis], f);
  const auto half = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  std::nth_element(order.begin(), half, order.end());
  for (auto at = order.begin(); at != order.end(); ++at) result[at < half ? 0 : 1].push_back(at->second);
  for (Faces& side : result) std::sort(side.begin(), side.end());
  return result;
}

Groups CellMaker::quarters_of_space(const Faces& faces) const {
  Groups quarters;
  for (const Faces& half : halves(faces)) {
    for (Faces& quarter : halves(half)) quarters.push_back(std::move(quarter));
  }
  return quarters;
}

// Sum of the squared diagonals of the tiles at a depth: how much space they lay claim to.
double CellMaker::spread(TileSplit split, int depth) const {
  struct Part {
    Faces faces;
    glm::dvec2 low;
    double size;
  };
  std::vector<Part> parts{{segmentation_.faces[segment_], glm::dvec2{0.0}, 1.0}};
  for (int d = 0; d < depth; ++d) {
    std::vector<Part> next;
    for (const Part& part : parts) {
      const Groups groups = split == TileSplit::Space ? quarters_of_space(part.faces)
                                                      : quarters_of_image(part.faces, part.low, part.size);
      for (std::size_t q = 0; q < groups.size(); ++q) {
        if (groups[q].empty()) continue;
        const glm::dvec2 corner{static_cast<double>(q & 1U), static_cast<double>(q >> 1U)};
        next.push_back({groups[q], part.low + corner * (0.5 * part.size), 0.5 * part.size});
      }
    }
    parts.swap(next);
  }
  double sum = 0.0;
  for (const Part& part : parts) {
    const double diagonal = measure(part.faces).box.diagonal_m();
    sum += diagonal * diagonal;
  }
  return sum;
}

std::uint32_t CellMaker::add(std::vector<std::uint32_t> children) {
  const auto id = static_cast<std::uint32_t>(tree_.cells.size());
  for (const std::uint32_t child : children) tree_.cells[child].parent = id;
  tree_.cells.push_back({std::move(children), none});
  return id;
}

std::uint32_t CellMaker::make_cell(const Faces& faces, TileSplit split, int depth, const glm::dvec2& low, double size) {
  const Measure here = measure(faces);
  const bool heavy =
      here.geometry > worth_a_cut * bytes_.tile_geometry || here.texture > worth_a_cut * bytes_.tile_texture;
  if (faces.size() < least_faces || depth >= most_depth || (depth >= depth_wanted_ && !heavy)) {
    const std::uint32_t leaf = add({});
    for (const FaceId f : faces) tree_.leaf_of_face[f] = leaf;
    return leaf;
  }
  Groups groups = split == TileSplit::Space ? quarters_of_space(faces) : quarters_of_image(faces, low, size);
  pour_flat(groups);
  std::vector<std::uint32_t> children;
  for (std::size_t q = 0; q < groups.size(); ++q) {
    if (groups[q].empty()) continue;
    const glm::dvec2 corner{static_cast<double>(q & 1U), static_cast<double>(q >> 1U)};
    children.push_back(make_cell(groups[q], split, depth + 1, low + corner * (0.5 * size), 0.5 * size));
  }
  return children.size() == 1 ? children.front() : add(std::move(children));
}

// Regular cells along the longer axis of what there is, four to a parent.
std::uint32_t CellMaker::join(std::vector<std::pair<glm::dvec3, std::uint32_t>> parts) {
  if (parts.size() == 1) return parts.front().second;
  constexpr std::size_t most_children = 4;
  std::vector<std::uint32_t> children;
  if (parts.size() <= most_children) {
    for (const auto& part : parts) children.push_back(part.second);
    return add(std::move(children));
  }
  Box box;
  for (const auto& part : parts) box.add(part.first);
  const glm::dvec3 size = box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  std::array<std::vector<std::pair<glm::dvec3, std::uint32_t>>, most_children> slots;
  for (const auto& part : parts) {
    const double share = size[axis] > 0.0 ? (part.first[axis] - box.min[axis]) / size[axis] : 0.0;
    slots[std::min(most_children - 1, static_cast<std::size_t>(share * most_children))].push_back(part);
  }
  const auto crowded = [&](const auto& slot) { return slot.size() == parts.size(); };
  if (std::any_of(slots.begin(), slots.end(), crowded)) {  // all in one place
    for (auto& slot : slots) slot.clear();
    for (std::size_t i = 0; i < parts.size(); ++i) slots[i * most_children / parts.size()].push_back(parts[i]);
  }
  for (auto& slot : slots) {
    if (!slot.empty()) children.push_back(join(std::move(slot)));
  }
  return add(std::move(children));
}

CellTree CellMaker::make(TileSplit split) {
  tree_.leaf_of_face.assign(mesh_.triangle_count(), none);
  std::vector<std::pair<glm::dvec3, std::uint32_t>> roots;
  for (segment_ = 0; segment_ < segmentation_.segments.size(); ++segment_) {
    OutcropSegment& segment = segmentation_.segments[segment_];
    const Faces& faces = segmentation_.faces[segment_];
    if (!any_area(faces)) {
      segment.split = TileSplit::Texture;
      continue;
    }
    const Measure whole = measure(faces);
    depth_wanted_ = depth_of_equation_1(whole);
    segment.split = segment.texture == none ? TileSplit::Space : split;
    if (segment.split == TileSplit::Auto) {
      const int depth = std::max(1, depth_wanted_);
      const bool torn = spread(TileSplit::Space, depth) < spread_limit * spread(TileSplit::Texture, depth);
      segment.split = torn ? TileSplit::Space : TileSplit::Texture;
    }
    roots.emplace_back(whole.box.center(), make_cell(faces, segment.split, 0, glm::dvec2{0.0}, 1.0));
  }
  join(std::move(roots));
  house_flat_segments();
  return std::move(tree_);
}

}  // namespace

CellTree make_cells(const Mesh& mesh, Segmentation& segmentation, const ByteModel& bytes, TileSplit split) {
  return CellMaker{mesh, segmentation, bytes}.make(split);
}

}  // namespace lodestone::outcrop

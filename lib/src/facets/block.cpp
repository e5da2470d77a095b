// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019, section 2.1 (the overall shape of a building is that of its footprint and roof); the prism
// is what CityGML 2.0 calls LoD1.
#include "facets/block.h"

#include <lodestone/polygon.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "facets/footprint.h"
#include "facets/outline.h"
#include "geometry/bvh.h"
#include "mesh/sampling.h"
#include "mesh/weld.h"

namespace lodestone::facets {
namespace {

constexpr std::uint32_t most_corners = 8;
constexpr double least_step_gain = 0.9;     // of the error of the prism: with no less a step is not worth its faces
constexpr double under_roof_m = 0.3;        // a roof may lie so far below the top of the block
constexpr double most_street_share = 0.03;  // of the faces, for several prisms: a house and its shed become one
constexpr std::uint32_t samples = 8192;     // of either surface, beside the corners
constexpr double least_face_share = 1e-5;   // of the area: smaller faces are not needed to find the nearest
constexpr double facing_cosine = 0.7;
constexpr double upright_sine = 0.01;
constexpr double least_fabric_share = 0.15;  // of the area of all walls, or of all roofs
constexpr std::uint32_t spare_faces = 2;     // one record may take as many

// What a face of the material counts: glass only where there is nothing else.
double see_through(const Mesh& mesh, MaterialId m) { return mesh.materials[m].transparent() ? 1e-6 : 1.0; }

Mesh mesh_of(const std::vector<glm::vec3>& corners, const std::vector<VertexId>& indices) {
  Mesh mesh;
  mesh.materials.emplace_back();
  mesh.vertices.positions = corners;
  mesh.indices = indices;
  return mesh;
}

// Of the faces that matter, which are few: distances to them are too large if anything.
TriangleBvh coarse_tree(const Mesh& mesh, double area) {
  std::vector<VertexId> indices;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    if (0.5 * glm::length(area_vector(mesh, f)) < least_face_share * area) continue;
    const auto at = mesh.indices.begin() + 3 * std::ptrdiff_t{f};
    indices.insert(indices.end(), at, at + 3);
  }
  return TriangleBvh{mesh.vertices.positions, indices};
}

double farthest_m(std::span<const glm::vec3> corners, const SurfaceSampler& sampler, const TriangleBvh& tree) {
  double farthest = 0.0;
  std::uint32_t hint = none;
  for (const glm::vec3& corner : corners) {
    const auto nearest = tree.nearest(glm::dvec3{corner}, hint);
    hint = nearest.slot;
    farthest = std::max(farthest, nearest.squared_distance);
  }
  for (std::uint32_t i = 0; i < samples; ++i) {
    const auto nearest = tree.nearest(sampler.sample(i, samples, 1).position, hint);
    hint = nearest.slot;
    farthest = std::max(farthest, nearest.squared_distance);
  }
  return std::sqrt(farthest);
}

// The footprint of one house of several, from its own faces.
Footprint footprint_of(const FacetMesh& mesh, const Houses& houses, std::uint32_t house) {
  const Mesh& source = *mesh.source;
  Mesh part;
  part.materials.emplace_back();
  CharacteristicSurfaces found;
  std::vector<std::uint32_t> surface_of(mesh.surfaces.surfaces.size(), none);
  for (FaceId f = 0; f < mesh.faces.size(); ++f) {
    if (houses.house_of_face[f] != house || !mesh.faces[f].live) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      part.indices.push_back(part.vertex_count());
      part.vertices.positions.push_back(source.vertices.positions[mesh.faces[f].vertex[k]]);
    }
    std::uint32_t& surface = surface_of[mesh.faces[f].surface];
    if (surface == none) {
      surface = static_cast<std::uint32_t>(found.surfaces.size());
      found.surfaces.push_back(mesh.surfaces.surfaces[mesh.faces[f].surface]);
      found.surfaces.back().area_m2 = 0.0;
      found.surfaces.back().face_count = 0;
    }
    found.surface_of_face.push_back(surface);
    found.surfaces[surface].area_m2 += mesh.area_m2(mesh.faces[f]);
    ++found.surfaces[surface].face_count;
  }
  if (part.indices.empty()) return {.sentence = "there is nothing of it"};
  return find_footprint(part, found, most_corners);
}

}  // namespace

Block::Block(const FacetMesh& mesh) : houses_(tell_houses(mesh)) {
  if (houses_.count > 1) {
    for (std::uint32_t house = 0; house < houses_.count; ++house) {
      const Footprint footprint = footprint_of(mesh, houses_, house);
      if (footprint.sentence.empty()) add_prism(footprint, house);
    }
  }
  if (triangles_.empty() || face_count() > most_street_share * mesh.live_faces) {
    houses_ = {1, std::vector<std::uint32_t>(mesh.faces.size(), 0)};
    corners_.clear();
    triangles_.clear();
    footprint_ = find_footprint(*mesh.source, mesh.surfaces, most_corners);
    sentence_ = footprint_.sentence;
    if (!sentence_.empty()) return;
    add_prism(footprint_, 0);
    lowest_roof_m_ = footprint_.high_m;
  }
  measure(mesh);
  choose_materials(mesh);
}

Block::Block(const FacetMesh& mesh, const Block& prism) : houses_{1, {}} {
  if (!prism.exists() || prism.houses_.count > 1) return;
  const auto shape = find_step(*mesh.source, mesh.surfaces, prism.footprint_);
  if (!shape) return;
  houses_ = prism.houses_;
  add_stepped(*shape);
  measure(mesh);
  if (error_m_ > least_step_gain * prism.error_m_) triangles_.clear();
  if (exists()) choose_materials(mesh);
}

void Block::add_stepped(const SteppedShape& shape) {
  for (const glm::dvec3& c : shape.corners) corners_.emplace_back(c);
  lowest_roof_m_ = std::numeric_limits<double>::infinity();
  std::uint32_t sides = 2;
  for (const SteppedFacet& facet : shape.facets) {
    std::vector<glm::dvec3> points;
    for (const std::uint32_t c : facet.corners) points.push_back(shape.corners[c]);
    const bool bottom = facet.kind == SteppedFacet::Kind::Bottom;
    const bool top = facet.kind == SteppedFacet::Kind::Top;
    if (top) lowest_roof_m_ = std::min(lowest_roof_m_, points.front().z);
    const std::uint32_t name = bottom ? 0 : top ? 1 : sides++;
    for (const auto& t : triangulate_polygon(points, facet.loop_ends)) {
      const std::array<std::uint32_t, 3> c{facet.corners[t[0]], facet.corners[t[1]], facet.corners[t[2]]};
      triangles_.push_back({bottom ? std::array{c[0], c[2], c[1]} : c, name, 0});
    }
  }
}

void Block::add_prism(const Footprint& footprint, std::uint32_t house) {
  const auto low = static_cast<std::uint32_t>(corners_.size());
  const std::uint32_t n = footprint.corner_count();
  const std::uint32_t high = low + n;
  std::vector<glm::dvec3> flat;
  for (const double z : {footprint.low_m, footprint.high_m}) {
    for (const glm::dvec2& c : footprint.corners) corners_.emplace_back(c.x, c.y, z);
  }
  for (const glm::dvec2& c : footprint.corners) flat.emplace_back(c.x, c.y, 0.0);
  for (const auto& t : triangulate_polygon(flat, footprint.loop_ends)) {
    triangles_.push_back({{low + t[0], low + t[2], low + t[1]}, 0, house});
    triangles_.push_back({{high + t[0], high + t[1], high + t[2]}, 1, house});
  }
  std::uint32_t facet = 2;
  std::uint32_t first = 0;
  for (const std::uint32_t end : footprint.loop_ends) {
    for (std::uint32_t i = first; i < end; ++i, ++facet) {
      const std::uint32_t j = i + 1 == end ? first : i + 1;
      triangles_.push_back({{low + i, low + j, high + j}, facet, house});
      triangles_.push_back({{low + i, high + j, high + i}, facet, house});
    }
    first = end;
  }
}

namespace {

double highest_m(const FacetMesh& mesh, const Face& face) {
  return std::max({mesh.at(face.point[0]).z, mesh.at(face.point[1]).z, mesh.at(face.point[2]).z});
}

}  // namespace

// No glass.
void Block::choose_materials(const FacetMesh& mesh) {
  std::vector<double> walls(mesh.source->materials.size(), 0.0);
  std::vector<double> roofs(walls.size(), 0.0);
  for (const Face& face : mesh.faces) {
    if (!face.live) continue;
    const MaterialId material = mesh.source->face_material(static_cast<FaceId>(&face - mesh.faces.data()));
    const double area = glm::length(mesh.area_vector(face)) * see_through(*mesh.source, material);
    if (face.normal.z < 1.0 - facing_cosine) {
      walls[material] += area * (1.0 - std::abs(face.normal.z));
    } else if (houses_.count > 1 || highest_m(mesh, face) > lowest_roof_m_ - under_roof_m) {
      // Floors and the ground are no roof.
      roofs[material] += area;
    }
  }
  const auto choose = [&](const std::vector<double>& areas, Fabric& fabric) {
    const double whole = std::accumulate(areas.begin(), areas.end(), 0.0);
    for (const double area : areas) fabric.has.push_back(area >= least_fabric_share * whole ? 1 : 0);
    if (fabric.left(mesh) < fabric.least_faces + spare_faces) fabric.least_faces = 0;
  };
  for (const Triangle& t : triangles_) {
    walls_.least_faces += t.facet > 1 ? 1 : 0;
    roofs_.least_faces += t.facet == 1 ? 1 : 0;
  }
  choose(walls, walls_);
  choose(roofs, roofs_);
  if (walls_.has == roofs_.has) walls_.least_faces += roofs_.least_faces;
}

std::uint32_t Block::Fabric::left(const FacetMesh& mesh) const noexcept {
  std::uint32_t count = 0;
  for (MaterialId m = 0; m < has.size(); ++m) count += has[m] != 0 ? mesh.live_of_material[m] : 0;
  return count;
}

bool Block::must_come(const FacetMesh& mesh) const noexcept {
  return exists() && (mesh.live_faces <= face_count() + spare_faces || walls_.left(mesh) < walls_.least_faces ||
                      roofs_.left(mesh) < roofs_.least_faces);
}

bool Block::needs(const FacetMesh& mesh, std::span<const FaceId> faces) const noexcept {
  const auto lacks = [&](const Fabric& fabric) {
    const auto going = std::count_if(faces.begin(), faces.end(),
                                     [&](FaceId f) { return fabric.has[mesh.source->face_material(f)] != 0; });
    return going > 0 && fabric.left(mesh) < fabric.least_faces + static_cast<std::uint32_t>(going);
  };
  return exists() && (mesh.live_faces <= face_count() + faces.size() || lacks(walls_) || lacks(roofs_));
}

void Block::measure(const FacetMesh& mesh) {
  const Mesh& source = *mesh.source;
  std::vector<glm::vec3> corners;
  for (std::uint32_t p = 0; p < mesh.point_count(); ++p) {
    if (!mesh.faces_of[p].empty()) corners.push_back(mesh.place[p]);
  }
  std::vector<VertexId> indices;
  for (const Triangle& t : triangles_) indices.insert(indices.end(), t.corner.begin(), t.corner.end());
  const Mesh prism = mesh_of(corners_, indices);
  const SurfaceSampler of_source{source};
  const SurfaceSampler of_prism{prism};
  const double there_m = farthest_m(corners, of_source, TriangleBvh{prism.vertices.positions, prism.indices});
  const double back_m = farthest_m(corners_, of_prism, coarse_tree(source, of_source.area()));
  // Points may lie off their vertices by the tolerance for welding.
  error_m_ = std::max(there_m, back_m) + (mesh.deviation_m.empty() ? 0.0 : double{mesh.deviation_m.front()});
  if (std::isfinite(error_m_)) return;
  triangles_.clear();
  sentence_ = "its shape cannot be compared with a block";
}

// Finds for each face of the prism one that is there, and for each of its corners a vertex.
class Block::Caster {
 public:
  Caster(const Block& block, const FacetMesh& mesh)
      : block_(block), mesh_(mesh), faces_(block.triangles_.size(), none) {
    for (FaceId f = 0; f < mesh.faces.size(); ++f) {
      if (mesh.faces[f].live) live_.push_back(f);
    }
    for (VertexId v = 0; v < mesh.uses.size(); ++v) {
      if (mesh.uses[v] != 0) free_.push_back(v);
    }
  }

  [[nodiscard]] bool run(Patch& patch) {
    if (live_.size() <= block_.triangles_.size() || !name_wedges()) return false;
    choose_faces();
    choose_vertices();
    write(patch);
    return true;
  }

 private:
  // The same corner of two facets has two vertices, unless these are rare and nothing tells the facets apart.
  [[nodiscard]] bool name_wedges() {
    const auto count = [&](bool shared) {
      wedge_of_.clear();
      for (const Triangle& t : block_.triangles_) {
        for (const std::uint32_t c : t.corner) {
          wedge_of_.emplace(std::pair{shared ? 0 : t.facet, c}, static_cast<std::uint32_t>(wedge_of_.size()));
        }
      }
      shared_ = shared;
      return wedge_of_.size();
    };
    return count(false) <= free_.size() || (mesh_.values.normals.empty() && count(true) <= free_.size());
  }
  [[nodiscard]] std::uint32_t wedge(const Triangle& t, std::size_t k) const {
    return wedge_of_.at({shared_ ? 0 : t.facet, t.corner[k]});
  }
  [[nodiscard]] glm::dvec3 normal_of(const Triangle& t) const {
    const auto at = [&](std::size_t k) { return glm::dvec3{block_.corners_[t.corner[k]]}; };
    return glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
  }
  [[nodiscard]] double area_of(FaceId f) const { return glm::length(mesh_.area_vector(mesh_.faces[f])); }

  // How well a face can stand for one of a house that faces along `normal`.
  [[nodiscard]] double worth(FaceId f, const glm::dvec3& normal, std::uint32_t house) const {
    const glm::dvec3& own = mesh_.faces[f].normal;
    const bool faces_there = glm::dot(own, normal) > facing_cosine;
    const bool upright = std::abs(own.z) < facing_cosine;
    const bool alike = upright == (std::abs(normal.z) < facing_cosine);
    const double at_home = block_.houses_.house_of_face[f] == house ? 1.0 : 1e-6;
    return area_of(f) * (faces_there ? 1.0 : alike ? 0.1 : 1e-3) * at_home;
  }

  // The best material for a facet that is left on enough faces, `none` if there is none.
  [[nodiscard]] MaterialId material_of(const Triangle& facet, const glm::dvec3& normal, std::size_t least_faces) const {
    std::vector<double> worths(mesh_.source->materials.size(), 0.0);
    std::vector<std::size_t> counts(worths.size(), 0);
    for (const FaceId f : live_) {
      const MaterialId material = mesh_.source->face_material(f);
      worths[material] += worth(f, normal, facet.house) * see_through(*mesh_.source, material);
      ++counts[material];
    }
    const Fabric& fabric = facet.facet > 1 ? block_.walls_ : block_.roofs_;
    MaterialId best = none;
    for (MaterialId m = 0; m < worths.size(); ++m) {
      if (facet.facet != 0 && block_.houses_.count == 1 && fabric.has[m] != 0) worths[m] *= 1e6;
      if (counts[m] >= least_faces && (best == none || worths[m] > worths[best])) best = m;
    }
    return best;
  }

  // A facet is of one material if possible. The bottom chooses last: it is seldom seen.
  void choose_faces() {
    using Facet = std::pair<std::uint32_t, std::uint32_t>;  // and its house
    std::map<Facet, std::vector<std::size_t>, std::greater<>> facets;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      facets[{block_.triangles_[i].facet, block_.triangles_[i].house}].push_back(i);
    }
    for (const auto& [name, triangles] : facets) {
      const Triangle& facet = block_.triangles_[triangles[0]];
      const glm::dvec3 normal = normal_of(facet);
      const MaterialId material = material_of(facet, normal, triangles.size());
      const auto rank = [&](FaceId f) {
        return std::pair{mesh_.source->face_material(f) == material, worth(f, normal, facet.house)};
      };
      for (const std::size_t i : triangles) {
        const auto best =
            std::max_element(live_.begin(), live_.end(), [&](FaceId a, FaceId b) { return rank(a) < rank(b); });
        faces_[i] = *best;
        live_.erase(best);
      }
    }
  }

  // Vertices of the faces chosen for a facet, nearest first, or any others.
  void choose_vertices() {
    vertices_.assign(wedge_of_.size(), none);
    const auto take_nearest = [&](const glm::dvec3& to, auto wanted) {
      VertexId best = none;
      double best_way = std::numeric_limits<double>::infinity();
      for (const VertexId v : free_) {
        const glm::dvec3 way = glm::dvec3{mesh_.values.positions[v]} - to;
        if (!wanted(v) || glm::dot(way, way) >= best_way) continue;
        best = v;
        best_way = glm::dot(way, way);
      }
      if (best != none) std::erase(free_, best);
      return best;
    };
    for (const bool own : {true, false}) {
      for (std::size_t i = 0; i < faces_.size(); ++i) {
        const Triangle& t = block_.triangles_[i];
        const auto& has = mesh_.faces[faces_[i]].vertex;
        for (std::size_t k = 0; k < 3; ++k) {
          VertexId& vertex = vertices_[wedge(t, k)];
          if (vertex != none) continue;
          vertex = take_nearest(glm::dvec3{block_.corners_[t.corner[k]]},
                                [&](VertexId v) { return !own || std::find(has.begin(), has.end(), v) != has.end(); });
        }
      }
    }
  }

  void write(Patch& patch) const {
    patch.gone = live_;
    patch.surface = mesh_.faces[faces_[0]].surface;
    patch.normal = normal_of(block_.triangles_[0]);
    std::map<std::pair<std::uint32_t, std::uint32_t>, FaceId> map_of;  // per house and facet: whose texture goes on
    std::vector<std::uint8_t> placed(vertices_.size(), 0);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const Triangle& t = block_.triangles_[i];
      const Face& face = mesh_.faces[map_of.try_emplace({t.house, t.facet}, faces_[i]).first->second];
      Redrawn redrawn{.face = faces_[i]};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t w = wedge(t, k);
        redrawn.point[k] = t.corner[k];
        redrawn.vertex[k] = vertices_[w];
        if (std::exchange(placed[w], std::uint8_t{1}) != 0) continue;
        Placed p{.vertex = vertices_[w], .point = t.corner[k]};
        if (!mesh_.values.normals.empty()) p.normal = glm::vec3{normal_of(t)};
        if (!mesh_.values.uvs.empty()) {
          p.uv = extrapolate_uv(mesh_, face, glm::dvec3{block_.corners_[t.corner[k]]});
          if (!std::isfinite(p.uv.x) || !std::isfinite(p.uv.y)) p.uv = mesh_.values.uvs[vertices_[w]];
        }
        patch.placed.push_back(p);
      }
      patch.redrawn.push_back(redrawn);
    }
    for (const VertexId v : free_) {
      const auto way = [&](const Placed& p) {
        const glm::vec3 d = block_.corners_[p.point] - mesh_.values.positions[v];
        return glm::dot(d, d);
      };
      const auto nearest = std::min_element(patch.placed.begin(), patch.placed.end(),
                                            [&](const Placed& a, const Placed& b) { return way(a) < way(b); });
      patch.merged.push_back({v, nearest->vertex});
    }
  }

  const Block& block_;
  const FacetMesh& mesh_;
  std::vector<FaceId> live_, faces_;  // not chosen, and chosen per triangle
  std::vector<VertexId> free_, vertices_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> wedge_of_;  // of facet and corner
  bool shared_ = false;
};

bool Block::apply(FacetMesh& mesh, progressive::EditLog& log) const {
  if (mesh.point_count() < corners_.size()) return false;
  Patch patch;
  if (!Caster{*this, mesh}.run(patch)) return false;
  // Nothing else is left, so that any points may become the corners.
  std::copy(corners_.begin(), corners_.end(), mesh.place.begin());
  facets::apply(mesh, patch, error_m_, log);
  for (const Redrawn& r : patch.redrawn) {
    mesh.faces[r.face].normal = glm::normalize(mesh.area_vector(mesh.faces[r.face]));
  }
  return true;
}

bool is_block(const FacetMesh& mesh) {
  std::vector<FaceId> live;
  for (FaceId f = 0; f < mesh.faces.size(); ++f) {
    if (!mesh.faces[f].live) continue;
    live.push_back(f);
    const glm::dvec3 n = mesh.area_vector(mesh.faces[f]);
    const double slope = std::abs(n.z) / std::max(glm::length(n), 1e-30);
    if (slope > upright_sine && slope < 1.0 - upright_sine) return false;
  }
  return !live.empty() && outline(mesh, live).empty();
}

}  // namespace lodestone::facets

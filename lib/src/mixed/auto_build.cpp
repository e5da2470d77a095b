// SPDX-License-Identifier: MIT
#include <lodestone/auto_build.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/disjoint_sets.h"
#include "collapse/build_log.h"
#include "collapse/engine.h"
#include "facets/build_log.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

// Of a part's area; but a plane is larger than the two triangles that make a facet of a round thing.
constexpr double least_plane_ratio = 1e-4;
constexpr double most_plane_ratio = 0.05;
constexpr double least_plane_triangles = 3.0;

// What is known of the parts that are to be done one way.
struct Share {
  std::uint32_t triangles = 0, parts = 0;
  double area_m2 = 0.0;
  double planar_m2 = 0.0;

  void add(const Share& other) {
    triangles += other.triangles;
    parts += other.parts;
    area_m2 += other.area_m2;
    planar_m2 += other.planar_m2;
  }
  [[nodiscard]] double planar() const { return area_m2 > 0.0 ? planar_m2 / area_m2 : 0.0; }
  [[nodiscard]] std::string percent() const { return std::to_string(std::lround(100.0 * planar())) + " %"; }
};

struct Choice {
  std::vector<std::uint8_t> by_collapse;  // per face
  Share shifted, collapsed;
};

Choice choose(const Mesh& mesh, const AutoBuildOptions& options) {
  const Weld weld = weld_by_position(mesh.vertices.positions);
  DisjointSets sets{weld.point_count()};
  const auto point = [&](std::size_t corner) { return weld.point_of[mesh.indices[corner]]; };
  for (std::size_t c = 0; c < mesh.indices.size(); c += 3) {
    sets.join(point(c), point(c + 1));
    sets.join(point(c), point(c + 2));
  }
  std::vector<Share> parts(weld.point_count());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    Share& part = parts[sets.find(point(3 * std::size_t{f}))];
    part.parts = 1;
    ++part.triangles;
    part.area_m2 += 0.5 * glm::length(area_vector(mesh, f));
  }
  const CharacteristicSurfaces found = characteristic_surfaces(mesh, options.facet_shift.tolerance);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const std::uint32_t s = found.surface_of_face[f];
    Share& part = parts[sets.find(point(3 * std::size_t{f}))];
    const double least = std::clamp(least_plane_triangles / part.triangles, least_plane_ratio, most_plane_ratio);
    if (s == none || found.surfaces[s].area_m2 < least * part.area_m2) continue;
    part.planar_m2 += 0.5 * glm::length(area_vector(mesh, f));
  }
  const double least_triangles = options.least_part_ratio * mesh.triangle_count();
  const auto stands_out = [&](const Share& part) {
    return part.triangles >= least_triangles && part.planar() < options.least_planar_share;
  };
  Choice choice;
  for (const Share& part : parts) (stands_out(part) ? choice.collapsed : choice.shifted).add(part);
  const bool nothing_planar = choice.shifted.planar() < options.least_planar_share;
  if (nothing_planar) choice.collapsed.add(std::exchange(choice.shifted, {}));
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    choice.by_collapse.push_back(nothing_planar || stands_out(parts[sets.find(point(3 * std::size_t{f}))]) ? 1 : 0);
  }
  return choice;
}

std::string reason_of(const Choice& choice) {
  const Share& shifted = choice.shifted;
  const Share& collapsed = choice.collapsed;
  if (collapsed.triangles == 0) {
    return "facet-shift, because " + shifted.percent() + " of the area lies in planes";
  }
  if (shifted.triangles == 0) {
    return "edge-collapse, because " + collapsed.percent() + " of the area lies in planes";
  }
  return "mixed: facet-shift for " + std::to_string(shifted.triangles) + " triangles, because " + shifted.percent() +
         " of their area lies in planes; edge-collapse for " + std::to_string(collapsed.triangles) + " triangles in " +
         std::to_string(collapsed.parts) + " connected part(s), because only " + collapsed.percent() + " does";
}

Mesh faces_of(const Mesh& mesh, const Choice& choice, std::uint8_t by_collapse) {
  Mesh part;
  static_cast<Surroundings&>(part) = mesh;
  std::vector<VertexId> copy(mesh.vertex_count(), none);
  const auto append = [](const auto& from, auto& to, VertexId v) {
    if (!from.empty()) to.push_back(from[v]);
  };
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    if (choice.by_collapse[f] != by_collapse) continue;
    for (std::size_t c = 3 * std::size_t{f}; c < 3 * std::size_t{f} + 3; ++c) {
      const VertexId v = mesh.indices[c];
      if (copy[v] == none) {
        copy[v] = part.vertex_count();
        append(mesh.vertices.positions, part.vertices.positions, v);
        append(mesh.vertices.normals, part.vertices.normals, v);
        append(mesh.vertices.uvs, part.vertices.uvs, v);
        append(mesh.vertices.colors, part.vertices.colors, v);
      }
      part.indices.push_back(copy[v]);
    }
    append(mesh.face_materials, part.face_materials, f);
    append(mesh.face_features, part.face_features, f);
  }
  return part;
}

template <class T>
void append_all(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

// The faces and vertices of `more` follow those of `mesh`.
void append_mesh(const Mesh& more, Mesh& mesh) {
  const VertexId first = mesh.vertex_count();
  append_all(more.vertices.positions, mesh.vertices.positions);
  append_all(more.vertices.normals, mesh.vertices.normals);
  append_all(more.vertices.uvs, mesh.vertices.uvs);
  append_all(more.vertices.colors, mesh.vertices.colors);
  for (const VertexId v : more.indices) mesh.indices.push_back(first + v);
  append_all(more.face_materials, mesh.face_materials);
  append_all(more.face_features, mesh.face_features);
}

Result<AutoBuildResult> build_mixed(const Mesh& mesh, const Choice& choice, const AutoBuildOptions& options,
                                    const Context& context) {
  AutoBuildResult result;
  FacetShiftOptions shift = options.facet_shift;
  EdgeCollapseOptions edges = options.edge_collapse;
  // Where the stack ends is known only when both are merged.
  shift.target_triangles = edges.target_triangles = 0;
  edges.max_error_m = shift.max_error_m;
  Mesh source = faces_of(mesh, choice, 0);
  const Mesh rest = faces_of(mesh, choice, 1);
  progressive::EditLog log = facets::shift_log(source, shift, context, result.facet_shift.emplace());
  const progressive::EditLog other = collapse::collapse_log(rest, edges, context, result.edge_collapse.emplace());
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "building was cancelled", ""};
  log.merge(other, source.triangle_count(), source.vertex_count(),
            source.triangle_count() + rest.triangle_count() -
                std::min(options.facet_shift.target_triangles, source.triangle_count() + rest.triangle_count()));
  append_mesh(rest, source);
  // The block of the one part is no block of the whole.
  result.facet_shift->reached_block = false;
  result.facet_shift->block_sentence = "some parts are not made of planes";
  ModelData data = progressive::record(source, std::move(log), "mixed");
  facets::name_levels(data, false);
  auto model = ProgressiveModel::from_data(std::move(data));
  if (!model.ok()) return model.error();
  result.model = std::move(model).value();
  return result;
}

}  // namespace

Result<AutoBuildResult> build_automatically(const Mesh& mesh, const AutoBuildOptions& options, const Context& context) {
  if (Status status = collapse::check(mesh, options.edge_collapse); !status.ok()) return status.error();
  const Choice choice = choose(mesh, options);
  AutoBuildResult result;
  if (choice.collapsed.triangles == 0) {
    auto built = build_by_facet_shift(mesh, options.facet_shift, context);
    if (!built.ok()) return built.error();
    result.model = built->model;
    result.facet_shift = std::move(built->report);
  } else if (choice.shifted.triangles == 0) {
    EdgeCollapseOptions edges = options.edge_collapse;
    edges.target_triangles = options.facet_shift.target_triangles;
    edges.max_error_m = options.facet_shift.max_error_m;
    auto built = build_by_edge_collapse(mesh, edges, context);
    if (!built.ok()) return built.error();
    result.model = built->model;
    result.edge_collapse = std::move(built->report);
  } else {
    auto built = build_mixed(mesh, choice, options, context);
    if (!built.ok()) return built.error();
    result = std::move(built).value();
  }
  result.reason = reason_of(choice);
  return result;
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
// CGAL's edge collapse under its two costs. CGAL is GPL: it stands in this benchmark only.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "peers.h"
#include "processor_clock.h"

namespace lodestone::peers {
namespace {

namespace Simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Surface surface_of(const Mesh& mesh, std::uint32_t& refused) {
  Surface surface;
  for (const glm::vec3& p : mesh.vertices.positions) surface.add_vertex(Kernel::Point_3(p.x, p.y, p.z));
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto at = [&](std::size_t c) { return Surface::Vertex_index(mesh.indices[i + c]); };
    if (surface.add_face(at(0), at(1), at(2)) == Surface::null_face()) ++refused;
  }
  return surface;
}

Mesh mesh_of(Surface& surface) {
  surface.collect_garbage();
  Mesh mesh;
  mesh.materials.emplace_back();
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    mesh.vertices.positions.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : surface.faces()) {
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) mesh.indices.push_back(v);
  }
  return mesh;
}

// `collapse(surface, stop)`.
template <class Collapse>
Outcome run(const Mesh& mesh, std::uint32_t target_triangles, Collapse&& collapse) {
  Outcome outcome;
  Surface surface = surface_of(mesh, outcome.refused_triangles);
  const double start = thread_seconds();
  // Its end is a number of edges: three for two triangles of a closed mesh.
  const Simplification::Count_stop_predicate<Surface> stop{std::size_t{target_triangles} * 3 / 2};
  collapse(surface, stop);
  outcome.seconds = thread_seconds() - start;
  outcome.mesh = mesh_of(surface);
  return outcome;
}

}  // namespace

Outcome by_garland_heckbert(const Mesh& mesh, std::uint32_t target_triangles) {
  return run(mesh, target_triangles, [](Surface& surface, const auto& stop) {
    using Policies = Simplification::GarlandHeckbert_plane_policies<Surface, Kernel>;
    Policies policies{surface};
    Simplification::edge_collapse(
        surface, stop, CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
  });
}

Outcome by_lindstrom_turk(const Mesh& mesh, std::uint32_t target_triangles) {
  return run(mesh, target_triangles, [](Surface& surface, const auto& stop) {
    Simplification::edge_collapse(surface, stop,
                                  CGAL::parameters::get_cost(Simplification::LindstromTurk_cost<Surface>{})
                                      .get_placement(Simplification::LindstromTurk_placement<Surface>{}));
  });
}

}  // namespace lodestone::peers

// SPDX-License-Identifier: MIT
// OpenMesh's decimater with its quadric module. What is no manifold is split first: OpenMesh cannot hold it.
#include <lodestone/openmesh.h>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "peers.h"
#include "processor_clock.h"

namespace lodestone::peers {

Outcome by_openmesh(const Mesh& mesh, std::uint32_t target_triangles) {
  using Half = OpenMesh::TriMesh;
  Half half = to_openmesh(mesh).mesh;
  Outcome outcome;
  const double start = thread_seconds();
  OpenMesh::Decimater::DecimaterT<Half> decimater{half};
  OpenMesh::Decimater::ModQuadricT<Half>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to_faces(0, target_triangles);
  half.garbage_collection();
  outcome.seconds = thread_seconds() - start;
  outcome.mesh.materials.emplace_back();
  for (const auto v : half.vertices()) {
    const auto& p = half.point(v);
    outcome.mesh.vertices.positions.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : half.faces()) {
    for (auto v = half.fv_iter(f); v.is_valid(); ++v) {
      outcome.mesh.indices.push_back(static_cast<VertexId>(v->idx()));
    }
  }
  return outcome;
}

}  // namespace lodestone::peers

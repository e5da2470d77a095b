// SPDX-License-Identifier: MIT
/// \file
/// Optional: converters to and from OpenMesh, for code that wants a half-edge structure. Needs OpenMesh's headers
/// (Debian: libopenmesh-dev) and is the only public header that does.
#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/mesh.h>
#include <OpenMesh/Core/Mesh/DefaultTriMesh.hh>

namespace lodestone {

/// A mesh as OpenMesh holds it. OpenMesh refuses a third face on an edge, so what is not manifold is cut apart first
/// and its vertices doubled; `point_of_vertex` remembers which are one place.
///
/// Attributes of wedges lie on half-edges, each of which holds those of the corner it points to: normals, 2D texture
/// coordinates and colours (RGBA, 0..1), if the source has them. Faces carry two properties of type unsigned int,
/// `openmesh_material` and `openmesh_feature`. The first half-edge of a face points to its first corner.
struct OpenMeshCopy {
  OpenMesh::TriMesh mesh;                      ///< positions relative to the source's origin
  std::vector<std::uint32_t> point_of_vertex;  ///< equal for twins; per vertex of `mesh`
  std::vector<FaceId> face_of;                 ///< source triangle; per face of `mesh`
};

/// Names of the face properties.
inline constexpr const char* openmesh_material = "lodestone:material";
inline constexpr const char* openmesh_feature = "lodestone:feature";

/// Triangles with two corners at one place have no half-edges and are left out. Precondition: validate(mesh).
[[nodiscard]] OpenMeshCopy to_openmesh(const Mesh& mesh);

/// The triangles of `mesh` that are not marked as deleted, in its order, with wedges built from the half-edges'
/// attributes or, where there are none, the vertices'. Materials and features refer to `surroundings`; a default
/// material is made if it has none. Positions become float: hand in coordinates relative to `surroundings.origin`.
[[nodiscard]] Mesh from_openmesh(const OpenMesh::TriMesh& mesh, const Surroundings& surroundings = {});

}  // namespace lodestone

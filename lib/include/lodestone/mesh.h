// SPDX-License-Identifier: MIT
/// \file
/// The one mesh: what readers return, builders take and writers write. Plain arrays, ready to hand to a GPU.
///
/// A vertex is a wedge (one position with one normal, uv and colour). At a uv seam or a crease several vertices share
/// the same position bit for bit; algorithms find them by position, so a mesh needs no other connectivity.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/image.h>
#include <lodestone/result.h>
#include <lodestone/types.h>

namespace lodestone {

/// Parallel arrays, one element per vertex. `positions` is always there; the others are empty or of the same size.
struct VertexArrays {
  std::vector<glm::vec3> positions;  ///< metres, relative to the owner's `origin`
  std::vector<glm::vec3> normals;    ///< unit length
  std::vector<glm::vec2> uvs;        ///< see types.h; may lie far outside 0..1 (the texture repeats)
  std::vector<glm::u8vec4> colors;   ///< sRGB with straight alpha

  [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(positions.size()); }
  friend bool operator==(const VertexArrays&, const VertexArrays&) = default;
};

/// An image used by materials: decoded pixels, or the encoded bytes of a file, or only a path. Shared, never changed
/// once it is in a mesh, so copies of a mesh do not copy pixels.
struct Texture {
  std::string name;                                          ///< As the source calls it; unique in a mesh.
  std::string path;                                          ///< File on disk, if there is one.
  std::string mime_type;                                     ///< Of `encoded`: "image/jpeg", "image/png", ...
  std::shared_ptr<const std::vector<std::uint8_t>> encoded;  ///< The file's bytes; null if not loaded.
  std::shared_ptr<const Image> image;                        ///< Pixels; null if not decoded.
};

/// Surface look. `base_color` multiplies the texture; alpha below 1 means glass: blended, drawn after opaque faces.
struct Material {
  std::string name;
  glm::vec4 base_color{1.0F, 1.0F, 1.0F, 1.0F};  ///< sRGB, straight alpha, 0..1
  std::uint32_t texture = none;                  ///< Index into Mesh::textures, or `none`.
  float alpha_cutoff = 0.0F;                     ///< Texels with alpha below it are holes; 0 = no cut-out.
  bool double_sided = true;

  [[nodiscard]] bool transparent() const noexcept { return base_color.a < 1.0F; }
};

/// What a group of faces is: a wall, a window, a horizon. From CityGML, CityJSON, IFC, or OBJ group names.
struct Feature {
  std::string id;               ///< gml:id, GUID or group name; unique in a mesh where the source is.
  std::string semantic_class;   ///< CityGML's word ("WallSurface", "Window", ...), empty if unknown.
  std::uint32_t parent = none;  ///< Feature that this one belongs to (a window's wall, a wall's building).
};

/// Everything but the geometry: it travels unchanged from a source through every level of a model.
struct Surroundings {
  glm::dvec3 origin{0.0};           ///< metres; a vertex's place in the world is origin + position
  std::string crs;                  ///< Coordinate reference system ("EPSG:25832"), empty if unknown.
  std::vector<Material> materials;  ///< Never empty in a valid mesh that has faces.
  std::vector<Texture> textures;
  std::vector<Feature> features;
};

/// Triangles with wedges, materials and features.
struct Mesh : Surroundings {
  VertexArrays vertices;
  std::vector<VertexId> indices;           ///< 3 per triangle, counter-clockwise from outside
  std::vector<MaterialId> face_materials;  ///< 1 per triangle, or empty: all of material 0
  std::vector<FeatureId> face_features;    ///< 1 per triangle, or empty: no features; `none` allowed

  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return vertices.size(); }
  [[nodiscard]] std::uint32_t triangle_count() const noexcept { return static_cast<std::uint32_t>(indices.size() / 3); }
  [[nodiscard]] MaterialId face_material(FaceId f) const noexcept {
    return face_materials.empty() ? 0 : face_materials[f];
  }
  [[nodiscard]] FeatureId face_feature(FaceId f) const noexcept {
    return face_features.empty() ? none : face_features[f];
  }
};

/// Box of the positions relative to the origin. O(vertices).
[[nodiscard]] Box bounds(const Mesh& mesh);

/// Checks the invariants that every function here relies on: sizes of parallel arrays agree, indices, materials,
/// textures and features are in range, numbers are finite. O(size).
[[nodiscard]] Status validate(const Mesh& mesh);

/// Counts that describe how clean a mesh is; edges are taken by position, so uv seams do not count as borders.
struct MeshReport {
  std::uint32_t corner_points = 0;         ///< distinct positions
  std::uint32_t components = 0;            ///< connected by shared positions along edges
  std::uint32_t boundary_edges = 0;        ///< used by one face
  std::uint32_t non_manifold_edges = 0;    ///< used by three or more faces
  std::uint32_t degenerate_triangles = 0;  ///< two equal corners, or zero area
  std::uint32_t duplicate_triangles = 0;   ///< same three positions as an earlier one
  Box bounds;                              ///< relative to the origin
};
[[nodiscard]] MeshReport inspect(const Mesh& mesh);

/// Removes what is never drawn: vertices that no face uses, materials and textures that nothing refers to. Stable.
void remove_unused(Mesh& mesh);

/// Fills in unit normals, area-and-angle weighted over faces around a position whose dihedral angle is below
/// `crease_rad`; vertices on creases are split. Existing normals are replaced.
void compute_normals(Mesh& mesh, double crease_rad = 0.7853981633974483);

/// Merges vertices that are equal in every attribute bit; faces keep their order. Returns how many went.
std::uint32_t merge_identical_vertices(Mesh& mesh);

}  // namespace lodestone

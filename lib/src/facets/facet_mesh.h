// SPDX-License-Identifier: MIT
// The building while its facets shift: faces between corner points, each with the plane it must keep.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/facet_shift.h>

#include "facets/face_list.h"
#include "facets/looks.h"
#include "progressive/recorder.h"

namespace lodestone::facets {

struct Face {
  std::array<std::uint32_t, 3> point{};
  std::array<VertexId, 3> vertex{};
  std::uint32_t surface = none;
  bool live = false;
  glm::dvec3 normal{0.0};  // unit, of the plane that the face is to keep

  [[nodiscard]] bool has_point(std::uint32_t p) const noexcept {
    return point[0] == p || point[1] == p || point[2] == p;
  }
};

// One corner point goes to another place, and becomes one with the point there if `onto` names it. Where points that
// move together meet, all but one go onto that one, which has `onto` none.
struct Move {
  std::uint32_t point = none;
  std::uint32_t onto = none;
  glm::vec3 to{0.0F};
};

struct FacetMesh {
  const Mesh* source = nullptr;
  std::vector<Face> faces;             // by source face
  std::vector<glm::vec3> place;        // per point
  std::vector<FaceList> faces_of;      // per point, live faces, each once
  std::vector<float> deviation_m;      // per point: of the surface around it from the source
  std::vector<std::uint32_t> version;  // per point: changes when its faces do
  CharacteristicSurfaces surfaces;
  std::vector<std::vector<FaceId>> surface_faces;  // may hold dead ones
  VertexArrays values;                             // current
  std::vector<std::uint32_t> uses;                 // per vertex: live corners that name it
  std::vector<double> material_area_m2;            // of the source
  Looks looks;
  std::uint32_t live_faces = 0;
  std::vector<std::uint32_t> live_of_material;
  std::uint64_t edits = 0;      // how many there were
  std::vector<FaceId> touched;  // moved, redrawn or gone since somebody emptied it

  [[nodiscard]] std::uint32_t point_count() const noexcept { return static_cast<std::uint32_t>(place.size()); }
  [[nodiscard]] glm::dvec3 at(std::uint32_t point) const noexcept { return glm::dvec3{place[point]}; }
  // Twice the area, along the current normal.
  [[nodiscard]] glm::dvec3 area_vector(const Face& f) const noexcept {
    return glm::cross(at(f.point[1]) - at(f.point[0]), at(f.point[2]) - at(f.point[0]));
  }
  [[nodiscard]] double area_m2(const Face& f) const noexcept { return 0.5 * glm::length(area_vector(f)); }
  // Changes when the face, its corners or its neighbours do; never 0.
  [[nodiscard]] std::uint64_t state_of(FaceId f) const noexcept {
    std::uint64_t sum = 1;
    for (const std::uint32_t p : faces[f].point)
      sum += (p + 1ULL) * 0x9E3779B97F4A7C15U + version[p] * 0xC2B2AE3D27D4EB4FU;
    return sum == 0 ? 1 : sum;
  }
  // Changes when one of its corners moves.
  [[nodiscard]] std::uint64_t shape_of(FaceId f) const noexcept {
    std::uint64_t hash = 1;
    for (const std::uint32_t p : faces[f].point) {
      for (int axis = 0; axis < 3; ++axis)
        hash = (hash ^ std::bit_cast<std::uint32_t>(place[p][axis])) * 0x9E3779B97F4A7C15U ^ (hash >> 29U);
    }
    return hash;
  }
};

// Faces with two corners on one point or no area are dead from the start: `degenerate` names them. Vertices of one
// point may lie apart by the tolerance for welding until the point moves.
[[nodiscard]] FacetMesh make_facet_mesh(const Mesh& source, const FacetShiftOptions& options,
                                        std::vector<FaceId>& degenerate);

// Where everything goes under a set of moves, without doing it. Kept between calls to save memory traffic.
class Moved {
 public:
  explicit Moved(const FacetMesh& mesh)
      : mesh_(mesh), stamp_(mesh.point_count(), 0), index_(mesh.point_count(), 0), face_stamp_(mesh.faces.size(), 0) {}
  void set(std::span<const Move> moves);

  [[nodiscard]] std::span<const Move> moves() const noexcept { return moves_; }
  [[nodiscard]] bool moves(std::uint32_t point) const noexcept { return stamp_[point] == now_; }
  [[nodiscard]] std::uint32_t point(std::uint32_t p) const noexcept {
    return moves(p) && moves_[index_[p]].onto != none ? moves_[index_[p]].onto : p;
  }
  [[nodiscard]] glm::dvec3 at(std::uint32_t p) const noexcept {
    return glm::dvec3{moves(p) ? moves_[index_[p]].to : mesh_.place[p]};
  }
  // All live faces with a moved corner, ascending by move.
  [[nodiscard]] const std::vector<FaceId>& faces() const noexcept { return faces_; }

 private:
  const FacetMesh& mesh_;
  std::span<const Move> moves_;
  std::vector<std::uint32_t> stamp_, index_, face_stamp_;
  std::vector<FaceId> faces_;
  std::uint32_t now_ = 0;
};

// The mean squared distance of a triangle whose corners are so far from a plane.
[[nodiscard]] inline double mean_square(double a, double b, double c) noexcept {
  return (a * a + b * b + c * c + a * b + b * c + c * a) / 6.0;
}

// Flatter than this a face is a line.
inline constexpr double line_height_m = 1e-4;

[[nodiscard]] double height_m(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

// The uv that the plane of face f has at `to`, by its affine map.
[[nodiscard]] glm::vec2 extrapolate_uv(const FacetMesh& mesh, const Face& f, const glm::dvec3& to);

// Two vertices of one place look alike.
[[nodiscard]] bool same_looks(const VertexArrays& values, VertexId a, VertexId b);

// Does the moves and logs them as one record. Faces between points that met go; of two that come to lie on each other
// and turn the same way one
// goes. Vertices keep the texture of the plane they lie in.
void apply(FacetMesh& mesh, Moved& moved, double error_m, progressive::EditLog& log);

// How faces go that are taken away: what cannot be seen may go where it is, anything else shrinks into a point of its
// own, or a colour would be gone from one picture to the next.
enum class Going : std::uint8_t { Still, Shrinking };

// Takes faces away, as one record.
void vanish(FacetMesh& mesh, std::span<const FaceId> faces, Going going, double error_m, progressive::EditLog& log);

// The same where some vertices, ascending, merge with others of these faces; the others stay where they are.
void vanish(FacetMesh& mesh, std::span<const FaceId> faces, std::span<const std::pair<VertexId, VertexId>> onto,
            double error_m, progressive::EditLog& log);

}  // namespace lodestone::facets

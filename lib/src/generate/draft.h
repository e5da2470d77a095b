// SPDX-License-Identifier: MIT
// A house on the drawing board: planar facets that make the closed body, and closed parts that are put on it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <lodestone/mesh.h>

#include "generate/lattice.h"

namespace lodestone::generate {

struct Look {
  MaterialId material = 0;
  FeatureId feature = 0;
};

// The body: polygons with holes whose edges meet, T-junctions allowed.
class Body {
 public:
  // `rings`: the outer loop counter-clockwise seen from outside, then holes clockwise; planar.
  void add(std::vector<Loop> rings, Look look) { facets_.push_back({std::move(rings), look}); }
  // Splits edges at every corner that lies on them, so that facets meet corner to corner.
  void close_t_junctions();
  // Appends triangles with a wedge per facet and corner: flat normals, uv along the facet's own horizontal.
  void emit(Mesh& mesh, const std::vector<double>& uv_scale) const;
  // Of the triangles that emit() will append. Call after close_t_junctions().
  [[nodiscard]] std::uint32_t triangle_count() const;

 private:
  struct Facet {
    std::vector<Loop> rings;
    Look look;
  };
  std::vector<Facet> facets_;
};

// A place and three perpendicular unit directions, right-handed; metres.
struct Frame {
  glm::dvec3 origin{0.0};
  glm::dvec3 x{1.0, 0.0, 0.0};
  glm::dvec3 y{0.0, 1.0, 0.0};
  glm::dvec3 z{0.0, 0.0, 1.0};
  [[nodiscard]] glm::dvec3 at(const glm::dvec3& p) const { return origin + p.x * x + p.y * y + p.z * z; }
  [[nodiscard]] glm::dvec3 turn(const glm::dvec3& v) const { return v.x * x + v.y * y + v.z * z; }
};

enum class Shape : std::uint8_t {
  Box,    // size: whole lengths, the origin at the middle of its base
  Prism,  // outline (x, z) extruded by size.y along y
  Lathe,  // outline (radius, z), bottom to top, turned about z
  Sweep,  // moulding (Cornice, ...) swept around the rectangle size.x by size.y from the origin
  Tile,   // half-round roof tile: size.x wide, size.y long, size.z high
  Spike,  // finial, two cones: size.x wide, size.z high; each segment more adds two triangles
};

enum class Moulding : std::uint8_t { Cornice, Band, Surround };

// A closed part. `segments` divides what is curved: each step more adds a known number of triangles.
struct Part {
  Shape shape = Shape::Box;
  Moulding moulding = Moulding::Band;
  std::uint32_t segments = 0;  // the fewest; more are given as the budget allows
  std::uint32_t outline = 0;   // index into Parts::outlines, for Prism and Lathe
  Frame frame;
  glm::dvec3 size{0.0};
  Look look;
};

struct Parts {
  std::vector<Part> list;
  std::vector<std::vector<glm::dvec2>> outlines;

  std::uint32_t add_outline(std::vector<glm::dvec2> outline) {
    outlines.push_back(std::move(outline));
    return static_cast<std::uint32_t>(outlines.size() - 1);
  }
  // Triangles of a part with that many segments, and how many each further segment adds (0: it has no curves).
  [[nodiscard]] std::uint32_t triangles(const Part& part, std::uint32_t segments) const;
  [[nodiscard]] std::uint32_t gain(const Part& part) const;
  // Of all parts at their fewest segments.
  [[nodiscard]] std::uint64_t least_triangles() const;
  // Segments per part that use up `spare` further triangles: all alike first, then one more here and there; the first
  // spike takes what is left, which any even number can be.
  [[nodiscard]] std::vector<std::uint32_t> share_out(std::uint64_t spare) const;
  void emit(const Part& part, std::uint32_t segments, Mesh& mesh, const std::vector<double>& uv_scale) const;
};

// Appends one triangle corner wedge; parts and facets alike. Positions are snapped to 1/16384 m, so that rounding in
// the last bits of a library's sine is never seen.
VertexId add_vertex(Mesh& mesh, const glm::dvec3& position, const glm::dvec3& normal, const glm::dvec2& uv);
void add_triangle(Mesh& mesh, VertexId a, VertexId b, VertexId c, Look look);

FeatureId add_feature(Mesh& mesh, std::string id, const char* semantic_class, FeatureId parent);

}  // namespace lodestone::generate

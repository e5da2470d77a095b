// SPDX-License-Identifier: MIT
#include "generate/draft.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>
#include <utility>

namespace lodestone::generate {

namespace {

// The line through an edge: its shortest whole direction and its moment, both exact, so that edges on one line agree.
using LineKey = std::array<std::int64_t, 6>;

struct LinePoint {
  LineKey line;
  std::int64_t along;
  Point point;
  friend bool operator<(const LinePoint& a, const LinePoint& b) {
    return std::tie(a.line, a.along) < std::tie(b.line, b.along);
  }
};

LinePoint on_line(const Point& p, glm::i64vec3 d) {
  const std::int64_t divisor = std::gcd(std::gcd(d.x, d.y), d.z);
  d /= divisor;
  const bool flip = d.x < 0 || (d.x == 0 && (d.y < 0 || (d.y == 0 && d.z < 0)));
  if (flip) d = -d;
  const glm::i64vec3 q{p};
  const glm::i64vec3 m{q.y * d.z - q.z * d.y, q.z * d.x - q.x * d.z, q.x * d.y - q.y * d.x};
  return {{d.x, d.y, d.z, m.x, m.y, m.z}, q.x * d.x + q.y * d.y + q.z * d.z, p};
}

void split_ring(Loop& ring, const std::vector<LinePoint>& points) {
  Loop split;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point& a = ring[i];
    const Point& b = ring[(i + 1) % ring.size()];
    split.push_back(a);
    const glm::i64vec3 d = glm::i64vec3{b} - glm::i64vec3{a};
    const LinePoint from = on_line(a, d);
    const LinePoint to = on_line(b, d);
    if (from.along < to.along) {
      auto p = std::upper_bound(points.begin(), points.end(), from);
      for (; p != points.end() && *p < to; ++p) split.push_back(p->point);
    } else {
      auto p = std::lower_bound(points.begin(), points.end(), from);
      while (p != points.begin() && to < *(p - 1)) split.push_back((--p)->point);
    }
  }
  ring = std::move(split);
}

// Drops the axis along which the plane is seen best; the order of the two others keeps the orientation.
Point2 flatten(const Point& p, const glm::i64vec3& normal) {
  const glm::i64vec3 n = glm::abs(normal);
  if (n.z >= n.x && n.z >= n.y) return normal.z > 0 ? Point2{p.x, p.y} : Point2{p.y, p.x};
  if (n.x >= n.y) return normal.x > 0 ? Point2{p.y, p.z} : Point2{p.z, p.y};
  return normal.y > 0 ? Point2{p.z, p.x} : Point2{p.x, p.z};
}

}  // namespace

void Body::close_t_junctions() {
  std::vector<LinePoint> points;
  for (const Facet& facet : facets_) {
    for (const Loop& ring : facet.rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point& a = ring[i];
        const Point& b = ring[(i + 1) % ring.size()];
        assert(a != b);
        const glm::i64vec3 d = glm::i64vec3{b} - glm::i64vec3{a};
        points.push_back(on_line(a, d));
        points.push_back(on_line(b, d));
      }
    }
  }
  std::sort(points.begin(), points.end());
  const auto same = [](const LinePoint& a, const LinePoint& b) { return a.line == b.line && a.along == b.along; };
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  for (Facet& facet : facets_) {
    for (Loop& ring : facet.rings) split_ring(ring, points);
  }
}

std::uint32_t Body::triangle_count() const {
  std::size_t count = 0;
  for (const Facet& facet : facets_) {
    for (const Loop& ring : facet.rings) count += ring.size();
    count += 2 * (facet.rings.size() - 1) - 2;
  }
  return static_cast<std::uint32_t>(count);
}

void Body::emit(Mesh& mesh, const std::vector<double>& uv_scale) const {
  for (const Facet& facet : facets_) {
    const glm::i64vec3 whole = loop_normal(facet.rings.front());
    const glm::dvec3 normal = glm::normalize(glm::dvec3{whole});
    const bool level = whole.x == 0 && whole.y == 0;
    const glm::dvec3 u = level ? glm::dvec3{1.0, 0.0, 0.0} : glm::normalize(glm::dvec3{-normal.y, normal.x, 0.0});
    const glm::dvec3 v = glm::cross(normal, u);
    const double scale = uv_scale[facet.look.material];
    std::vector<Loop2> flat;
    const VertexId first = mesh.vertex_count();
    for (const Loop& ring : facet.rings) {
      flat.emplace_back();
      for (const Point& p : ring) {
        flat.back().push_back(flatten(p, whole));
        const glm::dvec3 place = metres(p);
        add_vertex(mesh, place, normal, glm::dvec2{glm::dot(place, u), glm::dot(place, v)} * scale);
      }
    }
    const std::vector<std::uint32_t> triangles = triangulate(flat);
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
      add_triangle(mesh, first + triangles[t], first + triangles[t + 1], first + triangles[t + 2], facet.look);
    }
  }
}

VertexId add_vertex(Mesh& mesh, const glm::dvec3& position, const glm::dvec3& normal, const glm::dvec2& uv) {
  constexpr double per_m = 16384.0;
  mesh.vertices.positions.emplace_back(glm::round(position * per_m) / per_m);
  mesh.vertices.normals.emplace_back(normal);
  mesh.vertices.uvs.emplace_back(uv);
  return mesh.vertex_count() - 1;
}

void add_triangle(Mesh& mesh, VertexId a, VertexId b, VertexId c, Look look) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c});
  mesh.face_materials.push_back(look.material);
  mesh.face_features.push_back(look.feature);
}

FeatureId add_feature(Mesh& mesh, std::string id, const char* semantic_class, FeatureId parent) {
  mesh.features.push_back({.id = std::move(id), .semantic_class = semantic_class, .parent = parent});
  return static_cast<FeatureId>(mesh.features.size() - 1);
}

}  // namespace lodestone::generate

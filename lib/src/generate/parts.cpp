// SPDX-License-Identifier: MIT
#include <cassert>
#include <numbers>

#include "generate/draft.h"

namespace lodestone::generate {

namespace {

using Outline = std::vector<glm::dvec2>;

// What every shape needs while it is written.
struct Pen {
  Mesh& mesh;
  const Part& part;
  double uv_scale;

  VertexId put(const glm::dvec3& p, const glm::dvec3& normal, const glm::dvec2& uv) const {
    return add_vertex(mesh, part.frame.at(p), part.frame.turn(normal), uv * uv_scale);
  }
  void triangle(VertexId a, VertexId b, VertexId c) const { add_triangle(mesh, a, b, c, part.look); }
  // Flat quad, corners counter-clockwise from outside.
  void quad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) const {
    const glm::dvec3 normal = glm::normalize(glm::cross(c - a, d - b));
    const glm::dvec3 n = glm::abs(normal);
    const auto uv = [&](const glm::dvec3& p) {
      if (n.z > n.x && n.z > n.y) return glm::dvec2{p.x, p.y};
      return n.x > n.y ? glm::dvec2{p.y, p.z} : glm::dvec2{p.x, p.z};
    };
    const VertexId first = put(a, normal, uv(a));
    put(b, normal, uv(b));
    put(c, normal, uv(c));
    put(d, normal, uv(d));
    triangle(first, first + 1, first + 2);
    triangle(first, first + 2, first + 3);
  }
};

void emit_box(const Pen& pen) {
  const glm::dvec3 h = pen.part.size * glm::dvec3{0.5, 0.5, 1.0};
  const auto at = [&](int x, int y, int z) { return glm::dvec3{x * h.x, y * h.y, z * h.z}; };
  pen.quad(at(-1, -1, 0), at(1, -1, 0), at(1, -1, 1), at(-1, -1, 1));
  pen.quad(at(1, 1, 0), at(-1, 1, 0), at(-1, 1, 1), at(1, 1, 1));
  pen.quad(at(1, -1, 0), at(1, 1, 0), at(1, 1, 1), at(1, -1, 1));
  pen.quad(at(-1, 1, 0), at(-1, -1, 0), at(-1, -1, 1), at(-1, 1, 1));
  pen.quad(at(-1, -1, 1), at(1, -1, 1), at(1, 1, 1), at(-1, 1, 1));
  pen.quad(at(-1, 1, 0), at(1, 1, 0), at(1, -1, 0), at(-1, -1, 0));
}

void emit_prism(const Pen& pen, const Outline& outline) {
  const double length = pen.part.size.y;
  Loop2 flat;
  for (const glm::dvec2& p : outline) flat.emplace_back(glm::round(p * 16384.0));
  const std::vector<std::uint32_t> cap = triangulate({flat});
  const auto at = [&](std::size_t i, double y) { return glm::dvec3{outline[i].x, y, outline[i].y}; };
  for (const bool front : {true, false}) {
    const VertexId first = pen.mesh.vertex_count();
    const double y = front ? 0.0 : length;
    for (std::size_t i = 0; i < outline.size(); ++i) pen.put(at(i, y), {0.0, front ? -1.0 : 1.0, 0.0}, outline[i]);
    for (std::size_t t = 0; t < cap.size(); t += 3) {
      pen.triangle(first + cap[t], first + cap[front ? t + 1 : t + 2], first + cap[front ? t + 2 : t + 1]);
    }
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t j = (i + 1) % outline.size();
    pen.quad(at(i, 0.0), at(i, length), at(j, length), at(j, 0.0));
  }
}

void emit_lathe(const Pen& pen, const Outline& outline, std::uint32_t segments) {
  const auto direction = [&](std::uint32_t k) {
    const double angle = 2.0 * std::numbers::pi * (k % segments) / segments;
    return glm::dvec2{std::cos(angle), std::sin(angle)};
  };
  const auto rings = static_cast<std::uint32_t>(outline.size());
  const VertexId first = pen.mesh.vertex_count();
  for (std::uint32_t r = 0; r < rings; ++r) {
    const glm::dvec2 tangent = outline[r + 1 < rings ? r + 1 : r] - outline[r > 0 ? r - 1 : r];
    const glm::dvec2 slant = glm::normalize(glm::dvec2{tangent.y, -tangent.x});
    for (std::uint32_t k = 0; k <= segments; ++k) {
      const glm::dvec2 d = direction(k);
      const double turn = 2.0 * std::numbers::pi * outline[r].x * k / segments;
      pen.put({d * outline[r].x, outline[r].y}, {d * slant.x, slant.y}, {turn, outline[r].y});
    }
  }
  for (std::uint32_t r = 0; r + 1 < rings; ++r) {
    for (std::uint32_t k = 0; k < segments; ++k) {
      const VertexId a = first + r * (segments + 1) + k;
      const VertexId b = a + segments + 1;
      pen.triangle(a, a + 1, b + 1);
      pen.triangle(a, b + 1, b);
    }
  }
  for (const bool top : {false, true}) {
    const glm::dvec2 end = top ? outline.back() : outline.front();
    const glm::dvec3 normal{0.0, 0.0, top ? 1.0 : -1.0};
    const VertexId middle = pen.put({0.0, 0.0, end.y}, normal, {0.0, 0.0});
    for (std::uint32_t k = 0; k < segments; ++k) pen.put({direction(k) * end.x, end.y}, normal, direction(k) * end.x);
    for (std::uint32_t k = 0; k < segments; ++k) {
      const VertexId a = middle + 1 + k;
      const VertexId b = middle + 1 + (k + 1) % segments;
      pen.triangle(middle, top ? a : b, top ? b : a);
    }
  }
}

// Closed profile (distance from the rectangle, height), counter-clockwise, let into the wall behind it. A quarter of a
// circle, hollow or full, runs from `from` to `to` in the middle of it: 5 + segments points.
Outline profile(Moulding moulding, std::uint32_t segments) {
  struct Shape5 {
    glm::dvec2 start, edge, from, to, top;
    bool hollow;
  };
  static const Shape5 shapes[] = {
      {{-0.0625, 0.0}, {0.06, 0.0}, {0.06, 0.08}, {0.40, 0.34}, {0.46, 0.46}, true},         // Cornice
      {{-0.0625, 0.0}, {0.03, 0.0}, {0.05, 0.03}, {0.12, 0.13}, {0.12, 0.19}, false},        // Band
      {{0.02, -0.03125}, {0.17, -0.03125}, {0.17, 0.05}, {0.08, 0.09}, {0.02, 0.09}, false}  // Surround
  };
  const Shape5& s = shapes[static_cast<std::size_t>(moulding)];
  Outline outline{s.start, s.edge};
  for (std::uint32_t i = 0; i <= segments; ++i) {
    const double angle = 0.5 * std::numbers::pi * i / segments;
    const double x = s.hollow ? 1.0 - std::cos(angle) : std::sin(angle);
    const double y = s.hollow ? std::sin(angle) : 1.0 - std::cos(angle);
    outline.push_back(s.from + (s.to - s.from) * glm::dvec2{x, y});
  }
  if (moulding == Moulding::Surround) {
    outline.push_back(0.5 * (s.to + s.top));
    outline.push_back(s.top);
  } else {
    outline.emplace_back(s.top.x, s.top.y);
    outline.emplace_back(s.start.x, s.top.y);
  }
  return outline;
}

void emit_sweep(const Pen& pen, std::uint32_t segments) {
  const Outline outline = profile(pen.part.moulding, segments);
  const glm::dvec3 size = pen.part.size;
  const glm::dvec2 corners[] = {{0.0, 0.0}, {size.x, 0.0}, {size.x, size.y}, {0.0, size.y}};
  const glm::dvec2 outward[] = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
  const auto at = [&](std::size_t corner, const glm::dvec2& p) {
    return glm::dvec3{corners[corner] + outward[corner] * p.x, p.y};
  };
  for (std::size_t c = 0; c < 4; ++c) {
    const std::size_t next = (c + 1) % 4;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const glm::dvec2& p = outline[i];
      const glm::dvec2& q = outline[(i + 1) % outline.size()];
      pen.quad(at(c, p), at(next, p), at(next, q), at(c, q));
    }
  }
}

// Two cones base to base.
void emit_spike(const Pen& pen, std::uint32_t segments) {
  const glm::dvec3 size = pen.part.size;
  const double belly = 0.35 * size.z;
  const auto around = [&](std::uint32_t k) {
    const double angle = 2.0 * std::numbers::pi * (k % segments) / segments;
    return glm::dvec3{0.5 * size.x * std::cos(angle), 0.5 * size.x * std::sin(angle), belly};
  };
  for (const bool top : {false, true}) {
    const double tip_z = top ? size.z : 0.0;
    for (std::uint32_t k = 0; k < segments; ++k) {
      const glm::dvec3 a = around(top ? k : k + 1);
      const glm::dvec3 b = around(top ? k + 1 : k);
      const glm::dvec3 tip{0.0, 0.0, tip_z};
      const glm::dvec3 normal = glm::normalize(glm::cross(b - a, tip - a));
      const VertexId first = pen.put(a, normal, {a.x, a.z});
      pen.put(b, normal, {b.x, b.z});
      pen.put(tip, normal, {0.0, tip_z});
      pen.triangle(first, first + 1, first + 2);
    }
  }
}

void emit_tile(const Pen& pen, std::uint32_t segments) {
  const glm::dvec3 size = pen.part.size;
  const auto arc = [&](std::uint32_t i, double y) {
    const double angle = std::numbers::pi * i / segments;
    const double taper = y > 0.0 ? 0.86 : 1.0;
    return glm::dvec3{0.5 * taper * size.x * std::cos(angle), y, taper * size.z * std::sin(angle)};
  };
  const auto ends = {0.0, size.y};
  const VertexId first = pen.mesh.vertex_count();
  for (std::uint32_t i = 0; i <= segments; ++i) {
    const double angle = std::numbers::pi * i / segments;
    for (const double y : ends) pen.put(arc(i, y), {std::cos(angle), 0.0, std::sin(angle)}, {0.5 * size.x * angle, y});
  }
  for (std::uint32_t i = 0; i < segments; ++i) {
    const VertexId a = first + 2 * i;
    pen.triangle(a, a + 1, a + 3);
    pen.triangle(a, a + 3, a + 2);
  }
  for (const double y : ends) {
    const VertexId cap = pen.mesh.vertex_count();
    for (std::uint32_t i = 0; i <= segments; ++i)
      pen.put(arc(i, y), {0.0, y > 0.0 ? 1.0 : -1.0, 0.0}, {arc(i, y).x, arc(i, y).z});
    for (std::uint32_t i = 1; i < segments; ++i)
      pen.triangle(cap, cap + (y > 0.0 ? i + 1 : i), cap + (y > 0.0 ? i : i + 1));
  }
  pen.quad(arc(0, 0.0), arc(segments, 0.0), arc(segments, size.y), arc(0, size.y));
}

}  // namespace

std::uint32_t Parts::triangles(const Part& part, std::uint32_t segments) const {
  const auto points = [&] { return static_cast<std::uint32_t>(outlines[part.outline].size()); };
  switch (part.shape) {
    case Shape::Box:
      return 12;
    case Shape::Prism:
      return 4 * points() - 4;
    case Shape::Lathe:
      return 2 * points() * segments;
    case Shape::Sweep:
      return 8 * (5 + segments);
    case Shape::Tile:
      return 4 * segments;
    case Shape::Spike:
      return 2 * segments;
  }
  return 0;
}

std::uint32_t Parts::gain(const Part& part) const {
  return triangles(part, part.segments + 1) - triangles(part, part.segments);
}

std::uint64_t Parts::least_triangles() const {
  std::uint64_t sum = 0;
  for (const Part& part : list) sum += triangles(part, part.segments);
  return sum;
}

std::vector<std::uint32_t> Parts::share_out(std::uint64_t spare) const {
  std::uint64_t step = 0;
  for (const Part& part : list) step += part.shape == Shape::Spike ? 0 : gain(part);
  const std::uint64_t all = step == 0 ? 0 : spare / step;
  spare -= all * step;
  std::vector<std::uint32_t> segments;
  for (const Part& part : list) {
    const std::uint32_t more = gain(part);
    std::uint32_t count = part.segments;
    if (more > 0 && part.shape != Shape::Spike) {
      count += static_cast<std::uint32_t>(all);
      if (more <= spare) {
        ++count;
        spare -= more;
      }
    }
    segments.push_back(count);
  }
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].shape != Shape::Spike) continue;
    segments[i] += static_cast<std::uint32_t>(spare / 2);
    break;
  }
  return segments;
}

void Parts::emit(const Part& part, std::uint32_t segments, Mesh& mesh, const std::vector<double>& uv_scale) const {
  const Pen pen{mesh, part, uv_scale[part.look.material]};
  switch (part.shape) {
    case Shape::Box:
      return emit_box(pen);
    case Shape::Prism:
      return emit_prism(pen, outlines[part.outline]);
    case Shape::Lathe:
      return emit_lathe(pen, outlines[part.outline], segments);
    case Shape::Sweep:
      return emit_sweep(pen, segments);
    case Shape::Tile:
      return emit_tile(pen, segments);
    case Shape::Spike:
      return emit_spike(pen, segments);
  }
}

}  // namespace lodestone::generate

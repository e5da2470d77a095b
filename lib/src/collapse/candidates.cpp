// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998 (memoryless volume and border costs).
// Differs: the cost of an edge is estimated from the sums of its two ends, faces at both counted twice; the exact cost
// is taken only for the edges that are tried (collapser.cpp).
#include "collapse/candidates.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "collapse/wedges.h"
#include "collapse/weights.h"

namespace lodestone::collapse {
namespace {

// The other two points of the faces around one point, in the order of the faces.
struct Around {
  std::vector<std::uint32_t> next, previous;
  std::vector<glm::dvec3> normals;  // of the faces, twice their area long, if sharpness counts
};

// Up to so many faces at a point its lists are searched as they are; longer ones are sorted first, or a hub of a fan
// would cost the square of its faces.
constexpr std::size_t few_faces = 64;

// How often points occur in a list.
class Counter {
 public:
  explicit Counter(const std::vector<std::uint32_t>& list) : list_(list) {
    if (list.size() <= few_faces) return;
    sorted_ = list;
    std::sort(sorted_.begin(), sorted_.end());
  }
  [[nodiscard]] std::ptrdiff_t count(std::uint32_t p) const {
    if (sorted_.empty()) return std::count(list_.begin(), list_.end(), p);
    const auto [first, last] = std::equal_range(sorted_.begin(), sorted_.end(), p);
    return last - first;
  }

 private:
  const std::vector<std::uint32_t>& list_;
  std::vector<std::uint32_t> sorted_;
};

// The points around, each once.
template <class Visit>
void for_each_neighbour(const Around& around, Visit&& visit) {
  std::vector<std::uint32_t> all;
  if (around.next.size() > few_faces) {
    all = around.next;
    all.insert(all.end(), around.previous.begin(), around.previous.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    for (const std::uint32_t p : all) visit(p);
    return;
  }
  for (const std::vector<std::uint32_t>* list : {&around.next, &around.previous}) {
    for (const std::uint32_t p : *list) {
      if (std::find(all.begin(), all.end(), p) != all.end()) continue;
      all.push_back(p);
      visit(p);
    }
  }
}

// Edges that do not have one face on either side: adds their lines and tells what kind of point this is.
// Several borders may meet at a frozen point without making it complex: it belongs to a piece cut out of a larger mesh.
std::uint8_t add_borders(const WorkingMesh& mesh, const Around& around, const glm::dvec3& at, bool frozen,
                         double weight, Symmetric3& quadric) {
  std::uint32_t border = 0;
  bool complex = false;
  const Counter next{around.next};
  const Counter previous{around.previous};
  for_each_neighbour(around, [&](std::uint32_t p) {
    const auto out = next.count(p);
    const auto in = previous.count(p);
    if (out == 1 && in == 1) return;
    if (out + in == 1) {
      ++border;
    } else {
      complex = true;
    }
    const glm::dvec3 d = glm::dvec3{mesh.position[p]} - at;
    quadric.add_line(d, weight * glm::dot(d, d));
  });
  if (complex || (border > 2 && !frozen)) return point_complex;
  return border == 0 ? 0 : point_border;
}

// Where in a list each point comes first.
class Finder {
 public:
  explicit Finder(const std::vector<std::uint32_t>& list) : list_(list) {
    if (list.size() <= few_faces) return;
    for (std::uint32_t i = 0; i < list.size(); ++i) sorted_.emplace_back(list[i], i);
    std::sort(sorted_.begin(), sorted_.end());
  }
  // The list's size if it is not there.
  [[nodiscard]] std::size_t find(std::uint32_t p) const {
    if (sorted_.empty()) return static_cast<std::size_t>(std::find(list_.begin(), list_.end(), p) - list_.begin());
    const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair{p, 0U});
    return at != sorted_.end() && at->first == p ? at->second : list_.size();
  }

 private:
  const std::vector<std::uint32_t>& list_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted_;
};

// Seams, material borders and sharp edges at a point: adds their lines and tells what they make of it.
std::uint8_t add_inner_lines(const WorkingMesh& mesh, const LineRules& rules, std::uint32_t point, double sharp_cosine,
                             const Around& around, Symmetric3& quadric) {
  const glm::dvec3 at{mesh.position[point]};
  const std::uint32_t* corners = mesh.corners.data() + mesh.first[point];
  const auto offset = [&](std::uint32_t q) { return glm::dvec3{mesh.position[q]} - at; };
  const auto normal = [&](std::size_t i) { return glm::cross(offset(around.next[i]), offset(around.previous[i])); };
  const Finder previous{around.previous};
  std::uint8_t flags = 0;
  std::uint32_t sharp = 0;
  for (std::size_t i = 0; i < around.next.size(); ++i) {
    const std::uint32_t q = around.next[i];
    const std::size_t j = previous.find(q);
    if (j == around.previous.size()) continue;
    const glm::dvec3 a = normal(i);
    const glm::dvec3 b = normal(j);
    const bool is_sharp = glm::dot(a, b) < sharp_cosine * std::sqrt(glm::dot(a, a) * glm::dot(b, b));
    const bool is_seam = rules.looks_matter && seam_between(mesh, rules.source, mesh.faces[corners[i] >> 2U],
                                                            mesh.faces[corners[j] >> 2U], point, q);
    sharp += is_sharp ? 1U : 0U;
    if (is_seam) flags |= point_line;
    if (is_seam || is_sharp) quadric.add_line(offset(q), rules.weight * glm::dot(offset(q), offset(q)));
  }
  if (sharp == 2) flags |= point_sharp;
  if (sharp == 1 || sharp > 2) flags |= point_corner;
  return flags;
}

// The same for up to `most` faces, in steps that do several neighbours at once.
template <std::size_t most>
bool closed_short_ring(const Around& around) {
  const std::size_t count = around.next.size();
  std::array<std::uint32_t, most> next{};
  std::array<std::uint32_t, most> out{};
  std::array<std::uint32_t, most> in{};
  std::copy_n(around.next.data(), count, next.data());
  for (std::size_t j = 0; j < count; ++j) {
    const std::uint32_t a = around.next[j];
    const std::uint32_t b = around.previous[j];
    for (std::size_t i = 0; i < most; ++i) {
      out[i] += next[i] == a ? 1U : 0U;
      in[i] += next[i] == b ? 1U : 0U;
    }
  }
  bool closed = true;
  for (std::size_t i = 0; i < count; ++i) closed = closed && out[i] == 1 && in[i] == 1;
  return closed;
}

// Whether each edge at the point has one face on either side: every neighbour comes next once and previous once.
bool closed_ring(const Around& around) {
  const std::size_t count = around.next.size();
  if (count <= 8) return closed_short_ring<8>(around);
  if (count <= few_faces) return closed_short_ring<few_faces>(around);
  std::vector<std::uint32_t> out = around.next;
  std::vector<std::uint32_t> in = around.previous;
  std::sort(out.begin(), out.end());
  std::sort(in.begin(), in.end());
  return out == in && std::adjacent_find(out.begin(), out.end()) == out.end();
}

// Based on: Ao et al. 2025, equation 4: angles between the normals around a point, weighted by area. Differs: it is
// their mean, so it does not grow with the number of faces. `normals` are area vectors.
double sharpness_of(const std::vector<glm::dvec3>& normals) {
  if (normals.size() < 2 || normals.size() > few_faces) return 1.0;
  double total = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const double area = glm::length(normals[i]);
    total += area;
    for (std::size_t j = 0; j < i; ++j) {
      const double other = glm::length(normals[j]);
      if (!(area > 0.0) || !(other > 0.0)) continue;
      sum += (area + other) * std::acos(std::clamp(glm::dot(normals[i], normals[j]) / (area * other), -1.0, 1.0));
    }
  }
  return total > 0.0 ? sum / (total * static_cast<double>(normals.size() - 1)) : 0.0;
}

struct Estimator {
  const WorkingMesh& mesh;
  const std::vector<Symmetric3>& quadrics;

  template <Placement placement>
  [[nodiscard]] float cost(std::uint32_t u, std::uint32_t v) const {
    const glm::dvec3 e = glm::dvec3{mesh.position[v]} - glm::dvec3{mesh.position[u]};
    const Symmetric3& mu = quadrics[u];
    const Symmetric3& mv = quadrics[v];
    const glm::dvec3 b = mv * e;
    const double at_u = glm::dot(e, b);
    const double trace = mu.trace() + mv.trace();
    double cost = 0.0;
    if constexpr (placement == Placement::EndPoint || placement == Placement::Subset) {
      cost = std::min(at_u, mu.form(e));
    } else if constexpr (placement == Placement::Midpoint) {
      cost = 0.25 * (at_u + mu.form(e));
    } else {
      if constexpr (placement == Placement::OnEdge) {
        const double at_v = mu.form(e);
        cost = at_u + at_v > 0.0 ? at_u * at_v / (at_u + at_v) : 0.0;
      } else {
        // At the minimum y of the regularised form, (m + pull) y = b + pull / 2 e, the cost needs no second product.
        const double pull = middle_weight * trace + 1e-300;
        Symmetric3 m = mu + mv;
        m.add_isotropic(pull);
        const Solver3 solve{m};
        const glm::dvec3 towards_middle = (0.5 * pull) * e;
        const glm::dvec3 y = solve(b + towards_middle);
        cost =
            solve.valid() ? at_u - glm::dot(b, y) + glm::dot(towards_middle - pull * y, y) : std::min(at_u, mu.form(e));
      }
    }
    cost += length_weight * trace * glm::dot(e, e);
    return static_cast<float>(std::clamp(cost, 0.0, 1e38));
  }
};

// Whether the edge from u to v is to be listed at u. Where both ends are manifold the face on the other side has it the
// other way round, elsewhere either may be the only one.
bool listed_once(std::uint32_t u, std::uint32_t v, std::uint8_t flags_of_both) {
  return u < v || (flags_of_both & (point_border | point_complex)) != 0;
}

template <Placement placement>
void estimate(const WorkingMesh& mesh, const std::vector<Symmetric3>& quadrics, std::vector<Candidate>& edges,
              CostHistogram& histogram) {
  const Estimator estimator{mesh, quadrics};
  std::size_t kept = 0;
  for (const Candidate& c : edges) {
    const auto both = static_cast<std::uint8_t>(mesh.flags[c.u] & mesh.flags[c.v]);
    if (!listed_once(c.u, c.v, both) || (both & point_frozen) != 0) continue;
    const auto key = std::bit_cast<std::uint32_t>(estimator.cost<placement>(c.u, c.v));
    histogram.add(key);
    edges[kept] = {key, std::min(c.u, c.v), std::max(c.u, c.v)};
    kept += ((mesh.flags[c.u] | mesh.flags[c.v]) & point_outer) == 0 ? 1U : 0U;
  }
  edges.resize(kept);
}

// Lists what is around the point and sums its faces. Normals in float do for an estimate, and their sum of squares is
// taken in double.
Symmetric3 sum_faces(const WorkingMesh& mesh, std::uint32_t p, Around& around) {
  const std::uint32_t degree = mesh.first[p + 1] - mesh.first[p];
  around.next.resize(degree);
  around.previous.resize(degree);
  const glm::vec3* position = mesh.position.data();
  const Face* faces = mesh.faces.data();
  const std::uint32_t* corners = mesh.corners.data() + mesh.first[p];
  std::uint32_t* next = around.next.data();
  std::uint32_t* previous = around.previous.data();
  const glm::vec3 at{position[p]};
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;  // of the sum, kept in registers
  for (std::uint32_t i = 0; i != degree; ++i) {
    const std::uint32_t k = corners[i] & 3U;
    const Face& f = faces[corners[i] >> 2U];
    next[i] = f.point[corner_after[k]];
    previous[i] = f.point[corner_before[k]];
    const glm::vec3 a = position[next[i]] - at;
    const glm::vec3 b = position[previous[i]] - at;
    const auto x = double{a.y * b.z - b.y * a.z};
    const auto y = double{a.z * b.x - b.z * a.x};
    const auto z = double{a.x * b.y - b.x * a.y};
    xx += x * x;
    xy += x * y;
    xz += x * z;
    yy += y * y;
    yz += y * z;
    zz += z * z;
  }
  return {xx, xy, xz, yy, yz, zz};
}

// Twice the areas of the faces around.
void list_normals(const WorkingMesh& mesh, std::uint32_t p, Around& around) {
  const glm::vec3 at{mesh.position[p]};
  around.normals.clear();
  for (std::size_t i = 0; i < around.next.size(); ++i) {
    around.normals.emplace_back(glm::cross(mesh.position[around.next[i]] - at, mesh.position[around.previous[i]] - at));
  }
}

bool reaches_out(const Around& around, Range points) {
  std::uint32_t outside = 0;
  for (const std::uint32_t q : around.next) outside |= q - points.begin < points.size() ? 0U : 1U;
  for (const std::uint32_t q : around.previous) outside |= q - points.begin < points.size() ? 0U : 1U;
  return outside != 0;
}

// Everything about one point; `around` is scratch.
Symmetric3 sum_point(WorkingMesh& mesh, const LineRules& rules, std::uint32_t p, double sharp_cosine, Range points,
                     Around& around) {
  Symmetric3 quadric = sum_faces(mesh, p, around);
  if (!mesh.sharpness.empty()) {
    list_normals(mesh, p, around);
    mesh.sharpness[p] = static_cast<float>(std::pow(sharpness_of(around.normals), rules.options.sharpness_power));
    quadric *= mesh.weight_at(p);
  }
  std::uint8_t flags = mesh.flags[p] & point_frozen;
  const glm::dvec3 at{mesh.position[p]};
  if (!closed_ring(around)) flags |= add_borders(mesh, around, at, flags != 0, rules.weight, quadric);
  const bool inner_lines = rules.looks_matter || sharp_cosine > -1.0;
  if (inner_lines) flags |= add_inner_lines(mesh, rules, p, sharp_cosine, around, quadric);
  if (rules.options.borders == Borders::Lock && (flags & point_border) != 0) flags |= point_frozen;
  if (reaches_out(around, points)) flags |= point_outer;
  mesh.flags[p] = flags;
  return quadric;
}

}  // namespace

void sum_quadrics(WorkingMesh& mesh, const LineRules& rules, Range points, std::vector<Symmetric3>& quadrics,
                  std::vector<Candidate>& edges) {
  const double sharp_cosine = std::cos(std::min(rules.options.sharp_edge_rad, std::numbers::pi));
  edges.reserve(3 * std::size_t{points.size()} + points.size() / 8);
  Around around;
  for (std::uint32_t p = points.begin; p != points.end; ++p) {
    quadrics[p] = sum_point(mesh, rules, p, sharp_cosine, points, around);
    for (const std::uint32_t next : around.next) {
      if (listed_once(p, next, mesh.flags[p])) edges.push_back({0, p, next});
    }
  }
}

void CostHistogram::add(const CostHistogram& other) noexcept {
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
}

std::uint32_t CostHistogram::limit(double share) const noexcept {
  const auto total = std::accumulate(counts_.begin(), counts_.end(), std::size_t{0});
  const auto wanted = static_cast<std::size_t>(std::ceil(share * static_cast<double>(total)));
  std::uint32_t bin = 0;
  for (std::size_t below = 0; bin < counts_.size() && below < wanted; ++bin) below += counts_[bin];
  return bin == counts_.size() ? none : bin << shift;
}

void estimate_costs(const WorkingMesh& mesh, const std::vector<Symmetric3>& quadrics, Placement placement,
                    std::vector<Candidate>& edges, CostHistogram& histogram) {
  switch (placement) {
    case Placement::Optimal:
      return estimate<Placement::Optimal>(mesh, quadrics, edges, histogram);
    case Placement::OnEdge:
      return estimate<Placement::OnEdge>(mesh, quadrics, edges, histogram);
    case Placement::Midpoint:
      return estimate<Placement::Midpoint>(mesh, quadrics, edges, histogram);
    case Placement::EndPoint:
    case Placement::Subset:
      return estimate<Placement::Subset>(mesh, quadrics, edges, histogram);
  }
}

}  // namespace lodestone::collapse

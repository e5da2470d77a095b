// SPDX-License-Identifier: MIT
#include "collapse/working_mesh.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <type_traits>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/radix_sort.h"
#include "mesh/weld.h"

namespace lodestone::collapse {
namespace {

// Spreads the low 10 bits of x three apart.
std::uint32_t spread3(std::uint32_t x) {
  x = (x | (x << 16U)) & 0x030000FFU;
  x = (x | (x << 8U)) & 0x0300F00FU;
  x = (x | (x << 4U)) & 0x030C30C3U;
  return (x | (x << 2U)) & 0x09249249U;
}

constexpr std::size_t chunk = 16'384;  // of what is done on all threads

// Points of the weld in Morton order of a 1024^3 grid over the mesh.
std::vector<std::uint32_t> morton_order(const Mesh& source, const Weld& weld, const Context& context) {
  const Box box = bounds(source);
  const glm::dvec3 size = box.size();
  const double extent = std::max({size.x, size.y, size.z, 1e-30});
  std::vector<Keyed> keyed(weld.point_count());
  parallel_for_each(keyed.size(), chunk, context, [&](std::size_t i) {
    const glm::dvec3 at = (glm::dvec3{source.vertices.positions[weld.first_vertex[i]]} - box.min) * (1023.0 / extent);
    keyed[i] = {spread3(static_cast<std::uint32_t>(at.x)) | spread3(static_cast<std::uint32_t>(at.y)) << 1U |
                    spread3(static_cast<std::uint32_t>(at.z)) << 2U,
                static_cast<std::uint32_t>(i)};
  });
  radix_sort(keyed);
  std::vector<std::uint32_t> order(keyed.size());
  for (std::size_t i = 0; i < keyed.size(); ++i) order[i] = keyed[i].value;
  return order;
}

bool is_flat(const Face& f) noexcept {
  return f.point[0] == f.point[1] || f.point[1] == f.point[2] || f.point[2] == f.point[0];
}
std::uint32_t first_point(const Face& f) noexcept { return std::min({f.point[0], f.point[1], f.point[2]}); }

// By first point, otherwise as they are: first cut into parts of the points, then sorted part by part, in the caches.
void sort_faces(std::vector<Face>& faces, std::uint32_t point_count, const Context& context) {
  constexpr std::size_t long_chunk = 65'536;
  std::uint32_t shift = 11;
  while ((point_count >> shift) >= 512) ++shift;
  const std::size_t parts = (point_count >> shift) + 1;
  std::vector<std::vector<std::uint32_t>> at((faces.size() + long_chunk - 1) / long_chunk);  // by long_chunk and part
  parallel_chunks(faces.size(), long_chunk, context, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t>& counts = at[begin / long_chunk];
    counts.assign(parts, 0);
    for (std::size_t i = begin; i != end; ++i) ++counts[first_point(faces[i]) >> shift];
  });
  if (context.cancelled()) return;
  std::vector<std::uint32_t> part_begin(parts + 1, 0);
  std::uint32_t sum = 0;
  for (std::size_t part = 0; part != parts; ++part) {
    for (std::vector<std::uint32_t>& counts : at) sum += std::exchange(counts[part], sum);
    part_begin[part + 1] = sum;
  }
  std::vector<Face> cut(faces.size());
  parallel_chunks(faces.size(), long_chunk, context, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t>& next = at[begin / long_chunk];
    for (std::size_t i = begin; i != end; ++i) cut[next[first_point(faces[i]) >> shift]++] = faces[i];
  });
  parallel_chunks(parts, 8, context, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> next;
    for (std::size_t part = begin; part != end; ++part) {
      next.assign((std::size_t{1} << shift) + 1, 0);
      const auto first = static_cast<std::uint32_t>(part << shift);
      for (std::uint32_t i = part_begin[part]; i != part_begin[part + 1]; ++i) ++next[first_point(cut[i]) - first + 1];
      std::partial_sum(next.begin(), next.end(), next.begin());
      for (std::uint32_t i = part_begin[part]; i != part_begin[part + 1]; ++i) {
        faces[part_begin[part] + next[first_point(cut[i]) - first]++] = cut[i];
      }
    }
  });
}

// All faces of the source that have three points.
std::vector<Face> make_faces(const Mesh& source, const Weld& weld, const Context& context,
                             std::vector<FaceId>& degenerate) {
  std::vector<Face> faces(source.triangle_count());
  std::atomic<bool> any_flat = false;
  parallel_chunks(faces.size(), chunk, context, [&](std::size_t begin, std::size_t end) {
    bool flat = false;
    for (std::size_t f = begin; f != end; ++f) {
      const VertexId* v = &source.indices[3 * f];
      for (std::uint32_t k = 0; k < 3; ++k) faces[f].point[k] = weld.point_of[v[k]];
      faces[f].id = static_cast<FaceId>(f);
      flat = flat || is_flat(faces[f]);
    }
    if (flat) any_flat = true;
  });
  if (!any_flat) return faces;
  for (const Face& f : faces) {
    if (is_flat(f)) degenerate.push_back(f.id);
  }
  std::erase_if(faces, is_flat);
  return faces;
}

// True if no point has several vertices that a face names.
bool find_wedges(WorkingMesh& mesh, const Mesh& source, const Weld& weld, const std::vector<std::uint32_t>& order) {
  mesh.wedge.resize(mesh.point_count());
  if (weld.point_count() == source.vertex_count()) {
    std::transform(order.begin(), order.end(), mesh.wedge.begin(), [&](auto p) { return weld.first_vertex[p]; });
    return true;
  }
  std::fill(mesh.wedge.begin(), mesh.wedge.end(), none);
  for (const Face& f : mesh.faces) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const VertexId v = source.indices[3 * std::size_t{f.id} + k];
      VertexId& at = mesh.wedge[f.point[k]];
      if (at != none && at != v) return false;
      at = v;
    }
  }
  return true;
}

void add_looks(WorkingMesh& mesh, const Mesh& source) {
  mesh.values.normals = source.vertices.normals;
  mesh.values.uvs = source.vertices.uvs;
  mesh.values.colors = source.vertices.colors;
  if (!mesh.has_seams()) return;
  mesh.corner_vertex = source.indices;
  mesh.vertex_uses.assign(source.vertex_count(), 0);
  for (const VertexId v : source.indices) ++mesh.vertex_uses[v];
}

// Faces that lie next to each other in the list, and the points between the least and the greatest that they touch.
struct Stretch {
  Range faces, points;
};

// Closes the gaps that dead faces left.
std::vector<Stretch> drop_faces(std::vector<Face>& faces, const Context& context) {
  constexpr std::size_t stretch_faces = 4'096;
  std::vector<Stretch> stretches((faces.size() + stretch_faces - 1) / stretch_faces);
  parallel_chunks(faces.size(), stretch_faces, context, [&](std::size_t begin, std::size_t end) {
    auto kept = static_cast<std::uint32_t>(begin);
    std::uint32_t low = none;
    std::uint32_t high = 0;
    for (std::size_t i = begin; i != end; ++i) {
      // No branch on what is as good as random: a dead face is written too, and the next one over it.
      const auto [p, id] = faces[i];
      const std::uint32_t dead = id == none ? none : 0;
      low = std::min(low, std::min({p[0], p[1], p[2]}) | dead);
      high = std::max(high, std::max({p[0], p[1], p[2]}) & ~dead);
      faces[kept] = {p, id};
      kept += 1 + dead;
    }
    const Range points{low, high + 1};
    stretches[begin / stretch_faces] = {{static_cast<std::uint32_t>(begin), kept}, points};
  });
  auto end = faces.begin();
  for (Stretch& s : stretches) {
    const auto at = static_cast<std::uint32_t>(end - faces.begin());
    if (at == s.faces.begin) {
      end += s.faces.size();
    } else {
      end = std::move(faces.begin() + s.faces.begin, faces.begin() + s.faces.end, end);
    }
    s.faces = {at, static_cast<std::uint32_t>(end - faces.begin())};
  }
  faces.erase(end, faces.end());
  return stretches;
}

// Calls visit(point, 4 * position of the face + k) for all corners, those of a point in ascending order. Each thread
// does so for its share of the points, and passes over faces that are far from them.
template <class Visit>
void for_each_corner(const WorkingMesh& mesh, const std::vector<Stretch>& stretches, const Context& context,
                     Visit visit) {
  const std::uint32_t share = mesh.point_count() / static_cast<std::uint32_t>(worker_count(context)) + 1;
  parallel_chunks(mesh.point_count(), share, context, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<std::uint32_t>(begin);
    const auto count = static_cast<std::uint32_t>(end - begin);
    for (const Stretch& s : stretches) {
      if (s.points.end <= begin || s.points.begin >= end) continue;
      for (std::uint32_t i = s.faces.begin; i < s.faces.end; ++i) {
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t p = mesh.faces[i].point[k];
          if (p - first < count) visit(p, 4 * i + k);
        }
      }
    }
  });
}

// Renumbers points so that only those in use are left, in the same order.
void drop_points(WorkingMesh& mesh, const std::vector<std::uint32_t>& uses, std::vector<Stretch>& stretches,
                 const Context& context) {
  // Of a point that goes: that of the next that stays, so that nothing below branches on what is as good as random.
  std::vector<std::uint32_t> new_id(mesh.point_count());
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < mesh.point_count(); ++p) {
    new_id[p] = count;
    count += uses[p] != 0 ? 1 : 0;
  }
  const auto keep = [&](auto& array) {
    if (array.empty()) return;
    using Element = typename std::decay_t<decltype(array)>::value_type;
    for (std::uint32_t p = 0; p < new_id.size(); ++p) array[new_id[p]] = Element{array[p]};
    array.resize(count);
  };
  parallel_chunks(stretches.size(), 4, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) {
      Range& points = stretches[i].points;
      if (!stretches[i].faces.empty()) points = {new_id[points.begin], new_id[points.end - 1] + 1};
      for (std::uint32_t f = stretches[i].faces.begin; f != stretches[i].faces.end; ++f) {
        for (std::uint32_t& p : mesh.faces[f].point) p = new_id[p];
      }
    }
  });
  parallel_for_each(5, 1, context, [&](std::size_t array) {
    if (array == 0) keep(mesh.position);
    if (array == 1) keep(mesh.deviation_m);
    if (array == 2) keep(mesh.flags);
    if (array == 3) keep(mesh.part);
    if (array == 4) keep(mesh.wedge);
  });
}

}  // namespace

void find_parts(WorkingMesh& mesh) {
  DisjointSets sets{mesh.point_count()};
  for (const Face& f : mesh.faces) {
    sets.join(f.point[0], f.point[1]);
    sets.join(f.point[0], f.point[2]);
  }
  mesh.part.assign(mesh.point_count(), none);
  mesh.part_count = 0;
  for (std::uint32_t p = 0; p < mesh.point_count(); ++p) {
    const std::uint32_t root = sets.find(p);  // the smallest id of its set, numbered before the others
    mesh.part[p] = root == p ? mesh.part_count++ : mesh.part[root];
  }
  if (mesh.part_count <= 1) mesh.part.clear();
}

WorkingMeshStart make_working_mesh(const Mesh& source, const EdgeCollapseOptions& options, const Context& context) {
  WorkingMeshStart start;
  WorkingMesh& mesh = start.mesh;
  Weld weld = weld_by_position(source.vertices.positions);
  const std::vector<std::uint32_t> order = morton_order(source, weld, context);
  std::vector<std::uint32_t> rank(order.size());
  mesh.position.resize(order.size());
  parallel_for_each(order.size(), chunk, context, [&](std::size_t i) {
    rank[order[i]] = static_cast<std::uint32_t>(i);
    mesh.position[i] = glm::vec3{source.vertices.positions[weld.first_vertex[order[i]]]};
  });
  parallel_for_each(weld.point_of.size(), chunk, context,
                    [&](std::size_t v) { weld.point_of[v] = rank[weld.point_of[v]]; });
  if (!context.cancelled()) mesh.faces = make_faces(source, weld, context, start.degenerate);
  sort_faces(mesh.faces, mesh.point_count(), context);
  if (context.cancelled()) mesh.faces.clear();  // half done
  mesh.deviation_m.assign(mesh.point_count(), 0.0F);
  mesh.flags.assign(mesh.point_count(), 0);
  for (std::size_t v = 0; v < options.frozen.size(); ++v) {
    if (options.frozen[v] != 0) mesh.flags[weld.point_of[v]] |= point_frozen;
  }
  if (!find_wedges(mesh, source, weld, order)) mesh.wedge.clear();
  add_looks(mesh, source);
  return start;
}

void compact(WorkingMesh& mesh, const Context& context) {
  std::vector<Stretch> stretches = drop_faces(mesh.faces, context);
  std::vector<std::uint32_t> uses(std::size_t{mesh.point_count()}, 0);
  for_each_corner(mesh, stretches, context, [&](std::uint32_t p, std::uint32_t) { ++uses[p]; });
  const auto live = static_cast<std::uint32_t>(std::count_if(uses.begin(), uses.end(), [](auto n) { return n != 0; }));
  if (live < mesh.point_count() - mesh.point_count() / 4) {
    drop_points(mesh, uses, stretches, context);
    std::erase(uses, 0U);
  }
  mesh.first.resize(std::size_t{mesh.point_count()} + 1);
  mesh.first[0] = 0;
  std::partial_sum(uses.begin(), uses.end(), mesh.first.begin() + 1);
  mesh.corners.resize(3 * mesh.faces.size());
  std::copy(mesh.first.begin(), mesh.first.end() - 1, uses.begin());
  for_each_corner(mesh, stretches, context,
                  [&](std::uint32_t p, std::uint32_t corner) { mesh.corners[uses[p]++] = corner; });
}

}  // namespace lodestone::collapse

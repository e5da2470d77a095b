// SPDX-License-Identifier: MIT
#include "collapse/working_mesh.h"

#include <algorithm>
#include <numeric>

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

// Points of the weld in Morton order of a 1024^3 grid over the mesh.
std::vector<std::uint32_t> morton_order(const Mesh& source, const Weld& weld) {
  const Box box = bounds(source);
  const glm::dvec3 size = box.size();
  const double extent = std::max({size.x, size.y, size.z, 1e-30});
  std::vector<Keyed> keyed(weld.point_count());
  for (std::uint32_t i = 0; i < weld.point_count(); ++i) {
    const glm::dvec3 at = (glm::dvec3{source.vertices.positions[weld.first_vertex[i]]} - box.min) * (1023.0 / extent);
    keyed[i] = {spread3(static_cast<std::uint32_t>(at.x)) | spread3(static_cast<std::uint32_t>(at.y)) << 1U |
                    spread3(static_cast<std::uint32_t>(at.z)) << 2U,
                i};
  }
  radix_sort(keyed);
  std::vector<std::uint32_t> order(keyed.size());
  for (std::size_t i = 0; i < keyed.size(); ++i) order[i] = keyed[i].value;
  return order;
}

// Calls work(begin, count) on each thread for its share of the points. Who walks through all faces and takes what
// belongs to its points comes across it in the same order, however many threads there are.
template <class Work>
void share_points(std::uint32_t point_count, const Context& context, Work work) {
  const auto workers = static_cast<std::uint32_t>(worker_count(context));
  parallel_chunks(point_count, point_count / workers + 1, context, [&](std::size_t begin, std::size_t end) {
    work(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin));
  });
}

// Calls visit(point, 4 * position of the face + k) for all corners, those of a point in ascending order.
template <class Visit>
void for_each_corner(const WorkingMesh& mesh, const Context& context, Visit visit) {
  share_points(mesh.point_count(), context, [&](std::uint32_t begin, std::uint32_t count) {
    for (std::uint32_t i = 0; i < mesh.faces.size(); ++i) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t p = mesh.faces[i].point[k];
        if (p - begin < count) visit(p, 4 * i + k);
      }
    }
  });
}

void sort_faces(std::vector<Face>& faces, std::uint32_t point_count, const Context& context) {
  std::vector<std::uint32_t> at(std::size_t{point_count} + 1, 0);
  const auto key = [](const Face& f) { return std::min({f.point[0], f.point[1], f.point[2]}); };
  for (const Face& f : faces) ++at[key(f) + 1];
  std::partial_sum(at.begin(), at.end(), at.begin());
  std::vector<Face> sorted(faces.size());
  share_points(point_count, context, [&](std::uint32_t begin, std::uint32_t count) {
    for (const Face& f : faces) {
      if (key(f) - begin < count) sorted[at[key(f)]++] = f;
    }
  });
  faces.swap(sorted);
}

// All faces of the source that have three points.
std::vector<Face> make_faces(const Mesh& source, const Weld& weld, const Context& context,
                             std::vector<FaceId>& degenerate) {
  constexpr std::size_t chunk = 16'384;
  std::vector<Face> faces(source.triangle_count());
  parallel_chunks(faces.size(), chunk, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f != end; ++f) {
      const VertexId* v = &source.indices[3 * f];
      for (std::uint32_t k = 0; k < 3; ++k) faces[f].point[k] = weld.point_of[v[k]];
      faces[f].id = static_cast<FaceId>(f);
    }
  });
  const auto flat = [](const Face& f) {
    return f.point[0] == f.point[1] || f.point[1] == f.point[2] || f.point[2] == f.point[0];
  };
  for (const Face& f : faces) {
    if (flat(f)) degenerate.push_back(f.id);
  }
  if (!degenerate.empty()) std::erase_if(faces, flat);
  return faces;
}

void add_wedges(WorkingMesh& mesh, const Mesh& source, const std::vector<std::uint32_t>& point_of) {
  mesh.wedge.assign(mesh.point_count(), none);
  bool single = true;
  for (const Face& f : mesh.faces) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const VertexId v = source.indices[3 * std::size_t{f.id} + k];
      VertexId& at = mesh.wedge[point_of[v]];
      single = single && (at == none || at == v);
      at = v;
    }
  }
  mesh.values.normals = source.vertices.normals;
  mesh.values.uvs = source.vertices.uvs;
  mesh.values.colors = source.vertices.colors;
  if (single) return;
  mesh.wedge.clear();
  mesh.corner_vertex = source.indices;
  mesh.vertex_uses.assign(source.vertex_count(), 0);
  for (const VertexId v : source.indices) ++mesh.vertex_uses[v];
}

// Renumbers points so that only those in use are left, in the same order.
void drop_points(WorkingMesh& mesh, const std::vector<std::uint32_t>& uses) {
  std::vector<std::uint32_t> new_id(mesh.point_count(), none);
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < mesh.point_count(); ++p) {
    if (uses[p] == 0) continue;
    new_id[p] = count;
    mesh.position[count] = glm::vec3{mesh.position[p]};
    mesh.deviation_m[count] = mesh.deviation_m[p];
    mesh.flags[count] = mesh.flags[p];
    if (!mesh.part.empty()) mesh.part[count] = mesh.part[p];
    if (!mesh.wedge.empty()) mesh.wedge[count] = mesh.wedge[p];
    ++count;
  }
  mesh.position.resize(count);
  mesh.deviation_m.resize(count);
  mesh.flags.resize(count);
  if (!mesh.part.empty()) mesh.part.resize(count);
  if (!mesh.wedge.empty()) mesh.wedge.resize(count);
  for (Face& f : mesh.faces) {
    for (std::uint32_t& p : f.point) p = new_id[p];
  }
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
  const std::vector<std::uint32_t> order = morton_order(source, weld);
  std::vector<std::uint32_t> rank(order.size());
  mesh.position.resize(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
    mesh.position[i] = glm::vec3{source.vertices.positions[weld.first_vertex[order[i]]]};
  }
  for (std::uint32_t& p : weld.point_of) p = rank[p];
  mesh.faces = make_faces(source, weld, context, start.degenerate);
  sort_faces(mesh.faces, mesh.point_count(), context);
  if (context.cancelled()) mesh.faces.clear();  // half done
  mesh.deviation_m.assign(mesh.point_count(), 0.0F);
  mesh.flags.assign(mesh.point_count(), 0);
  for (std::size_t v = 0; v < options.frozen.size(); ++v) {
    if (options.frozen[v] != 0) mesh.flags[weld.point_of[v]] |= point_frozen;
  }
  add_wedges(mesh, source, weld.point_of);
  if (options.prune_parts && !context.cancelled()) find_parts(mesh);
  return start;
}

void compact(WorkingMesh& mesh, const Context& context) {
  std::erase_if(mesh.faces, [](const Face& f) { return f.id == none; });
  std::vector<std::uint32_t> uses(std::size_t{mesh.point_count()}, 0);
  for_each_corner(mesh, context, [&](std::uint32_t p, std::uint32_t) { ++uses[p]; });
  const auto live = static_cast<std::uint32_t>(std::count_if(uses.begin(), uses.end(), [](auto n) { return n != 0; }));
  if (live < mesh.point_count() - mesh.point_count() / 4) {
    drop_points(mesh, uses);
    std::erase(uses, 0U);
  }
  mesh.first.resize(std::size_t{mesh.point_count()} + 1);
  mesh.first[0] = 0;
  std::partial_sum(uses.begin(), uses.end(), mesh.first.begin() + 1);
  mesh.corners.resize(3 * mesh.faces.size());
  std::copy(mesh.first.begin(), mesh.first.end() - 1, uses.begin());
  for_each_corner(mesh, context, [&](std::uint32_t p, std::uint32_t corner) { mesh.corners[uses[p]++] = corner; });
}

}  // namespace lodestone::collapse

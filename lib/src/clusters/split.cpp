// SPDX-License-Identifier: MIT
// Based on: Wang et al. 2023, section 2.2 (clusters by multilevel graph partition, links between near parts).
// Differs: a large mesh is first cut into blocks in space, so that a graph stays small enough for the caches; borders
// of clusters are not locked, only those of groups, so this costs nothing later.
#include "clusters/split.h"

#include <algorithm>
#include <bit>

#include "base/hash.h"
#include "clusters/face_graph.h"

namespace lodestone::clusters {
namespace {

std::uint32_t vertex_count(std::span<const LiveFace> faces) {
  std::vector<VertexId> table(std::bit_ceil(6 * faces.size() + 2), none);
  const std::size_t mask = table.size() - 1;
  std::uint32_t count = 0;
  for (const LiveFace& f : faces) {
    for (const VertexId v : f.vertex) {
      std::size_t at = mix64(v) & mask;
      while (table[at] != none && table[at] != v) at = (at + 1) & mask;
      if (table[at] == none) ++count;
      table[at] = v;
    }
  }
  return count;
}

// Appends the faces in `parts` clusters, halving those with too many vertices.
void append(std::vector<LiveFace> faces, const Ground& ground, const partition::PartSizes& sizes, Pieces& out) {
  std::vector<std::uint32_t> part(faces.size(), 0);
  if (sizes.parts > 1) part = partition::partition_graph(face_graph(faces, ground), sizes);
  std::vector<std::vector<LiveFace>> clusters(sizes.parts);
  for (std::size_t f = 0; f < faces.size(); ++f) clusters[part[f]].push_back(faces[f]);
  for (std::vector<LiveFace>& cluster : clusters) {
    const auto count = static_cast<std::uint32_t>(cluster.size());
    if (count > 85 && vertex_count(cluster) > max_cluster_vertices) {
      append(std::move(cluster), ground, {2, 1, count - count / 3}, out);
      continue;
    }
    const auto begin = static_cast<std::uint32_t>(out.faces.size());
    out.faces.insert(out.faces.end(), cluster.begin(), cluster.end());
    out.clusters.push_back({begin, begin + count});
  }
}

struct Place {
  glm::vec3 middle{0.0F};
  std::uint32_t face = 0;
};

class Blocks {
 public:
  Blocks(std::vector<Place>& places, std::uint32_t block_faces, std::uint32_t cluster_faces)
      : places_(places), block_faces_(block_faces), cluster_faces_(cluster_faces) {}

  void cut(std::size_t begin, std::size_t end) {
    if (end - begin <= block_faces_) {
      blocks.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)});
      return;
    }
    glm::vec3 low{std::numeric_limits<float>::max()};
    glm::vec3 high{std::numeric_limits<float>::lowest()};
    for (std::size_t i = begin; i != end; ++i) {
      low = glm::min(low, places_[i].middle);
      high = glm::max(high, places_[i].middle);
    }
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = (end - begin) / 2 / cluster_faces_ * cluster_faces_;
    const auto at = [&](std::size_t i) { return places_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(begin + half), at(end), [axis](const Place& a, const Place& b) {
      return a.middle[axis] != b.middle[axis] ? a.middle[axis] < b.middle[axis] : a.face < b.face;
    });
    cut(begin, begin + half);
    cut(begin + half, end);
  }

  std::vector<Range> blocks;

 private:
  std::vector<Place>& places_;
  std::uint32_t block_faces_;
  std::uint32_t cluster_faces_;
};

Pieces split_into(const std::vector<LiveFace>& faces, const Ground& ground, std::uint32_t parts,
                  std::uint32_t max_triangles) {
  const std::uint32_t mean = static_cast<std::uint32_t>(faces.size()) / parts;
  Pieces out;
  append(faces, ground, {parts, std::min(mean, max_triangles - max_triangles / 32), max_triangles}, out);
  return out;
}

}  // namespace

Pieces split(std::vector<LiveFace> faces, const Ground& ground, std::uint32_t max_triangles) {
  const auto count = static_cast<std::uint32_t>(faces.size());
  if (count == 0) return {};
  // Where every face has vertices of its own, fewer fit.
  const double vertices_per_face = static_cast<double>(vertex_count(faces)) / count;
  const auto fitting = static_cast<std::uint32_t>(0.98 * max_cluster_vertices / vertices_per_face);
  max_triangles = std::min(max_triangles, std::max(1U, fitting));
  // Two triangles of play for each cluster where there are many, so that borders need not be ragged.
  std::uint32_t parts = (count + max_triangles - 1) / max_triangles;
  const std::uint32_t roomy = (count + max_triangles - 3) / (max_triangles - 2);
  if (roomy >= 16) parts = roomy;
  Pieces best = split_into(faces, ground, parts, max_triangles);
  // Halves of clusters with too many vertices are half empty: one cluster more from the start may be better than many
  // halves.
  for (++parts; parts + 1 < best.clusters.size(); ++parts) {
    Pieces other = split_into(faces, ground, parts, max_triangles);
    if (other.clusters.size() < best.clusters.size()) best = std::move(other);
  }
  return best;
}

std::vector<Range> cut_blocks(std::vector<LiveFace>& faces, std::span<const glm::vec3> positions,
                              std::uint32_t block_faces, std::uint32_t cluster_faces) {
  std::vector<Place> places(faces.size());
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const auto& v = faces[f].vertex;
    places[f] = {(positions[v[0]] + positions[v[1]] + positions[v[2]]) / 3.0F, f};
  }
  Blocks blocks{places, block_faces, cluster_faces};
  blocks.cut(0, places.size());
  for (const Range& block : blocks.blocks) {
    std::sort(places.begin() + block.begin, places.begin() + block.end,
              [](const Place& a, const Place& b) { return a.face < b.face; });
  }
  std::vector<LiveFace> sorted(faces.size());
  for (std::size_t i = 0; i < places.size(); ++i) sorted[i] = faces[places[i].face];
  faces.swap(sorted);
  return std::move(blocks.blocks);
}

}  // namespace lodestone::clusters

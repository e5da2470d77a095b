// SPDX-License-Identifier: MIT
#include "topology.h"

#include <algorithm>

namespace lodestone::model_file {

MaterialId Topology::material(FaceId face) const noexcept {
  const auto above = std::upper_bound(face_begin_.begin(), face_begin_.end() - 1, face);
  return static_cast<MaterialId>(above - face_begin_.begin() - 1);
}

void Topology::link(VertexId vertex, CornerId corner) noexcept {
  vertices_[corner] = vertex;
  if (!listed(vertex)) return;
  if (++valence_[vertex] > max_star) {
    first_[vertex] = none;
    return;
  }
  next_[corner] = first_[vertex];
  first_[vertex] = corner;
}

void Topology::unlink(VertexId vertex, CornerId corner) noexcept {
  if (!listed(vertex)) return;
  --valence_[vertex];
  if (first_[vertex] == corner) {
    first_[vertex] = next_[corner];
    return;
  }
  CornerId before = first_[vertex];
  while (next_[before] != corner) before = next_[before];
  next_[before] = next_[corner];
}

FaceId Topology::add_face(MaterialId m, VertexId a, VertexId b, VertexId c) noexcept {
  const FaceId face = next_face_[m]++;
  link(a, 3 * face);
  link(b, 3 * face + 1);
  link(c, 3 * face + 2);
  return face;
}

void Topology::repoint(CornerId corner, VertexId to) noexcept {
  unlink(vertices_[corner], corner);
  link(to, corner);
}

bool Topology::split_star(VertexId from, const Star& star, std::span<const CornerId> run, VertexId to) noexcept {
  for (const CornerId corner : run) {
    if (vertices_[corner] != from) return false;
    vertices_[corner] = to;
  }
  for (std::size_t i = 0; i < run.size(); ++i) next_[run[i]] = i + 1 < run.size() ? run[i + 1] : none;
  first_[to] = run.front();
  valence_[to] = static_cast<std::uint8_t>(run.size());
  if (!listed(from)) return true;
  CornerId last = none;
  for (std::uint32_t i = 0; i < star.count; ++i) {
    const CornerId corner = star.corners[i];
    if (vertices_[corner] != from) continue;
    (last == none ? first_[from] : next_[last]) = corner;
    last = corner;
  }
  (last == none ? first_[from] : next_[last]) = none;
  valence_[from] = static_cast<std::uint8_t>(star.count - run.size());
  return true;
}

}  // namespace lodestone::model_file

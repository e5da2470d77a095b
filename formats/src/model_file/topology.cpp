// SPDX-License-Identifier: MIT
#include "topology.h"

#include <algorithm>
#include <bit>

namespace lodestone::model_file {

MaterialId Topology::material(FaceId face) const noexcept {
  const auto above = std::upper_bound(face_begin_.begin(), face_begin_.end() - 1, face);
  return static_cast<MaterialId>(above - face_begin_.begin() - 1);
}

std::uint32_t Topology::take(std::uint32_t room) {
  auto& free = free_[static_cast<std::size_t>(std::countr_zero(room)) - 4];
  if (free.empty()) {
    pool_.resize(pool_.size() + room);
    return static_cast<std::uint32_t>(pool_.size() - room);
  }
  const std::uint32_t offset = free.back();
  free.pop_back();
  return offset;
}

void Topology::give_back(const Inline& place) {
  free_[static_cast<std::size_t>(std::countr_zero(place[1])) - 4].push_back(place[0]);
}

void Topology::link_long(VertexId vertex, CornerId corner) {
  const std::uint32_t count = counts_[vertex];
  if (count > max_star) return;
  Inline& place = stars_[vertex];
  if (count == max_star) {
    give_back(place);
  } else if (count == inline_corners || count == place[1]) {
    const std::uint32_t offset = take(2 * count);
    std::copy_n(list(vertex), count, &pool_[offset]);
    if (count != inline_corners) give_back(place);
    place[0] = offset;
    place[1] = 2 * count;
  }
  if (count < max_star) pool_[place[0] + count] = corner;
  counts_[vertex] = static_cast<std::uint16_t>(count + 1);
}

void Topology::shorten(VertexId vertex, std::uint32_t count) {
  if (counts_[vertex] > inline_corners && count <= inline_corners) {
    const Inline place = stars_[vertex];
    std::copy_n(&pool_[place[0]], count, stars_[vertex].data());
    give_back(place);
  }
  counts_[vertex] = static_cast<std::uint16_t>(count);
}

void Topology::unlink(VertexId vertex, CornerId corner) {
  if (!listed(vertex)) return;
  CornerId* first = list(vertex);
  shorten(vertex, static_cast<std::uint32_t>(std::remove(first, first + counts_[vertex], corner) - first));
}

void Topology::repoint(CornerId corner, VertexId to) {
  unlink(vertices_[corner], corner);
  link(to, corner);
}

// Takes the corners that now belong to others off a long list.
void Topology::drop_moved(VertexId from) {
  CornerId* first = list(from);
  const auto moved = [&](CornerId corner) { return vertices_[corner] != from; };
  shorten(from, static_cast<std::uint32_t>(std::remove_if(first, first + counts_[from], moved) - first));
}

}  // namespace lodestone::model_file

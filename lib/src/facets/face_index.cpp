// SPDX-License-Identifier: MIT
#include "facets/face_index.h"

#include <algorithm>
#include <bit>

namespace lodestone::facets {

FaceIndex::FaceIndex(const FacetMesh& mesh)
    : mesh_(mesh),
      links_(mesh.faces.size()),
      heads_(std::bit_ceil(mesh.faces.size() + 1), none),
      first_(level_count, none),
      count_(level_count, 0) {}

std::uint32_t FaceIndex::bucket_of(int level, const glm::dvec3& cell) const noexcept {
  const auto bits = [](double x) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(x)); };
  std::uint64_t h = static_cast<std::uint64_t>(level);
  for (const double x : {cell.x, cell.y, cell.z}) h = (h ^ bits(x)) * 0x9E3779B97F4A7C15U;
  return static_cast<std::uint32_t>(h >> 32U) & static_cast<std::uint32_t>(heads_.size() - 1);
}

void FaceIndex::put(FaceId f) {
  take(f);
  const auto& p = mesh_.faces[f].point;
  Links& links = links_[f];
  links.low = glm::min(mesh_.place[p[0]], glm::min(mesh_.place[p[1]], mesh_.place[p[2]]));
  links.high = glm::max(mesh_.place[p[0]], glm::max(mesh_.place[p[1]], mesh_.place[p[2]]));
  const glm::dvec3 size = glm::dvec3{links.high} - glm::dvec3{links.low};
  const double longest = std::max({size.x, size.y, size.z});
  int level = 0;
  while (level + 1 < level_count && size_of(level) < longest) ++level;
  const glm::dvec3 cell = glm::floor(0.5 * (glm::dvec3{links.low} + glm::dvec3{links.high}) / size_of(level));
  links.level = static_cast<std::uint8_t>(level);
  links.bucket = bucket_of(level, cell);
  const auto push = [&](FaceId& head, FaceId Links::*next, FaceId Links::*previous) {
    links.*next = head;
    links.*previous = none;
    if (head != none) links_[head].*previous = f;
    head = f;
  };
  push(heads_[links.bucket], &Links::next, &Links::previous);
  push(first_[links.level], &Links::next_of_level, &Links::previous_of_level);
  ++count_[links.level];
}

void FaceIndex::take(FaceId f) {
  Links& links = links_[f];
  if (links.level == nowhere) return;
  const auto drop = [&](FaceId& head, FaceId Links::*next, FaceId Links::*previous) {
    (links.*previous == none ? head : links_[links.*previous].*next) = links.*next;
    if (links.*next != none) links_[links.*next].*previous = links.*previous;
  };
  drop(heads_[links.bucket], &Links::next, &Links::previous);
  drop(first_[links.level], &Links::next_of_level, &Links::previous_of_level);
  --count_[links.level];
  links.level = nowhere;
}

void FaceIndex::clear() {
  for (Links& links : links_) links.level = nowhere;
  std::fill(heads_.begin(), heads_.end(), none);
  std::fill(first_.begin(), first_.end(), none);
  std::fill(count_.begin(), count_.end(), 0);
}

}  // namespace lodestone::facets

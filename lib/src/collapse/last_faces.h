// SPDX-License-Identifier: MIT
// Keeps the last face of each group of materials (EdgeCollapseOptions::material_groups).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collapse/working_mesh.h"

namespace lodestone::collapse {

// Counts the faces that a pass could take. Regions work beside each other, so each group is watched by one region: that
// of its first face, which counts those that lie in it wholly. Where that face lies across two regions no collapse of
// the pass reaches it, and the group is safe.
class LastFaces {
 public:
  LastFaces(const Mesh& source, const EdgeCollapseOptions& options)
      : source_(source), group_of_(options.material_groups) {}

  // Of `mesh` as it is now, whose points are cut into `regions`.
  void count(const WorkingMesh& mesh, std::span<const Range> regions);

  // Whether none of these faces, named as in the source, is the last one that `region` has to keep.
  [[nodiscard]] bool may_go(std::span<const FaceId> faces, std::uint32_t region) const;
  // They go.
  void take(std::span<const FaceId> faces, std::uint32_t region);

 private:
  [[nodiscard]] std::uint32_t group(FaceId face) const { return group_of_[source_.face_material(face)]; }

  const Mesh& source_;
  const std::vector<std::uint32_t>& group_of_;
  std::vector<std::uint32_t> keeper_;  // per group: the region that watches it
  std::vector<std::uint32_t> left_;    // per group: faces with an area in that region
};

}  // namespace lodestone::collapse

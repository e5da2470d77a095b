// SPDX-License-Identifier: MIT
// What lies around a part: nearest faces of other parts in a mesh that changes a little from one search to the next.
#pragma once

#include <vector>

#include "facets/facet_mesh.h"
#include "geometry/bvh.h"

namespace lodestone::facets {

class Surroundings {
 public:
  explicit Surroundings(const FacetMesh& mesh) : mesh_(mesh) {}

  // To be called when the mesh has changed. `part_of` is per face and must live as long as it is asked for.
  void update(const std::vector<std::uint32_t>& part_of);

  struct Nearest {
    double distance_m = std::numeric_limits<double>::infinity();
    FaceId face = none;
  };
  // Among the faces of other parts nearer than the limit. `hint`: one of these that is likely near, or none.
  [[nodiscard]] Nearest nearest(const glm::dvec3& p, std::uint32_t part, double limit_m, FaceId hint) const;

  // Whether a face of another part, before or behind, covers p when one looks along `across`.
  [[nodiscard]] bool lies_behind(const glm::dvec3& p, const glm::dvec3& across, std::uint32_t part,
                                 double limit_m) const;

 private:
  // The faces as they were when the tree was built; those that went or moved since are left out.
  struct Grove {
    std::vector<FaceId> faces;
    TriangleBvh tree{{}, {}};  // labelled by part, none where a face is not there any more
  };
  void plant(Grove& grove, std::vector<FaceId> faces) const;
  [[nodiscard]] bool stands(FaceId f) const;

  const FacetMesh& mesh_;
  Grove old_, young_;
  std::vector<std::uint64_t> state_;  // per face when old_ was planted, 0 if it is not in it
};

}  // namespace lodestone::facets

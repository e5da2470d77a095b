// SPDX-License-Identifier: MIT
// Detached parts that lie on, in or near the rest: frames, bars, railings, pipes, antennas.
#pragma once

#include <vector>

#include "facets/facet_mesh.h"
#include "facets/surroundings.h"

namespace lodestone::facets {

struct Part {
  std::vector<FaceId> faces;
  std::vector<std::uint32_t> support;  // points of the faces that it lies upon
  double error_m = 0.0;                // farthest point of it from the rest
  double cost = 0.0;                   // integral of squared distance
};

// Finds the parts that may go. Remembers what each cost at least when it was looked at last, so that most are not
// measured again before the price is near.
class PartFinder {
 public:
  explicit PartFinder(const FacetMesh& mesh);

  // All parts but the largest whose every point is within `limit_m` of the rest and that cost at most `price` a face,
  // the cheapest first.
  [[nodiscard]] std::vector<Part> find(double limit_m, double price);

 private:
  struct Known {
    std::uint64_t state = 0;  // of its faces when it was measured
    double key = 0.0;         // it costs at least so much a face
    FaceId dearest = none;    // the face that costs most
  };
  void split();
  [[nodiscard]] std::uint64_t state_of(const std::vector<FaceId>& faces) const;
  [[nodiscard]] bool measure(std::uint32_t id, double limit_m, double price, Part& part, Known& known);
  [[nodiscard]] bool measure_face(const Face& face, std::uint32_t id, double limit_m, Part& part, double& cost);
  [[nodiscard]] bool add_sample(const glm::dvec3& p, std::uint32_t id, double limit_m, Part& part, double& distance);
  [[nodiscard]] bool closes_opening(std::uint32_t id, double limit_m, const Part& part) const;

  const FacetMesh& mesh_;
  Surroundings around_;
  std::vector<std::uint32_t> part_of_;      // per face
  std::vector<std::vector<FaceId>> parts_;  // faces, ascending
  std::vector<Known> known_;                // per face: of the part whose first face it is
  std::vector<double> distance_m_;          // per point, of the part measured now
  std::vector<std::uint32_t> measured_;     // per point: the part for which distance_m_ holds, plus one
};

}  // namespace lodestone::facets

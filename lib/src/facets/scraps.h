// SPDX-License-Identifier: MIT
// What hangs on the rest by a point or by an edge of three or more faces: bars, ends of mullions, bits of reveals.
#pragma once

#include <optional>
#include <vector>

#include "facets/surroundings.h"

namespace lodestone::facets {

struct Scrap {
  std::vector<FaceId> faces;
  std::vector<FaceId> support;  // that it lies upon, ascending
  double cost = 0.0;            // integral of squared distance from the rest, and of what it showed
  double error_m = 0.0;
};

// Surveyed models have one point where mullions, reveals and walls meet, so mullions are no parts of their own, and
// what is left of them can often slide nowhere.
class ScrapFinder {
 public:
  ScrapFinder(const FacetMesh& mesh, Surroundings& around)
      : mesh_(mesh),
        around_(around),
        group_of_(mesh.faces.size(), none),
        known_(mesh.faces.size()),
        corners_(mesh.point_count()) {}

  // Those that cost at most `price` a face, the cheapest first.
  [[nodiscard]] std::vector<Scrap> find(double price);

 private:
  void group();
  [[nodiscard]] bool belongs(FaceId f, FaceId g) const;
  [[nodiscard]] bool hangs_on_rest(std::uint32_t id) const;
  // What a group costs a face, or at least costs, as long as its faces are as they were.
  struct Known {
    std::uint64_t state = 0;
    double key = 0.0;
    FaceId dearest = none;
  };
  [[nodiscard]] std::uint64_t state_of(std::uint32_t id) const;
  [[nodiscard]] std::optional<Scrap> measure(std::uint32_t id, double price, Known& known);
  void find_corners(const Face& face, std::uint32_t id, double limit_m);
  [[nodiscard]] double cost_of(FaceId f, std::uint32_t id, double limit_m, Scrap& scrap);

  const FacetMesh& mesh_;
  Surroundings& around_;
  std::vector<std::uint32_t> group_of_;  // per face
  FaceGroups groups_;                    // joined by edges that two faces share, ascending
  std::vector<Known> known_;             // per face: of the group whose first face it is

  // Of the group that is measured:
  struct Corner {
    std::uint32_t look = 0;
    FaceId face = none;  // of the rest, the nearest within limit_m
    double squared_m = 0.0;
    double limit_m = 0.0;
  };
  std::vector<Corner> corners_;  // per point
  std::uint32_t look_ = 0;
  FaceId last_nearest_ = none;
};

}  // namespace lodestone::facets

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
  explicit ScrapFinder(const FacetMesh& mesh) : mesh_(mesh), around_(mesh), group_of_(mesh.faces.size(), none) {}

  // Those that cost at most `price` a face, the cheapest first.
  [[nodiscard]] std::vector<Scrap> find(double price);

 private:
  void group();
  [[nodiscard]] bool belongs(FaceId f, FaceId g) const;
  [[nodiscard]] bool hangs_on_rest(std::uint32_t id) const;
  [[nodiscard]] std::optional<Scrap> measure(std::uint32_t id, double price) const;
  [[nodiscard]] double cost_of(FaceId f, std::uint32_t id, double limit_m, Scrap& scrap) const;

  const FacetMesh& mesh_;
  Surroundings around_;
  std::vector<std::uint32_t> group_of_;      // per face
  std::vector<std::vector<FaceId>> groups_;  // joined by edges that two faces share, ascending
};

}  // namespace lodestone::facets

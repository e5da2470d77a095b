// SPDX-License-Identifier: MIT
// Detached parts that lie on, in or near the rest: frames, bars, railings, pipes, antennas.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "facets/face_groups.h"
#include "facets/facet_mesh.h"
#include "facets/pieces.h"
#include "facets/surroundings.h"

namespace lodestone::facets {

struct Part {
  std::vector<FaceId> faces;
  std::vector<std::uint32_t> support;  // points of the faces that it lies upon
  double error_m = 0.0;                // farthest point of it from the rest
  double deviation_m = 0.0;            // of its points before
  double cost = 0.0;                   // integral of squared distance
};

// Live faces that hang together by points: sets the part of every face, none of the dead ones, numbered by their first
// face. Returns how many there are.
std::uint32_t split_by_points(const FacetMesh& mesh, std::vector<std::uint32_t>& part_of_face);

// Finds the parts that may go. Remembers what each cost at least when it was looked at last, so that most are not
// measured again before the price is near.
class PartFinder {
 public:
  PartFinder(const FacetMesh& mesh, const Pieces& pieces, Surroundings& around);

  // To be called when faces may have been sewn to other parts.
  void split();
  [[nodiscard]] const FaceGroups& parts() const noexcept { return parts_; }

  // All parts but that of the most area whose every point is within `limit_m` of the rest and that cost at most `price`
  // a face, the cheapest first.
  [[nodiscard]] std::vector<Part> find(double limit_m, double price);

  // The faces that hang together with this one, as of the last call of find() or of the start.
  [[nodiscard]] std::span<const FaceId> part_of(FaceId f) const { return parts_[part_of_[f]]; }
  [[nodiscard]] bool same_part(FaceId f, FaceId g) const { return part_of_[f] == part_of_[g]; }

 private:
  struct Known {
    std::uint64_t state = 0;  // of its faces when it was measured
    double key = 0.0;         // it costs at least so much a face
    FaceId dearest = none;    // the face that costs most
    bool measured = false;    // then `part` holds all but the faces, as long as what it lies upon is as it was
    std::uint64_t support_state = 0;
    Part part;
  };
  [[nodiscard]] std::uint32_t largest_part() const;
  [[nodiscard]] std::uint64_t state_of(std::span<const FaceId> faces) const;
  enum class Look : std::uint8_t { FromCorners, Everywhere };
  [[nodiscard]] bool measure(double limit_m, double price, Known& known);
  [[nodiscard]] double cost_of(const Face& face, Look look, double limit_m, double most);
  [[nodiscard]] double at_corner(std::uint32_t p, double limit_m);
  [[nodiscard]] double at_middle(std::uint32_t p, std::uint32_t q, double limit_m);
  // The distance of a place from the rest, when it was looked for last.
  struct Sample {
    glm::vec3 at{std::numeric_limits<float>::quiet_NaN()};  // the place
    FaceId face = none;                                     // the nearest; none: there is nothing within distance_m
    std::uint64_t shape = 0;                                // of that face
    double distance_m = 0.0;
  };
  [[nodiscard]] bool holds(const Sample& known, const glm::vec3& at, double limit_m) const;
  [[nodiscard]] double sample(const glm::vec3& at, double limit_m, std::span<const FaceId> hints, Sample& known);
  void sample_corners(std::span<const FaceId> faces, double limit_m);
  [[nodiscard]] double eroded() const;
  [[nodiscard]] double look_lost() const;
  [[nodiscard]] std::uint64_t support_state(const Part& part) const;
  [[nodiscard]] bool closes_opening(double limit_m) const;

  const FacetMesh& mesh_;
  const Pieces& pieces_;
  Surroundings& around_;
  std::vector<std::uint32_t> part_of_;  // per face
  FaceGroups parts_;
  std::optional<std::uint64_t> edits_;  // there had been when they were found
  std::vector<Known> known_;
  std::vector<std::uint32_t> known_of_;  // per face: of the part whose first face it is, or none

  struct Middle {
    std::uint32_t low = none, high = none;  // ends of the edge
    std::uint32_t measurement = 0;          // for which the sample holds
    Sample sample;
  };
  std::vector<Sample> corners_;  // per point
  std::vector<Middle> middles_;  // of edges, by their hash; the last one stays

  // Of the part that is measured:
  std::uint32_t id_ = none;
  Part part_;
  std::uint32_t measurement_ = 0;
  std::vector<std::uint32_t> measured_;  // per point: the measurement for which its sample holds
  std::vector<std::uint32_t> asked_;     // per point: the same for sample_corners()
  std::vector<Surroundings::Query> queries_;
  std::vector<std::uint32_t> query_points_;
  FaceId last_nearest_ = none;  // to the sample before
};

}  // namespace lodestone::facets

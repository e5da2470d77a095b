// SPDX-License-Identifier: MIT
// Finds where a plane can move to.
#pragma once

#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

enum class Direction : std::uint8_t { Outwards, Inwards };

struct Plan {
  std::vector<Move> moves;  // empty: there is nowhere to go
  double way_m = 0.0;       // along the normal, positive outwards
};

class Planner {
 public:
  explicit Planner(const FacetMesh& mesh);

  // Looks at the plane of `surface`, with all faces that lie in it around the same points, which is to move until it
  // meets the next plane of its family or until some edge has shrunk to nothing. Its points keep to the other planes
  // they lie in. False if some point is held by three planes, or if the group was looked at since begin_round().
  void begin_round() { ++round_; }
  [[nodiscard]] bool look_at(std::uint32_t surface);
  // The way it would go, 0 if there is none.
  [[nodiscard]] double way_m(Direction direction) const {
    return next_event(direction == Direction::Outwards ? 1.0 : -1.0);
  }
  [[nodiscard]] std::uint32_t first_point() const { return runners_.front().point; }
  [[nodiscard]] double area_m2() const noexcept { return area_m2_; }
  [[nodiscard]] std::size_t face_count() const noexcept { return faces_.size(); }
  // Empty if there is no way, or if the next plane is less important.
  [[nodiscard]] Plan plan(double way_m);

 private:
  struct Runner {
    std::uint32_t point = none;
    glm::dvec3 speed{0.0};  // per metre along the normal
    std::uint32_t onto = none;
  };
  [[nodiscard]] bool gather(std::uint32_t surface);
  void add_face(FaceId f);
  [[nodiscard]] bool find_speed(Runner& runner) const;
  [[nodiscard]] glm::dvec3 speed_of(std::uint32_t point) const;
  [[nodiscard]] double next_event(double sign) const;
  [[nodiscard]] bool goes_to_greater(double way) const;
  void join_meeting(double way);
  [[nodiscard]] bool in_group_plane(const Face& face) const;

  const FacetMesh& mesh_;
  glm::dvec3 normal_{0.0};
  double offset_m_ = 0.0;
  double area_m2_ = 0.0;
  std::vector<FaceId> faces_;
  std::vector<Runner> runners_;
  std::vector<std::uint32_t> point_stamp_, point_index_, face_stamp_, surface_round_;
  std::uint32_t now_ = 0;
  std::uint32_t round_ = 0;
};

}  // namespace lodestone::facets

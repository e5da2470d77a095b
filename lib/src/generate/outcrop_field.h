// SPDX-License-Identifier: MIT
// The rock behind an outcrop: one function of the place on the surface that both the geometry and the pictures are made
// from, so that painted beds and cracks lie where the carved ones are.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace lodestone::generate {

// One layer of sediment.
struct Bed {
  double base_m = 0;  // stratigraphic height of its lower face
  double thickness_m = 0;
  double hardness = 0;    // -1 recedes .. 1 stands out
  glm::vec3 color{0.0F};  // linear 0..1
};

// What the surface is like at one place.
struct RockSample {
  double relief_m = 0;  // displacement along the outward direction
  double strata_m = 0;  // stratigraphic height, folds and faults taken in
  float face = 0;       // 1 on the cliff, 0 on talus and turf
  float turf = 0;       // 1 on the plateau
  float crack = 0;      // 1 in an open joint or bedding cleft
};

class OutcropField {
 public:
  static constexpr double width_m = 80.0;
  static constexpr double profile_m = 52.0;  // from the foot of the talus over the cliff to the back of the plateau

  explicit OutcropField(std::uint64_t seed);

  // `s_m` along the cliff, `t_m` up the profile; detail finer than `cell_m` is left out.
  [[nodiscard]] RockSample sample(double s_m, double t_m, double cell_m) const noexcept;
  [[nodiscard]] glm::dvec3 position(double s_m, double t_m, double cell_m) const noexcept;
  [[nodiscard]] const std::vector<Bed>& beds() const noexcept { return beds_; }
  [[nodiscard]] std::uint32_t seed() const noexcept { return seed_; }

 private:
  struct Joints {
    double offset_m = 0;  // how far the block stands out
    double crack = 0;
  };
  [[nodiscard]] Joints joints(std::uint32_t bed, double along_m, double up_m, double spacing_m) const noexcept;
  [[nodiscard]] std::uint32_t bed_at(double strata_m) const noexcept;
  [[nodiscard]] RockSample carve(double s_m, double z_m, double cell_m) const noexcept;

  std::uint32_t seed_ = 0;
  double dip_ = 0;
  double fault_s_m_ = 0;
  double throw_m_ = 0;
  std::vector<Bed> beds_;
};

}  // namespace lodestone::generate

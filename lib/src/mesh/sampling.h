// SPDX-License-Identifier: MIT
// Points spread evenly over a surface.
#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/mesh.h>

#include "base/rng.h"

namespace lodestone {

// Sample i of n lies in the i-th of n strips of equal area (faces laid end to end), at a random place. Any sample can
// be asked for on its own, from any thread.
class SurfaceSampler {
 public:
  struct Sample {
    glm::dvec3 position{0.0};  // relative to the mesh's origin
    FaceId face = 0;
  };

  // O(faces). Keeps a reference to the mesh.
  explicit SurfaceSampler(const Mesh& mesh);

  [[nodiscard]] double area() const noexcept { return area_before_.back(); }

  // Precondition: area() > 0, i < n. O(log faces).
  [[nodiscard]] Sample sample(std::uint32_t i, std::uint32_t n, std::uint64_t seed) const;

 private:
  const Mesh& mesh_;
  std::vector<double> area_before_;  // of the faces before each face, and of all
};

}  // namespace lodestone

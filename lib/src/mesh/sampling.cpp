// SPDX-License-Identifier: MIT
// Based on: Turk 1990, "Generating random points in triangles"; stratified along the sum of areas, which lowers the
// variance of a mean against independent samples.
#include "mesh/sampling.h"

#include <algorithm>
#include <cmath>

#include "mesh/weld.h"

namespace lodestone {

SurfaceSampler::SurfaceSampler(const Mesh& mesh) : mesh_(mesh) {
  area_before_.reserve(std::size_t{mesh.triangle_count()} + 1);
  double sum = 0.0;
  area_before_.push_back(sum);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    sum += 0.5 * glm::length(area_vector(mesh, f));
    area_before_.push_back(sum);
  }
}

SurfaceSampler::Sample SurfaceSampler::sample(std::uint32_t i, std::uint32_t n, std::uint64_t seed) const {
  Rng rng{seed, i};
  const double at = area() * (i + rng.unit()) / n;
  // The last face that begins at or before `at`: never one without area, except where rounding leads past the end.
  const auto after = std::upper_bound(area_before_.begin(), area_before_.end() - 1, at);
  const auto face = static_cast<FaceId>(after - area_before_.begin() - 1);
  const double r = std::sqrt(rng.unit());
  const double s = rng.unit();
  const auto& p = mesh_.vertices.positions;
  const VertexId* v = &mesh_.indices[3 * std::size_t{face}];
  return {(1.0 - r) * glm::dvec3{p[v[0]]} + r * (1.0 - s) * glm::dvec3{p[v[1]]} + r * s * glm::dvec3{p[v[2]]}, face};
}

}  // namespace lodestone

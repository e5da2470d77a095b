// SPDX-License-Identifier: MIT
// Based on: Cignoni, Rocchini and Scopigno 1998, "Metro: measuring error on simplified surfaces".
// Differs: samples are stratified by area, found by (seed, number) alone, and summed in order, so that the figures do
// not depend on the number of threads.
#include <algorithm>
#include <cmath>
#include <vector>

#include <lodestone/metrics.h>

#include "base/parallel.h"
#include "geometry/bvh.h"
#include "mesh/sampling.h"

namespace lodestone {
namespace {

constexpr std::size_t chunk = 4096;

// Distances of count points, where point(i) is in the frame of `surface`. Neighbours start from each other's result.
template <class Point>
std::vector<double> distances_to(const TriangleBvh& surface, std::size_t count, const Context& context, Point point) {
  std::vector<double> result(count);
  parallel_chunks(count, chunk, context, [&](std::size_t begin, std::size_t end) {
    std::uint32_t hint = none;
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleBvh::Nearest nearest = surface.nearest(point(i), hint);
      hint = nearest.slot;
      result[i] = std::sqrt(nearest.squared_distance);
    }
  });
  return result;
}

std::vector<VertexId> used_vertices(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertex_count(), 0);
  for (const VertexId v : mesh.indices) used[v] = 1;
  std::vector<VertexId> result;
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    if (used[v] != 0) result.push_back(v);
  }
  return result;
}

// From `mesh` to `surface`, which lies at `offset` in the mesh's frame.
Distances one_side(const Mesh& mesh, const TriangleBvh& surface, const glm::dvec3& offset,
                   const DistanceOptions& options, const Context& context) {
  Distances result;
  const auto vertices = used_vertices(mesh);
  for (const double d : distances_to(surface, vertices.size(), context, [&](std::size_t i) {
         return glm::dvec3{mesh.vertices.positions[vertices[i]]} - offset;
       })) {
    result.max_m = std::max(result.max_m, d);
  }
  const SurfaceSampler sampler{mesh};
  if (options.samples == 0 || !(sampler.area() > 0.0)) return result;
  auto sampled = distances_to(surface, options.samples, context, [&](std::size_t i) {
    return sampler.sample(static_cast<std::uint32_t>(i), options.samples, options.seed).position - offset;
  });
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double d : sampled) {
    sum += d;
    sum_of_squares += d * d;
    result.max_m = std::max(result.max_m, d);
  }
  const auto count = static_cast<double>(sampled.size());
  result.mean_m = sum / count;
  result.rms_m = std::sqrt(sum_of_squares / count);
  const auto rank = std::min(sampled.size() - 1, static_cast<std::size_t>(std::ceil(0.999 * count)));
  std::nth_element(sampled.begin(), sampled.begin() + static_cast<std::ptrdiff_t>(rank), sampled.end());
  result.p999_m = sampled[rank];
  return result;
}

}  // namespace

Result<MeshDistance> compare(const Mesh& a, const Mesh& b, const DistanceOptions& options, const Context& context) {
  if (a.indices.empty() || b.indices.empty()) {
    return Error{ErrorCode::BadData, "there is nothing to compare: the mesh has no triangles",
                 a.indices.empty() ? "first mesh" : "second mesh"};
  }
  const TriangleBvh surface_a{a.vertices.positions, a.indices};
  const TriangleBvh surface_b{b.vertices.positions, b.indices};
  MeshDistance result;
  context.report("distance", 0.0);
  result.a_to_b = one_side(a, surface_b, b.origin - a.origin, options, context);
  context.report("distance", 0.4);
  result.b_to_a = one_side(b, surface_a, a.origin - b.origin, options, context);
  context.report("distance", 0.8);
  result.hausdorff_m = std::max(result.a_to_b.max_m, result.b_to_a.max_m);
  if (!std::isfinite(result.hausdorff_m)) {
    return Error{ErrorCode::BadData, "the meshes cannot be compared: a coordinate is not a finite number", {}};
  }
  result.mean_m = 0.5 * (result.a_to_b.mean_m + result.b_to_a.mean_m);
  result.rms_m =
      std::sqrt(0.5 * (result.a_to_b.rms_m * result.a_to_b.rms_m + result.b_to_a.rms_m * result.b_to_a.rms_m));
  result.p999_m = std::max(result.a_to_b.p999_m, result.b_to_a.p999_m);
  result.diagonal_m = bounds(a).diagonal_m();
  result.normal_deviation_rad = normal_deviation_rad(a, b, context);
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "comparison was cancelled", {}};
  return result;
}

}  // namespace lodestone

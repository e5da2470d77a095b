// SPDX-License-Identifier: MIT
/// \file
/// How far apart two meshes, or two pictures, are.
#pragma once

#include <cstdint>
#include <span>

#include <lodestone/context.h>
#include <lodestone/image.h>
#include <lodestone/mesh.h>

namespace lodestone {

struct DistanceOptions {
  /// Area-uniform random samples on each side, besides all vertices.
  std::uint32_t samples = 200'000;
  std::uint64_t seed = 1;
};

/// From the samples of one surface to the nearest point of the other; metres.
struct Distances {
  double max_m = 0.0;
  double mean_m = 0.0;  ///< over the area samples
  double rms_m = 0.0;   ///< over the area samples
  double p999_m = 0.0;  ///< 99.9 % of the area samples are nearer
};

struct MeshDistance {
  Distances a_to_b, b_to_a;
  double hausdorff_m = 0.0;           ///< larger maximum of the two sides (vertices included)
  double mean_m = 0.0;                ///< mean of the two sides
  double rms_m = 0.0;                 ///< root of the mean of the two mean squares
  double p999_m = 0.0;                ///< larger of the two
  double diagonal_m = 0.0;            ///< of a's bounds
  double normal_deviation_rad = 0.0;  ///< see normal_deviation_rad()
};

/// Two-sided distance by sampling plus vertices; origins are taken into account. O((samples + size) log size).
/// Metro (Cignoni, Rocchini and Scopigno 1998).
[[nodiscard]] Result<MeshDistance> compare(const Mesh& a, const Mesh& b, const DistanceOptions& options = {},
                                           const Context& context = {});

/// Area-weighted mean, over b's faces, of the smallest angle between the face's normal (either sign) and that of any
/// face of `a` that passes within 0.1 m or 1 % of a's diagonal of the face's centre, whichever is smaller (the nearest
/// face if none does); radians. 0 means that every face lies parallel to a plane that the source has there.
[[nodiscard]] double normal_deviation_rad(const Mesh& a, const Mesh& b, const Context& context = {});

/// Mean colour of an image that is not empty, from up to 128 x 128 of its pixels; R, G and B, 0..1, as stored (sRGB).
[[nodiscard]] glm::vec3 mean_color(const Image& image);

/// Root mean square difference of two pictures of one size over RGB, 0..255; with `mask` (one byte per pixel, 0 =
/// skip).
[[nodiscard]] double image_rms(const Image& a, const Image& b, std::span<const std::uint8_t> mask = {});

/// Largest mean absolute RGB difference (0..255) in any 16 x 16 block (blocks at multiples of 16, cut at the border).
[[nodiscard]] double block_pop(const Image& a, const Image& b);

}  // namespace lodestone

// SPDX-License-Identifier: MIT
/// \file
/// The words every other header uses, and the one statement of conventions:
///
///   units         metres, radians, seconds, bytes; a number with a dimension carries its unit in its name
///   axes          right-handed, Z up; a front face is counter-clockwise seen from outside
///   texture       u to the right, v up, (0,0) the bottom-left corner of the image; outside 0..1 it repeats
///   coordinates   float relative to a double `origin`, so that UTM-size coordinates keep 0.1 mm
///   colours       8-bit sRGB with straight (not premultiplied) alpha
///
/// The readers and writers of the `formats` library convert to and from the habits of each file format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

namespace lodestone {

/// Positions in an array. A vertex is a *wedge*: one position with one normal, uv and colour. Vertices that share a
/// position bit for bit are wedges of the same corner point.
using VertexId = std::uint32_t;
using FaceId = std::uint32_t;
using CornerId = std::uint32_t;  ///< 3 * face + {0, 1, 2}
using MaterialId = std::uint32_t;
using FeatureId = std::uint32_t;

inline constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Half-open range of array elements.
struct Range {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  [[nodiscard]] std::uint32_t size() const noexcept { return end - begin; }
  [[nodiscard]] bool empty() const noexcept { return begin == end; }
  friend bool operator==(const Range&, const Range&) = default;
};

/// Axis-aligned box, empty until something is added.
struct Box {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec3& p) noexcept {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  [[nodiscard]] bool empty() const noexcept { return !(min.x <= max.x); }
  [[nodiscard]] glm::dvec3 center() const noexcept { return (min + max) * 0.5; }
  [[nodiscard]] glm::dvec3 size() const noexcept { return empty() ? glm::dvec3{0.0} : max - min; }
  [[nodiscard]] double diagonal_m() const noexcept { return glm::length(size()); }
};

/// Bounding sphere.
struct Sphere {
  glm::dvec3 center{0.0};
  double radius_m = 0.0;
};

}  // namespace lodestone

// SPDX-License-Identifier: MIT
// Based on: Garland and Heckbert 1997; Lindstrom and Turk 1998, section 3 (memoryless: sums over the faces as they
// are). Differs: a quadric is centred at the point whose faces it sums. All of them pass through that point, so its
// linear and constant parts vanish: 6 numbers are left instead of 10, and nothing cancels far from the origin.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

namespace lodestone::collapse {

// Symmetric 3 x 3 matrix; the quadratic form of a sum of squared distances to planes through the origin.
struct Symmetric3 {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  Symmetric3& operator+=(const Symmetric3& o) noexcept {
    xx += o.xx;
    xy += o.xy;
    xz += o.xz;
    yy += o.yy;
    yz += o.yz;
    zz += o.zz;
    return *this;
  }
  Symmetric3& operator*=(double s) noexcept {
    xx *= s;
    xy *= s;
    xz *= s;
    yy *= s;
    yz *= s;
    zz *= s;
    return *this;
  }
  friend Symmetric3 operator+(Symmetric3 a, const Symmetric3& b) noexcept { return a += b; }

  // Adds weight * n n^T: squared distance from the plane with normal n, times weight * |n|^2.
  void add_plane(const glm::dvec3& n, double weight = 1.0) noexcept {
    const glm::dvec3 w = n * weight;
    xx += w.x * n.x;
    xy += w.x * n.y;
    xz += w.x * n.z;
    yy += w.y * n.y;
    yz += w.y * n.z;
    zz += w.z * n.z;
  }
  // Adds weight * (|d|^2 I - d d^T): squared distance from the line along d, times weight * |d|^2.
  void add_line(const glm::dvec3& d, double weight) noexcept {
    add_isotropic(weight * glm::dot(d, d));
    add_plane(d, -weight);
  }
  void add_isotropic(double weight) noexcept {
    xx += weight;
    yy += weight;
    zz += weight;
  }
  [[nodiscard]] double trace() const noexcept { return xx + yy + zz; }
  [[nodiscard]] glm::dvec3 operator*(const glm::dvec3& v) const noexcept {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  [[nodiscard]] double form(const glm::dvec3& v) const noexcept { return glm::dot(v, *this * v); }
};

// Solves with one positive definite matrix by its adjugate.
class Solver3 {
 public:
  explicit Solver3(const Symmetric3& m) noexcept {
    adjugate_.xx = m.yy * m.zz - m.yz * m.yz;
    adjugate_.xy = m.xz * m.yz - m.xy * m.zz;
    adjugate_.xz = m.xy * m.yz - m.xz * m.yy;
    adjugate_.yy = m.xx * m.zz - m.xz * m.xz;
    adjugate_.yz = m.xy * m.xz - m.xx * m.yz;
    adjugate_.zz = m.xx * m.yy - m.xy * m.xy;
    determinant_ = m.xx * adjugate_.xx + m.xy * adjugate_.xy + m.xz * adjugate_.xz;
  }
  [[nodiscard]] bool valid() const noexcept { return determinant_ > 0.0; }
  [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& b) const noexcept {
    return (adjugate_ * b) * (1.0 / determinant_);
  }

 private:
  Symmetric3 adjugate_;
  double determinant_ = 0.0;
};

}  // namespace lodestone::collapse

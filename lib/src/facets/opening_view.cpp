// SPDX-License-Identifier: MIT
#include "facets/opening_view.h"

#include <algorithm>
#include <cmath>

namespace lodestone::facets {
namespace {

constexpr int samples = 28;  // per side of the box around the outline
constexpr double inset_step_m = 0.025;
constexpr double most_inset_ratio = 0.3;  // of the shorter side

// Draws triangles over the samples; the nearest to the viewer stays.
class Raster {
 public:
  Raster(std::vector<MaterialId>& seen, std::vector<double>& height_m) : seen_(seen), height_m_(height_m) {}

  // Corners in samples and, third, towards the viewer.
  void draw(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, MaterialId material) {
    const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (std::abs(area) < 1e-9) return;
    const auto first = [](double x, double y, double z) {
      return static_cast<int>(std::max(0.0, std::ceil(std::min({x, y, z}) - 0.5)));
    };
    const auto last = [](double x, double y, double z) {
      return static_cast<int>(std::min(samples - 1.0, std::floor(std::max({x, y, z}) - 0.5)));
    };
    for (int y = first(a.y, b.y, c.y); y <= last(a.y, b.y, c.y); ++y) {
      for (int x = first(a.x, b.x, c.x); x <= last(a.x, b.x, c.x); ++x) {
        const glm::dvec2 p{x + 0.5, y + 0.5};
        const double s = ((p.x - a.x) * (c.y - a.y) - (c.x - a.x) * (p.y - a.y)) / area;
        const double t = ((b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y)) / area;
        if (s < 0.0 || t < 0.0 || s + t > 1.0) continue;
        const std::size_t at = static_cast<std::size_t>(y) * samples + static_cast<std::size_t>(x);
        const double height_m = a.z + s * (b.z - a.z) + t * (c.z - a.z);
        if (height_m <= height_m_[at]) continue;
        height_m_[at] = height_m;
        seen_[at] = material;
      }
    }
  }

 private:
  std::vector<MaterialId>& seen_;
  std::vector<double>& height_m_;
};

}  // namespace

OpeningView::OpeningView(const FacetMesh& mesh, const std::vector<std::uint32_t>& loop, const glm::dvec3& normal,
                         const std::vector<FaceId>& content)
    : looks_(mesh.looks),
      normal_(normal),
      offset_m_(glm::dot(normal, mesh.at(loop[0]))),
      seen_(std::size_t{samples} * samples, none),
      height_m_(seen_.size(), -std::numeric_limits<double>::infinity()),
      faces_(mesh.source->materials.size(), 0) {
  const glm::dvec3 helper = std::abs(normal.z) < 0.9 ? glm::dvec3{0, 0, 1} : glm::dvec3{1, 0, 0};
  u_ = glm::normalize(glm::cross(helper, normal));
  v_ = glm::cross(normal, u_);
  low_ = glm::dvec2{std::numeric_limits<double>::infinity()};
  high_ = -low_;
  for (const std::uint32_t p : loop) {
    const glm::dvec2 at{glm::dot(u_, mesh.at(p)), glm::dot(v_, mesh.at(p))};
    low_ = glm::min(low_, at);
    high_ = glm::max(high_, at);
  }
  const glm::dvec2 scale = double{samples} / glm::max(high_ - low_, glm::dvec2{1e-6});
  const auto place = [&](std::uint32_t p) {
    const glm::dvec2 at = (glm::dvec2{glm::dot(u_, mesh.at(p)), glm::dot(v_, mesh.at(p))} - low_) * scale;
    return glm::dvec3{at, glm::dot(normal, mesh.at(p))};
  };
  Raster raster{seen_, height_m_};
  for (const FaceId f : content) {
    const auto& p = mesh.faces[f].point;
    const MaterialId material = mesh.source->face_material(f);
    ++faces_[material];
    raster.draw(place(p[0]), place(p[1]), place(p[2]), material);
  }
  for (MaterialId m = 0; m < faces_.size(); ++m) {
    if (faces_[m] != 0) materials_.push_back(m);
  }
}

double OpeningView::area_between(double from_m, double to_m) const {
  const auto count = std::count_if(height_m_.begin(), height_m_.end(), [&](double height_m) {
    return offset_m_ - height_m > from_m && offset_m_ - height_m < to_m;
  });
  const glm::dvec2 size = high_ - low_;
  return size.x * size.y * static_cast<double>(count) / (samples * samples);
}

double OpeningView::farthest_m(double depth_m) const {
  const glm::dvec2 step = (high_ - low_) / double{samples};
  double farthest2 = 0.0;
  for (int i = 0; i < samples * samples; ++i) {
    double nearest2 = std::numeric_limits<double>::infinity();
    const auto look_at = [&](int x, int y, const glm::dvec2& beside) {
      if (x < 0 || x >= samples) return;
      const double height_m = height_m_[static_cast<std::size_t>(y) * samples + static_cast<std::size_t>(x)];
      const glm::dvec3 apart{beside, offset_m_ - height_m - depth_m};
      nearest2 = std::min(nearest2, glm::dot(apart, apart));
    };
    // By rows and columns, from this one on, as long as one may be nearer.
    for (int away = 0; away < samples && away * step.y * away * step.y < nearest2; ++away) {
      for (const int y : {i / samples - away, i / samples + away}) {
        if (y < 0 || y >= samples) continue;
        for (int side = 0; side < samples && side * step.x * side * step.x < nearest2; ++side) {
          look_at(i % samples - side, y, {step.x * side, step.y * away});
          look_at(i % samples + side, y, {step.x * side, step.y * away});
        }
      }
    }
    if (std::isfinite(nearest2)) farthest2 = std::max(farthest2, nearest2);
  }
  return std::sqrt(farthest2) + 0.5 * glm::length(step);
}

double OpeningView::cost(MaterialId material, double area_m2) const {
  double cost = 0.0;
  for (const MaterialId m : seen_) {
    if (m != none) cost += looks_.cost(m, material, area_m2 / (samples * samples));
  }
  return cost;
}

OpeningView::Choice OpeningView::best_for(const std::vector<double>& shares, double area_m2,
                                          std::size_t least_faces) const {
  Choice best{none, std::numeric_limits<double>::infinity()};
  for (const MaterialId m : materials_) {
    if (faces_[m] < least_faces) continue;
    double cost = 0.0;
    for (const MaterialId seen : materials_) cost += looks_.cost(seen, m, shares[seen] * area_m2);
    if (cost < best.cost) best = {m, cost};
  }
  return best;
}

std::array<glm::dvec3, 4> OpeningView::inset(double inset_m) const {
  const glm::dvec2 a = low_ + inset_m;
  const glm::dvec2 b = high_ - inset_m;
  const auto at = [&](double x, double y) { return x * u_ + y * v_ + offset_m_ * normal_; };
  return {at(a.x, a.y), at(a.x, b.y), at(b.x, b.y), at(b.x, a.y)};
}

std::optional<WindowFrame> OpeningView::best_frame(double area_m2, std::size_t frame_faces,
                                                   std::size_t pane_faces) const {
  WindowFrame best;
  best.cost = std::numeric_limits<double>::infinity();
  const glm::dvec2 size = high_ - low_;
  constexpr double share = 1.0 / (samples * samples);
  int steps = 0;
  while ((steps + 1) * inset_step_m < most_inset_ratio * std::min(size.x, size.y)) ++steps;
  // Samples of each material that come to lie outside with each step.
  std::vector<std::uint32_t> count(faces_.size(), 0);
  std::vector<std::uint32_t> leaving(static_cast<std::size_t>(steps) * faces_.size(), 0);
  for (int i = 0; i < samples * samples; ++i) {
    const MaterialId m = seen_[static_cast<std::size_t>(i)];
    if (m == none) continue;
    ++count[m];
    const int row = i / samples;
    const glm::dvec2 at{i % samples + 0.5, row + 0.5};
    const glm::dvec2 depth = glm::min(at, double{samples} - at) * size / double{samples};
    const double step = std::max(0.0, std::ceil(std::min(depth.x, depth.y) / inset_step_m) - 1.0);
    if (step < steps) ++leaving[static_cast<std::size_t>(step) * faces_.size() + m];
  }
  std::vector<std::uint32_t> gone(faces_.size(), 0);
  std::vector<double> inside(faces_.size()), outside(faces_.size());
  for (int step = 1; step <= steps; ++step) {
    const double d = step * inset_step_m;
    for (const MaterialId m : materials_) {
      gone[m] += leaving[static_cast<std::size_t>(step - 1) * faces_.size() + m];
      inside[m] = share * (count[m] - gone[m]);
      outside[m] = share * gone[m];
    }
    const Choice pane = best_for(inside, area_m2, pane_faces);
    const Choice frame = best_for(outside, area_m2, frame_faces);
    if (pane.material == none || frame.material == none || pane.material == frame.material) continue;
    if (pane.cost + frame.cost >= best.cost) continue;
    best = {inset(d), frame.material, pane.material, pane.cost + frame.cost};
  }
  if (best.frame == none) return std::nullopt;
  return best;
}

}  // namespace lodestone::facets

// SPDX-License-Identifier: MIT
// What one sees of an opening from before its wall.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

// A window as two rectangles: its outline in one material and, so far inside, the pane in another one.
struct WindowFrame {
  std::array<glm::dvec3, 4> corners{};  // of the pane, clockwise as seen from before the wall
  MaterialId frame = none;
  MaterialId pane = none;
  double cost = 0.0;
};

class OpeningView {
 public:
  // The faces that stand in the opening, seen against the normal of its wall.
  OpeningView(const FacetMesh& mesh, const std::vector<std::uint32_t>& loop, const glm::dvec3& normal,
              const std::vector<FaceId>& content);

  // Faces of the material among those that stand in it.
  [[nodiscard]] std::size_t face_count(MaterialId material) const noexcept { return faces_[material]; }
  // What is seen of it between these distances behind the wall, m2.
  [[nodiscard]] double area_between(double from_m, double to_m) const;
  // How far any place of a sheet so far behind the wall is from what is seen, at most.
  [[nodiscard]] double farthest_m(double depth_m) const;
  // Of showing one material all over an opening of so much area, m^4.
  [[nodiscard]] double cost(MaterialId material, double area_m2) const;
  // The frame that shows most of it, of materials that have so many faces; empty if one material looks as well.
  [[nodiscard]] std::optional<WindowFrame> best_frame(double area_m2, std::size_t frame_faces,
                                                      std::size_t pane_faces) const;

 private:
  struct Choice {
    MaterialId material = none;
    double cost = 0.0;
  };
  [[nodiscard]] Choice best_for(const std::vector<double>& shares, double area_m2, std::size_t least_faces) const;
  [[nodiscard]] std::array<glm::dvec3, 4> inset(double inset_m) const;

  const Looks& looks_;
  glm::dvec3 u_, v_, normal_;
  glm::dvec2 low_{0.0}, high_{0.0};
  double offset_m_ = 0.0;
  std::vector<MaterialId> seen_;       // per sample, row by row; none where nothing stands
  std::vector<double> height_m_;       // of what is seen, before the origin along the normal
  std::vector<std::size_t> faces_;     // per material
  std::vector<MaterialId> materials_;  // that stand in it, ascending
};

}  // namespace lodestone::facets

// SPDX-License-Identifier: MIT
// A street on the screen: every house has a cursor of its own, at the level that its distance asks for.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "../render/renderer.h"
#include "street.h"

namespace lodestone::render {

class StreetScene {
 public:
  StreetScene(const Gl& gl, std::shared_ptr<const Street> street, double morph_seconds);

  /// Moves every house towards the coarsest level that is wrong by at most so many pixels.
  void update(const View& view, double error_px, double dt_s);

  /// To be drawn since the last update.
  [[nodiscard]] std::span<const Item> items() const { return items_; }
  [[nodiscard]] const Street& street() const { return *street_; }
  [[nodiscard]] bool still() const { return still_; }
  [[nodiscard]] std::uint32_t triangle_count() const;  ///< of the houses, as drawn
  [[nodiscard]] std::uint32_t finest_triangle_count() const;
  /// The fewest and the most that a house is drawn with.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> triangles_of_a_house() const;
  [[nodiscard]] std::size_t uploaded_bytes() const { return uploaded_bytes_; }  ///< by the last update

 private:
  struct House {
    House(const Gl& gl, const Street::House& house, double morph_seconds);
    Cursor cursor;
    Geometry geometry;
    std::optional<Geometry> beside;
  };

  std::shared_ptr<const Street> street_;
  std::map<const ProgressiveModel*, std::unique_ptr<Surfaces>> surfaces_;  ///< looked up only
  std::vector<std::unique_ptr<House>> houses_;
  SortedMesh sorted_ground_;
  Geometry ground_;
  Surfaces ground_surfaces_;
  std::vector<Item> items_;  ///< the ground, the houses, then the second pictures of those that fade
  bool still_ = false;
  std::size_t uploaded_bytes_ = 0;
};

}  // namespace lodestone::render

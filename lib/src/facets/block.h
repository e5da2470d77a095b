// SPDX-License-Identifier: MIT
// The last level of a building: a closed prism over its footprint; of a street, one for each house. And what comes
// before it where a house has two heights.
#pragma once

#include <optional>
#include <string>

#include "facets/facet_mesh.h"
#include "facets/footprint.h"
#include "facets/houses.h"
#include "facets/patch.h"
#include "facets/stepped.h"

namespace lodestone::facets {

class Block {
 public:
  // Precondition: nothing has changed in the mesh yet, the error is that from the source. O(faces).
  explicit Block(const FacetMesh& mesh);
  // The same with a step in its roof, to come before it: of one house with two heights. Does not exist otherwise.
  Block(const FacetMesh& mesh, const Block& prism);

  [[nodiscard]] bool exists() const noexcept { return !triangles_.empty(); }
  [[nodiscard]] std::uint32_t face_count() const noexcept { return static_cast<std::uint32_t>(triangles_.size()); }
  [[nodiscard]] double error_m() const noexcept { return error_m_; }
  [[nodiscard]] const std::string& why_not() const noexcept { return sentence_; }

  // Whether it is time: with fewer faces, or fewer that look like walls or roofs, it could not be made any more.
  [[nodiscard]] bool must_come(const FacetMesh& mesh) const noexcept;
  // Whether these faces are among the last that it needs, of all or for its looks.
  [[nodiscard]] bool needs(const FacetMesh& mesh, std::span<const FaceId> faces) const noexcept;

  // All faces that are left become the prisms, in one record. False, and nothing happens, if they or their vertices are
  // too few.
  [[nodiscard]] bool apply(FacetMesh& mesh, progressive::EditLog& log) const;

 private:
  struct Triangle {
    std::array<std::uint32_t, 3> corner{};
    std::uint32_t facet = 0;  // 0 bottom, 1 top, then the sides
    std::uint32_t house = 0;
  };
  class Caster;
  void add_prism(const Footprint& footprint, std::uint32_t house);
  void add_stepped(const SteppedShape& shape);
  void measure(const FacetMesh& mesh);
  void choose_materials(const FacetMesh& mesh);

  Houses houses_;
  Footprint footprint_;         // of one house
  double lowest_roof_m_ = 0.0;  // of one house
  std::vector<glm::vec3> corners_;
  std::vector<Triangle> triangles_;
  // What walls, and what roofs are made of to a good part, and how many faces of that must be left.
  struct Fabric {
    std::vector<std::uint8_t> has;  // per material
    std::uint32_t least_faces = 0;
    [[nodiscard]] std::uint32_t left(const FacetMesh& mesh) const noexcept;
  };
  Fabric walls_, roofs_;
  double error_m_ = 0.0;
  std::string sentence_;
};

// Whether the faces that are left are a closed prism as they are: nothing but upright and level faces without an open
// side.
[[nodiscard]] bool is_block(const FacetMesh& mesh);

}  // namespace lodestone::facets

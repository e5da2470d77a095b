// SPDX-License-Identifier: MIT
// What lies around a part: nearest faces of other parts in a mesh that changes a little from one search to the next.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "facets/face_groups.h"
#include "facets/facet_mesh.h"
#include "facets/float_box.h"
#include "geometry/bvh.h"

namespace lodestone::facets {

class Surroundings {
 public:
  explicit Surroundings(const FacetMesh& mesh) : mesh_(mesh) {}

  // To be called when the mesh or what counts as a part has changed; `part_of`, per face, must live as long as it is
  // asked for.
  void update(const FaceGroups& parts, const std::vector<std::uint32_t>& part_of);

  // What is nearest to a place.
  struct Query {
    glm::vec3 at{0.0F};
    double squared_m = 0.0;  // before: of the limit
    FaceId face = none;      // none: there is nothing within the limit
  };
  // Tells a face of another part that is likely near.
  void hint(Query& query, FaceId face) const;
  // Among the faces of other parts, for places that lie together, in one walk.
  void nearest(std::span<Query> queries, std::uint32_t part) const;

  // Whether a face of another part, before or behind, covers p when one looks along `across`, a unit vector. The hints,
  // which may be dead or none, are asked first.
  [[nodiscard]] bool lies_behind(const glm::dvec3& p, const glm::dvec3& across, std::uint32_t part, double limit_m,
                                 std::span<const FaceId> hints) const;

 private:
  // The faces as they were when the tree was built; those that went or moved since are left out. The tree is about
  // boxes of few faces of one part each, so that ten thousand tiles are ten thousand things, not a hundred thousand.
  struct Slot {
    std::array<glm::vec3, 3> corner{};
    FaceId face = none;  // none if it does not stand any more
  };
  struct Bundle {
    FloatBox box;
    std::uint32_t first = 0, count = 0;  // in slots
  };
  struct Grove {
    std::vector<Slot> slots;
    std::vector<Bundle> bundles;
    TriangleBvh tree{{}, {}};  // of the boxes
  };
  // Calls visit(slot) for the faces of other parts in the bundle until it returns false; whether it never did.
  template <class Visit>
  bool visit_others(const Grove& grove, const Bundle& bundle, std::uint32_t part, Visit visit) const;
  void add_bundle(Grove& grove, std::span<const FaceId> faces) const;
  void plant(Grove& grove) const;
  [[nodiscard]] bool stands(FaceId f) const;

  const FacetMesh& mesh_;
  const std::vector<std::uint32_t>* part_of_ = nullptr;
  std::optional<std::uint64_t> edits_;  // there had been at the last update
  Grove old_, young_;
  std::vector<std::uint64_t> shape_;  // per face when old_ was planted, 0 if it is not in it
};

}  // namespace lodestone::facets

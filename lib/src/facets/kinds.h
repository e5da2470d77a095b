// SPDX-License-Identifier: MIT
// Detached parts of one shape, so that what happens within a part is found out once for all like it.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "facets/face_groups.h"
#include "facets/facet_mesh.h"

namespace lodestone::facets {

// Parts are of one kind if one is the other, turned and moved: the same faces between the same points in the same
// order, materials, planes to keep and deviations included, all within a hundredth of a millimetre. The first of a kind
// leads; the others follow: nobody looks at them, they do what it does. Holds as long as nothing else happens to any
// of them; then update().
class Kinds {
 public:
  explicit Kinds(const FacetMesh& mesh);

  // Sorts the parts. Without call there are no kinds.
  void update(const FaceGroups& parts);

  [[nodiscard]] bool follows(std::uint32_t point) const noexcept { return follows_[point] != 0; }
  [[nodiscard]] bool follows(const Face& face) const noexcept { return follows(face.point[0]); }

  // What the followers of a part have to do: take it before the part's own moves are done.
  class Errand {
   public:
    [[nodiscard]] std::uint32_t size() const noexcept { return count_; }
    // Until it is called again.
    [[nodiscard]] std::span<const Move> moves(std::uint32_t follower);
    // How far it is from the shape of the leader.
    [[nodiscard]] double apart_m(std::uint32_t follower) const noexcept;

   private:
    friend class Kinds;
    const Kinds* kinds_ = nullptr;
    std::uint32_t kind_ = none, count_ = 0;
    std::vector<Move> local_;  // points as the leader's shape numbers them, ways instead of places
    std::vector<Move> moves_;
  };
  void prepare(std::span<const Move> moves, Errand& errand) const;

 private:
  struct Member {
    std::uint32_t first_point = 0;  // in points_
    glm::dmat3 turn{1.0};           // from the frame of the shape
    double apart_m = 0.0;
  };
  // A part in a frame of its own.
  struct Shape {
    std::vector<std::uint32_t> points;  // in the order in which faces name them
    std::vector<std::uint32_t> words;   // of each face: corners, material, surface, all by their order
    std::vector<glm::vec3> vectors;     // places, then the normals of the faces
    std::vector<float> numbers;         // deviations, then areas of surfaces
    glm::dmat3 turn{1.0};
    double size_m = 0.0;  // sum of the places' distances from the first one
    std::uint64_t hash = 0;
  };
  struct Kind {
    Shape shape;  // of the leader
    std::vector<Member> members;
  };
  [[nodiscard]] bool describe(std::span<const FaceId> faces);
  void find_frame(std::span<const FaceId> faces);
  [[nodiscard]] double apart_m(const Shape& a) const;
  [[nodiscard]] std::uint32_t find_kind(double& apart_m) const;

  const FacetMesh& mesh_;
  std::vector<std::uint8_t> follows_;        // per point
  std::vector<std::uint32_t> kind_, local_;  // per point: of a leader with followers, else none
  std::vector<std::uint32_t> points_;        // of members
  std::vector<Kind> kinds_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> by_hash_;

  Shape shape_;                       // of the part that is looked at
  std::vector<std::uint32_t> seen_;   // per point: the look in which it was met
  std::vector<std::uint32_t> order_;  // per point: as the how manyth
  std::uint32_t look_ = 0;
};

}  // namespace lodestone::facets

// SPDX-License-Identifier: MIT
// What a cursor draws, taken out for comparison.
#pragma once

#include <cstring>
#include <vector>

#include <lodestone/cursor.h>

namespace lodestone::test {

template <class T>
void append_bytes(std::vector<std::byte>& out, std::span<const T> array, std::size_t count) {
  const auto bytes = std::as_bytes(array.subspan(0, std::min(count, array.size())));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

// Every byte in use: indices of the drawn faces, then the vertices they may name.
[[nodiscard]] inline std::vector<std::byte> bytes_in_use(const Cursor& cursor) {
  std::vector<std::byte> bytes;
  for (const DrawRange& draw : cursor.draws()) {
    append_bytes(bytes, cursor.indices().subspan(static_cast<std::size_t>(draw.first_index) * cursor.index_bytes()),
                 static_cast<std::size_t>(draw.index_count) * cursor.index_bytes());
  }
  append_bytes(bytes, cursor.positions(), cursor.vertex_count());
  append_bytes(bytes, cursor.normals(), cursor.vertex_count());
  append_bytes(bytes, cursor.uvs(), cursor.vertex_count());
  append_bytes(bytes, cursor.colors(), cursor.vertex_count());
  return bytes;
}

// Corners of each face slot as drawn; three zeros where the slot is not in use.
struct DrawnFaces {
  std::vector<glm::vec3> positions;
  std::vector<bool> in_use;
};
[[nodiscard]] inline DrawnFaces drawn_faces(const Cursor& cursor) {
  DrawnFaces drawn;
  for (FaceId f = 0; f < cursor.model().face_slot_count(); ++f) {
    drawn.in_use.push_back(cursor.face_in_use(f));
    for (CornerId c = 3 * f; c < 3 * f + 3; ++c) {
      drawn.positions.push_back(drawn.in_use.back() ? glm::vec3{cursor.positions()[cursor.index(c)]} : glm::vec3{0.0F});
    }
  }
  return drawn;
}

}  // namespace lodestone::test

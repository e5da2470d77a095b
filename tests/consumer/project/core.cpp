// SPDX-License-Identifier: MIT
// Uses the core alone: a model of a tetrahedron, slid to its base.
#include <lodestone/cursor.h>
#include <lodestone/edge_collapse.h>

int main() {
  lodestone::Mesh mesh;
  mesh.materials.resize(1);
  mesh.vertices.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const auto built = lodestone::build_by_edge_collapse(mesh);
  if (!built) return 1;
  lodestone::Cursor cursor{built->model};
  cursor.jump(built->model->record_count());
  return cursor.triangle_count() == 4 ? 0 : 2;
}

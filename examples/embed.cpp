// SPDX-License-Identifier: MIT
// Lodestone in a viewer: open a progressive model and draw it at a level that follows a target. The lines between the
// two marks are all there is to it (README.md shows them); the three functions above stand for your renderer.
//
//     embed house.lode
#include <lodestone/cursor.h>
#include <lodestone/formats.h>

#include <cstdint>
#include <cstdio>

namespace {

std::uint64_t uploaded_elements = 0;
std::uint64_t drawn_triangles = 0;

void upload_vertices(const lodestone::Cursor& /*cursor*/, lodestone::Range range) { uploaded_elements += range.size(); }
void upload_indices(const lodestone::Cursor& /*cursor*/, lodestone::Range range) { uploaded_elements += range.size(); }
void draw_triangles(const lodestone::DrawRange& draw) { drawn_triangles += draw.index_count / 3; }

// [embed]
int run(const char* file) {
  const auto model = lodestone::read_model(file);
  if (!model) return std::fprintf(stderr, "%s\n", lodestone::to_line(model.error()).c_str()), 2;
  lodestone::Cursor cursor{*model};                   // one per instance; many share a model
  cursor.set_target(lodestone::Target::ratio(0.25));  // or by level, triangles, metres or pixels
  for (bool arrived = false; !arrived;) {             // your frame loop
    arrived = cursor.step({.max_records = 20'000}, 1.0 / 60.0).arrived;
    for (const auto range : cursor.dirty_vertices()) upload_vertices(cursor, range);
    for (const auto range : cursor.dirty_indices()) upload_indices(cursor, range);
    cursor.clear_dirty();
    for (const auto& draw : cursor.draws()) draw_triangles(draw);
  }
  return 0;
}
// [embed]

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: embed MODEL.lode\n", stderr);
    return 1;
  }
  const int code = run(argv[1]);
  std::printf("uploaded %llu elements, drew %llu triangles\n", static_cast<unsigned long long>(uploaded_elements),
              static_cast<unsigned long long>(drawn_triangles));
  return code;
}

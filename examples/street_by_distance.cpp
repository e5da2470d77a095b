// SPDX-License-Identifier: MIT
// A street that coarsens with distance: houses of every roof in two rows, each a model by facet shift, each at the
// coarsest level that is wrong by at most so many pixels for a camera at the street's near end.
//
//     street_by_distance street.glb [PIXELS]
//
// Look at it with `lodestone view street.glb`, or from where the camera stands, which is printed.
#include <lodestone/auto_build.h>
#include <lodestone/formats.h>
#include <lodestone/generate.h>
#include <lodestone/view.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using namespace lodestone;

constexpr Roof roofs[] = {Roof::Gable, Roof::Hip, Roof::Flat, Roof::Spire};
constexpr int houses_a_side = 12;
constexpr double plot_m = 28.0;
constexpr double half_street_m = 16.0;

int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", to_line(error).c_str());
  return 2;
}

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void add_house(const Mesh& house, const glm::dvec3& place, Mesh& street) {
  const auto first = street.vertex_count();
  const auto first_material = static_cast<MaterialId>(street.materials.size());
  const auto first_texture = static_cast<std::uint32_t>(street.textures.size());
  for (const glm::vec3& p : house.vertices.positions) street.vertices.positions.emplace_back(glm::dvec3{p} + place);
  append(house.vertices.normals, street.vertices.normals);
  append(house.vertices.uvs, street.vertices.uvs);
  for (const VertexId v : house.indices) street.indices.push_back(first + v);
  for (FaceId f = 0; f < house.triangle_count(); ++f) {
    street.face_materials.push_back(first_material + house.face_material(f));
  }
  for (Material material : house.materials) {
    if (material.texture != none) material.texture += first_texture;
    street.materials.push_back(std::move(material));
  }
  append(house.textures, street.textures);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("usage: street_by_distance OUT.glb [PIXELS]\n", stderr);
    return 1;
  }
  const double most_px = argc > 2 ? std::atof(argv[2]) : 1.0;
  std::vector<std::shared_ptr<const ProgressiveModel>> models;
  for (const Roof roof : roofs) {
    const auto house = generate_house({{.triangles = 12'000, .texture_size_px = 64}, roof});
    if (!house) return fail(house.error());
    const auto built = build_automatically(*house);
    if (!built) return fail(built.error());
    models.push_back(built->model);
  }
  const View view{.eye = {0.0, -30.0, 4.0}};
  Mesh street;
  for (int i = 0; i < houses_a_side; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const std::size_t kind = static_cast<std::size_t>(2 * i + (side > 0.0 ? 1 : 0)) % models.size();
      const ProgressiveModel& model = *models[kind];
      const Box& box = model.bounds();
      const glm::dvec3 middle = 0.5 * (box.min + box.max);
      const glm::dvec3 place{side * half_street_m - middle.x, plot_m * i - middle.y, -box.min.z};
      const Sphere around{place + middle, 0.5 * box.diagonal_m()};
      const LevelInfo level = model.info(model.level_of_error(error_m_at(view, most_px, around)));
      std::printf("%5.0f m away: %5u triangles, at most %.3f m wrong\n", glm::length(around.center - view.eye),
                  level.triangles, level.error_m);
      add_house(model.extract(level.level), place, street);
    }
  }
  std::printf("%u triangles; the camera stands at 0,-30,4\n", street.triangle_count());
  if (Status written = write_mesh(street, argv[1]); !written) return fail(written.error());
  return 0;
}

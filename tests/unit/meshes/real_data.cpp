// SPDX-License-Identifier: MIT
#include <map>
#include <sstream>

#include "data.h"
#include "reading.h"

using namespace lodestone;

namespace {

struct Counts {
  std::uint32_t polygons = 0;
  std::uint32_t triangles = 0;
};

std::map<std::string, Counts> known_counts(const std::filesystem::path& csv) {
  std::map<std::string, Counts> counts;
  std::ifstream file{csv};
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream row{line};
    std::string id;
    std::string polygons;
    std::string vertices;
    std::string triangles;
    std::getline(row, id, ',');
    std::getline(row, polygons, ',');
    std::getline(row, vertices, ',');
    std::getline(row, triangles, ',');
    counts[id] = {static_cast<std::uint32_t>(std::stoul(polygons)), static_cast<std::uint32_t>(std::stoul(triangles))};
  }
  return counts;
}

}  // namespace

TEST_CASE("every real building reads with its triangles, textures and place") {
  LODESTONE_REQUIRE_DATA(root);
  const auto counts = known_counts(root / "buildings" / "counts.csv");
  REQUIRE(counts.size() == 49);
  for (const auto& [id, count] : counts) {
    const auto read = read_mesh(root / "buildings" / id / (id + ".obj"));
    CAPTURE(id);
    REQUIRE(read.ok());
    CHECK(read->mesh.triangle_count() == count.triangles);
    CHECK(read.warnings().empty());
    CHECK(read->mesh.origin.x > 600'000.0);
    CHECK_FALSE(read->mesh.textures.empty());
    for (const auto& texture : read->mesh.textures) CHECK(texture.mime_type == "image/jpeg");
  }
}

TEST_CASE("the street, the outcrops, the scans and the geological model read whole") {
  LODESTONE_REQUIRE_DATA(root);
  const std::pair<const char*, std::uint32_t> files[] = {
      {"outcrops/sol1151/sol1151-wheel-measure.obj", 138'878},
      {"outcrops/sol1151_multitex/sol1151_multitex.obj", 138'878},
      {"meshes/koala/koala.obj", 99'994},
      {"meshes/boat/boat.obj", 32'416},
      {"meshes/mountain/mountain.obj", 50'562},
      {"geology/obj/geomodel3d.obj", 55'426},
  };
  for (const auto& [name, triangles] : files) {
    const auto read = read_mesh(root / name);
    CAPTURE(name);
    REQUIRE(read.ok());
    CHECK(read->mesh.triangle_count() == triangles);
    CHECK(read.warnings().empty());
  }
  const auto street = read_mesh(root / "buildings" / "street_all" / "street_all.obj");
  REQUIRE(street.ok());
  CHECK(street->mesh.materials.size() == 107);  // of 112 in its library; five are used by no face
  CHECK(street->mesh.textures.size() == 63);
  CHECK(read_mesh(root / files[1].first)->mesh.textures.size() == 9);
}

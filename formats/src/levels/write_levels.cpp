// SPDX-License-Identifier: MIT
// Based on: OGC 3D Tiles 1.1 (22-025r4); glTF vendor extension MSFT_lod.
#include <lodestone/discrete_levels.h>
#include <lodestone/formats.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "meshes/writers.h"
#include "output_file.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;
constexpr double client_error_px = 16.0;  // maximumScreenSpaceError that CesiumJS starts with

std::string level_name(std::size_t i) { return "level_" + std::to_string(i) + ".glb"; }

// Share of the screen under the model's sphere at a distance: where MSFT_lod switches.
double coverage(const LevelPlan& plan, double distance_m) {
  const double radius_px = plan.radius_m * plan.focal_px / distance_m;
  return std::min(1.0, std::numbers::pi * radius_px * radius_px / (plan.width_px * plan.height_px));
}

// The error that projects to the client's limit at this distance, which clients measure to the sphere's surface.
double geometric_error_m(const LevelPlan& plan, double distance_m) {
  return client_error_px * std::max(0.0, distance_m - plan.radius_m) / plan.focal_px;
}

Json tile_of(const LevelPlan& plan, std::size_t i, const glm::dvec3& middle_m) {
  const double error_m = i == 0 ? 0.0 : geometric_error_m(plan, plan.levels[i].from_m);
  Json tile{{"boundingVolume", {{"sphere", {middle_m.x, middle_m.y, middle_m.z, plan.radius_m}}}},
            {"geometricError", error_m},
            {"content", {{"uri", level_name(i)}}}};
  if (i > 0) tile["children"].push_back(tile_of(plan, i - 1, middle_m));
  return tile;
}

Status write_tileset(const LevelPlan& plan, const glm::dvec3& middle_m, const std::filesystem::path& folder) {
  Json root = tile_of(plan, plan.levels.size() - 1, middle_m);
  root["refine"] = "REPLACE";
  const Json tileset{{"asset", {{"version", "1.1"}, {"generator", "Lodestone"}}},
                     {"geometricError", geometric_error_m(plan, plan.last_m)},
                     {"root", std::move(root)}};
  const std::string text = tileset.dump(2) + "\n";
  return write_whole_file(folder / "tileset.json", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace

Status write_levels(const ProgressiveModel& model, const LevelPlan& plan, const std::filesystem::path& folder,
                    const Context& context) {
  if (Status status = check_level_plan(plan, model); !status) return status;
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  if (fault) return Error{ErrorCode::Unreadable, "the folder cannot be made: " + fault.message(), folder.string()};
  std::vector<Mesh> meshes;
  std::vector<GltfLevel> levels;
  meshes.reserve(plan.levels.size());
  std::vector<Warning> warnings;
  for (std::size_t i = 0; i < plan.levels.size(); ++i) {
    meshes.push_back(model.extract(plan.levels[i].level));
    Status written = write_mesh(meshes.back(), folder / level_name(i), context);
    if (!written) return written;
    if (i == 0) warnings = std::move(written.warnings());  // those of textures, the same for every level
    const double end_m = i + 1 < plan.levels.size() ? plan.levels[i + 1].from_m : plan.last_m;
    levels.push_back({&meshes.back(), coverage(plan, end_m)});
  }
  if (Status written = write_gltf_levels(levels, folder / "levels.glb", context); !written) return written;
  if (Status written = write_tileset(plan, model.data().origin + model.bounds().center(), folder); !written) {
    return written;
  }
  return {Done{}, std::move(warnings)};
}

}  // namespace lodestone

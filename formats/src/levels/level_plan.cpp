// SPDX-License-Identifier: MIT
#include <lodestone/discrete_levels.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "output_file.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* format_name = "lodestone level plan";
constexpr int format_version = 1;

Error bad(const std::filesystem::path& file, std::string message) {
  return {ErrorCode::BadData, std::move(message), file.string()};
}

// Reads what nlohmann checks the types of (its exceptions are caught by the caller).
LevelPlan plan_of(const Json& json) {
  LevelPlan plan;
  plan.last_m = json.at("last_m").get<double>();
  plan.radius_m = json.at("radius_m").get<double>();
  plan.focal_px = json.at("focal_px").get<double>();
  plan.width_px = json.at("width_px").get<double>();
  plan.height_px = json.at("height_px").get<double>();
  for (const Json& level : json.at("levels")) {
    plan.levels.push_back({level.at("from_m").get<double>(), level.at("level").get<Level>(),
                           level.at("triangles").get<std::uint32_t>(), level.at("error_m").get<double>()});
  }
  if (!json.contains("needed")) return plan;
  for (const Json& needed : json.at("needed")) {
    plan.needed.push_back({needed.at("distance_m").get<double>(), needed.at("level").get<Level>()});
  }
  return plan;
}

std::string fault_of(const std::vector<NeededLevel>& needed, Level finest) {
  constexpr std::size_t most_needed = 1000;
  if (needed.size() > most_needed) return "a plan has at most 1000 needed levels";
  NeededLevel before{0.0, finest};
  for (const NeededLevel& next : needed) {
    if (!(next.distance_m > before.distance_m) || !std::isfinite(next.distance_m) || next.level > before.level) {
      return "needed levels must get coarser with distance";
    }
    before = next;
  }
  return {};
}

// Empty if the plan can be used.
std::string fault_of(const LevelPlan& plan) {
  constexpr std::size_t most_levels = 64;
  if (plan.levels.empty() || plan.levels.size() > most_levels) return "a plan has 1 to 64 levels";
  for (const double value : {plan.last_m, plan.radius_m, plan.focal_px, plan.width_px, plan.height_px}) {
    if (!(value > 0.0) || !std::isfinite(value)) return "distances and sizes must be finite and above 0";
  }
  if (plan.levels.front().from_m != 0.0) return "the first level of a plan is shown from 0 m on";
  for (std::size_t i = 1; i < plan.levels.size(); ++i) {
    const PlannedLevel& before = plan.levels[i - 1];
    const PlannedLevel& level = plan.levels[i];
    if (!(level.from_m >= before.from_m) || !(level.from_m <= plan.last_m)) {
      return "the distance of level " + std::to_string(i) + " is out of order";
    }
    if (level.level > before.level) return "level " + std::to_string(i) + " is finer than the one before";
  }
  return fault_of(plan.needed, plan.levels.front().level);
}

}  // namespace

Level needed_level(const LevelPlan& plan, double distance_m) noexcept {
  const auto& needed = plan.needed;
  if (needed.empty()) {
    const auto is_beyond = [&](const PlannedLevel& level) { return level.from_m > distance_m; };
    const auto next = std::find_if(plan.levels.begin() + 1, plan.levels.end(), is_beyond);
    return std::prev(next)->level;
  }
  if (!(distance_m >= needed.front().distance_m)) return plan.levels.front().level;
  const auto next = std::upper_bound(needed.begin(), needed.end(), distance_m,
                                     [](double d, const NeededLevel& n) { return d < n.distance_m; });
  if (next == needed.end()) return needed.back().level;
  const NeededLevel& before = *std::prev(next);
  const double place = std::log(distance_m / before.distance_m) / std::log(next->distance_m / before.distance_m);
  return before.level - static_cast<Level>(place * (before.level - next->level));
}

Status check_level_plan(const LevelPlan& plan, const ProgressiveModel& model) {
  if (plan.levels.empty()) return Error{ErrorCode::BadArgument, "the plan has no levels", ""};
  for (const PlannedLevel& level : plan.levels) {
    if (level.level > model.record_count() || model.info(level.level).triangles != level.triangles) {
      return Error{ErrorCode::BadArgument,
                   "the plan was made for another model: level " + std::to_string(level.level) + " with " +
                       std::to_string(level.triangles) + " triangles is not there",
                   ""};
    }
  }
  return Done{};
}

Status write_level_plan(const LevelPlan& plan, const std::filesystem::path& file) {
  if (const std::string fault = fault_of(plan); !fault.empty()) {
    return Error{ErrorCode::BadArgument, fault, file.string()};
  }
  Json json{{"format", format_name},       {"version", format_version}, {"last_m", plan.last_m},
            {"radius_m", plan.radius_m},   {"focal_px", plan.focal_px}, {"width_px", plan.width_px},
            {"height_px", plan.height_px}, {"levels", Json::array()}};
  for (const PlannedLevel& level : plan.levels) {
    json["levels"].push_back(
        {{"from_m", level.from_m}, {"level", level.level}, {"triangles", level.triangles}, {"error_m", level.error_m}});
  }
  for (const NeededLevel& needed : plan.needed) {
    json["needed"].push_back({{"distance_m", needed.distance_m}, {"level", needed.level}});
  }
  const std::string text = json.dump(2) + "\n";
  return write_whole_file(file, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

Result<LevelPlan> read_level_plan(const std::filesystem::path& file) {
  std::error_code fault;
  const auto bytes = std::filesystem::file_size(file, fault);
  if (fault) return Error{ErrorCode::NotFound, "the file cannot be opened: " + fault.message(), file.string()};
  constexpr std::uintmax_t most_bytes = 1U << 20;
  if (bytes > most_bytes) return Error{ErrorCode::TooLarge, "a level plan is smaller than 1 MB", file.string()};
  std::ifstream stream{file, std::ios::binary};
  try {
    const Json json = Json::parse(stream);
    if (json.value("format", "") != format_name || json.value("version", 0) != format_version) {
      return bad(file, "it is no level plan of version 1, make one with 'lodestone distances'");
    }
    LevelPlan plan = plan_of(json);
    if (const std::string what = fault_of(plan); !what.empty()) return bad(file, what);
    return plan;
  } catch (const nlohmann::json::exception& problem) {
    return bad(file, std::string{"it is no level plan: "} + problem.what());
  }
}

}  // namespace lodestone

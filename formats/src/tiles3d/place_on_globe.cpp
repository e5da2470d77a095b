// SPDX-License-Identifier: MIT
// The only file that names PROJ.
#include "tiles3d/place_on_globe.h"

#include <proj.h>

#include <cmath>
#include <memory>

namespace lodestone {
namespace {

struct ContextCloser {
  void operator()(PJ_CONTEXT* context) const noexcept { proj_context_destroy(context); }
};
struct Closer {
  void operator()(PJ* transformation) const noexcept { proj_destroy(transformation); }
};

}  // namespace

Result<Transform> place_on_globe(const glm::dvec3& origin, const std::string& crs) {
  const Error unknown{ErrorCode::BadData, "the coordinate system \"" + crs + "\" cannot be placed on the globe", ""};
  const std::unique_ptr<PJ_CONTEXT, ContextCloser> context{proj_context_create()};
  proj_log_level(context.get(), PJ_LOG_NONE);
  proj_context_set_enable_network(context.get(), 0);
  const std::unique_ptr<PJ, Closer> raw{proj_create_crs_to_crs(context.get(), crs.c_str(), "EPSG:4978", nullptr)};
  if (!raw) return unknown;
  const std::unique_ptr<PJ, Closer> transformation{proj_normalize_for_visualization(context.get(), raw.get())};
  if (!transformation) return unknown;
  const auto to_earth = [&](const glm::dvec3& p) {
    const PJ_COORD out = proj_trans(transformation.get(), PJ_FWD, proj_coord(p.x, p.y, p.z, 0.0));
    return glm::dvec3{out.xyz.x, out.xyz.y, out.xyz.z};
  };
  constexpr double step_m = 100.0;
  const glm::dvec3 place = to_earth(origin);
  Transform result{};
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step{0.0};
    step[axis] = step_m;
    const glm::dvec3 along = (to_earth(origin + step) - to_earth(origin - step)) / (2.0 * step_m);
    // A system in degrees, or a place far outside its area, stretches a metre to something else.
    if (!(glm::length(along) > 0.9 && glm::length(along) < 1.1)) return unknown;
    for (int k = 0; k < 3; ++k) result[4 * static_cast<std::size_t>(axis) + static_cast<std::size_t>(k)] = along[k];
  }
  for (int k = 0; k < 3; ++k) result[12 + static_cast<std::size_t>(k)] = place[k];
  result[15] = 1.0;
  return result;
}

}  // namespace lodestone

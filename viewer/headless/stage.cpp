// SPDX-License-Identifier: MIT
#include "stage.h"

#include "../render/detailed_side.h"

#include <algorithm>

namespace lodestone::render {

Result<std::unique_ptr<Stage>> Stage::create() {
  auto context = OsmesaContext::create();
  if (!context) return context.error();
  auto gl = load_gl(OsmesaContext::address);
  if (!gl) return gl.error();
  // The objects keep a reference to the table, so they are made with the one inside the stage.
  auto table = std::make_unique<Gl>(*gl);
  auto renderer = Renderer::create(*table);
  if (!renderer) return renderer.error();
  auto presenter = Presenter::create(*table);
  if (!presenter) return presenter.error();
  OsmesaContext::release_compiler();
  return std::unique_ptr<Stage>{new Stage{std::move(context).value(), std::move(table), std::move(renderer).value(),
                                          std::move(presenter).value()}};
}

Result<View> view_of(const RenderOptions& options, const Box& bounds, const glm::dvec3& origin,
                     const DrawArrays& finest) {
  const auto refuse = [](const char* message) { return Error{ErrorCode::BadArgument, message, ""}; };
  if (options.width_px == 0 || options.height_px == 0) return refuse("a picture needs at least one pixel");
  if (options.supersample < 1 || options.supersample > 4) return refuse("supersampling goes from 1 to 4");
  const Camera& camera = options.camera;
  if (!(camera.fov_y_rad >= 0.01 && camera.fov_y_rad <= 3.0)) {
    return refuse("the field of view must lie between 0.01 and 3 radians");
  }
  if (!camera.eye_m) {
    const Orbit orbit{camera.yaw_rad ? *camera.yaw_rad : detailed_yaw_rad(finest),
                      std::clamp(camera.pitch_rad, -1.5, 1.5)};
    View view = framed_view(bounds, orbit, options.width_px, options.height_px, camera.fov_y_rad);
    if (camera.target_m) view.eye += *camera.target_m - origin - bounds.center();
    return view;
  }
  const glm::dvec3 eye = *camera.eye_m - origin;
  const glm::dvec3 target = camera.target_m ? *camera.target_m - origin : bounds.center();
  if (glm::length(target - eye) <= 0.0) return refuse("the camera stands on the point it looks at");
  return look_at(eye, target, options.width_px, options.height_px, camera.fov_y_rad);
}

}  // namespace lodestone::render

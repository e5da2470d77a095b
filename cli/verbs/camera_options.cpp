// SPDX-License-Identifier: MIT
#include "camera_options.h"

namespace lodestone::cli {

void CameraOptions::declare(Arguments& arguments) {
  arguments.point_m("--eye", eye_m_,
                    "Where the camera stands, world coordinates; without it the whole model is framed");
  arguments.point_m("--target", target_m_, "What it looks at; the model's middle if not given");
  arguments.number("--fov", fov_deg_, 1.0, 170.0, "Vertical field of view in degrees");
  arguments.picture_size("--size", size_, "Picture size in pixels");
}

void CameraOptions::apply(render::RenderOptions& options) const {
  options.width_px = size_.width_px;
  options.height_px = size_.height_px;
  options.camera.eye_m = eye_m_;
  options.camera.target_m = target_m_;
  options.camera.fov_y_rad = glm::radians(fov_deg_);
}

}  // namespace lodestone::cli

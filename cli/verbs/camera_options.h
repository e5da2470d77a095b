// SPDX-License-Identifier: MIT
// The camera of a picture and its size.
#pragma once

#include "frame/verb.h"
#include "viewer/headless/headless.h"

namespace lodestone::cli {

class CameraOptions {
 public:
  explicit CameraOptions(PictureSize size = {}) : size_(size) {}

  void declare(Arguments& arguments);
  // Sets camera and size, leaves the look alone.
  void apply(render::RenderOptions& options) const;

 private:
  PictureSize size_;
  std::optional<glm::dvec3> eye_m_;
  std::optional<glm::dvec3> target_m_;
  double fov_deg_ = 35.0;
};

}  // namespace lodestone::cli

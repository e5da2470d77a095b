// SPDX-License-Identifier: MIT
// A headless context with a renderer in it: the common part of render, sweep, sheet and compare.
#pragma once

#include <memory>

#include "../render/camera.h"
#include "../render/frame.h"
#include "../render/renderer.h"
#include "headless.h"
#include "osmesa_context.h"

namespace lodestone::render {

class Stage {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Stage>> create();

  [[nodiscard]] const Gl& gl() const { return *gl_; }
  [[nodiscard]] Renderer& renderer() { return renderer_; }
  [[nodiscard]] Presenter& presenter() { return presenter_; }

 private:
  Stage(std::unique_ptr<OsmesaContext> context, std::unique_ptr<Gl> gl, Renderer renderer, Presenter presenter)
      : context_(std::move(context)),
        gl_(std::move(gl)),
        renderer_(std::move(renderer)),
        presenter_(std::move(presenter)) {}
  std::unique_ptr<OsmesaContext> context_;  // first in, last out
  std::unique_ptr<Gl> gl_;                  // on the heap: the objects below refer to it
  Renderer renderer_;
  Presenter presenter_;
};

/// The view that the options ask for, in the frame of a model with these bounds, origin and finest faces.
[[nodiscard]] Result<View> view_of(const RenderOptions& options, const Box& bounds, const glm::dvec3& origin,
                                   const DrawArrays& finest);

[[nodiscard]] inline FrameSize frame_size(const RenderOptions& options) {
  return {options.width_px, options.height_px, options.supersample};
}

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
// Pictures for the perceptual metric: one side of a model at a distance, flat shaded under a light that stays with the
// camera, without textures, on white, and which pixels are the object's.
#pragma once

#include <memory>

#include <lodestone/perception.h>

namespace lodestone::render {

enum class Edges : std::uint8_t {
  Sampled,  ///< as many samples per pixel as the stage was made with: what a plain program draws
  Smooth,   ///< sixteen at least, averaged in linear light: what remains when a picture is compared with another of
            ///< the same thing, and the luck of where a sample falls should not count
};

class DetailStage {
 public:
  /// `supersample` 1 takes one sample per pixel, without any antialiasing; 2 to 4 as many per axis.
  /// Errors: BadArgument for a model without triangles or a display out of range, Unsupported without OSMesa.
  [[nodiscard]] static Result<std::unique_ptr<DetailStage>> create(std::shared_ptr<const ProgressiveModel> model,
                                                                   const Display& display,
                                                                   std::uint32_t supersample = 1);
  DetailStage(const DetailStage&) = delete;
  DetailStage& operator=(const DetailStage&) = delete;
  ~DetailStage();

  /// The level that picture() shows; the finest at first.
  void set_level(Level level);

  /// From `distance_m` before the middle of the model, at the height of its middle. `azimuth_rad` is the direction that
  /// the side faces: 0 = north (+y), clockwise seen from above; the camera stands there and looks back.
  /// Only the middle of the screen is drawn: the object with as much white around it as a vision model of the display
  /// reaches, so that what it makes of the object is the same as on the whole screen.
  [[nodiscard]] Result<ObjectPicture> picture(double azimuth_rad, double distance_m, Edges edges = Edges::Sampled);

 private:
  struct State;
  explicit DetailStage(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
// How a picture looks. Shared by the window and the headless renderer.
#pragma once

#include <cstdint>

namespace lodestone::render {

enum class Background : std::uint8_t {
  Gradient,  ///< light grey, a little darker below
  White,
};

enum class Coloring : std::uint8_t {
  Materials,   ///< base colours, vertex colours and textures
  Untextured,  ///< base colours without textures
  Lod,         ///< by triangle size: blue where fine, green, yellow, red where coarse
  Clusters,    ///< a colour for each cluster of a cluster graph
};

enum class Lighting : std::uint8_t {
  Automatic,   ///< Photograph for tilesets with photographs on them, as they are meant to be seen; else Lamps
  Lamps,       ///< a key light, a fill light and a sky: shape shows
  Photograph,  ///< none: colours as they are, for photographs that have their light in them
};

struct Look {
  Coloring coloring = Coloring::Materials;
  Background background = Background::Gradient;
  Lighting lighting = Lighting::Automatic;
  /// Draw triangle edges over the surface.
  bool wireframe = false;
};

}  // namespace lodestone::render

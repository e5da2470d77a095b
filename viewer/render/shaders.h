// SPDX-License-Identifier: MIT
// GLSL sources of the renderer (version line added on compiling).
#pragma once

namespace lodestone::render {

/// Surface: vertex, optional geometry stage (with `#define EDGES` in all three: wireframe and LOD colours), fragment.
extern const char* const surface_vertex_shader;
extern const char* const surface_geometry_shader;
extern const char* const surface_fragment_shader;

/// A triangle that covers the picture, without vertex data.
extern const char* const picture_vertex_shader;
extern const char* const background_fragment_shader;
/// Reduces one supersampled picture, or a blend of two, to the output and encodes sRGB.
extern const char* const present_fragment_shader;

}  // namespace lodestone::render

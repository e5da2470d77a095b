// SPDX-License-Identifier: MIT
// Draws geometry with its surfaces, lit, into a frame.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <lodestone/types.h>
#include <lodestone/view.h>

#include "frame.h"
#include "geometry.h"
#include "options.h"
#include "program.h"
#include "surfaces.h"

namespace lodestone::render {

/// One thing to draw. Geometry and surfaces are shared by its instances.
struct Item {
  const Geometry* geometry = nullptr;
  const Surfaces* surfaces = nullptr;
  glm::dvec3 offset_m{0.0};  ///< where its origin lies in the frame of the view
  double size_m = 1.0;       ///< diagonal of the whole model: the scale of the LOD colours
  float share = 1.0F;        ///< of its pixels, as TilePager::share(): below 1 while it comes, below 0 while it leaves
  /// How far its vertices have travelled to DrawArrays::target, 0..1; what morph() of clusters.h does.
  float morph = 0.0F;
  std::span<const DrawRange> draws;        ///< empty: those of the geometry
  std::span<const glm::vec4> draw_colors;  ///< per element of `draws`, linear, instead of the materials'; or empty
};

class Renderer {
 public:
  [[nodiscard]] static Result<Renderer> create(const Gl& gl);
  Renderer(Renderer&& other) noexcept;
  Renderer& operator=(Renderer&&) = delete;
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  ~Renderer();

  /// Clears the frame and draws the items: opaque faces first, then blended ones back to front, triangle by triangle.
  /// `bounds` encloses all items in the view's frame (it sets the depth range).
  void draw(const Frame& frame, const View& view, const Box& bounds, std::span<const Item> items, const Look& look);

 private:
  struct SurfaceProgram {
    explicit SurfaceProgram(Program p);
    Program program;
    GLint to_eye, to_clip, base_color, image, alpha_cutoff, has_normals, up, wire_px, lod_colors, unlit, model_size_m,
        share, morph;
  };
  struct BlendedTriangle {
    float depth;  ///< along the line of sight, larger is farther
    MaterialId material;
    std::uint32_t first_index;
  };
  Renderer(const Gl& gl, Program background, Program plain);

  [[nodiscard]] const SurfaceProgram& with_edges();
  void draw_background(const Look& look) const;
  void set_item(const SurfaceProgram& program, const Item& item, const glm::dmat4& view) const;
  void set_surface(const SurfaceProgram& program, const Surface& surface, const Look& look, GLuint white) const;
  void draw_opaque(const SurfaceProgram& program, const Item& item, const Look& look) const;
  void draw_blended(const SurfaceProgram& program, const Item& item, const glm::dmat4& view, const Look& look);

  const Gl* gl_;
  Program background_;
  SurfaceProgram plain_;
  std::optional<SurfaceProgram> edges_;  ///< with wireframe and LOD colours
  bool edges_refused_ = false;
  GLuint empty_vertex_array_ = 0;
  std::vector<BlendedTriangle> blended_;  ///< kept between frames for its memory
  std::vector<VertexId> blended_indices_;
};

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
#include "renderer.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <utility>

#include "camera.h"
#include "shaders.h"

namespace lodestone::render {

namespace {

std::span<const DrawRange> draws_of(const Item& item) {
  return item.draws.empty() ? item.geometry->arrays().draws : item.draws;
}

// Blended where materials are; colours that tell something are opaque.
bool shows_materials(const Look& look) {
  return look.coloring == Coloring::Materials || look.coloring == Coloring::Untextured;
}

}  // namespace

Renderer::SurfaceProgram::SurfaceProgram(Program p)
    : program(std::move(p)),
      to_eye(program.uniform("to_eye")),
      to_clip(program.uniform("to_clip")),
      base_color(program.uniform("base_color")),
      image(program.uniform("image")),
      alpha_cutoff(program.uniform("alpha_cutoff")),
      has_normals(program.uniform("has_normals")),
      up(program.uniform("up")),
      wire_px(program.uniform("wire_px")),
      lod_colors(program.uniform("lod_colors")),
      unlit(program.uniform("unlit")),
      model_size_m(program.uniform("model_size_m")),
      share(program.uniform("share")),
      morph(program.uniform("morph")) {}

Result<Renderer> Renderer::create(const Gl& gl) {
  auto background = Program::create(gl, picture_vertex_shader, nullptr, background_fragment_shader);
  if (!background) return background.error();
  auto plain = Program::create(gl, surface_vertex_shader, nullptr, surface_fragment_shader);
  if (!plain) return plain.error();
  return Renderer{gl, std::move(background).value(), std::move(plain).value()};
}

Renderer::Renderer(const Gl& gl, Program background, Program plain)
    : gl_(&gl), background_(std::move(background)), plain_(std::move(plain)) {
  gl.gen_vertex_arrays(1, &empty_vertex_array_);
}

Renderer::Renderer(Renderer&& other) noexcept
    : gl_(other.gl_),
      background_(std::move(other.background_)),
      plain_(std::move(other.plain_)),
      edges_(std::move(other.edges_)),
      edges_refused_(other.edges_refused_),
      empty_vertex_array_(std::exchange(other.empty_vertex_array_, 0)),
      blended_(std::move(other.blended_)),
      blended_indices_(std::move(other.blended_indices_)) {}

Renderer::~Renderer() { gl_->delete_vertex_arrays(1, &empty_vertex_array_); }

// Compiled when first asked for: few pictures need it, and none should wait for it. A driver that refuses it shows
// surfaces without lines.
const Renderer::SurfaceProgram& Renderer::with_edges() {
  if (!edges_ && !edges_refused_) {
    auto made = Program::create(*gl_, surface_vertex_shader, surface_geometry_shader, surface_fragment_shader,
                                "#define EDGES\n");
    edges_refused_ = !made.ok();
    if (made) edges_.emplace(std::move(made).value());
  }
  return edges_ ? *edges_ : plain_;
}

void Renderer::draw_background(const Look& look) const {
  const bool white = look.background == Background::White;
  gl_->disable(GL_DEPTH_TEST);
  gl_->disable(GL_BLEND);
  background_.use();
  // Linear light; the gradient runs from a pale blue grey to a warmer, darker one.
  gl_->uniform_3f(background_.uniform("top"), white ? 1.0F : 0.83F, white ? 1.0F : 0.87F, white ? 1.0F : 0.91F);
  gl_->uniform_3f(background_.uniform("bottom"), white ? 1.0F : 0.56F, white ? 1.0F : 0.57F, white ? 1.0F : 0.58F);
  gl_->bind_vertex_array(empty_vertex_array_);
  gl_->draw_arrays(GL_TRIANGLES, 0, 3);
}

void Renderer::draw(const Frame& frame, const View& view, const Box& bounds, std::span<const Item> items,
                    const Look& look) {
  frame.begin();
  gl_->depth_mask(GL_TRUE);
  gl_->clear_color(1.0F, 1.0F, 1.0F, 1.0F);
  gl_->clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  draw_background(look);

  const glm::dmat4 to_eye = view_matrix(view);
  const glm::mat4 to_clip{projection_matrix(view, bounds)};
  const glm::vec3 up{glm::dmat3{to_eye} * glm::dvec3{0.0, 0.0, 1.0}};
  const bool lod_colors = look.coloring == Coloring::Lod;
  const SurfaceProgram& surface = look.wireframe || lod_colors ? with_edges() : plain_;
  surface.program.use();
  gl_->uniform_matrix_4fv(surface.to_clip, 1, GL_FALSE, glm::value_ptr(to_clip));
  gl_->uniform_3f(surface.up, up.x, up.y, up.z);
  gl_->uniform_1i(surface.image, 0);
  // A uniform that a program lacks has place -1, and setting it does nothing.
  gl_->uniform_1f(surface.wire_px, look.wireframe ? 1.1F * static_cast<float>(frame.size().supersample) : 0.0F);
  gl_->uniform_1i(surface.lod_colors, lod_colors ? 1 : 0);
  // Colours that tell something else than the photograph are under lamps, so that shape shows.
  const bool unlit = look.lighting == Lighting::Photograph && look.coloring == Coloring::Materials;
  gl_->uniform_1i(surface.unlit, unlit ? 1 : 0);
  gl_->active_texture(GL_TEXTURE0);

  gl_->enable(GL_DEPTH_TEST);
  // Of coplanar duplicates the first drawn wins, whatever the level: no flicker between materials.
  gl_->depth_func(GL_LESS);
  for (const Item& item : items) {
    set_item(surface, item, to_eye);
    draw_opaque(surface, item, look);
  }
  if (shows_materials(look)) {
    gl_->enable(GL_BLEND);
    gl_->blend_func_separate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl_->depth_mask(GL_FALSE);
    // Items are few and apart from each other: far ones first, their triangles sorted within.
    std::vector<const Item*> order;
    for (const Item& item : items) order.push_back(&item);
    std::stable_sort(order.begin(), order.end(), [&](const Item* a, const Item* b) {
      return glm::dot(a->offset_m, view.forward) > glm::dot(b->offset_m, view.forward);
    });
    for (const Item* item : order) draw_blended(surface, *item, to_eye, look);
    gl_->depth_mask(GL_TRUE);
    gl_->disable(GL_BLEND);
  }
  gl_->disable(GL_CULL_FACE);
  frame.end();
}

void Renderer::set_item(const SurfaceProgram& program, const Item& item, const glm::dmat4& view) const {
  const glm::mat4 to_eye{glm::translate(view, item.offset_m)};
  gl_->uniform_matrix_4fv(program.to_eye, 1, GL_FALSE, glm::value_ptr(to_eye));
  gl_->uniform_1i(program.has_normals, item.geometry->arrays().normals.empty() ? 0 : 1);
  gl_->uniform_1f(program.share, item.share);
  gl_->uniform_1f(program.model_size_m, static_cast<float>(std::max(item.size_m, 1e-6)));
  gl_->uniform_1f(program.morph, item.morph);
}

void Renderer::set_surface(const SurfaceProgram& program, const Surface& surface, const Look& look,
                           GLuint white) const {
  const bool textured = look.coloring == Coloring::Materials;
  gl_->bind_texture(GL_TEXTURE_2D, textured ? surface.texture : white);
  gl_->uniform_1f(program.alpha_cutoff, textured ? surface.alpha_cutoff : 0.0F);
  const glm::vec4 c = look.coloring == Coloring::Lod ? glm::vec4{1.0F} : surface.base_color;
  gl_->uniform_4f(program.base_color, c.r, c.g, c.b, c.a);
  if (surface.double_sided) {
    gl_->disable(GL_CULL_FACE);
  } else {
    gl_->enable(GL_CULL_FACE);
  }
}

void Renderer::draw_opaque(const SurfaceProgram& program, const Item& item, const Look& look) const {
  const DrawArrays& arrays = item.geometry->arrays();
  item.geometry->bind();
  const GLenum type = arrays.index_bytes == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
  const std::span<const DrawRange> draws = draws_of(item);
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const DrawRange& draw = draws[i];
    const Surface& surface = (*item.surfaces)[draw.material];
    if (draw.index_count == 0 || (surface.transparent && shows_materials(look))) continue;
    set_surface(program, surface, look, item.surfaces->white());
    if (!item.draw_colors.empty()) {
      const glm::vec4& c = item.draw_colors[i];
      gl_->uniform_4f(program.base_color, c.r, c.g, c.b, c.a);
    }
    gl_->draw_elements(
        GL_TRIANGLES, static_cast<GLsizei>(draw.index_count), type,
        reinterpret_cast<const void*>(static_cast<std::uintptr_t>(draw.first_index) * arrays.index_bytes));
  }
}

void Renderer::draw_blended(const SurfaceProgram& program, const Item& item, const glm::dmat4& view, const Look& look) {
  const DrawArrays& arrays = item.geometry->arrays();
  const glm::vec3 away{-view[0][2], -view[1][2], -view[2][2]};
  blended_.clear();
  for (const DrawRange& draw : draws_of(item)) {
    if (!(*item.surfaces)[draw.material].transparent) continue;
    for (std::uint32_t i = draw.first_index; i < draw.first_index + draw.index_count; i += 3) {
      const glm::vec3 sum = arrays.positions[arrays.index(i)] + arrays.positions[arrays.index(i + 1)] +
                            arrays.positions[arrays.index(i + 2)];
      blended_.push_back({glm::dot(sum, away), draw.material, i});
    }
  }
  if (blended_.empty()) return;
  std::sort(blended_.begin(), blended_.end(), [](const BlendedTriangle& a, const BlendedTriangle& b) {
    return a.depth != b.depth ? a.depth > b.depth : a.first_index < b.first_index;
  });
  blended_indices_.clear();
  for (const BlendedTriangle& t : blended_) {
    for (std::uint32_t corner = 0; corner < 3; ++corner)
      blended_indices_.push_back(arrays.index(t.first_index + corner));
  }
  set_item(program, item, view);
  item.geometry->bind_with(blended_indices_);
  for (std::size_t begin = 0; begin < blended_.size();) {
    std::size_t end = begin + 1;
    while (end < blended_.size() && blended_[end].material == blended_[begin].material) ++end;
    set_surface(program, (*item.surfaces)[blended_[begin].material], look, item.surfaces->white());
    gl_->draw_elements(GL_TRIANGLES, static_cast<GLsizei>((end - begin) * 3), GL_UNSIGNED_INT,
                       reinterpret_cast<const void*>(begin * 3 * sizeof(VertexId)));
    begin = end;
  }
}

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
// Based on: Hoppe 1999 (wedges share a position; attributes as linear functions over faces), Garland and Heckbert 1998.
// Differs: a face predicts the attributes at the new place by its own linear function; a vertex takes the mean of the
// predictions of its faces weighted by squared area, and their scatter is the cost. Nothing is accumulated.
#include "collapse/wedges.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lodestone::collapse {
namespace {

constexpr double flat_cosine = 0.9999;

// Weights of the corners k, k+1, k+2 of a star face at place y, times the squared normal.
glm::dvec3 spread_weights(const StarFace& f, const glm::dvec3& e, const glm::dvec3& y) {
  const glm::dvec3 near = f.side == Side::V ? e : glm::dvec3{0.0};
  const double near_weight = glm::dot(glm::cross(f.at_a - y, f.at_b - y), f.normal);
  const double a_weight = glm::dot(glm::cross(f.at_b - y, near - y), f.normal);
  return {near_weight, a_weight, glm::dot(f.normal, f.normal) - near_weight - a_weight};
}

glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : otherwise;
}

glm::u8vec4 to_color(const glm::dvec4& c) {
  const glm::dvec4 clamped = glm::clamp(c, 0.0, 255.0);
  return {static_cast<std::uint8_t>(std::lround(clamped.x)), static_cast<std::uint8_t>(std::lround(clamped.y)),
          static_cast<std::uint8_t>(std::lround(clamped.z)), static_cast<std::uint8_t>(std::lround(clamped.w))};
}

}  // namespace

bool same_look(const WorkingMesh& mesh, VertexId a, VertexId b) {
  if (a == b) return true;
  if (!mesh.values.uvs.empty() && mesh.values.uvs[a] != mesh.values.uvs[b]) return false;
  return mesh.values.colors.empty() || mesh.values.colors[a] == mesh.values.colors[b];
}

bool seam_between(const WorkingMesh& mesh, const Mesh& source, const Face& f, const Face& g, std::uint32_t p,
                  std::uint32_t q) {
  return source.face_material(f.id) != source.face_material(g.id) ||
         !same_look(mesh, mesh.vertex_of(f, corner_at(f, p)), mesh.vertex_of(g, corner_at(g, p))) ||
         !same_look(mesh, mesh.vertex_of(f, corner_at(f, q)), mesh.vertex_of(g, corner_at(g, q)));
}

Wedges::Wedges(WorkingMesh& mesh, const EdgeCollapseOptions& options, double diagonal_m)
    : mesh_(mesh),
      options_(options),
      uv_scale_(options.uv_weight * diagonal_m),
      color_scale_(options.color_weight * diagonal_m / 255.0) {}

bool Wedges::has_looks() const noexcept {
  return !mesh_.values.uvs.empty() || !mesh_.values.normals.empty() || !mesh_.values.colors.empty();
}

bool Wedges::steered() const noexcept { return options_.attributes == Attributes::All && has_looks(); }

VertexId Wedges::target_of(VertexId vertex) const {
  for (const Pair& pair : pairs_) {
    if (pair.from == vertex) return pair.to;
  }
  return vertex;
}

Wedges::Group& Wedges::group_of(VertexId vertex) {
  for (Group& group : groups_) {
    if (group.vertex == vertex) return group;
  }
  groups_.push_back(Group{.vertex = vertex});
  return groups_.back();
}

void Wedges::make_pairs(const Star& star, const Choice& choice) {
  pairs_.clear();
  if (!mesh_.has_seams()) {
    pairs_.push_back({mesh_.wedge[choice.gone], mesh_.wedge[choice.kept]});
    return;
  }
  for (const StarFace& f : star.faces) {
    if (f.side != Side::Both) continue;
    const Face& face = mesh_.faces[f.index];
    const VertexId from = mesh_.vertex_of(face, corner_at(face, choice.gone));
    const VertexId to = mesh_.vertex_of(face, corner_at(face, choice.kept));
    if (target_of(from) == from) pairs_.push_back({from, to});
  }
  if (options_.placement == Placement::Subset) pair_the_rest(star, choice);
}

// No vertex may move: what has no partner on the edge takes the vertex at the place that looks most like it.
void Wedges::pair_the_rest(const Star& star, const Choice& choice) {
  const Side gone_side = choice.gone == star.u ? Side::U : Side::V;
  for (const StarFace& f : star.faces) {
    if (f.side != gone_side || f.twin) continue;
    const VertexId from = mesh_.vertex_of(mesh_.faces[f.index], f.k);
    if (target_of(from) != from) continue;
    Nearest nearest;
    for (const StarFace& s : star.faces) {
      if (s.side == gone_side) continue;
      const Face& face = mesh_.faces[s.index];
      const VertexId v = mesh_.vertex_of(face, corner_at(face, choice.kept));
      nearest.offer(v, look_distance(v, from));
    }
    if (nearest.vertex != none) pairs_.push_back({from, nearest.vertex});
  }
}

// Weighted means of what the faces of each group predict at the new place.
void Wedges::predict(const Star& star, const Choice& choice) {
  groups_.clear();
  const Side gone_side = choice.gone == star.u ? Side::U : Side::V;
  const VertexArrays& values = mesh_.values;
  for (const StarFace& f : star.faces) {
    const Face& face = mesh_.faces[f.index];
    const std::array<VertexId, 3> corners{mesh_.vertex_of(face, f.k), mesh_.vertex_of(face, corner_after[f.k]),
                                          mesh_.vertex_of(face, corner_before[f.k])};
    Group& group =
        group_of(target_of(f.side == Side::Both ? mesh_.vertex_of(face, corner_at(face, choice.gone)) : corners[0]));
    group.of_gone = group.of_gone || (group.vertex == corners[0] && f.side == gone_side);
    const double square = glm::dot(f.normal, f.normal);
    const glm::dvec3 weights = spread_weights(f, star.e, choice.relative);
    group.weight += square;
    for (int c = 0; c < 3; ++c) {
      const double w = weights[c];
      if (!values.normals.empty()) group.normal += w * glm::dvec3{values.normals[corners[c]]};
      if (!values.uvs.empty()) group.uv += w * glm::dvec2{values.uvs[corners[c]]};
      if (!values.colors.empty()) group.color += w * glm::dvec4{values.colors[corners[c]]};
    }
    if (f.side == Side::Both) continue;
    const bool flat = !values.normals.empty() &&
                      glm::dot(glm::dvec3{values.normals[corners[0]]}, f.normal) > flat_cosine * std::sqrt(square);
    group.flat = group.flat && flat;
    if (flat) group.face_normals += glm::cross(f.at_a - choice.relative, f.at_b - choice.relative);
  }
  for (Group& group : groups_) finish(group, choice);
}

void Wedges::finish(Group& group, const Choice& choice) {
  const VertexArrays& values = mesh_.values;
  group.moves = choice.moves || group.of_gone;
  const VertexId v = group.vertex;
  if (!group.moves || group.weight <= 0.0) {
    if (!values.normals.empty()) group.normal = glm::dvec3{values.normals[v]};
    if (!values.uvs.empty()) group.uv = glm::dvec2{values.uvs[v]};
    if (!values.colors.empty()) group.color = glm::dvec4{values.colors[v]};
    return;
  }
  group.uv /= group.weight;
  group.color = glm::clamp(group.color / group.weight, 0.0, 255.0);
  if (values.normals.empty()) return;
  const glm::dvec3 old{values.normals[v]};
  group.normal = unit_or(group.normal, old);
  if (group.flat) group.normal = unit_or(group.face_normals, group.normal);
}

double Wedges::residual(const Star& star, const Choice& choice) {
  double sum = 0.0;
  const VertexArrays& values = mesh_.values;
  // A normal that turns over the length of the edge says as much as a distance of angle times length.
  const double normal_scale2 = options_.normal_weight * options_.normal_weight * glm::dot(star.e, star.e);
  const bool turns = options_.placement != Placement::Subset;  // flat normals do, with their faces
  for (const StarFace& f : star.faces) {
    const double square = glm::dot(f.normal, f.normal);
    if (square <= 0.0) continue;
    const Face& face = mesh_.faces[f.index];
    const std::array<VertexId, 3> corners{mesh_.vertex_of(face, f.k), mesh_.vertex_of(face, corner_after[f.k]),
                                          mesh_.vertex_of(face, corner_before[f.k])};
    const Group& group =
        group_of(target_of(f.side == Side::Both ? mesh_.vertex_of(face, corner_at(face, choice.gone)) : corners[0]));
    const glm::dvec3 weights = spread_weights(f, star.e, choice.relative) / square;
    glm::dvec3 normal{group.normal};
    glm::dvec2 uv{group.uv};
    glm::dvec4 color{group.color};
    for (int c = 0; c < 3; ++c) {
      if (!values.normals.empty()) normal -= weights[c] * glm::dvec3{values.normals[corners[c]]};
      if (!values.uvs.empty()) uv -= weights[c] * glm::dvec2{values.uvs[corners[c]]};
      if (!values.colors.empty()) color -= weights[c] * glm::dvec4{values.colors[corners[c]]};
    }
    double scatter = 0.0;
    if (!values.normals.empty() && !(group.flat && turns)) scatter += normal_scale2 * glm::dot(normal, normal);
    if (!values.uvs.empty()) scatter += uv_scale_ * uv_scale_ * glm::dot(uv, uv);
    if (!values.colors.empty()) scatter += color_scale_ * color_scale_ * glm::dot(color, color);
    sum += square * scatter;
  }
  return sum;
}

double Wedges::plan(const Star& star, const Choice& choice) {
  groups_.clear();
  if (!mesh_.has_seams() && !has_looks()) return 0.0;
  make_pairs(star, choice);
  if (mesh_.has_seams() || (has_looks() && (steered() || choice.moves))) predict(star, choice);
  return steered() ? residual(star, choice) : 0.0;
}

void Wedges::log_move(VertexId vertex, const glm::vec3& position, PassLog& log) {
  const VertexArrays& values = mesh_.values;
  log.moved.push_back(vertex);
  const auto put = [&](float x) { log.values.push_back(std::bit_cast<std::uint32_t>(x)); };
  put(position.x);
  put(position.y);
  put(position.z);
  if (!values.normals.empty()) {
    put(values.normals[vertex].x);
    put(values.normals[vertex].y);
    put(values.normals[vertex].z);
  }
  if (!values.uvs.empty()) {
    put(values.uvs[vertex].x);
    put(values.uvs[vertex].y);
  }
  if (!values.colors.empty()) log.values.push_back(std::bit_cast<std::uint32_t>(values.colors[vertex]));
}

double Wedges::look_distance(VertexId a, VertexId b) const {
  const VertexArrays& values = mesh_.values;
  double sum = 0.0;
  if (!values.uvs.empty()) {
    const glm::dvec2 d = glm::dvec2{values.uvs[a]} - glm::dvec2{values.uvs[b]};
    sum += glm::dot(d, d);
  }
  if (!values.normals.empty()) {
    const glm::dvec3 d = glm::dvec3{values.normals[a]} - glm::dvec3{values.normals[b]};
    sum += 1e-3 * glm::dot(d, d);  // decides where uv does not
  }
  return sum;
}

VertexId Wedges::nearest_look_at(std::uint32_t point, VertexId to) const {
  Nearest nearest;
  for (std::uint32_t i = mesh_.first[point]; i != mesh_.first[point + 1]; ++i) {
    const Face& f = mesh_.faces[mesh_.corners[i] >> 2U];
    if (f.id == none) continue;
    const VertexId v = mesh_.vertex_of(f, mesh_.corners[i] & 3U);
    nearest.offer(v, look_distance(v, to));
  }
  return nearest.vertex;
}

// Faces whose normal their vertices carried keep that: the vertices of one face only turn with it.
void Wedges::turn_flat_normals(const Star& star, const Choice& choice, PassLog& log) {
  if (options_.placement == Placement::Subset || mesh_.values.normals.empty()) return;
  for (const StarFace& f : star.faces) {
    const Face& face = mesh_.faces[f.index];
    if (f.side == Side::Both || f.twin) continue;
    const double length = glm::length(f.normal);
    const glm::dvec3 turned = glm::cross(f.at_a - choice.relative, f.at_b - choice.relative);
    for (std::uint32_t step = 1; step < 3; ++step) {
      const std::uint32_t k = (f.k + step) % 3;
      const VertexId v = mesh_.vertex_of(face, k);
      glm::vec3& normal = mesh_.values.normals[v];
      const glm::dvec3 old{normal};
      if (mesh_.vertex_uses[v] != 1 || glm::dot(old, f.normal) <= flat_cosine * length) continue;
      const glm::dvec3 now = unit_or(turned, old);
      if (glm::length(now - old) < 1e-4) continue;
      normal = glm::vec3{now};
      log_move(v, mesh_.position[face.point[k]], log);
    }
  }
}

void Wedges::store(const Group& group) {
  VertexArrays& values = mesh_.values;
  if (!values.normals.empty()) values.normals[group.vertex] = glm::vec3{group.normal};
  if (!values.uvs.empty()) values.uvs[group.vertex] = glm::vec2{group.uv};
  if (!values.colors.empty()) values.colors[group.vertex] = to_color(group.color);
}

void Wedges::commit_single(const Star& star, const Choice& choice, PassLog& log) {
  const VertexId kept = mesh_.wedge[choice.kept];
  log.vertices.push_back({mesh_.wedge[choice.gone], kept});
  const Side gone_side = choice.gone == star.u ? Side::U : Side::V;
  for (const StarFace& f : star.faces) {
    const FaceId id = mesh_.faces[f.index].id;
    if (f.side == Side::Both || f.twin) {
      log.faces.push_back(id);
    } else if (f.side == gone_side) {
      log.corners.push_back({3 * id + f.k, kept});
    }
  }
  if (!choice.moves) return;
  for (const Group& group : groups_) store(group);
  log_move(kept, choice.place, log);
}

void Wedges::commit(const Star& star, const Choice& choice, PassLog& log) {
  if (!mesh_.has_seams()) {
    commit_single(star, choice, log);
    return;
  }
  dead_.clear();
  const Side gone_side = choice.gone == star.u ? Side::U : Side::V;
  for (const StarFace& f : star.faces) {
    if (f.side != Side::Both && !f.twin) continue;
    Face& face = mesh_.faces[f.index];
    log.faces.push_back(face.id);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const VertexId v = mesh_.vertex_of(face, k);
      if (--mesh_.vertex_uses[v] == 0) dead_.push_back({v, face.point[k] == choice.gone ? choice.kept : face.point[k]});
    }
    face.id = none;
  }
  for (const StarFace& f : star.faces) {
    if (f.side != gone_side || f.twin) continue;
    const Face& face = mesh_.faces[f.index];
    VertexId& corner = mesh_.corner_vertex[3 * std::size_t{face.id} + f.k];
    const VertexId to = target_of(corner);
    if (to == corner) continue;
    log.corners.push_back({3 * face.id + f.k, to});
    ++mesh_.vertex_uses[to];
    if (--mesh_.vertex_uses[corner] == 0) dead_.push_back({corner, choice.kept});
    corner = to;
  }
  turn_flat_normals(star, choice, log);
  for (const Group& group : groups_) {
    if (!group.moves || mesh_.vertex_uses[group.vertex] == 0) continue;
    store(group);
    log_move(group.vertex, choice.place, log);
  }
  for (const Dead& dead : dead_) {
    if (mesh_.vertex_uses[dead.vertex] == 0) log.vertices.push_back({dead.vertex, heir(star, choice, dead)});
  }
}

// A vertex that goes glides to its heir: where nothing was paired, to the one whose look is nearest.
VertexId Wedges::heir(const Star& star, const Choice& choice, const Dead& dead) const {
  const VertexId paired = target_of(dead.vertex);
  if (paired != dead.vertex && mesh_.vertex_uses[paired] != 0) return paired;
  if (dead.point != choice.kept) {
    // A corner whose last face went along has nothing left at its place: it goes to the vertex kept.
    if (const VertexId there = nearest_look_at(dead.point, dead.vertex); there != none) return there;
  }
  Nearest nearest;
  for (const StarFace& f : star.faces) {
    const Face& face = mesh_.faces[f.index];
    if (face.id == none) continue;
    const VertexId v = mesh_.vertex_of(face, f.k);
    nearest.offer(v, look_distance(v, dead.vertex));
  }
  return nearest.vertex == none ? dead.vertex : nearest.vertex;
}

}  // namespace lodestone::collapse

// SPDX-License-Identifier: MIT
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include <lodestone/mesh.h>

namespace lodestone {
namespace {

Error bad(std::string message, std::string_view kind, std::size_t index) {
  return {ErrorCode::BadData, std::move(message), std::string{kind} + " " + std::to_string(index)};
}

Error bad(std::string message) { return {ErrorCode::BadData, std::move(message), {}}; }

template <class Vector>
std::optional<Error> check_finite(const std::vector<Vector>& values, const char* what) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    // A sum is finite exactly when no term is NaN or infinite, but for overflow, which is refused as well.
    float sum = 0.0F;
    for (int c = 0; c < Vector::length(); ++c) sum += std::abs(values[i][c]);
    if (!std::isfinite(sum)) return bad(std::string{what} + " is not a finite number", "vertex", i);
  }
  return std::nullopt;
}

std::optional<Error> check_vertices(const VertexArrays& v) {
  if (v.positions.size() >= none) return bad("more vertices than an index can name");
  const auto fits = [&](std::size_t size) { return size == 0 || size == v.positions.size(); };
  if (!fits(v.normals.size())) return bad("normals are neither absent nor one per vertex");
  if (!fits(v.uvs.size())) return bad("uvs are neither absent nor one per vertex");
  if (!fits(v.colors.size())) return bad("colours are neither absent nor one per vertex");
  if (auto error = check_finite(v.positions, "position")) return error;
  if (auto error = check_finite(v.normals, "normal")) return error;
  return check_finite(v.uvs, "uv");
}

std::optional<Error> check_range(std::span<const std::uint32_t> values, std::size_t count, bool none_allowed,
                                 const char* what, const char* kind) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] >= count && !(none_allowed && values[i] == none)) {
      return bad(std::string{what} + " " + std::to_string(values[i]) + " does not exist", kind, i);
    }
  }
  return std::nullopt;
}

std::optional<Error> check_faces(const Mesh& mesh) {
  if (mesh.indices.size() % 3 != 0) return bad("the number of indices is not a multiple of three");
  if (mesh.indices.size() >= none) return bad("more triangles than a corner id can name");
  const std::size_t faces = mesh.indices.size() / 3;
  if (!mesh.face_materials.empty() && mesh.face_materials.size() != faces) {
    return bad("face materials are neither absent nor one per triangle");
  }
  if (!mesh.face_features.empty() && mesh.face_features.size() != faces) {
    return bad("face features are neither absent nor one per triangle");
  }
  if (faces > 0 && mesh.materials.empty()) return bad("there are triangles but no material");
  if (auto error = check_range(mesh.indices, mesh.vertex_count(), false, "vertex", "corner")) return error;
  if (auto error = check_range(mesh.face_materials, mesh.materials.size(), false, "material", "triangle")) return error;
  return check_range(mesh.face_features, mesh.features.size(), true, "feature", "triangle");
}

// Parents must exist and lead to a root, so that whoever walks up comes to an end.
std::optional<Error> check_features(const std::vector<Feature>& features) {
  std::vector<std::uint32_t> walk(features.size(), none);  // the walk that came by
  for (std::uint32_t start = 0; start < features.size(); ++start) {
    for (std::uint32_t f = start; f != none && walk[f] != start; f = features[f].parent) {
      const std::uint32_t parent = features[f].parent;
      if (parent != none && parent >= features.size()) return bad("parent does not exist", "feature", f);
      if (parent != none && (parent == f || walk[parent] == start)) {
        return bad("parents form a circle", "feature", f);
      }
      if (walk[f] != none) break;  // an earlier walk reached a root from here
      walk[f] = start;
    }
  }
  return std::nullopt;
}

std::optional<Error> check_surroundings(const Surroundings& s) {
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(s.origin[c])) return bad("the origin is not finite");
  }
  for (std::size_t i = 0; i < s.materials.size(); ++i) {
    const Material& m = s.materials[i];
    if (m.texture != none && m.texture >= s.textures.size()) return bad("texture does not exist", "material", i);
    bool finite = std::isfinite(m.alpha_cutoff);
    for (int c = 0; c < 4; ++c) finite = finite && std::isfinite(m.base_color[c]);
    if (!finite) return bad("colour is not a finite number", "material", i);
  }
  for (std::size_t i = 0; i < s.textures.size(); ++i) {
    if (s.textures[i].image == nullptr) continue;
    const Image& image = *s.textures[i].image;
    if (image.channels > 4 || image.pixels.size() != std::size_t{image.width} * image.height * image.channels) {
      return bad("pixels do not match the size of the image", "texture", i);
    }
  }
  return check_features(s.features);
}

}  // namespace

Status validate(const Mesh& mesh) {
  if (auto error = check_vertices(mesh.vertices)) return *std::move(error);
  if (auto error = check_faces(mesh)) return *std::move(error);
  if (auto error = check_surroundings(mesh)) return *std::move(error);
  return Done{};
}

}  // namespace lodestone

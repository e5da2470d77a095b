// SPDX-License-Identifier: MIT
// The mesh of a glTF 2.0 file or GLB. What tinygltf hands over is checked here.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <map>

#include "axes.h"
#include "gltf_accessors.h"
#include "gltf_colors.h"
#include "gltf_draco.h"
#include "gltf_features.h"
#include "gltf_parse.h"
#include "reader.h"

namespace lodestone {
namespace {

using tinygltf::Model;

glm::dmat4 local_matrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 m{1.0};
  if (node.translation.size() == 3)
    m[3] = glm::dvec4{node.translation[0], node.translation[1], node.translation[2], 1.0};
  if (node.rotation.size() == 4) {
    m *= glm::mat4_cast(glm::dquat{node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]});
  }
  if (node.scale.size() == 3) {
    for (int a = 0; a < 3; ++a) m[a] *= node.scale[a];
  }
  return m;
}

struct Instance {
  int node = 0;
  glm::dmat4 world{1.0};
};

// uv' = matrix * uv + offset, and which uv set.
struct UvUse {
  int set = 0;
  glm::mat2 matrix{1.0F};
  glm::vec2 offset{0.0F};
};

double number_at(const tinygltf::Value& object, const char* key, std::size_t index, double fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const auto& list = object.Get(key);
  if (!list.IsArray() || list.ArrayLen() <= index || !list.Get(static_cast<int>(index)).IsNumber()) return fallback;
  return list.Get(static_cast<int>(index)).GetNumberAsDouble();
}

UvUse uv_use(const tinygltf::ExtensionMap& extensions, int set) {
  UvUse use{.set = set};
  const auto found = extensions.find("KHR_texture_transform");
  if (found == extensions.end() || !found->second.IsObject()) return use;
  const tinygltf::Value& t = found->second;
  if (t.Has("texCoord") && t.Get("texCoord").IsInt()) use.set = t.Get("texCoord").Get<int>();
  const double turn = t.Has("rotation") && t.Get("rotation").IsNumber() ? t.Get("rotation").GetNumberAsDouble() : 0.0;
  const glm::vec2 scale{number_at(t, "scale", 0, 1.0), number_at(t, "scale", 1, 1.0)};
  const auto c = static_cast<float>(std::cos(turn));
  const auto s = static_cast<float>(std::sin(turn));
  use.matrix = glm::mat2{glm::vec2{c, -s} * scale.x, glm::vec2{s, c} * scale.y};
  use.offset = {number_at(t, "offset", 0, 0.0), number_at(t, "offset", 1, 0.0)};
  return use;
}

// An error with the file's name before its place in it.
Error in_file(Error error, const Input& input) {
  error.where = input.name() + (error.where.empty() || error.where == input.name() ? "" : ", " + error.where);
  return error;
}

class GltfReader {
 public:
  GltfReader(const Input& input, const Model& model, const ReadOptions& options, const Context& context)
      : input_{input}, model_{model}, options_{options}, context_{context}, features_{model, options.max_triangles} {}
  [[nodiscard]] Result<LoadedMesh> read();

 private:
  void find_instances();
  void visit(int node, const glm::dmat4& parent, int depth);
  void choose_place();
  void add_materials();
  [[nodiscard]] MaterialId material_of(const tinygltf::Primitive& primitive);
  [[nodiscard]] std::uint32_t texture_of(int index);
  [[nodiscard]] Status add_instance(const Instance& instance);
  [[nodiscard]] Status add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& to_mesh,
                                     FeatureId feature);
  [[nodiscard]] Result<VertexId> add_vertices(const tinygltf::Primitive& primitive, const UvUse& use,
                                              const glm::dmat4& to_mesh, std::uint32_t& count);
  void add_colors(const tinygltf::Primitive& primitive, std::size_t first, std::size_t count);
  [[nodiscard]] Status add_faces(const tinygltf::Primitive& primitive, VertexId first, std::uint32_t count,
                                 bool flipped, MaterialId material, FeatureId feature);
  [[nodiscard]] int attribute(const tinygltf::Primitive& primitive, const std::string& name) const {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
  }

  const Input& input_;
  const Model& model_;
  const ReadOptions& options_;
  const Context& context_;
  Warnings warnings_;
  Mesh mesh_;
  std::vector<Instance> instances_;
  std::vector<bool> visited_;
  std::vector<UvUse> uv_uses_;  // by material
  MaterialId plain_ = none;     // for primitives without a material
  // Primitives of one instance often share their vertices.
  std::map<std::string, std::pair<VertexId, std::uint32_t>> shared_;
  GltfFeatures features_;
  std::vector<FeatureId> vertex_features_;  // of the primitive being read, if it has any
  bool split_ = false;                      // vertices were split where features meet
  std::vector<float> floats_;
  std::vector<std::uint32_t> indices_;
};

void GltfReader::visit(int node, const glm::dmat4& parent, int depth) {
  constexpr int deepest = 1000;
  if (node < 0 || static_cast<std::size_t>(node) >= model_.nodes.size() || depth > deepest) return;
  if (visited_[node]) {
    warnings_.add("a node has two parents or is its own; it is used once");
    return;
  }
  visited_[node] = true;
  const tinygltf::Node& n = model_.nodes[node];
  const glm::dmat4 world = parent * local_matrix(n);
  if (n.mesh >= 0 && static_cast<std::size_t>(n.mesh) < model_.meshes.size()) instances_.push_back({node, world});
  for (const int child : n.children) visit(child, world, depth + 1);
}

void GltfReader::find_instances() {
  visited_.assign(model_.nodes.size(), false);
  std::vector<int> roots;
  if (!model_.scenes.empty()) {
    const bool named = model_.defaultScene >= 0 && static_cast<std::size_t>(model_.defaultScene) < model_.scenes.size();
    roots = model_.scenes[named ? model_.defaultScene : 0].nodes;
  } else {
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const auto& node : model_.nodes) {
      for (const int child : node.children) {
        if (child >= 0 && static_cast<std::size_t>(child) < is_child.size()) is_child[child] = true;
      }
    }
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i]) roots.push_back(static_cast<int>(i));
    }
  }
  for (const int root : roots) visit(root, glm::dmat4{1.0}, 0);
  if (instances_.empty() && model_.nodes.empty()) {
    warnings_.add("there is no scene; the meshes are taken as they are");
  }
}

// The translation that all instances share becomes the origin, in double; else what keeps far coordinates precise.
void GltfReader::choose_place() {
  Box places;
  for (const Instance& instance : instances_) {
    const glm::dvec3 place{instance.world[3]};
    if (std::isfinite(place.x + place.y + place.z)) places.add(place);
  }
  if (places.empty()) return;
  mesh_.origin = places.min == places.max ? places.min : choose_origin(places);
}

std::uint32_t GltfReader::texture_of(int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= model_.textures.size()) return none;
  const tinygltf::Texture& texture = model_.textures[index];
  int source = texture.source;
  if (const auto webp = texture.extensions.find("EXT_texture_webp");
      webp != texture.extensions.end() && webp->second.IsObject() && webp->second.Has("source") &&
      webp->second.Get("source").IsInt()) {
    source = webp->second.Get("source").Get<int>();
  }
  if (source < 0 || static_cast<std::size_t>(source) >= model_.images.size()) {
    warnings_.add("a texture has no image of a kind that can be read");
    return none;
  }
  const tinygltf::Image& image = model_.images[source];
  if (!image.uri.empty()) {
    if (find_beside(input_.folder(), image.uri)) {
      return add_texture_file(mesh_, image.uri, input_, options_, warnings_);
    }
    if (image.image.empty()) {
      warnings_.add("the texture \"" + image.uri + "\" is missing", input_.name());
      return none;
    }
  }
  std::string name = image.name.empty() ? "image" + std::to_string(source) : image.name;
  for (int other = 0; other < source; ++other) {
    if (model_.images[other].name == image.name) name = image.name + '#' + std::to_string(source);
  }
  std::vector<std::uint8_t> bytes = image.image;
  if (bytes.empty()) {
    const auto view = view_bytes(model_, image.bufferView);
    bytes.assign(view.begin(), view.end());
  }
  return add_texture_bytes(mesh_, name, std::move(bytes), options_, warnings_);
}

void GltfReader::add_materials() {
  for (const tinygltf::Material& from : model_.materials) {
    Material material;
    material.name = from.name.empty() ? "material" + std::to_string(mesh_.materials.size()) : from.name;
    const auto& pbr = from.pbrMetallicRoughness;
    std::vector<double> factor = pbr.baseColorFactor;
    int texture = pbr.baseColorTexture.index;
    UvUse use = uv_use(pbr.baseColorTexture.extensions, pbr.baseColorTexture.texCoord);
    if (const auto old = from.extensions.find("KHR_materials_pbrSpecularGlossiness");
        old != from.extensions.end() && texture < 0 && old->second.IsObject()) {
      for (std::size_t c = 0; c < 4; ++c) factor[c] = number_at(old->second, "diffuseFactor", c, 1.0);
      if (old->second.Has("diffuseTexture") && old->second.Get("diffuseTexture").IsObject()) {
        const auto& info = old->second.Get("diffuseTexture");
        if (info.Has("index") && info.Get("index").IsInt()) texture = info.Get("index").Get<int>();
      }
    }
    for (int c = 0; c < 4 && factor.size() == 4; ++c) {
      const double value = std::isfinite(factor[c]) ? std::clamp(factor[c], 0.0, 1.0) : 1.0;
      material.base_color[c] = static_cast<float>(c < 3 ? linear_to_srgb(value) : value);
    }
    if (from.alphaMode != "BLEND") material.base_color.a = 1.0F;
    if (from.alphaMode == "MASK") material.alpha_cutoff = static_cast<float>(std::clamp(from.alphaCutoff, 0.0, 1.0));
    material.double_sided = from.doubleSided;
    if (texture >= 0) material.texture = texture_of(texture);
    uv_uses_.push_back(use);
    mesh_.materials.push_back(std::move(material));
  }
}

MaterialId GltfReader::material_of(const tinygltf::Primitive& primitive) {
  if (primitive.material >= 0 && static_cast<std::size_t>(primitive.material) < model_.materials.size()) {
    return static_cast<MaterialId>(primitive.material);
  }
  if (plain_ == none) {
    plain_ = static_cast<MaterialId>(mesh_.materials.size());
    Material material;
    material.name = "default";
    mesh_.materials.push_back(std::move(material));
    uv_uses_.emplace_back();
  }
  return plain_;
}

void GltfReader::add_colors(const tinygltf::Primitive& primitive, std::size_t first, std::size_t count) {
  const int index = attribute(primitive, "COLOR_0");
  if (index < 0 || static_cast<std::size_t>(index) >= model_.accessors.size()) return;
  const int components = model_.accessors[index].type == TINYGLTF_TYPE_VEC3 ? 3 : 4;
  if (!read_floats(model_, index, components, count, floats_) || floats_.size() != count * components) {
    warnings_.add("vertex colours that do not fit their mesh are left out");
    return;
  }
  auto& colors = mesh_.vertices.colors;
  colors.resize(first + count, glm::u8vec4{255});
  for (std::size_t i = 0; i < count; ++i) {
    for (int c = 0; c < components; ++c) {
      const double value = static_cast<double>(floats_[i * components + c]);
      const double shown = !(value > 0.0) ? 0.0 : (c < 3 ? linear_to_srgb(value) : std::min(value, 1.0));
      colors[first + i][c] = static_cast<std::uint8_t>(std::lround(shown * 255.0));
    }
  }
}

Result<VertexId> GltfReader::add_vertices(const tinygltf::Primitive& primitive, const UvUse& use,
                                          const glm::dmat4& to_mesh, std::uint32_t& count) {
  VertexArrays& v = mesh_.vertices;
  const std::size_t first = v.positions.size();
  const std::uint64_t room = options_.max_vertices - std::min<std::uint64_t>(options_.max_vertices, first);
  if (auto done = read_floats(model_, attribute(primitive, "POSITION"), 3, room, floats_); !done) return done.error();
  count = static_cast<std::uint32_t>(floats_.size() / 3);
  const bool plain = to_mesh == glm::dmat4{1.0};
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 p{floats_[3 * i], floats_[3 * i + 1], floats_[3 * i + 2]};
    v.positions.push_back(plain ? p : glm::vec3{to_mesh * glm::dvec4{p, 1.0}});
  }
  if (const int normals = attribute(primitive, "NORMAL"); normals >= 0) {
    if (read_floats(model_, normals, 3, count, floats_) && floats_.size() == 3 * std::size_t{count}) {
      const glm::dmat3 turn = glm::transpose(glm::inverse(glm::dmat3{to_mesh}));
      v.normals.resize(first + count, glm::vec3{0.0F});
      for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 n{floats_[3 * i], floats_[3 * i + 1], floats_[3 * i + 2]};
        v.normals[first + i] = plain ? n : glm::vec3{turn * glm::dvec3{n}};
        if (!plain) {
          const float length = glm::length(v.normals[first + i]);
          if (length > 0.0F) v.normals[first + i] /= length;
        }
      }
    } else {
      warnings_.add("normals that do not fit their mesh are left out");
    }
  }
  if (const int uvs = attribute(primitive, "TEXCOORD_" + std::to_string(use.set)); uvs >= 0) {
    if (read_floats(model_, uvs, 2, count, floats_) && floats_.size() == 2 * std::size_t{count}) {
      v.uvs.resize(first + count, glm::vec2{0.0F});
      for (std::size_t i = 0; i < count; ++i) {
        v.uvs[first + i] = flip_v(use.matrix * glm::vec2{floats_[2 * i], floats_[2 * i + 1]} + use.offset);
      }
    } else {
      warnings_.add("texture coordinates that do not fit their mesh are left out");
    }
  }
  add_colors(primitive, first, count);
  return static_cast<VertexId>(first);
}

Status GltfReader::add_faces(const tinygltf::Primitive& primitive, VertexId first, std::uint32_t count, bool flipped,
                             MaterialId material, FeatureId feature) {
  if (primitive.indices >= 0) {
    if (auto done = read_indices(model_, primitive.indices, 3 * options_.max_triangles, indices_); !done) return done;
  } else {
    indices_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) indices_[i] = i;
  }
  const bool strip = primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP;
  const bool fan = primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
  const std::size_t step = strip || fan ? 1 : 3;
  for (std::size_t i = 0; i + 2 < indices_.size(); i += step) {
    std::array<std::uint32_t, 3> t{indices_[fan ? 0 : i], indices_[i + 1], indices_[i + 2]};
    if (strip && i % 2 == 1) std::swap(t[0], t[1]);
    if (flipped) std::swap(t[1], t[2]);
    if (t[0] >= count || t[1] >= count || t[2] >= count) {
      warnings_.add("a face names a vertex that does not exist; it is left out");
      continue;
    }
    // In strips and fans faces without area only steer.
    if (step == 1 && (t[0] == t[1] || t[1] == t[2] || t[0] == t[2])) continue;
    for (const std::uint32_t corner : t) mesh_.indices.push_back(first + corner);
    mesh_.face_materials.push_back(material);
    mesh_.face_features.push_back(vertex_features_.empty() ? feature : vertex_features_[t[0]]);
    if (mesh_.face_materials.size() > options_.max_triangles) {
      return too_large(input_, "triangles", mesh_.face_materials.size(), options_.max_triangles);
    }
  }
  return Done{};
}

Status GltfReader::add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& to_mesh, FeatureId feature) {
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
      primitive.mode != TINYGLTF_MODE_TRIANGLE_FAN && primitive.mode != -1) {
    warnings_.add("lines and points are left out");
    return Done{};
  }
  const MaterialId material = material_of(primitive);
  const UvUse use = uv_uses_[material];
  std::string key;
  for (const auto& [name, accessor] : primitive.attributes) key += name + '=' + std::to_string(accessor) + ';';
  for (const float value :
       {use.matrix[0].x, use.matrix[0].y, use.matrix[1].x, use.matrix[1].y, use.offset.x, use.offset.y}) {
    key += std::to_string(value) + ';';
  }
  key += std::to_string(use.set);
  auto found = shared_.find(key);
  if (found == shared_.end()) {
    std::uint32_t count = 0;
    auto first = add_vertices(primitive, use, to_mesh, count);
    if (!first) return first.error();
    found = shared_.emplace(key, std::pair{*first, count}).first;
  }
  const bool flipped = glm::determinant(glm::dmat3{to_mesh}) < 0.0;
  vertex_features_.clear();
  if (features_.read(primitive, found->second.second, feature, mesh_, warnings_, vertex_features_)) split_ = true;
  return add_faces(primitive, found->second.first, found->second.second, flipped, material, feature);
}

Status GltfReader::add_instance(const Instance& instance) {
  const tinygltf::Node& node = model_.nodes[instance.node];
  if (node.skin >= 0) warnings_.add("skins are not applied");
  FeatureId feature = none;
  if (instances_.size() > 1) {
    feature = static_cast<FeatureId>(mesh_.features.size());
    Feature named;
    named.id = node.name.empty() ? "node" + std::to_string(instance.node) : node.name;
    mesh_.features.push_back(std::move(named));
  }
  glm::dmat4 to_mesh = instance.world;
  to_mesh[3] -= glm::dvec4{mesh_.origin, 0.0};
  shared_.clear();
  for (const tinygltf::Primitive& primitive : model_.meshes[node.mesh].primitives) {
    if (context_.cancelled()) return Error{ErrorCode::Cancelled, "reading was cancelled", input_.name()};
    if (auto done = add_primitive(primitive, to_mesh, feature); !done) return done;
  }
  return Done{};
}

Result<LoadedMesh> GltfReader::read() {
  find_instances();
  choose_place();
  add_materials();
  for (const Instance& instance : instances_) {
    if (auto done = add_instance(instance); !done) return in_file(done.error(), input_);
  }
  VertexArrays& v = mesh_.vertices;
  if (!v.normals.empty()) v.normals.resize(v.positions.size(), glm::vec3{0.0F});
  if (!v.uvs.empty()) v.uvs.resize(v.positions.size(), glm::vec2{0.0F});
  if (!v.colors.empty()) v.colors.resize(v.positions.size(), glm::u8vec4{255});
  if (mesh_.features.empty()) mesh_.face_features.clear();
  if (!instances_.empty()) {
    const auto& extras = model_.nodes[instances_.front().node].extras;
    if (extras.IsObject() && extras.Has("crs") && extras.Get("crs").IsString())
      mesh_.crs = extras.Get("crs").Get<std::string>();
  }
  remove_unused(mesh_);
  if (split_) merge_identical_vertices(mesh_);
  return {to_lodestone_axes(std::move(mesh_), "gltf", UpAxis::Y, 1.0, options_), warnings_.take()};
}

}  // namespace

Result<LoadedMesh> read_gltf(const Input& input, const ReadOptions& options, const Context& context) {
  auto model = parse_gltf(input, options);
  if (!model) return model.error();
  if (auto done = unpack_draco(*model, options); !done) return in_file(done.error(), input);
  return GltfReader{input, *model, options, context}.read();
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
// 3DS and everything else that assimp reads. The only file that names assimp, which runs in a process of its own: its
// many importers are not all safe on broken files.
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <assimp/ProgressHandler.hpp>
#include <cmath>
#include <cstring>

#include "axes.h"
#include "isolated.h"
#include "polygon_faces.h"
#include "reader.h"
#include "strays.h"

namespace lodestone {
namespace {

// Lets a Context stop assimp, as far as its importers ask.
class Watcher : public Assimp::ProgressHandler {
 public:
  explicit Watcher(const Context& context) : context_{context} {}
  bool Update(float) override { return !context_.cancelled(); }

 private:
  const Context& context_;
};

// Formats whose importers hand over the file's own Z-up coordinates; all others are turned to Y up by assimp.
bool is_z_up(const std::string& extension) {
  static constexpr std::array names{".stl", ".off", ".3mf", ".amf", ".raw", ".ter", ".nff", ".blend"};
  return std::find(names.begin(), names.end(), extension) != names.end();
}

// Formats that are Z up themselves and that assimp has turned to Y up.
bool was_z_up(const std::string& extension) {
  static constexpr std::array names{".3ds", ".ase", ".dxf", ".ifc", ".ifczip"};
  return std::find(names.begin(), names.end(), extension) != names.end();
}

glm::dmat4 matrix_of(const aiMatrix4x4& m) {
  return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

glm::vec3 vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

std::string text_of(const aiString& s) { return {s.data, std::min<std::size_t>(s.length, sizeof s.data)}; }

class SceneReader {
 public:
  SceneReader(const Input& input, const aiScene& scene, const ReadOptions& options, const Context& context)
      : input_{input}, scene_{scene}, options_{options}, context_{context} {}
  [[nodiscard]] Result<LoadedMesh> read();

 private:
  struct Instance {
    const aiMesh* mesh = nullptr;
    glm::dmat4 world{1.0};
    FeatureId feature = none;
  };

  void visit(const aiNode& node, const glm::dmat4& parent, FeatureId parent_feature, int depth);
  [[nodiscard]] FeatureId add_feature(const aiNode& node, FeatureId parent);
  void add_materials();
  [[nodiscard]] std::uint32_t texture_of(const aiMaterial& material);
  [[nodiscard]] std::uint32_t embedded_texture(const aiTexture& texture, const std::string& name);
  void choose_place();
  [[nodiscard]] Status add_instance(const Instance& instance);
  void add_vertices(const aiMesh& mesh, const glm::dmat4& to_mesh);
  void add_face(const aiMesh& mesh, const aiFace& face, VertexId first, bool flipped, FeatureId feature);
  [[nodiscard]] double unit_m() const;
  [[nodiscard]] UpAxis up_axis() const;

  const Input& input_;
  const aiScene& scene_;
  const ReadOptions& options_;
  const Context& context_;
  Warnings warnings_;
  Mesh mesh_;
  std::vector<Instance> instances_;
  std::vector<glm::dvec3> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

// The names that IFC gives its products begin with their class: "IfcWall_South_2O2Fr$t4X7Zf8NOew3FNr2".
FeatureId SceneReader::add_feature(const aiNode& node, FeatureId parent) {
  constexpr std::size_t most = 1U << 22;
  if (mesh_.features.size() >= most) return parent;
  Feature feature;
  feature.id = text_of(node.mName);
  if (feature.id.empty()) return parent;
  if (feature.id.starts_with("Ifc")) feature.semantic_class = feature.id.substr(0, feature.id.find('_'));
  feature.parent = parent;
  mesh_.features.push_back(std::move(feature));
  return static_cast<FeatureId>(mesh_.features.size() - 1);
}

void SceneReader::visit(const aiNode& node, const glm::dmat4& parent, FeatureId parent_feature, int depth) {
  constexpr int deepest = 1000;
  constexpr std::size_t most = 1U << 24;
  if (depth > deepest || instances_.size() > most) {
    warnings_.add("the scene is nested too deep; parts are left out");
    return;
  }
  const glm::dmat4 world = parent * matrix_of(node.mTransformation);
  const FeatureId feature = depth == 0 ? none : add_feature(node, parent_feature);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    if (node.mMeshes[i] >= scene_.mNumMeshes || scene_.mMeshes[node.mMeshes[i]] == nullptr) continue;
    instances_.push_back({scene_.mMeshes[node.mMeshes[i]], world, feature});
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    if (node.mChildren[i] != nullptr) visit(*node.mChildren[i], world, feature, depth + 1);
  }
}

std::uint32_t SceneReader::embedded_texture(const aiTexture& texture, const std::string& name) {
  std::vector<std::uint8_t> bytes;
  if (texture.mHeight == 0) {  // the bytes of an image file
    const auto* first = reinterpret_cast<const std::uint8_t*>(texture.pcData);
    bytes.assign(first, first + texture.mWidth);
  } else {
    Image image{texture.mWidth, texture.mHeight, 4, {}};
    const std::size_t count = static_cast<std::size_t>(texture.mWidth) * texture.mHeight;
    if (count > options_.max_texture_pixels) return none;
    for (std::size_t i = 0; i < count; ++i) {
      const aiTexel& t = texture.pcData[i];
      image.pixels.insert(image.pixels.end(), {t.r, t.g, t.b, t.a});
    }
    auto png = encode_png(image);
    if (!png) return none;
    bytes = std::move(*png);
  }
  return add_texture_bytes(mesh_, name, std::move(bytes), options_, warnings_);
}

std::uint32_t SceneReader::texture_of(const aiMaterial& material) {
  aiString path;
  if (material.GetTexture(aiTextureType_DIFFUSE, 0, &path) != AI_SUCCESS &&
      material.GetTexture(aiTextureType_BASE_COLOR, 0, &path) != AI_SUCCESS) {
    return none;
  }
  const std::string name = text_of(path);
  if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str())) return embedded_texture(*embedded, name);
  return add_texture_file(mesh_, name, input_, options_, warnings_);
}

void SceneReader::add_materials() {
  for (unsigned i = 0; i < scene_.mNumMaterials; ++i) {
    Material material;
    if (scene_.mMaterials[i] == nullptr) {
      material.name = "material" + std::to_string(i);
      mesh_.materials.push_back(std::move(material));
      continue;
    }
    const aiMaterial& from = *scene_.mMaterials[i];
    aiString name;
    if (from.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) material.name = text_of(name);
    if (material.name.empty()) material.name = "material" + std::to_string(i);
    material.texture = texture_of(from);
    aiColor4D color{1.0F, 1.0F, 1.0F, 1.0F};
    float opacity = 1.0F;
    (void)from.Get(AI_MATKEY_COLOR_DIFFUSE, color);
    (void)from.Get(AI_MATKEY_OPACITY, opacity);
    const auto share = [](float v) { return std::isfinite(v) ? std::clamp(v, 0.0F, 1.0F) : 1.0F; };
    // Many exporters leave the colour of textured materials black; a picture times black shows nothing.
    const bool black = color.r == 0.0F && color.g == 0.0F && color.b == 0.0F;
    if (material.texture != none && black) color = {1.0F, 1.0F, 1.0F, color.a};
    material.base_color = {share(color.r), share(color.g), share(color.b), share(opacity)};
    mesh_.materials.push_back(std::move(material));
  }
  if (mesh_.materials.empty()) {
    Material material;
    material.name = "default";
    mesh_.materials.push_back(std::move(material));
  }
}

void SceneReader::choose_place() {
  std::vector<glm::dvec3> places;
  for (const Instance& instance : instances_) {
    for (unsigned i = 0; i < instance.mesh->mNumVertices; ++i) {
      places.emplace_back(instance.world * glm::dvec4{vector_of(instance.mesh->mVertices[i]), 1.0});
    }
  }
  mesh_.origin = choose_origin(box_without_strays(places.size(), [&](std::size_t i) { return places[i]; }));
}

void SceneReader::add_vertices(const aiMesh& mesh, const glm::dmat4& to_mesh) {
  VertexArrays& v = mesh_.vertices;
  const std::size_t first = v.positions.size();
  const std::size_t count = mesh.mNumVertices;
  const glm::dmat3 turn = glm::transpose(glm::inverse(glm::dmat3{to_mesh}));
  if (mesh.HasNormals()) v.normals.resize(first, glm::vec3{0.0F});
  if (mesh.HasTextureCoords(0)) v.uvs.resize(first, glm::vec2{0.0F});
  if (mesh.HasVertexColors(0)) v.colors.resize(first, glm::u8vec4{255});
  const auto byte = [](float c) {
    return static_cast<std::uint8_t>(std::lround(std::isfinite(c) ? std::clamp(c, 0.0F, 1.0F) * 255.0F : 0.0F));
  };
  for (std::size_t i = 0; i < count; ++i) {
    v.positions.emplace_back(to_mesh * glm::dvec4{vector_of(mesh.mVertices[i]), 1.0});
    if (mesh.HasNormals()) {
      const glm::dvec3 n = turn * glm::dvec3{vector_of(mesh.mNormals[i])};
      const double length = glm::length(n);
      v.normals.push_back(length > 0.0 ? glm::vec3{n / length} : glm::vec3{0.0F});
    }
    if (mesh.HasTextureCoords(0)) v.uvs.emplace_back(mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y);
    if (mesh.HasVertexColors(0)) {
      const aiColor4D& c = mesh.mColors[0][i];
      v.colors.emplace_back(byte(c.r), byte(c.g), byte(c.b), byte(c.a));
    }
  }
  const std::size_t all = first + count;
  if (!v.normals.empty()) v.normals.resize(all, glm::vec3{0.0F});
  if (!v.uvs.empty()) v.uvs.resize(all, glm::vec2{0.0F});
  if (!v.colors.empty()) v.colors.resize(all, glm::u8vec4{255});
}

void SceneReader::add_face(const aiMesh& mesh, const aiFace& face, VertexId first, bool flipped, FeatureId feature) {
  if (face.mNumIndices < 3) {
    warnings_.add("lines and points are left out");
    return;
  }
  points_.clear();
  for (unsigned c = 0; c < face.mNumIndices; ++c) {
    if (face.mIndices[c] >= mesh.mNumVertices) {
      warnings_.add("a face names a vertex that does not exist; it is left out");
      return;
    }
    points_.emplace_back(mesh_.vertices.positions[first + face.mIndices[c]]);
    if (!std::isfinite(points_.back().x + points_.back().y + points_.back().z)) {
      warnings_.add("a face has a corner that is not a finite number; it is left out");
      return;
    }
  }
  split_polygon(points_, triangles_);
  for (auto t : triangles_) {
    if (flipped) std::swap(t[1], t[2]);
    for (const std::uint32_t c : t) mesh_.indices.push_back(first + face.mIndices[c]);
    mesh_.face_materials.push_back(mesh.mMaterialIndex < mesh_.materials.size() ? mesh.mMaterialIndex : 0);
    mesh_.face_features.push_back(feature);
  }
}

Status SceneReader::add_instance(const Instance& instance) {
  if (context_.cancelled()) return Error{ErrorCode::Cancelled, "reading was cancelled", input_.name()};
  const aiMesh& mesh = *instance.mesh;
  const std::uint64_t vertices = std::uint64_t{mesh_.vertices.positions.size()} + mesh.mNumVertices;
  const std::uint64_t triangles = mesh_.indices.size() / 3 + std::uint64_t{mesh.mNumFaces};
  if (vertices > options_.max_vertices) return too_large(input_, "vertices", vertices, options_.max_vertices);
  if (triangles > options_.max_triangles) return too_large(input_, "triangles", triangles, options_.max_triangles);
  const VertexId first = mesh_.vertices.size();
  glm::dmat4 to_mesh = instance.world;
  to_mesh[3] -= glm::dvec4{mesh_.origin, 0.0};
  add_vertices(mesh, to_mesh);
  const bool flipped = glm::determinant(glm::dmat3{to_mesh}) < 0.0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) add_face(mesh, mesh.mFaces[f], first, flipped, instance.feature);
  return Done{};
}

// assimp scales IFC and COLLADA to metres itself; FBX tells centimetres per unit, 3MF and AMF are in millimetres.
double SceneReader::unit_m() const {
  const std::string extension = input_.extension();
  if (extension == ".3mf" || extension == ".amf") return 0.001;
  if (extension != ".fbx" || scene_.mMetaData == nullptr) return 1.0;
  double centimetres = 1.0;
  float as_float = 0.0F;
  if (!scene_.mMetaData->Get("UnitScaleFactor", centimetres) && scene_.mMetaData->Get("UnitScaleFactor", as_float)) {
    centimetres = static_cast<double>(as_float);
  }
  return std::isfinite(centimetres) && centimetres > 0.0 ? centimetres * 0.01 : 0.01;
}

UpAxis SceneReader::up_axis() const {
  std::int32_t axis = 1;
  if (input_.extension() == ".fbx" && scene_.mMetaData != nullptr && scene_.mMetaData->Get("UpAxis", axis)) {
    return axis == 2 ? UpAxis::Z : UpAxis::Y;
  }
  return is_z_up(input_.extension()) ? UpAxis::Z : UpAxis::Y;
}

Result<LoadedMesh> SceneReader::read() {
  if (scene_.mRootNode != nullptr) visit(*scene_.mRootNode, glm::dmat4{1.0}, none, 0);
  add_materials();
  choose_place();
  for (const Instance& instance : instances_) {
    if (auto done = add_instance(instance); !done) return done.error();
  }
  if (mesh_.features.empty()) mesh_.face_features.clear();
  if ((scene_.mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) warnings_.add("the file was not read completely");
  const std::string format = input_.extension().empty() ? "assimp" : input_.extension().substr(1);
  LoadedMesh loaded = to_lodestone_axes(std::move(mesh_), format, up_axis(), unit_m(), options_);
  if (options_.up == UpAxis::FromFile && was_z_up(input_.extension())) loaded.info.up_axis = "Z";
  return {std::move(loaded), warnings_.take()};
}

}  // namespace

bool assimp_reads(const std::string& extension) {
  if (extension.size() < 2) return false;
  static const Assimp::Importer importer;  // its list of importers does not change
  return importer.IsExtensionSupported(extension.c_str());
}

Result<LoadedMesh> read_assimp_in_process(const Input& input, const ReadOptions& options, const Context& context) {
  Assimp::Importer importer;
  importer.SetProgressHandler(new Watcher{context});  // owned by the importer
  const aiScene* scene = nullptr;
  std::string reason;
  try {
    if (!input.file().empty()) {
      scene = importer.ReadFile(input.file().string(), 0);
    } else {
      auto bytes = input.read_all();
      if (!bytes) return bytes.error();
      const std::string hint = input.extension().empty() ? "" : input.extension().substr(1);
      scene = importer.ReadFileFromMemory(bytes->data(), bytes->size(), 0, hint.c_str());
    }
    reason = importer.GetErrorString();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::TooLarge, "asks for more memory than there is, or than a limit allows", input.name()};
  } catch (const std::exception& thrown) {
    reason = thrown.what();
  }
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "reading was cancelled", input.name()};
  if (scene == nullptr) {
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    return Error{ErrorCode::BadData, "cannot be read (" + reason.substr(0, 200) + ")", input.name()};
  }
  return SceneReader{input, *scene, options, context}.read();
}

Result<LoadedMesh> read_assimp(const Input& input, const ReadOptions& options, const Context& context) {
  auto loaded = run_isolated(input, context, [&] { return read_assimp_in_process(input, options, context); });
  if (!loaded) return loaded;
  remove_unused(loaded->mesh);
  merge_identical_vertices(loaded->mesh);  // assimp gives every face corners of its own
  return loaded;
}

}  // namespace lodestone

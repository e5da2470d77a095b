// SPDX-License-Identifier: MIT
// Binary glTF 2.0: one primitive per material over shared vertex arrays, everything in one file. Several levels of one
// model become one mesh each, that share materials and textures (MSFT_lod). Features of faces become ids of vertices
// and a table (EXT_mesh_features, EXT_structural_metadata).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "axes.h"
#include "gltf_colors.h"
#include "gltf_meshopt.h"
#include "gltf_metadata.h"
#include "writers.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "glTF is little-endian and written as it lies in memory");

enum GltfConstant : int {
  ArrayBuffer = 34962,
  ElementArrayBuffer = 34963,
  Byte = 5120,
  UnsignedShort = 5123,
  UnsignedInt = 5125,
  Float = 5126,
};

constexpr std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) & ~std::uint64_t{3}; }
constexpr std::uint64_t padded_to_8(std::uint64_t bytes) { return (bytes + 7) & ~std::uint64_t{7}; }

std::vector<std::uint8_t> bytes_of(std::span<const std::byte> raw) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(raw.data());
  return {first, first + raw.size()};
}

constexpr const char* webp = "image/webp";
constexpr const char* meshopt = "EXT_meshopt_compression";

std::vector<glm::vec3> turned_positions(const VertexArrays& vertices) {
  std::vector<glm::vec3> turned;
  turned.reserve(vertices.positions.size());
  for (const glm::vec3& p : vertices.positions) turned.push_back(z_up_to_y_up(p));
  return turned;
}

glm::vec3 normal_for_gltf(const glm::vec3& normal) {
  const glm::vec3 n = z_up_to_y_up(normal);
  const float length = glm::length(n);
  constexpr float tolerance = 4e-4F;  // gltf-validator allows 5e-4
  if (std::abs(length - 1.0F) < tolerance) return n;
  return length > 0.0F ? n / length : glm::vec3{0.0F, 1.0F, 0.0F};
}

std::vector<glm::vec3> normals_for_gltf(const VertexArrays& vertices) {
  std::vector<glm::vec3> normals;
  normals.reserve(vertices.normals.size());
  for (const glm::vec3& n : vertices.normals) normals.push_back(normal_for_gltf(n));
  return normals;
}

// 16 bits each, four a vertex.
std::vector<std::uint16_t> linear_colors(const VertexArrays& vertices) {
  std::array<std::uint16_t, 256> linear{};
  for (int c = 0; c < 256; ++c)
    linear[c] = static_cast<std::uint16_t>(std::lround(srgb_to_linear(c / 255.0) * 65535.0));
  std::vector<std::uint16_t> colors;
  colors.reserve(4 * vertices.colors.size());
  for (const glm::u8vec4& color : vertices.colors) {
    for (int c = 0; c < 3; ++c) colors.push_back(linear[color[c]]);
    colors.push_back(static_cast<std::uint16_t>(color.a * 257));
  }
  return colors;
}

// The least and greatest place of an accessor.
void set_range(Json& accessor, std::span<const glm::vec3> positions) {
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};
  for (const glm::vec3& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  accessor["min"] = {low.x, low.y, low.z};
  accessor["max"] = {high.x, high.y, high.z};
}

// glTF takes JPEG and PNG, and WebP by an extension that tiles use; anything else is turned into PNG.
Result<EncodedTexture> image_for_gltf(const Texture& texture, GltfLook look) {
  auto encoded = encoded_texture(texture);
  if (!encoded || encoded->mime_type == "image/jpeg" || encoded->mime_type == "image/png") return encoded;
  if (look == GltfLook::Photograph && encoded->mime_type == webp) return encoded;
  auto image = decode_image(encoded->bytes, texture.name);
  if (!image) return image.error();
  auto png = encode_png(*image);
  if (!png) return png.error();
  return EncodedTexture{std::move(*png), "image/png"};
}

class GlbWriter {
 public:
  // The finest level first; all have the surroundings of the first.
  GlbWriter(std::span<const GltfLevel> levels, const GltfStyle& style)
      : first_{*levels.front().mesh}, look_{style.look}, packing_{style.packing} {
    for (const GltfLevel& level : levels) parts_.push_back({level.mesh, {}, {}, {}, false, level.least_coverage});
  }
  [[nodiscard]] Status plan(std::vector<Warning>& warnings);
  [[nodiscard]] std::uint64_t total_bytes() const { return 12 + 8 + json_.size() + 8 + binary_bytes_; }
  void write(BlockWriter& out) const;

 private:
  struct Part {
    const Mesh* mesh;
    std::unique_ptr<Mesh> own;               // split where features meet, or in another order; `mesh` is this one then
    std::vector<std::uint32_t> vertex_rows;  // where there are features
    std::vector<std::vector<FaceId>> faces;  // by material
    bool short_indices;
    double least_coverage;
  };
  struct Column {  // of the table; begins at a multiple of 8 bytes
    std::uint64_t gap;
    std::vector<std::uint8_t> bytes;
  };
  int add_view(std::uint64_t size, int target);
  int add_packed_view(const packing::View& view, int target, std::vector<std::uint8_t> bytes);
  int add_packed_floats(std::span<const float> values, std::size_t components, const char* shape, int exponent);
  [[nodiscard]] Json plan_packed_attributes(const Part& part);
  int add_indices(const Part& part, const std::vector<FaceId>& faces);
  int add_accessor(int view, int type, std::uint64_t count, const char* shape);
  void plan_faces(Part& part) const;
  void plan_features(std::vector<Warning>& warnings);
  void plan_table();
  void add_column(const char* name, const Json& type, std::vector<std::uint8_t> bytes, const StringColumn* strings);
  int add_metadata(std::vector<std::uint8_t> bytes);
  [[nodiscard]] Json plan_attributes(const Part& part);
  [[nodiscard]] Json feature_ids(const Part& part, const std::vector<FaceId>& faces) const;
  [[nodiscard]] Json plan_primitives(const Part& part);
  void plan_levels(Json& node);
  void name_packing();
  void plan_textures(std::vector<Warning>& warnings);
  [[nodiscard]] Json material_json(const Material& material) const;
  static void write_vertices(const Part& part, BlockWriter& out);
  static void write_indices(const Part& part, BlockWriter& out);

  const Mesh& first_;
  GltfLook look_;
  std::optional<GltfPacking> packing_;
  std::vector<std::vector<std::uint8_t>> packed_;  // vertices and indices, in place of the meshes' own
  std::uint64_t unpacked_bytes_ = 0;               // of the buffer that is not there
  std::vector<Part> parts_;
  Json root_;
  std::string json_;
  std::uint64_t binary_bytes_ = 0;
  std::vector<EncodedTexture> images_;
  std::vector<int> texture_ids_;  // -1 for those left out
  FeatureRows rows_;
  std::vector<Column> metadata_;
};

int GlbWriter::add_view(std::uint64_t size, int target) {
  Json view{{"buffer", 0}, {"byteOffset", binary_bytes_}, {"byteLength", size}};
  if (target != 0) view["target"] = target;
  root_["bufferViews"].push_back(std::move(view));
  binary_bytes_ += padded(size);
  return static_cast<int>(root_["bufferViews"].size()) - 1;
}

// The view itself lies in a buffer that is not there; where its bytes are the extension says.
int GlbWriter::add_packed_view(const packing::View& view, int target, std::vector<std::uint8_t> bytes) {
  Json json{{"buffer", 1}, {"byteOffset", unpacked_bytes_}, {"byteLength", view.count * view.stride}};
  if (target == ArrayBuffer) json["byteStride"] = view.stride;
  json["target"] = target;
  Json& packed = json["extensions"][meshopt];
  packed = {{"buffer", 0},
            {"byteOffset", binary_bytes_},
            {"byteLength", bytes.size()},
            {"byteStride", view.stride},
            {"count", view.count},
            {"mode", view.mode}};
  if (!view.filter.empty()) packed["filter"] = view.filter;
  root_["bufferViews"].push_back(std::move(json));
  unpacked_bytes_ += padded(view.count * view.stride);
  binary_bytes_ += padded(bytes.size());
  packed_.push_back(std::move(bytes));
  return static_cast<int>(root_["bufferViews"].size()) - 1;
}

int GlbWriter::add_packed_floats(std::span<const float> values, std::size_t components, const char* shape,
                                 int exponent) {
  const packing::View view{values.size() / components, 4 * components, "ATTRIBUTES", "EXPONENTIAL"};
  return add_accessor(add_packed_view(view, ArrayBuffer, packing::pack_floats(values, components, exponent)), Float,
                      view.count, shape);
}

Json GlbWriter::plan_packed_attributes(const Part& part) {
  const VertexArrays& v = part.mesh->vertices;
  const std::uint64_t count = v.size();
  const auto floats = [](const auto& vectors) {
    return std::span{reinterpret_cast<const float*>(vectors.data()), vectors.size() * (sizeof vectors[0] / 4)};
  };
  const auto add_normalized = [&](const packing::View& view, std::vector<std::uint8_t> bytes, int type,
                                  const char* shape) {
    const int accessor = add_accessor(add_packed_view(view, ArrayBuffer, std::move(bytes)), type, count, shape);
    root_["accessors"][accessor]["normalized"] = true;
    return accessor;
  };
  Json attributes;
  std::vector<glm::vec3> turned = turned_positions(v);
  attributes["POSITION"] = add_packed_floats(floats(turned), 3, "VEC3", packing_->position_exponent);
  for (glm::vec3& p : turned) {
    for (int c = 0; c < 3; ++c) p[c] = packing::on_grid(p[c], packing_->position_exponent);
  }
  set_range(root_["accessors"][attributes["POSITION"].get<int>()], turned);
  if (!v.normals.empty()) {
    attributes["NORMAL"] = add_normalized({count, 4, "ATTRIBUTES", "OCTAHEDRAL"},
                                          packing::pack_normals(normals_for_gltf(v)), Byte, "VEC3");
  }
  if (!v.uvs.empty()) {
    std::vector<glm::vec2> flipped;
    for (const glm::vec2& uv : v.uvs) flipped.push_back(flip_v(uv));
    attributes["TEXCOORD_0"] = add_packed_floats(floats(flipped), 2, "VEC2", packing_->uv_exponent);
  }
  if (!v.colors.empty()) {
    const std::vector<std::uint16_t> colors = linear_colors(v);
    const std::vector<std::uint8_t> raw = bytes_of(std::as_bytes(std::span{colors}));
    attributes["COLOR_0"] =
        add_normalized({count, 8, "ATTRIBUTES", {}}, packing::pack_raw(raw, 8), UnsignedShort, "VEC4");
  }
  if (!part.vertex_rows.empty()) {
    const std::vector<float> ids(part.vertex_rows.begin(), part.vertex_rows.end());
    const std::vector<std::uint8_t> raw = bytes_of(std::as_bytes(std::span{ids}));
    attributes["_FEATURE_ID_0"] = add_accessor(
        add_packed_view({count, 4, "ATTRIBUTES", {}}, ArrayBuffer, packing::pack_raw(raw, 4)), Float, count, "SCALAR");
  }
  return attributes;
}

int GlbWriter::add_indices(const Part& part, const std::vector<FaceId>& faces) {
  const std::uint64_t count = 3 * faces.size();
  const int type = part.short_indices ? UnsignedShort : UnsignedInt;
  const std::uint64_t size = part.short_indices ? 2 : 4;
  if (!packing_) return add_accessor(add_view(count * size, ElementArrayBuffer), type, count, "SCALAR");
  std::vector<std::uint32_t> corners;
  for (const FaceId f : faces) {
    const VertexId* v = &part.mesh->indices[3 * std::size_t{f}];
    corners.insert(corners.end(), v, v + 3);
  }
  const int view =
      add_packed_view({count, size, "TRIANGLES", {}}, ElementArrayBuffer, packing::pack_triangles(corners));
  return add_accessor(view, type, count, "SCALAR");
}

int GlbWriter::add_accessor(int view, int type, std::uint64_t count, const char* shape) {
  root_["accessors"].push_back({{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
  return static_cast<int>(root_["accessors"].size()) - 1;
}

void GlbWriter::plan_faces(Part& part) const {
  if (packing_) {
    part.own = std::make_unique<Mesh>(packing::in_packing_order(*part.mesh, part.vertex_rows));
    part.mesh = part.own.get();
  }
  const Mesh& mesh = *part.mesh;
  part.faces.resize(mesh.materials.size());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) part.faces[mesh.face_material(f)].push_back(f);
  constexpr std::uint32_t restart = 65535;  // the largest 16-bit index has a meaning of its own
  part.short_indices = mesh.vertex_count() <= restart;
}

// Ids are floats, which count exactly to 2^24: glTF has no 32-bit integers for vertices.
void GlbWriter::plan_features(std::vector<Warning>& warnings) {
  if (first_.face_features.empty()) return;
  rows_ = rows_of(first_);
  if (rows_.features.size() >= 1U << 24) {
    warnings.push_back({"more features than glTF can tell apart: they were left out", {}});
    rows_ = {};
  }
  if (rows_.empty()) return;
  for (Part& part : parts_) {
    FeatureVertices split = split_by_feature(*part.mesh, rows_);
    part.own = std::make_unique<Mesh>(std::move(split.mesh));
    part.mesh = part.own.get();
    part.vertex_rows = std::move(split.vertex_rows);
  }
  root_["extensionsUsed"].push_back("EXT_mesh_features");
  root_["extensionsUsed"].push_back("EXT_structural_metadata");
}

int GlbWriter::add_metadata(std::vector<std::uint8_t> bytes) {
  const std::uint64_t gap = padded_to_8(binary_bytes_) - binary_bytes_;
  binary_bytes_ += gap;
  metadata_.push_back({gap, std::move(bytes)});
  return add_view(metadata_.back().bytes.size(), 0);
}

void GlbWriter::add_column(const char* name, const Json& type, std::vector<std::uint8_t> bytes,
                           const StringColumn* strings) {
  if (bytes.empty()) return;  // a column of empty strings says nothing
  Json& metadata = root_["extensions"]["EXT_structural_metadata"];
  metadata["schema"]["classes"]["feature"]["properties"][name] = type;
  Json& values = metadata["propertyTables"][0]["properties"][name];
  values["values"] = add_metadata(std::move(bytes));
  if (strings != nullptr) values["stringOffsets"] = add_metadata(bytes_of(std::as_bytes(std::span{strings->offsets})));
}

void GlbWriter::plan_table() {
  if (rows_.empty()) return;
  Json& metadata = root_["extensions"]["EXT_structural_metadata"];
  metadata["schema"] = {{"id", "lodestone"}, {"classes", {{"feature", {{"name", "Feature"}}}}}};
  metadata["propertyTables"].push_back({{"class", "feature"}, {"count", rows_.features.size()}});
  const StringColumn ids = column_of(first_, rows_, &Feature::id);
  const StringColumn classes = column_of(first_, rows_, &Feature::semantic_class);
  const std::vector<std::int32_t> parents = parents_of(first_, rows_);
  add_column("id", {{"type", "STRING"}}, ids.bytes, &ids);
  add_column("class", {{"type", "STRING"}}, classes.bytes, &classes);
  add_column("parent", {{"type", "SCALAR"}, {"componentType", "INT32"}, {"noData", -1}},
             bytes_of(std::as_bytes(std::span{parents})), nullptr);
}

Json GlbWriter::feature_ids(const Part& part, const std::vector<FaceId>& faces) const {
  std::set<std::uint32_t> seen;
  for (const FaceId f : faces) seen.insert(part.vertex_rows[part.mesh->indices[3 * std::size_t{f}]]);
  seen.erase(rows_.no_row());
  if (seen.empty()) return {};
  Json set{{"featureCount", seen.size()}, {"nullFeatureId", rows_.no_row()}, {"attribute", 0}, {"propertyTable", 0}};
  return {{"featureIds", Json::array({std::move(set)})}};
}

Json GlbWriter::plan_attributes(const Part& part) {
  if (packing_) return plan_packed_attributes(part);
  const VertexArrays& v = part.mesh->vertices;
  const std::uint64_t count = v.size();
  Json attributes;
  const int positions = add_accessor(add_view(12 * count, ArrayBuffer), Float, count, "VEC3");
  set_range(root_["accessors"][positions], turned_positions(v));
  attributes["POSITION"] = positions;
  if (!v.normals.empty()) attributes["NORMAL"] = add_accessor(add_view(12 * count, ArrayBuffer), Float, count, "VEC3");
  if (!v.uvs.empty()) attributes["TEXCOORD_0"] = add_accessor(add_view(8 * count, ArrayBuffer), Float, count, "VEC2");
  if (!v.colors.empty()) {
    const int colors = add_accessor(add_view(8 * count, ArrayBuffer), UnsignedShort, count, "VEC4");
    root_["accessors"][colors]["normalized"] = true;
    attributes["COLOR_0"] = colors;
  }
  if (!part.vertex_rows.empty()) {
    attributes["_FEATURE_ID_0"] = add_accessor(add_view(4 * count, ArrayBuffer), Float, count, "SCALAR");
  }
  return attributes;
}

Json GlbWriter::plan_primitives(const Part& part) {
  const Json attributes = plan_attributes(part);
  Json primitives = Json::array();
  for (std::size_t m = 0; m < part.faces.size(); ++m) {
    if (part.faces[m].empty()) continue;
    const int indices = add_indices(part, part.faces[m]);
    primitives.push_back({{"attributes", attributes}, {"indices", indices}, {"material", m}});
    if (part.vertex_rows.empty()) continue;
    if (Json ids = feature_ids(part, part.faces[m]); !ids.empty()) {
      primitives.back()["extensions"]["EXT_mesh_features"] = std::move(ids);
    }
  }
  return primitives;
}

// The first node is the finest level and names the others.
void GlbWriter::plan_levels(Json& node) {
  Json ids = Json::array();
  Json coverage = Json::array();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (i > 0) ids.push_back(i);
    coverage.push_back(parts_[i].least_coverage);
  }
  node["extensions"]["MSFT_lod"]["ids"] = std::move(ids);
  node["extras"]["MSFT_screencoverage"] = std::move(coverage);
  root_["extensionsUsed"].push_back("MSFT_lod");
}

void GlbWriter::plan_textures(std::vector<Warning>& warnings) {
  bool has_webp = false;
  for (const Texture& texture : first_.textures) {
    texture_ids_.push_back(-1);
    auto encoded = image_for_gltf(texture, look_);
    if (!encoded) {
      warnings.push_back({"a texture was left out: it " + encoded.error().message, encoded.error().where});
      continue;
    }
    texture_ids_.back() = static_cast<int>(images_.size());
    images_.push_back(std::move(*encoded));
    const EncodedTexture& image = images_.back();
    root_["images"].push_back(
        {{"name", texture.name}, {"mimeType", image.mime_type}, {"bufferView", add_view(image.bytes.size(), 0)}});
    if (image.mime_type != webp) {
      root_["textures"].push_back({{"source", texture_ids_.back()}});
      continue;
    }
    Json json;
    json["extensions"]["EXT_texture_webp"] = {{"source", texture_ids_.back()}};
    root_["textures"].push_back(std::move(json));
    has_webp = true;
  }
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (has_webp) root_[list].push_back("EXT_texture_webp");
  }
  if (look_ == GltfLook::Lit || images_.empty()) return;
  constexpr int linear = 9729;
  constexpr int linear_mipmap_linear = 9987;
  constexpr int clamp_to_edge = 33071;
  root_["samplers"].push_back(
      {{"magFilter", linear}, {"minFilter", linear_mipmap_linear}, {"wrapS", clamp_to_edge}, {"wrapT", clamp_to_edge}});
  for (Json& texture : root_["textures"]) texture["sampler"] = 0;
  root_["extensionsUsed"].push_back("KHR_materials_unlit");
}

Json GlbWriter::material_json(const Material& material) const {
  Json pbr{{"metallicFactor", 0.0}};
  const glm::vec4& c = material.base_color;
  const auto linear = [](float value) { return srgb_to_linear(std::clamp(static_cast<double>(value), 0.0, 1.0)); };
  pbr["baseColorFactor"] = {linear(c.r), linear(c.g), linear(c.b), std::clamp(static_cast<double>(c.a), 0.0, 1.0)};
  const bool textured = material.texture != none && texture_ids_[material.texture] >= 0;
  if (textured) pbr["baseColorTexture"] = {{"index", texture_ids_[material.texture]}};
  Json json{{"name", material.name}, {"pbrMetallicRoughness", std::move(pbr)}};
  if (material.alpha_cutoff > 0.0F) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = material.alpha_cutoff;
  } else if (material.transparent()) {
    json["alphaMode"] = "BLEND";
  }
  if (material.double_sided) json["doubleSided"] = true;
  if (textured && look_ == GltfLook::Photograph) json["extensions"]["KHR_materials_unlit"] = Json::object();
  return json;
}

void GlbWriter::name_packing() {
  Json absent{{"byteLength", unpacked_bytes_}};
  absent["extensions"][meshopt] = {{"fallback", true}};
  root_["buffers"].push_back(std::move(absent));
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    root_[list].push_back(meshopt);
    if (!first_.vertices.normals.empty()) root_[list].push_back("KHR_mesh_quantization");
  }
}

Status GlbWriter::plan(std::vector<Warning>& warnings) {
  root_["asset"] = {{"version", "2.0"}, {"generator", "Lodestone"}};
  root_["scene"] = 0;
  root_["scenes"].push_back({{"nodes", {0}}});
  const bool empty = first_.triangle_count() == 0;
  const glm::dvec3 origin = z_up_to_y_up(first_.origin);
  plan_features(warnings);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Json node{{"name", "lodestone"}};
    if (origin != glm::dvec3{0.0}) node["translation"] = {origin.x, origin.y, origin.z};
    if (!first_.crs.empty()) node["extras"] = {{"crs", first_.crs}};
    if (!empty) {
      plan_faces(parts_[i]);
      Json primitives = plan_primitives(parts_[i]);
      root_["meshes"].push_back({{"primitives", std::move(primitives)}});
      node["mesh"] = i;
    }
    if (i == 0 && parts_.size() > 1) plan_levels(node);
    root_["nodes"].push_back(std::move(node));
  }
  if (!empty) {
    plan_textures(warnings);
    for (const Material& material : first_.materials) root_["materials"].push_back(material_json(material));
    plan_table();
  }
  if (binary_bytes_ > 0) root_["buffers"].push_back({{"byteLength", binary_bytes_}});
  if (!packed_.empty()) name_packing();
  json_ = root_.dump(-1, ' ', false, Json::error_handler_t::replace);
  json_.resize(padded(json_.size()), ' ');
  if (total_bytes() > std::numeric_limits<std::uint32_t>::max()) {
    return Error{ErrorCode::TooLarge, "a GLB holds at most 4 GB; write .ply or .obj instead", {}};
  }
  return Done{};
}

void GlbWriter::write_vertices(const Part& part, BlockWriter& out) {
  const VertexArrays& v = part.mesh->vertices;
  for (std::size_t i = 0; i < v.positions.size() && out.pass(); ++i) out.raw(z_up_to_y_up(v.positions[i]));
  for (std::size_t i = 0; i < v.normals.size() && out.pass(); ++i) out.raw(normal_for_gltf(v.normals[i]));
  for (std::size_t i = 0; i < v.uvs.size() && out.pass(); ++i) out.raw(flip_v(v.uvs[i]));
  for (const std::uint16_t color : linear_colors(v)) out.raw(color);
  for (std::size_t i = 0; i < part.vertex_rows.size() && out.pass(); ++i) {
    out.raw(static_cast<float>(part.vertex_rows[i]));
  }
}

void GlbWriter::write_indices(const Part& part, BlockWriter& out) {
  for (const auto& faces : part.faces) {
    for (const FaceId f : faces) {
      for (int c = 0; c < 3; ++c) {
        const VertexId v = part.mesh->indices[3 * std::size_t{f} + c];
        if (part.short_indices) {
          out.raw(static_cast<std::uint16_t>(v));
        } else {
          out.raw(v);
        }
      }
      if (!out.pass()) return;
    }
    if (part.short_indices && faces.size() % 2 == 1) out.raw(std::uint16_t{0});
  }
}

void GlbWriter::write(BlockWriter& out) const {
  const bool has_binary = binary_bytes_ > 0;
  out.text("glTF");
  out.raw(std::uint32_t{2});
  out.raw(static_cast<std::uint32_t>(has_binary ? total_bytes() : total_bytes() - 8));
  out.raw(static_cast<std::uint32_t>(json_.size()));
  out.text("JSON");
  out.text(json_);
  if (!has_binary) return;
  out.raw(static_cast<std::uint32_t>(binary_bytes_));
  out.text(std::string_view{"BIN\0", 4});
  for (const Part& part : parts_) {
    if (packing_) break;
    write_vertices(part, out);
    write_indices(part, out);
  }
  const auto write_padded = [&](const std::vector<std::uint8_t>& bytes) {
    out.text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    out.text(std::string(padded(bytes.size()) - bytes.size(), '\0'));
  };
  for (const auto& view : packed_) write_padded(view);
  for (const EncodedTexture& image : images_) write_padded(image.bytes);
  for (const Column& column : metadata_) {
    out.text(std::string(column.gap, '\0'));
    write_padded(column.bytes);
  }
}

}  // namespace

Status write_gltf_levels(std::span<const GltfLevel> levels, const std::filesystem::path& file, const Context& context,
                         const GltfStyle& style) {
  std::vector<Warning> warnings;
  GlbWriter writer{levels, style};
  if (auto planned = writer.plan(warnings); !planned) {
    return Error{planned.error().code, planned.error().message, file.string()};
  }
  auto created = OutputFile::create(file);
  if (!created) return created.error();
  BlockWriter out{std::move(*created), file.string(), context, writer.total_bytes()};
  writer.write(out);
  if (auto done = out.commit(); !done) return done;
  return {Done{}, std::move(warnings)};
}

Status write_glb(const Mesh& mesh, const std::filesystem::path& file, const Context& context) {
  const GltfLevel only{&mesh, 0.0};
  return write_gltf_levels({&only, 1}, file, context);
}

}  // namespace lodestone

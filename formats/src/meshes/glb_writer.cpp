// SPDX-License-Identifier: MIT
// Binary glTF 2.0: one primitive per material over shared vertex arrays, everything in one file. Several levels of one
// model become one mesh each, that share materials and textures (MSFT_lod). Features of faces become ids of vertices
// and a table (EXT_mesh_features, EXT_structural_metadata).
#include <bit>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "axes.h"
#include "gltf_layout.h"
#include "gltf_metadata.h"
#include "gltf_surfaces.h"
#include "gltf_vertices.h"
#include "writers.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "glTF is little-endian and written as it lies in memory");

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

class GlbWriter {
 public:
  // The finest level first; all have the surroundings of the first.
  GlbWriter(std::span<const GltfLevel> levels, const GltfStyle& style)
      : first_{*levels.front().mesh}, look_{style.look}, packing_{style.packing} {
    for (const GltfLevel& level : levels) parts_.push_back({level.mesh, {}, {}, {}, false, level.least_coverage});
  }
  [[nodiscard]] Status plan(std::vector<Warning>& warnings);
  [[nodiscard]] std::uint64_t total_bytes() const { return 12 + 8 + json_.size() + 8 + layout_.size(); }
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
  int add_packed_floats(std::span<const float> values, std::size_t components, const char* shape, int exponent);
  [[nodiscard]] Json plan_packed_attributes(const Part& part);
  int add_indices(const Part& part, const std::vector<FaceId>& faces);
  void plan_faces(Part& part) const;
  void plan_features(std::vector<Warning>& warnings);
  void plan_table();
  void add_column(const char* name, const Json& type, std::vector<std::uint8_t> bytes, const StringColumn* strings);
  int add_metadata(std::vector<std::uint8_t> bytes);
  [[nodiscard]] Json plan_attributes(const Part& part);
  [[nodiscard]] Json feature_ids(const Part& part, const std::vector<FaceId>& faces) const;
  [[nodiscard]] Json plan_primitives(const Part& part);
  void plan_levels(Json& node);
  static void write_vertices(const Part& part, BlockWriter& out);
  static void write_indices(const Part& part, BlockWriter& out);

  const Mesh& first_;
  GltfLook look_;
  std::optional<GltfPacking> packing_;
  std::vector<Part> parts_;
  Json root_;
  std::string json_;
  GltfLayout layout_{root_};
  GltfSurfaces surfaces_;
  FeatureRows rows_;
  std::vector<Column> metadata_;
};

int GlbWriter::add_packed_floats(std::span<const float> values, std::size_t components, const char* shape,
                                 int exponent) {
  const packing::View view{values.size() / components, 4 * components, "ATTRIBUTES", "EXPONENTIAL"};
  return layout_.add_accessor(
      layout_.add_packed_view(view, ArrayBuffer, packing::pack_floats(values, components, exponent)), Float, view.count,
      shape);
}

Json GlbWriter::plan_packed_attributes(const Part& part) {
  const VertexArrays& v = part.mesh->vertices;
  const std::uint64_t count = v.size();
  const auto floats = [](const auto& vectors) {
    return std::span{reinterpret_cast<const float*>(vectors.data()), vectors.size() * (sizeof vectors[0] / 4)};
  };
  const auto add_normalized = [&](const packing::View& view, std::vector<std::uint8_t> bytes, int type,
                                  const char* shape) {
    const int accessor =
        layout_.add_accessor(layout_.add_packed_view(view, ArrayBuffer, std::move(bytes)), type, count, shape);
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
    attributes["_FEATURE_ID_0"] = layout_.add_accessor(
        layout_.add_packed_view({count, 4, "ATTRIBUTES", {}}, ArrayBuffer, packing::pack_raw(raw, 4)), Float, count,
        "SCALAR");
  }
  return attributes;
}

int GlbWriter::add_indices(const Part& part, const std::vector<FaceId>& faces) {
  const std::uint64_t count = 3 * faces.size();
  const int type = part.short_indices ? UnsignedShort : UnsignedInt;
  const std::uint64_t size = part.short_indices ? 2 : 4;
  if (!packing_) return layout_.add_accessor(layout_.add_view(count * size, ElementArrayBuffer), type, count, "SCALAR");
  std::vector<std::uint32_t> corners;
  for (const FaceId f : faces) {
    const VertexId* v = &part.mesh->indices[3 * std::size_t{f}];
    corners.insert(corners.end(), v, v + 3);
  }
  const int view =
      layout_.add_packed_view({count, size, "TRIANGLES", {}}, ElementArrayBuffer, packing::pack_triangles(corners));
  return layout_.add_accessor(view, type, count, "SCALAR");
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
  const std::uint64_t gap = layout_.align_to_8();
  metadata_.push_back({gap, std::move(bytes)});
  return layout_.add_view(metadata_.back().bytes.size(), 0);
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
  const int positions = layout_.add_accessor(layout_.add_view(12 * count, ArrayBuffer), Float, count, "VEC3");
  set_range(root_["accessors"][positions], turned_positions(v));
  attributes["POSITION"] = positions;
  if (!v.normals.empty())
    attributes["NORMAL"] = layout_.add_accessor(layout_.add_view(12 * count, ArrayBuffer), Float, count, "VEC3");
  if (!v.uvs.empty())
    attributes["TEXCOORD_0"] = layout_.add_accessor(layout_.add_view(8 * count, ArrayBuffer), Float, count, "VEC2");
  if (!v.colors.empty()) {
    const int colors = layout_.add_accessor(layout_.add_view(8 * count, ArrayBuffer), UnsignedShort, count, "VEC4");
    root_["accessors"][colors]["normalized"] = true;
    attributes["COLOR_0"] = colors;
  }
  if (!part.vertex_rows.empty()) {
    attributes["_FEATURE_ID_0"] =
        layout_.add_accessor(layout_.add_view(4 * count, ArrayBuffer), Float, count, "SCALAR");
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
    surfaces_.plan(first_, look_, root_, layout_, warnings);
    plan_table();
  }
  layout_.name_buffers(!first_.vertices.normals.empty());
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
  const bool has_binary = layout_.size() > 0;
  out.text("glTF");
  out.raw(std::uint32_t{2});
  out.raw(static_cast<std::uint32_t>(has_binary ? total_bytes() : total_bytes() - 8));
  out.raw(static_cast<std::uint32_t>(json_.size()));
  out.text("JSON");
  out.text(json_);
  if (!has_binary) return;
  out.raw(static_cast<std::uint32_t>(layout_.size()));
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
  for (const auto& view : layout_.packed()) write_padded(view);
  for (const EncodedTexture& image : surfaces_.images()) write_padded(image.bytes);
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

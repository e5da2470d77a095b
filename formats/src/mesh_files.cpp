// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <string_view>

#include <lodestone/cluster_file.h>

#include "reader.h"
#include "tidy.h"

namespace lodestone {
namespace {

bool contains(std::string_view text, std::string_view word) { return text.find(word) != text.npos; }

bool is_text(std::string_view head) { return head.find('\0') == head.npos; }

// Lines of an OBJ whatever its name: "v 1 2 3" and a face, group or library among the first ones.
bool looks_like_obj(std::string_view head) {
  if (!is_text(head)) return false;
  const bool vertex = head.starts_with("v ") || contains(head, "\nv ");
  const bool rest = contains(head, "\nf ") || contains(head, "mtllib ") || contains(head, "\no ") ||
                    contains(head, "\ng ") || contains(head, "\nvn ") || contains(head, "\nvt ");
  return vertex && rest;
}

ReadFunction reader_by_content(std::string_view head) {
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return read_ply;
  if (is_text(head) && contains(head, "CityModel") && contains(head, "citygml")) return read_citygml;
  if (is_text(head) && contains(head, "\"CityJSON")) return read_cityjson;
  if (head.starts_with("glTF")) return read_gltf;
  if (looks_like_obj(head)) return read_obj;
  // 3DS, FBX, IFC and COLLADA under whatever name.
  if (head.starts_with("MM") && head.size() >= 6 && head[2] != '\0' && !is_text(head)) return read_assimp;
  if (head.starts_with("Kaydara FBX") || head.starts_with("ISO-10303-21") || contains(head, "<COLLADA")) {
    return read_assimp;
  }
  return nullptr;
}

ReadFunction reader_by_extension(const std::string& extension) {
  static constexpr std::array<std::pair<std::string_view, ReadFunction>, 9> table{{
      {".obj", read_obj},
      {".ply", read_ply},
      {".gltf", read_gltf},
      {".glb", read_gltf},
      {".gml", read_citygml},
      {".citygml", read_citygml},
      {".json", read_cityjson},
      {".cityjson", read_cityjson},
      {".jsonl", read_cityjson},
  }};
  const auto* found = std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.first == extension; });
  if (found != table.end()) return found->second;
  return assimp_reads(extension) ? read_assimp : nullptr;
}

Result<LoadedMesh> read_finest_level(const std::filesystem::path& file, const Context& context) {
  auto model = read_model(file, {}, context);
  if (!model) return model.error();
  LoadedMesh loaded;
  loaded.mesh = (*model)->extract((*model)->record_count());
  loaded.info = {.format = "lode", .up_axis = "Z", .unit_m = 1.0};
  return {std::move(loaded), std::move(model.warnings())};
}

// The leaves of a cluster graph, put together again.
Result<LoadedMesh> read_leaves(const std::filesystem::path& file, const Context& context) {
  auto graph = read_cluster_graph(file, context);
  if (!graph) return graph.error();
  std::vector<NodeId> leaves;
  for (const LodLink& link : graph->graph.links) {
    for (NodeId n = link.nodes.begin; link.maker == none && n != link.nodes.end; ++n) leaves.push_back(n);
  }
  LoadedMesh loaded;
  loaded.mesh = extract(*graph, leaves);
  merge_identical_vertices(loaded.mesh);
  loaded.info = {.format = "lodg", .up_axis = "Z", .unit_m = 1.0};
  return loaded;
}

// The code in well-known text ("EPSG" and a number, the last of them names the whole system), else its name.
std::string crs_of_text(std::string_view text) {
  constexpr std::string_view authority = "\"EPSG\",";
  if (const std::size_t at = text.rfind(authority); at != text.npos) {
    std::string code;
    for (const char c : text.substr(at + authority.size())) {
      if (c >= '0' && c <= '9') {
        code += c;
      } else if (c != '"' && c != ' ') {
        break;
      }
    }
    if (!code.empty()) return "EPSG:" + code;
  }
  const std::size_t begin = text.find('"');
  const std::size_t end = begin == text.npos ? begin : text.find('"', begin + 1);
  return end == text.npos ? std::string{} : std::string{text.substr(begin + 1, end - begin - 1)};
}

// What a .prj file beside the mesh says.
std::string crs_beside(const Input& input) {
  constexpr std::uint64_t most_bytes = 1U << 16U;
  auto place = input.file();
  if (place.empty()) return {};
  const auto prj = Input::open(place.replace_extension(".prj"), most_bytes);
  const auto bytes = prj ? prj->read_all() : Error{};
  if (!bytes) return {};
  return crs_of_text({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

// Says what the reader left out, if anything: that may have been all.
Error no_faces(const Input& input, const std::vector<Warning>& warnings) {
  std::string message = "has no face that can be used";
  if (!warnings.empty()) message += " (" + warnings.front().message + ")";
  return Error{ErrorCode::BadData, message + "; a surface of triangles or polygons is needed", input.name()};
}

}  // namespace

ReadFunction find_reader(const Input& input) {
  std::string head(4096, '\0');
  head.resize(input.read(0, {reinterpret_cast<std::uint8_t*>(head.data()), head.size()}));
  if (ReadFunction reader = reader_by_content(head)) return reader;
  return reader_by_extension(input.extension());
}

Result<LoadedMesh> read_input(const Input& input, const ReadOptions& options, const Context& context) {
  if (input.size() == 0) return Error{ErrorCode::BadData, "is empty", input.name()};
  const ReadFunction reader = find_reader(input);
  if (reader == nullptr) {
    return Error{ErrorCode::Unsupported, "is not a mesh of a kind that can be read", input.name()};
  }
  auto loaded = reader(input, options, context);
  if (!loaded) return loaded;
  Mesh& mesh = loaded->mesh;
  if (mesh.vertices.positions.size() > options.max_vertices) {
    return too_large(input, "vertices", mesh.vertices.positions.size(), options.max_vertices);
  }
  if (mesh.indices.size() / 3 > options.max_triangles) {
    return too_large(input, "triangles", mesh.indices.size() / 3, options.max_triangles);
  }
  if (!options.crs.empty()) mesh.crs = options.crs;
  if (mesh.crs.empty()) mesh.crs = crs_beside(input);
  Warnings warnings;
  warnings.add_all(std::move(loaded.warnings()));
  tidy(mesh, warnings);
  if (mesh.indices.empty()) return no_faces(input, warnings.take());
  if (auto valid = validate(mesh); !valid) {
    return Error{ErrorCode::BadData, valid.error().message + " (" + valid.error().where + ")", input.name()};
  }
  std::vector<Warning> list = warnings.take();
  for (Warning& warning : list) {
    if (warning.where.empty()) warning.where = input.name();
  }
  return {std::move(*loaded), std::move(list)};
}

Result<LoadedMesh> read_mesh(const std::filesystem::path& file, const ReadOptions& options, const Context& context) {
  auto input = Input::open(file, options.max_file_bytes);
  if (!input) return input.error();
  if (is_model_file(file)) return read_finest_level(file, context);
  if (is_cluster_file(file)) return read_leaves(file, context);
  return read_input(*input, options, context);
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <string_view>

#include <lodestone/cluster_file.h>

#include "reader.h"

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
  return read_with(reader, input, options, context);
}

Result<LoadedMesh> read_mesh(const std::filesystem::path& file, const ReadOptions& options, const Context& context) {
  auto input = Input::open(file, options.max_file_bytes);
  if (!input) return input.error();
  if (is_model_file(file)) return read_finest_level(file, context);
  if (is_cluster_file(file)) return read_leaves(file, context);
  return read_input(*input, options, context);
}

}  // namespace lodestone

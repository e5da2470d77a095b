// SPDX-License-Identifier: MIT
#include "gltf_layout.h"

namespace lodestone {
namespace {

constexpr const char* meshopt = "EXT_meshopt_compression";

}  // namespace

int GltfLayout::add_view(std::uint64_t size, int target) {
  Json view{{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", size}};
  if (target != 0) view["target"] = target;
  root_["bufferViews"].push_back(std::move(view));
  bytes_ += padded(size);
  return static_cast<int>(root_["bufferViews"].size()) - 1;
}

int GltfLayout::add_accessor(int view, int type, std::uint64_t count, const char* shape) {
  root_["accessors"].push_back({{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
  return static_cast<int>(root_["accessors"].size()) - 1;
}

// The view itself lies in a buffer that is not there; where its bytes are the extension says.
int GltfLayout::add_packed_view(const packing::View& view, int target, std::vector<std::uint8_t> bytes) {
  Json json{{"buffer", 1}, {"byteOffset", unpacked_bytes_}, {"byteLength", view.count * view.stride}};
  if (target == ArrayBuffer) json["byteStride"] = view.stride;
  json["target"] = target;
  Json& packed = json["extensions"][meshopt];
  packed = {{"buffer", 0},         {"byteOffset", bytes_}, {"byteLength", bytes.size()}, {"byteStride", view.stride},
            {"count", view.count}, {"mode", view.mode}};
  if (!view.filter.empty()) packed["filter"] = view.filter;
  root_["bufferViews"].push_back(std::move(json));
  unpacked_bytes_ += padded(view.count * view.stride);
  bytes_ += padded(bytes.size());
  packed_.push_back(std::move(bytes));
  return static_cast<int>(root_["bufferViews"].size()) - 1;
}

std::uint64_t GltfLayout::align_to_8() {
  const std::uint64_t gap = (8 - bytes_ % 8) % 8;
  bytes_ += gap;
  return gap;
}

void GltfLayout::name_buffers(bool has_normals) {
  if (bytes_ > 0) root_["buffers"].push_back({{"byteLength", bytes_}});
  if (packed_.empty()) return;
  Json absent{{"byteLength", unpacked_bytes_}};
  absent["extensions"][meshopt] = {{"fallback", true}};
  root_["buffers"].push_back(std::move(absent));
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    root_[list].push_back(meshopt);
    if (has_normals) root_[list].push_back("KHR_mesh_quantization");
  }
}

}  // namespace lodestone

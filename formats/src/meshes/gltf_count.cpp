// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "mesh_count.h"

namespace lodestone {
namespace {

using Json = nlohmann::json;

const Json nothing;

const Json& at(const Json& object, const char* key) {
  if (!object.is_object()) return nothing;
  const auto found = object.find(key);
  return found == object.end() ? nothing : *found;
}

const Json& element(const Json& list, std::uint64_t index) {
  return list.is_array() && index < list.size() ? list[index] : nothing;
}

constexpr std::uint64_t no_number = ~std::uint64_t{0};

std::uint64_t number(const Json& object, const char* key, std::uint64_t otherwise) {
  const Json& value = at(object, key);
  return value.is_number_unsigned() ? value.get<std::uint64_t>() : otherwise;
}

std::string text(const Json& object, const char* key) {
  const Json& value = at(object, key);
  return value.is_string() ? value.get<std::string>() : std::string{};
}

bool is_data(const std::string& uri) { return uri.starts_with("data:"); }

// Of a GLB, the chunk after the JSON.
struct Chunks {
  std::uint64_t json_begin = 0;
  std::uint64_t json_bytes = 0;
  std::uint64_t binary_begin = 0;  // 0 where there is none
};

Chunks chunks_of(const Input& input) {
  std::array<std::uint8_t, 20> head{};
  const bool binary = input.read(0, head) == head.size() && std::equal(head.begin(), head.begin() + 4, "glTF");
  if (!binary) return {0, input.size(), 0};
  const std::uint64_t length = head[12] | head[13] << 8U | head[14] << 16U | std::uint64_t{head[15]} << 24U;
  constexpr std::uint64_t chunk_head = 8;
  return {head.size(), std::min(length, input.size() - head.size()), head.size() + length + chunk_head};
}

class Counter {
 public:
  Counter(const Input& input, const Json& root, const Chunks& chunks) : input_{input}, root_{root}, chunks_{chunks} {}

  [[nodiscard]] MeshCount count() {
    std::map<std::uint64_t, std::uint64_t> uses;
    for (const Json& node : at(root_, "nodes")) {
      if (const std::uint64_t mesh = number(node, "mesh", no_number); mesh != no_number) ++uses[mesh];
    }
    for (const auto& [mesh, times] : uses) add_mesh(element(at(root_, "meshes"), mesh), times);
    count_.vertex_bytes = 12U + (uvs_ ? 8U : 0U) + (normals_ ? 12U : 0U) + (colors_ ? 4U : 0U);
    for (const Json& image : at(root_, "images")) add_image(image);
    count_.reading_bytes = reading_bytes();
    return std::move(count_);
  }

 private:
  void add_mesh(const Json& mesh, std::uint64_t times) {
    std::set<std::string> seen;  // primitives often share their vertices
    for (const Json& primitive : at(mesh, "primitives")) {
      constexpr std::uint64_t triangles = 4;
      constexpr std::uint64_t fan = 6;
      const std::uint64_t mode = number(primitive, "mode", triangles);
      if (mode < triangles || mode > fan) continue;
      const Json& attributes = at(primitive, "attributes");
      const std::uint64_t vertices = accessor_count(attributes, "POSITION");
      const std::uint64_t corners =
          at(primitive, "indices").is_null() ? vertices : accessor_count(primitive, "indices");
      count_.triangles += times * (mode == triangles ? corners / 3 : corners - std::min<std::uint64_t>(corners, 2));
      std::string key;
      for (const auto& [name, accessor] : attributes.items()) {
        if (accessor.is_number_unsigned()) key += name + '=' + std::to_string(accessor.get<std::uint64_t>()) + ';';
      }
      if (seen.insert(key).second) count_.vertices += times * vertices;
      uvs_ = uvs_ || attributes.contains("TEXCOORD_0");
      normals_ = normals_ || attributes.contains("NORMAL");
      colors_ = colors_ || attributes.contains("COLOR_0");
    }
  }

  [[nodiscard]] std::uint64_t accessor_count(const Json& object, const char* key) const {
    return number(element(at(root_, "accessors"), number(object, key, no_number)), "count", 0);
  }

  void add_image(const Json& image) {
    const std::string uri = text(image, "uri");
    if (is_data(uri)) {
      count_.other_image_bytes += uri.size() / 4 * 3;
    } else if (!uri.empty()) {
      if (auto file = find_beside(input_.folder(), uri)) count_.textures.push_back(std::move(*file));
    } else {
      const Json& view = element(at(root_, "bufferViews"), number(image, "bufferView", no_number));
      const std::uint64_t size_bytes = number(view, "byteLength", 0);
      const std::uint64_t buffer = number(view, "buffer", no_number);
      const bool here =
          chunks_.binary_begin > 0 && buffer == 0 && text(element(at(root_, "buffers"), 0), "uri").empty();
      if (here) {
        count_.images.push_back({chunks_.binary_begin + number(view, "byteOffset", 0), size_bytes});
      } else {
        count_.other_image_bytes += size_bytes;
      }
    }
  }

  // First the file, its JSON and its buffers; then buffers, images and the mesh, whose arrays grow.
  [[nodiscard]] double reading_bytes() const {
    double buffers = 0.0;
    for (const Json& buffer : at(root_, "buffers")) buffers += static_cast<double>(number(buffer, "byteLength", 0));
    double unpacked = 0.0;
    for (const Json& view : at(root_, "bufferViews")) {
      const Json& packed = at(at(view, "extensions"), "EXT_meshopt_compression");
      unpacked +=
          static_cast<double>(number(packed, "count", 0)) * static_cast<double>(number(packed, "byteStride", 0));
    }
    double images = static_cast<double>(count_.other_image_bytes);
    double beside = 0.0;
    for (const InnerImage& image : count_.images) images += static_cast<double>(image.size_bytes);
    for (const std::filesystem::path& file : count_.textures) {
      std::error_code fault;
      if (const auto size = std::filesystem::file_size(file, fault); !fault) beside += static_cast<double>(size);
    }
    constexpr double json_growth = 10.0;
    constexpr double text_growth = 3.0;  // of what is mostly data in text
    constexpr double triangle = 50.0;
    constexpr double vertex_growth = 2.5;
    const auto json = static_cast<double>(chunks_.json_bytes);
    const double parsed = json * (chunks_.binary_begin > 0 ? json_growth : text_growth);
    const double mesh = triangle * static_cast<double>(count_.triangles) +
                        vertex_growth * count_.vertex_bytes * static_cast<double>(count_.vertices);
    const double file = static_cast<double>(input_.size()) + unpacked;
    return std::max(file + buffers + unpacked + parsed, buffers + unpacked + images + mesh) + beside;
  }

  const Input& input_;
  const Json& root_;
  const Chunks& chunks_;
  MeshCount count_;
  bool uvs_ = false, normals_ = false, colors_ = false;
};

}  // namespace

std::uint64_t gltf_json_bytes(const Input& input) { return chunks_of(input).json_bytes; }

Result<MeshCount> count_gltf(const Input& input) {
  const Chunks chunks = chunks_of(input);
  std::string json(chunks.json_bytes, ' ');
  json.resize(input.read(chunks.json_begin, {reinterpret_cast<std::uint8_t*>(json.data()), json.size()}));
  const Json root = Json::parse(json, nullptr, false);
  if (!root.is_object()) return MeshCount{};
  return Counter{input, root, chunks}.count();
}

}  // namespace lodestone

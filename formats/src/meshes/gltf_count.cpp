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

// Where the bytes of a buffer are.
struct Buffer {
  std::filesystem::path file{};  // empty = the glTF's own
  std::uint64_t begin = 0;
  std::uint64_t size_bytes = 0;  // those that are there
  bool in_text = false;
};

constexpr std::uint64_t most_packing = 1024;  // elements of a byte that any codec unpacks

std::uint64_t capped_sum(std::uint64_t sum, std::uint64_t times, std::uint64_t count) {
  const std::uint64_t most_count = ReadOptions{}.max_triangles;  // and vertices
  if (count > 0 && times > (most_count - sum) / count) return most_count;
  return sum + times * count;
}

class Counter {
 public:
  Counter(const Input& input, const Json& root, const Chunks& chunks) : input_{input}, root_{root}, chunks_{chunks} {
    const Json& buffers = at(root, "buffers");
    for (const Json& buffer : buffers) buffers_.push_back(find_buffer(buffer, buffers_.empty()));
  }

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
  [[nodiscard]] Buffer find_buffer(const Json& json, bool first) const {
    const std::string uri = text(json, "uri");
    if (is_data(uri)) return {.size_bytes = uri.size() / 4 * 3, .in_text = true};
    if (!uri.empty()) {
      Buffer buffer{.file = find_beside(input_.folder(), uri).value_or(std::filesystem::path{})};
      std::error_code fault;
      const auto size = std::filesystem::file_size(buffer.file, fault);
      if (!fault) buffer.size_bytes = size;
      return buffer;
    }
    if (!first || chunks_.binary_begin == 0 || chunks_.binary_begin > input_.size()) return {};
    const std::uint64_t rest = input_.size() - chunks_.binary_begin;
    return {.begin = chunks_.binary_begin, .size_bytes = std::min(rest, number(json, "byteLength", 0))};
  }

  // What a view has of its buffer.
  [[nodiscard]] Buffer bytes_of(std::uint64_t view_number) const {
    const Json& view = element(at(root_, "bufferViews"), view_number);
    const std::uint64_t number_of_buffer = number(view, "buffer", no_number);
    if (number_of_buffer >= buffers_.size()) return {};
    Buffer part = buffers_[number_of_buffer];
    const std::uint64_t offset = std::min(number(view, "byteOffset", 0), part.size_bytes);
    part.begin += offset;
    part.size_bytes = std::min(number(view, "byteLength", 0), part.size_bytes - offset);
    return part;
  }

  void add_mesh(const Json& mesh, std::uint64_t times) {
    std::set<std::string> seen;  // primitives often share their vertices
    for (const Json& primitive : at(mesh, "primitives")) {
      constexpr std::uint64_t triangles = 4;
      constexpr std::uint64_t fan = 6;
      const std::uint64_t mode = number(primitive, "mode", triangles);
      if (mode < triangles || mode > fan) continue;
      const Json& attributes = at(primitive, "attributes");
      const std::uint64_t vertices = accessor_count(primitive, number(attributes, "POSITION", no_number), 3);
      const std::uint64_t corners = at(primitive, "indices").is_null()
                                        ? vertices
                                        : accessor_count(primitive, number(primitive, "indices", no_number), 1);
      count_.triangles = capped_sum(count_.triangles, times,
                                    mode == triangles ? corners / 3 : corners - std::min<std::uint64_t>(corners, 2));
      std::string key;
      for (const auto& [name, accessor] : attributes.items()) {
        if (accessor.is_number_unsigned()) key += name + '=' + std::to_string(accessor.get<std::uint64_t>()) + ';';
      }
      if (seen.insert(key).second) count_.vertices = capped_sum(count_.vertices, times, vertices);
      uvs_ = uvs_ || attributes.contains("TEXCOORD_0");
      normals_ = normals_ || attributes.contains("NORMAL");
      colors_ = colors_ || attributes.contains("COLOR_0");
    }
  }

  // As many elements as there are bytes for, whatever is claimed.
  [[nodiscard]] std::uint64_t accessor_count(const Json& primitive, std::uint64_t index,
                                             std::uint64_t components) const {
    const Json& accessor = element(at(root_, "accessors"), index);
    return std::min(number(accessor, "count", 0), most_elements(primitive, accessor, components));
  }
  [[nodiscard]] std::uint64_t most_elements(const Json& primitive, const Json& accessor,
                                            std::uint64_t components) const {
    const std::uint64_t view_number = number(accessor, "bufferView", no_number);
    if (const Json& draco = at(at(primitive, "extensions"), "KHR_draco_mesh_compression");
        draco.is_object() && view_number == no_number) {
      return most_packing * (bytes_of(number(draco, "bufferView", no_number)).size_bytes + 1);
    }
    constexpr std::uint64_t most_zeros = 1U << 24U;  // as in reading
    if (view_number == no_number) return most_zeros;
    const Json& view = element(at(root_, "bufferViews"), view_number);
    if (const Json& packed = meshopt_of(view); packed.is_object()) return packed_count(packed);
    const std::uint64_t type = number(accessor, "componentType", 0);
    constexpr std::uint64_t first_short = 5122;
    constexpr std::uint64_t last_short = 5123;
    const std::uint64_t unit = type < first_short ? 1 : type <= last_short ? 2 : 4;
    const std::uint64_t stride = number(view, "byteStride", unit * components);
    return bytes_of(view_number).size_bytes / std::clamp<std::uint64_t>(stride, 1, unit * components);
  }
  [[nodiscard]] static const Json& meshopt_of(const Json& view) {
    return at(at(view, "extensions"), "EXT_meshopt_compression");
  }
  [[nodiscard]] std::uint64_t packed_count(const Json& packed) const {
    const std::uint64_t bytes = std::min(number(packed, "byteLength", 0), input_.size());
    return std::min(number(packed, "count", 0), most_packing * (bytes + 1));
  }

  void add_image(const Json& image) {
    const std::string uri = text(image, "uri");
    if (is_data(uri)) {
      count_.other_image_bytes += uri.size() / 4 * 3;
    } else if (!uri.empty()) {
      if (auto file = find_beside(input_.folder(), uri)) count_.textures.push_back(std::move(*file));
    } else {
      const Buffer part = bytes_of(number(image, "bufferView", no_number));
      if (part.in_text) {
        count_.other_image_bytes += part.size_bytes;
      } else if (part.size_bytes > 0) {
        count_.images.push_back({part.file, part.begin, part.size_bytes});
      }
    }
  }

  // First the file, its JSON and its buffers; then buffers, images and the mesh, whose arrays grow.
  [[nodiscard]] double reading_bytes() const {
    double unpacked = 0.0;
    for (const Json& view : at(root_, "bufferViews")) {
      constexpr std::uint64_t longest_stride = 256;
      const Json& packed = meshopt_of(view);
      unpacked += static_cast<double>(packed_count(packed)) *
                  static_cast<double>(std::min(number(packed, "byteStride", 0), longest_stride));
    }
    double buffers = unpacked;
    for (const Buffer& buffer : buffers_) buffers += static_cast<double>(buffer.size_bytes);
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
    const bool data_in_text =
        std::any_of(buffers_.begin(), buffers_.end(), [](const Buffer& buffer) { return buffer.in_text; });
    const double parsed = json * (data_in_text || count_.other_image_bytes > 0 ? text_growth : json_growth);
    const double mesh = triangle * static_cast<double>(count_.triangles) +
                        vertex_growth * count_.vertex_bytes * static_cast<double>(count_.vertices);
    const double file = static_cast<double>(input_.size()) + unpacked;
    return std::max(file + buffers + parsed, buffers + images + mesh) + beside;
  }

  const Input& input_;
  const Json& root_;
  const Chunks& chunks_;
  std::vector<Buffer> buffers_;
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

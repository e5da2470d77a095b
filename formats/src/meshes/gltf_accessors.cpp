// SPDX-License-Identifier: MIT
#include "gltf_accessors.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <string>

namespace lodestone {
namespace {

using Bytes = std::span<const std::uint8_t>;

Error bad(int accessor, const char* what) {
  return Error{ErrorCode::BadData, std::string{"an accessor "} + what, "accessor " + std::to_string(accessor)};
}

std::size_t component_bytes(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T load(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

double component(const std::uint8_t* at, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const double v = load<std::int8_t>(at);
      return normalized ? std::max(v / 127.0, -1.0) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const double v = *at;
      return normalized ? v / 255.0 : v;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const double v = load<std::int16_t>(at);
      return normalized ? std::max(v / 32767.0, -1.0) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const double v = load<std::uint16_t>(at);
      return normalized ? v / 65535.0 : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<std::uint32_t>(at);
    default:
      return static_cast<double>(load<float>(at));
  }
}

// `count` elements of `size` bytes that lie `stride` apart from `offset` on.
bool fits(Bytes bytes, std::uint64_t offset, std::uint64_t stride, std::uint64_t size, std::uint64_t count) {
  if (count == 0) return true;
  if (offset > bytes.size() || size > bytes.size() - offset) return false;
  return stride == 0 ? count == 1 : (count - 1) <= (bytes.size() - offset - size) / stride;
}

struct Layout {
  Bytes bytes;
  std::uint64_t offset = 0;
  std::uint64_t stride = 0;
};

// Calls put(element, component, value) for every number of the accessor, sparse ones last.
template <class Put>
Status for_each_number(const tinygltf::Model& model, int index, int components, std::uint64_t cap, const Put& put,
                       const std::function<void(std::size_t)>& resize) {
  if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size()) return bad(index, "does not exist");
  const tinygltf::Accessor& accessor = model.accessors[index];
  const std::size_t unit = component_bytes(accessor.componentType);
  if (unit == 0 || tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)) != components) {
    return bad(index, "has a type that does not fit its use");
  }
  const std::uint64_t count = accessor.count;
  const std::uint64_t size = unit * components;
  if (count > cap) return Error{ErrorCode::TooLarge, "an accessor exceeds the limit on counts", {}};
  const auto copy = [&](const Layout& from, std::size_t element, std::uint64_t at) {
    const std::uint8_t* first = from.bytes.data() + from.offset + at * from.stride;
    for (int c = 0; c < components; ++c) {
      put(element, c, component(first + c * unit, accessor.componentType, accessor.normalized));
    }
  };
  if (accessor.bufferView >= 0) {
    Layout layout{view_bytes(model, accessor.bufferView), accessor.byteOffset, size};
    const std::size_t stride = static_cast<std::size_t>(accessor.bufferView) < model.bufferViews.size()
                                   ? model.bufferViews[accessor.bufferView].byteStride
                                   : 0;
    if (stride != 0) layout.stride = stride;
    if (!fits(layout.bytes, layout.offset, layout.stride, size, count)) return bad(index, "reaches outside its buffer");
    resize(count);
    for (std::size_t i = 0; i < count; ++i) copy(layout, i, i);
  } else {
    constexpr std::uint64_t most_zeros = 1U << 24;  // no bytes stand behind this count
    if (count > most_zeros)
      return Error{ErrorCode::TooLarge, "an accessor without data exceeds the limit on counts", {}};
    resize(count);
  }
  if (!accessor.sparse.isSparse) return Done{};
  const auto& sparse = accessor.sparse;
  const std::size_t index_unit = component_bytes(sparse.indices.componentType);
  const Layout places{view_bytes(model, sparse.indices.bufferView),
                      static_cast<std::uint64_t>(sparse.indices.byteOffset), index_unit};
  const Layout values{view_bytes(model, sparse.values.bufferView), static_cast<std::uint64_t>(sparse.values.byteOffset),
                      size};
  const auto changed = static_cast<std::uint64_t>(std::max(sparse.count, 0));
  if (index_unit == 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0 ||
      !fits(places.bytes, places.offset, places.stride, index_unit, changed) ||
      !fits(values.bytes, values.offset, values.stride, size, changed)) {
    return bad(index, "has sparse values outside its buffer");
  }
  for (std::uint64_t i = 0; i < changed; ++i) {
    const double element =
        component(places.bytes.data() + places.offset + i * places.stride, sparse.indices.componentType, false);
    if (!(element >= 0.0) || element >= static_cast<double>(count))
      return bad(index, "has a sparse index out of range");
    copy(values, static_cast<std::size_t>(element), i);
  }
  return Done{};
}

}  // namespace

Bytes view_bytes(const tinygltf::Model& model, int view) {
  if (view < 0 || static_cast<std::size_t>(view) >= model.bufferViews.size()) return {};
  const tinygltf::BufferView& v = model.bufferViews[view];
  if (v.buffer < 0 || static_cast<std::size_t>(v.buffer) >= model.buffers.size()) return {};
  const auto& data = model.buffers[v.buffer].data;
  if (v.byteOffset > data.size() || v.byteLength > data.size() - v.byteOffset) return {};
  return Bytes{data}.subspan(v.byteOffset, v.byteLength);
}

Status read_floats(const tinygltf::Model& model, int accessor, int components, std::uint64_t cap,
                   std::vector<float>& values) {
  values.clear();
  return for_each_number(
      model, accessor, components, cap,
      [&](std::size_t element, int c, double value) { values[element * components + c] = static_cast<float>(value); },
      [&](std::size_t count) { values.assign(count * components, 0.0F); });
}

Status read_indices(const tinygltf::Model& model, int accessor, std::uint64_t cap, std::vector<std::uint32_t>& values) {
  values.clear();
  return for_each_number(
      model, accessor, 1, cap,
      [&](std::size_t element, int, double value) {
        const bool valid = value >= 0.0 && value < 4294967295.0;
        values[element] = valid ? static_cast<std::uint32_t>(value) : 4294967295U;
      },
      [&](std::size_t count) { values.assign(count, 0U); });
}

}  // namespace lodestone

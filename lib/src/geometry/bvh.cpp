// SPDX-License-Identifier: MIT
#include "geometry/bvh.h"

#include <algorithm>
#include <numeric>

namespace lodestone {
namespace {

constexpr std::uint32_t bin_count = 16;
constexpr std::uint32_t leaf_size = 4;
constexpr std::uint32_t depth_by_area = 64;

struct FloatBox {
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};

  void add(const FloatBox& b) noexcept {
    low = glm::min(low, b.low);
    high = glm::max(high, b.high);
  }
  void add(const glm::vec3& p) noexcept {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  [[nodiscard]] float half_area() const noexcept {
    const glm::vec3 d = high - low;
    return d.x < 0.0F ? 0.0F : d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

}  // namespace

struct TriangleBvh::Build {
  struct Item {
    FloatBox box;
    glm::vec3 center{0.0F};
    FaceId face = 0;
  };
  struct Split {
    int axis = -1;  // -1: none is worth it
    std::uint32_t bin = 0;
    float low = 0.0F;
    float scale = 0.0F;

    [[nodiscard]] std::uint32_t bin_of(const Item& item) const noexcept {
      return std::min(bin_count - 1, static_cast<std::uint32_t>((item.center[axis] - low) * scale));
    }
  };

  std::vector<Item> items;
  std::vector<Node> nodes;

  // The plane between two bins with the least sum of area times count.
  static Split best_split(std::span<const Item> range, const FloatBox& centers) {
    Split best;
    float best_cost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const float extent = centers.high[axis] - centers.low[axis];
      const Split candidate{.axis = axis, .low = centers.low[axis], .scale = static_cast<float>(bin_count) / extent};
      if (!(extent > 0.0F) || !(candidate.scale < std::numeric_limits<float>::max())) continue;
      std::array<FloatBox, bin_count> boxes;
      std::array<std::uint32_t, bin_count> counts{};
      for (const Item& item : range) {
        const std::uint32_t bin = candidate.bin_of(item);
        boxes[bin].add(item.box);
        ++counts[bin];
      }
      std::array<float, bin_count> left_cost{};
      FloatBox box;
      std::uint32_t count = 0;
      for (std::uint32_t bin = 0; bin + 1 < bin_count; ++bin) {
        box.add(boxes[bin]);
        count += counts[bin];
        left_cost[bin] = box.half_area() * static_cast<float>(count);
      }
      box = {};
      count = 0;
      for (std::uint32_t bin = bin_count - 1; bin > 0; --bin) {
        box.add(boxes[bin]);
        count += counts[bin];
        const float cost = left_cost[bin - 1] + box.half_area() * static_cast<float>(count);
        if (cost < best_cost && count > 0 && count < range.size()) {
          best_cost = cost;
          best = candidate;
          best.bin = bin;
        }
      }
    }
    return best;
  }

  // Orders items[begin, end) into two parts; returns where the second begins.
  std::uint32_t partition(std::uint32_t begin, std::uint32_t end, const FloatBox& centers, std::uint32_t depth) {
    const auto first = items.begin() + begin;
    const auto last = items.begin() + end;
    if (depth < depth_by_area) {
      const Split split = best_split({first, last}, centers);
      if (split.axis >= 0) {
        const auto middle =
            std::partition(first, last, [&](const Item& item) { return split.bin_of(item) < split.bin; });
        return static_cast<std::uint32_t>(middle - items.begin());
      }
    }
    const glm::vec3 size = centers.high - centers.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = first + (end - begin) / 2;
    std::nth_element(first, middle, last, [axis](const Item& a, const Item& b) {
      return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.face < b.face;
    });
    return begin + (end - begin) / 2;
  }

  void add_node(std::uint32_t begin, std::uint32_t end, std::uint32_t depth) {
    FloatBox box;
    FloatBox centers;
    for (std::uint32_t i = begin; i < end; ++i) {
      box.add(items[i].box);
      centers.add(items[i].center);
    }
    const auto index = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back({.low = box.low, .first = begin, .high = box.high, .count = end - begin});
    if (end - begin <= leaf_size) return;
    const std::uint32_t middle = partition(begin, end, centers, depth);
    add_node(begin, middle, depth + 1);
    nodes[index].first = static_cast<std::uint32_t>(nodes.size());
    nodes[index].count = 0;
    add_node(middle, end, depth + 1);
  }
};

TriangleBvh::TriangleBvh(std::span<const glm::vec3> positions, std::span<const VertexId> indices) {
  const auto count = static_cast<std::uint32_t>(indices.size() / 3);
  if (count == 0) return;
  Build build;
  build.items.resize(count);
  for (FaceId f = 0; f < count; ++f) {
    Build::Item& item = build.items[f];
    for (std::size_t c = 0; c < 3; ++c) item.box.add(positions[indices[3 * std::size_t{f} + c]]);
    item.center = 0.5F * item.box.low + 0.5F * item.box.high;
    item.face = f;
  }
  build.nodes.reserve(count);
  build.add_node(0, count, 0);
  nodes_ = std::move(build.nodes);
  faces_.resize(count);
  for (std::uint32_t slot = 0; slot < count; ++slot) faces_[slot] = build.items[slot].face;
  build.items = {};  // not beside the triangles
  triangles_.resize(count);
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    for (std::size_t c = 0; c < 3; ++c) triangles_[slot][c] = positions[indices[3 * std::size_t{faces_[slot]} + c]];
  }
}

void TriangleBvh::set_labels(std::span<const std::uint32_t> label_of_face) {
  labels_.resize(faces_.size());
  for (std::size_t slot = 0; slot < faces_.size(); ++slot) labels_[slot] = label_of_face[faces_[slot]];
  const auto join = [](std::uint32_t a, std::uint32_t b) { return a == none || a == b ? b : b == none ? a : mixed; };
  node_labels_.resize(nodes_.size());
  // Children come after their parents.
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const Node& node = nodes_[i];
    std::uint32_t label = none;
    for (std::uint32_t slot = node.first; slot < node.first + node.count; ++slot) label = join(label, labels_[slot]);
    if (node.count == 0) label = join(node_labels_[i + 1], node_labels_[node.first]);
    node_labels_[i] = label;
  }
}

}  // namespace lodestone

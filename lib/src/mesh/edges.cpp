// SPDX-License-Identifier: MIT
#include "mesh/edges.h"

#include <algorithm>

namespace lodestone {
namespace {

// Calls f(low, use) for every side of every face that is not collapsed, in order of corners.
template <class F>
void for_each_side(const Mesh& mesh, const Weld& weld, F f) {
  const auto corners = static_cast<CornerId>(mesh.indices.size());
  for (CornerId c = 0; c < corners; ++c) {
    if (collapsed(weld, &mesh.indices[c - c % 3])) continue;
    const std::uint32_t a = weld.point_of[mesh.indices[c]];
    const std::uint32_t b = weld.point_of[mesh.indices[next_corner(c)]];
    f(std::min(a, b), EdgeUse{.high = std::max(a, b), .corner = c, .ascending = a < b});
  }
}

}  // namespace

EdgeTable find_edges(const Mesh& mesh, const Weld& weld) {
  // Bucket the sides by their smaller point, then order each bucket (about six sides) by the larger.
  std::vector<std::uint32_t> bucket(std::size_t{weld.point_count()} + 1, 0);
  for_each_side(mesh, weld, [&](std::uint32_t low, const EdgeUse&) { ++bucket[low + 1]; });
  for (std::size_t i = 1; i < bucket.size(); ++i) bucket[i] += bucket[i - 1];
  EdgeTable table;
  table.uses.resize(bucket.back());
  std::vector<std::uint32_t> fill(bucket.begin(), bucket.end() - 1);
  for_each_side(mesh, weld, [&](std::uint32_t low, const EdgeUse& use) { table.uses[fill[low]++] = use; });

  for (std::uint32_t low = 0; low < weld.point_count(); ++low) {
    const auto begin = table.uses.begin() + bucket[low];
    const auto end = table.uses.begin() + bucket[low + 1];
    std::sort(begin, end, [](const EdgeUse& a, const EdgeUse& b) {
      return a.high != b.high ? a.high < b.high : a.corner < b.corner;
    });
    for (auto use = begin; use != end; ++use) {
      if (use != begin && use->high == (use - 1)->high) continue;
      table.first_use.push_back(static_cast<std::uint32_t>(use - table.uses.begin()));
      table.low.push_back(low);
    }
  }
  table.first_use.push_back(static_cast<std::uint32_t>(table.uses.size()));
  return table;
}

}  // namespace lodestone

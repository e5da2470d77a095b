// SPDX-License-Identifier: MIT
#include <lodestone/terrain_files.h>

#include <algorithm>

namespace lodestone {

std::vector<TileRange> available_ranges(const std::vector<TileInfo>& tiles) {
  // Runs of each row, then runs that are equal in the row above are taken together.
  std::vector<TileRange> ranges;
  std::vector<std::size_t> open;  // ranges that end in the row before
  for (std::size_t i = 0; i < tiles.size();) {
    const std::uint32_t y = tiles[i].y;
    std::vector<std::size_t> here;
    while (i < tiles.size() && tiles[i].y == y) {
      const std::uint32_t start = tiles[i].x;
      std::uint32_t end = start;
      for (++i; i < tiles.size() && tiles[i].y == y && tiles[i].x == end + 1; ++i) ++end;
      const auto above = std::find_if(open.begin(), open.end(), [&](std::size_t r) {
        return ranges[r].end_y + 1 == y && ranges[r].start_x == start && ranges[r].end_x == end;
      });
      if (above != open.end()) {
        ranges[*above].end_y = y;
        here.push_back(*above);
      } else {
        here.push_back(ranges.size());
        ranges.push_back({start, y, end, y});
      }
    }
    open = std::move(here);
  }
  return ranges;
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include "terrain/chains.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>

#include "heights.h"

using namespace lodestone;
using namespace lodestone::terrain;
using lodestone::test::lattice_of;

namespace {

// Posts of a rough line at full density: index counts posts of the finest zoom.
double rough_m(std::int64_t index) {
  double height_m = 0.0, scale = 900.0;
  for (int octave = 0; octave < 8; ++octave, scale *= 0.6) {
    const std::int64_t cell = std::int64_t{256} >> octave;
    if (cell == 0) break;
    const auto knot = [&](std::int64_t k) {
      return static_cast<double>(mix64(static_cast<std::uint64_t>(k * 31 + octave)) % 1000) / 1000.0;
    };
    const double at = static_cast<double>(index % cell) / static_cast<double>(cell);
    height_m += scale * ((1.0 - at) * knot(index / cell) + at * knot(index / cell + 1));
  }
  return height_m;
}

std::vector<int> chain_at(std::int64_t first, std::int64_t stride, double tolerance_m, double scale = 1.0) {
  std::array<double, size + 3> line_m{};
  for (int x = -1; x <= size + 1; ++x)
    line_m[static_cast<std::size_t>(x + 1)] = scale * rough_m(first + stride * (x + 1));
  const TileLattice lattice = lattice_of([&](int x, int) { return line_m[static_cast<std::size_t>(x + 1)]; });
  return border_chain(lattice, Side::South, {tolerance_m, 0.25, 1});
}

}  // namespace

TEST_CASE("the chain of a zoom contains the chain of the zoom above, on cliffs as well") {
  const double tolerance_m = GENERATE(2.0, 20.0, 100.0);
  const double finer_m = GENERATE(1.0, 0.5) * tolerance_m;
  const double scale = GENERATE(1.0, 8.0);
  for (std::int64_t start = 0; start < 60000; start += 4001) {
    const std::vector<int> coarse = chain_at(start, 2, tolerance_m, scale);
    // Post t of the coarse line is post 2 t of the two fine ones together.
    const std::vector<int> first = chain_at(start + 1, 1, finer_m, scale),
                           second = chain_at(start + 257, 1, finer_m, scale);
    const bool nested = std::all_of(coarse.begin(), coarse.end(), [&](int t) {
      const std::vector<int>& fine = t <= size / 2 ? first : second;
      return std::binary_search(fine.begin(), fine.end(), t <= size / 2 ? 2 * t : 2 * t - size);
    });
    CHECK(nested);
    CHECK(coarse.size() > 2);
  }
}

TEST_CASE("both tiles of a border compute the same chain, beside voids as well") {
  const bool voids = GENERATE(false, true);
  const auto height_m = [&](std::int64_t x, std::int64_t y) {
    if (voids && mix64(static_cast<std::uint64_t>(x / 5 * 1000 + y / 3)) % 7 == 0) return static_cast<double>(NAN);
    return rough_m(x + 1000) + rough_m(3 * y + 5000);
  };
  const TileLattice west = lattice_of([&](int x, int y) { return height_m(x + 10, y + 10); });
  const TileLattice east = lattice_of([&](int x, int y) { return height_m(x + 10 + size, y + 10); });
  const TileLattice north = lattice_of([&](int x, int y) { return height_m(x + 10, y + 10 + size); });
  const ChainOptions options{30.0, 0.5, 4};
  CHECK(border_chain(west, Side::East, options) == border_chain(east, Side::West, options));
  CHECK(border_chain(west, Side::North, options) == border_chain(north, Side::South, options));
  CHECK(border_chain(west, Side::East, options).size() > 10);
}

TEST_CASE("a chain stays within the tolerance of its posts, as drawn") {
  const double tolerance_m = GENERATE(1.0, 7.0, 60.0);
  const TileLattice lattice = lattice_of([](int x, int) { return rough_m(x + 1); });
  const std::vector<int> chain = border_chain(lattice, Side::North, {tolerance_m, 0.25, 1});
  REQUIRE(chain.front() == 0);
  REQUIRE(chain.back() == size);
  const auto place = [](int t) { return t + quantized_shift(t); };
  const auto vertex_m = [&](int t) { return snapped_m(lattice.vertex_height_m(post_of(Side::North, t)), 0.25); };
  std::size_t k = 0;
  double most_m = 0.0;
  for (int t = 0; t <= size; ++t) {
    while (k + 2 < chain.size() && place(chain[k + 1]) < t) ++k;
    const double share = (t - place(chain[k])) / (place(chain[k + 1]) - place(chain[k]));
    most_m =
        std::max(most_m, std::fabs(lattice.at(t, size) - std::lerp(vertex_m(chain[k]), vertex_m(chain[k + 1]), share)));
  }
  CHECK(most_m <= tolerance_m + 0.125);
}

TEST_CASE("quantised places are the nearest to their posts") {
  for (int t = 0; t <= size; ++t) {
    const double exact = static_cast<double>(t) * quantized_max / size;
    CHECK(std::fabs(quantized(t) - exact) <= 0.5);
    CHECK(quantized_shift(t) == Approx((quantized(t) - exact) * size / quantized_max).margin(1e-12));
  }
}

// SPDX-License-Identifier: MIT
#include <atomic>
#include <catch2/catch.hpp>
#include <vector>

#include "base/disjoint_sets.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/rng.h"

using namespace lodestone;

TEST_CASE("the generator gives the same numbers on every platform, other ones for other seeds and streams") {
  Rng rng{1};
  CHECK(rng.next() == 0xa706dd2f4d197e6fULL);
  CHECK(rng.next() == 0xb382a305f4414f5eULL);
  CHECK(Rng{1, 1}.next() == 0x5e41ab087439611eULL);
  CHECK(Rng{2}.next() != Rng{1}.next());
}

TEST_CASE("random numbers stay in range and are spread evenly") {
  Rng rng{9};
  std::vector<int> hits(10, 0);
  double sum = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double x = rng.uniform(-2.0, 4.0);
    CHECK((x >= -2.0 && x < 4.0));
    sum += x;
    ++hits[rng.below(10)];
  }
  CHECK(sum / 100'000 == Approx(1.0).margin(0.02));
  for (const int h : hits) CHECK(h == Approx(10'000).epsilon(0.05));
}

TEST_CASE("unique_ids numbers classes by first appearance, also when all hashes are equal") {
  const std::vector<int> values{7, 3, 7, 7, 9, 3, 1, 9};
  for (const std::uint64_t spread : {0ULL, 1ULL, 0x9e3779b97f4a7c15ULL}) {
    const UniqueIds ids = unique_ids(
        8, [&](std::uint32_t i) { return spread * static_cast<std::uint64_t>(values[i]); },
        [&](std::uint32_t i, std::uint32_t j) { return values[i] == values[j]; });
    CHECK(ids.id_of == std::vector<std::uint32_t>{0, 1, 0, 0, 2, 1, 3, 2});
    CHECK(ids.first == std::vector<std::uint32_t>{0, 1, 4, 6});
  }
}

TEST_CASE("disjoint sets are named by their first member") {
  DisjointSets sets{6};
  CHECK(sets.join(5, 3));
  CHECK(sets.join(3, 4));
  CHECK_FALSE(sets.join(4, 5));
  CHECK(sets.find(5) == 3);
  CHECK(sets.join(1, 5));
  CHECK(sets.find(4) == 1);
  CHECK(sets.find(0) == 0);
}

TEST_CASE("every element is visited once, in the same chunks, for any number of workers") {
  for (const unsigned workers : {0U, 1U, 2U, 8U}) {
    std::vector<std::atomic<int>> visits(1003);
    std::atomic<int> odd{0};
    parallel_chunks(visits.size(), 10, {.max_workers = workers}, [&](std::size_t begin, std::size_t end) {
      if (begin % 10 != 0 || end != std::min<std::size_t>(begin + 10, 1003)) ++odd;
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    CHECK(odd == 0);
    for (const auto& v : visits) CHECK(v == 1);
  }
}

TEST_CASE("chunks not yet begun are left out once cancelled") {
  std::atomic<bool> cancel{false};
  std::atomic<int> begun{0};
  parallel_for_each(100, 1, {.cancel = &cancel, .max_workers = 1}, [&](std::size_t) {
    if (++begun == 3) cancel = true;
  });
  CHECK(begun == 3);
}

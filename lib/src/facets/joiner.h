// SPDX-License-Identifier: MIT
// Makes one record of those that belong together.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

// Records made while one key holds become one, when the key changes and at the end.
class Joiner {
 public:
  using Key = std::array<std::int64_t, 4>;

  Joiner(progressive::EditLog& log, ShiftOrder order) : log_(log), joins_(order == ShiftOrder::Together) {}
  ~Joiner() { join(); }
  Joiner(const Joiner&) = delete;
  Joiner& operator=(const Joiner&) = delete;

  [[nodiscard]] bool joins() const noexcept { return joins_; }
  void begin(const Key& key) {
    if (!joins_ || key_ == key) return;
    join();
    key_ = key;
    first_ = log_.record_count();
  }

 private:
  void join() {
    if (key_) log_.join_from(first_);
  }

  progressive::EditLog& log_;
  bool joins_;
  std::optional<Key> key_;
  std::uint32_t first_ = 0;
};

}  // namespace lodestone::facets

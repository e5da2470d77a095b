// SPDX-License-Identifier: MIT
// The faces around a point: nearly always few, and then kept in place, since they are asked for all the time.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <lodestone/types.h>

namespace lodestone::facets {

class FaceList {
 public:
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] const FaceId* begin() const noexcept { return many_.empty() ? few_.data() : many_.data(); }
  [[nodiscard]] const FaceId* end() const noexcept { return begin() + size_; }
  [[nodiscard]] FaceId front() const noexcept { return *begin(); }
  [[nodiscard]] FaceId back() const noexcept { return *(end() - 1); }

  void push_back(FaceId f) {
    if (size_ == few_.size() && many_.empty()) many_.assign(few_.begin(), few_.end());
    if (many_.empty()) {
      few_[size_] = f;
    } else {
      many_.push_back(f);
    }
    ++size_;
  }
  // Nothing if it is not there; the others keep their order.
  void erase(FaceId f) {
    FaceId* first = many_.empty() ? few_.data() : many_.data();
    const auto left = static_cast<std::uint32_t>(std::remove(first, first + size_, f) - first);
    size_ = left;
    if (!many_.empty()) many_.resize(left);
  }
  void clear() noexcept {
    size_ = 0;
    many_.clear();
  }

 private:
  std::uint32_t size_ = 0;
  std::array<FaceId, 7> few_{};
  std::vector<FaceId> many_;  // all of them, once there were more; empty while few_ holds them
};

}  // namespace lodestone::facets

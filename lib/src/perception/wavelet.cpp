// SPDX-License-Identifier: MIT
#include "perception/wavelet.h"

#include <algorithm>

namespace lodestone::perception {
namespace {

constexpr float predict_1 = -1.586134342059924F;
constexpr float update_1 = -0.052980118572961F;
constexpr float predict_2 = 0.882911075530934F;
constexpr float update_2 = 0.443506852043971F;
constexpr float scale = 1.230174104914001F;

constexpr std::size_t columns_at_once = 16;  // a cache line of floats: columns are walked side by side

// A bundle of signals: sample i of signal k is data[i * step + k].
struct Bundle {
  float* data;
  std::size_t count;  // samples of each signal
  std::size_t step;
  std::size_t signals;

  // x[i] += factor * (x[i - 1] + x[i + 1]) for every second i, mirrored at the ends.
  void lift(std::size_t first, float factor) const {
    for (std::size_t i = first; i < count; i += 2) {
      const float* before = data + (i == 0 ? 1 : i - 1) * step;
      const float* after = data + (i + 1 == count ? i - 1 : i + 1) * step;
      float* at = data + i * step;
      for (std::size_t k = 0; k < signals; ++k) at[k] += factor * (before[k] + after[k]);
    }
  }
  void multiply(std::size_t first, float factor) const {
    for (std::size_t i = first; i < count; i += 2) {
      float* at = data + i * step;
      for (std::size_t k = 0; k < signals; ++k) at[k] *= factor;
    }
  }
};

void forward(const Bundle& x) {
  x.lift(1, predict_1);
  x.lift(0, update_1);
  x.lift(1, predict_2);
  x.lift(0, update_2);
  x.multiply(0, 1.0F / scale);
  x.multiply(1, scale);
}

void inverse(const Bundle& x) {
  x.multiply(1, 1.0F / scale);
  x.multiply(0, scale);
  x.lift(0, -update_2);
  x.lift(1, -predict_2);
  x.lift(0, -update_1);
  x.lift(1, -predict_1);
}

// Even samples first, then odd ones; or back.
void sort_bands(const Bundle& x, std::vector<float>& room, bool split) {
  room.resize(x.count * x.signals);
  const std::size_t low = (x.count + 1) / 2;
  for (std::size_t i = 0; i < x.count; ++i) {
    const std::size_t band = i % 2 == 0 ? i / 2 : low + i / 2;
    std::copy_n(x.data + (split ? i : band) * x.step, x.signals, room.data() + (split ? band : i) * x.signals);
  }
  for (std::size_t i = 0; i < x.count; ++i) std::copy_n(room.data() + i * x.signals, x.signals, x.data + i * x.step);
}

void transform(const Bundle& x, std::vector<float>& room, bool is_forward) {
  if (x.count < 2) return;
  if (is_forward) {
    forward(x);
    sort_bands(x, room, true);
  } else {
    sort_bands(x, room, false);
    inverse(x);
  }
}

void rows(std::vector<float>& plane, std::size_t stride, std::size_t width, std::size_t height, bool is_forward) {
  std::vector<float> room;
  for (std::size_t y = 0; y < height; ++y) transform({plane.data() + y * stride, width, 1, 1}, room, is_forward);
}

void columns(std::vector<float>& plane, std::size_t stride, std::size_t width, std::size_t height, bool is_forward) {
  std::vector<float> room;
  for (std::size_t x = 0; x < width; x += columns_at_once) {
    transform({plane.data() + x, height, stride, std::min(columns_at_once, width - x)}, room, is_forward);
  }
}

}  // namespace

void wavelet_forward(std::vector<float>& plane, std::size_t stride, std::size_t width, std::size_t height) {
  rows(plane, stride, width, height, true);
  columns(plane, stride, width, height, true);
}

void wavelet_inverse(std::vector<float>& plane, std::size_t stride, std::size_t width, std::size_t height) {
  columns(plane, stride, width, height, false);
  rows(plane, stride, width, height, false);
}

}  // namespace lodestone::perception

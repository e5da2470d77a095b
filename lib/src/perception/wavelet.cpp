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

// A row with its even and odd samples side by side, so that every step runs over contiguous floats.
struct SplitRow {
  std::vector<float> even, odd;

  void resize(std::size_t count) {
    even.resize((count + 1) / 2);
    odd.resize(count / 2);
  }
  // odd[i] += factor * (even before + even after), mirrored at the end.
  void lift_odd(float factor) {
    const std::size_t inner = even.size() - 1;
    for (std::size_t i = 0; i < inner; ++i) odd[i] += factor * (even[i] + even[i + 1]);
    if (odd.size() > inner) odd[inner] += factor * (even[inner] + even[inner]);
  }
  void lift_even(float factor) {
    even[0] += factor * (odd[0] + odd[0]);
    for (std::size_t i = 1; i < odd.size(); ++i) even[i] += factor * (odd[i - 1] + odd[i]);
    if (even.size() > odd.size()) even[odd.size()] += factor * (odd.back() + odd.back());
  }
  void multiply(float even_factor, float odd_factor) {
    for (float& v : even) v *= even_factor;
    for (float& v : odd) v *= odd_factor;
  }
};

void forward_row(float* data, std::size_t count, SplitRow& row) {
  row.resize(count);
  for (std::size_t i = 0; i < row.odd.size(); ++i) {
    row.even[i] = data[2 * i];
    row.odd[i] = data[2 * i + 1];
  }
  if (count % 2 == 1) row.even.back() = data[count - 1];
  row.lift_odd(predict_1);
  row.lift_even(update_1);
  row.lift_odd(predict_2);
  row.lift_even(update_2);
  row.multiply(1.0F / scale, scale);
  std::copy(row.odd.begin(), row.odd.end(), std::copy(row.even.begin(), row.even.end(), data));
}

void inverse_row(float* data, std::size_t count, SplitRow& row) {
  row.resize(count);
  std::copy_n(data, row.even.size(), row.even.begin());
  std::copy_n(data + row.even.size(), row.odd.size(), row.odd.begin());
  row.multiply(scale, 1.0F / scale);
  row.lift_even(-update_2);
  row.lift_odd(-predict_2);
  row.lift_even(-update_1);
  row.lift_odd(-predict_1);
  for (std::size_t i = 0; i < row.odd.size(); ++i) {
    data[2 * i] = row.even[i];
    data[2 * i + 1] = row.odd[i];
  }
  if (count % 2 == 1) data[count - 1] = row.even.back();
}

void rows(std::vector<float>& plane, std::size_t stride, std::size_t width, std::size_t height, bool is_forward) {
  if (width < 2) return;
  SplitRow row;
  for (std::size_t y = 0; y < height; ++y) {
    float* data = plane.data() + y * stride;
    is_forward ? forward_row(data, width, row) : inverse_row(data, width, row);
  }
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

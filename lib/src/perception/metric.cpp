// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, sections 3.1 to 3.3.
#include <lodestone/perception.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "perception/luminance.h"

namespace lodestone {
namespace {

Error bad(std::string message) { return Error{ErrorCode::BadArgument, std::move(message), "perceptual metric"}; }

class Sampler {
 public:
  Sampler(const VisionModel& vision, const RenderAtDistance& render, const Context& context, std::uint32_t count)
      : vision_(vision), render_(render), context_(context), count_(count) {}

  // Empty if all is well.
  std::optional<Error> take(double distance_m) {
    if (context_.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", "perceptual metric"};
    context_.report("looking", static_cast<double>(samples_.size()) / count_);
    const auto picture = render_(distance_m);
    if (!picture) return picture.error();
    const auto detail = visible_detail(*picture, vision_);
    if (!detail)
      return Error{detail.error().code, "from " + std::to_string(distance_m) + " m: " + detail.error().message,
                   detail.error().where};
    if (samples_.empty()) first_pixels_ = static_cast<double>(detail->object_pixels);
    const auto seen = static_cast<double>(detail->object_pixels - detail->imperceptible_pixels);
    samples_.push_back({distance_m, seen / first_pixels_, *detail});
    return std::nullopt;
  }

  // Between the neighbours whose metric differs most; wide gaps win ties.
  [[nodiscard]] double widest_gap() {
    sort();
    double best = -1.0;
    double place = 0.0;
    for (std::size_t i = 1; i < samples_.size(); ++i) {
      const double width = samples_[i].distance_m - samples_[i - 1].distance_m;
      const double gap = std::abs(samples_[i].metric - samples_[i - 1].metric) + 1e-6 * width;
      if (gap > best) {
        best = gap;
        place = samples_[i - 1].distance_m + 0.5 * width;
      }
    }
    return place;
  }

  [[nodiscard]] std::vector<DetailSample> samples() {
    sort();
    return std::move(samples_);
  }

 private:
  void sort() {
    std::sort(samples_.begin(), samples_.end(),
              [](const DetailSample& a, const DetailSample& b) { return a.distance_m < b.distance_m; });
  }

  const VisionModel& vision_;
  const RenderAtDistance& render_;
  const Context& context_;
  std::uint32_t count_;
  double first_pixels_ = 1.0;
  std::vector<DetailSample> samples_;
};

}  // namespace

Result<VisibleDetail> visible_detail(const ObjectPicture& picture, const VisionModel& vision) {
  const std::size_t pixels = static_cast<std::size_t>(picture.image.width) * picture.image.height;
  if (pixels == 0 || picture.mask.size() != pixels) return bad("picture and mask must have the same size, not zero");
  const auto seen = vision.simulate(picture.image);
  if (!seen) return seen.error();
  VisibleDetail detail;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (picture.mask[i] == 0) continue;
    ++detail.object_pixels;
    if (perception::grey(picture.image, i) != seen->pixels[i]) ++detail.imperceptible_pixels;
  }
  if (detail.object_pixels == 0)
    return bad(
        "no pixel of the picture belongs to the object: the screen is too small for it or the field of view too wide, "
        "or "
        "it lies behind the camera or edge-on");
  return detail;
}

Result<std::vector<DetailSample>> sample_perceptual_metric(const SamplingOptions& options, const VisionModel& vision,
                                                           const RenderAtDistance& render, const Context& context) {
  if (!(options.first_m > 0.0) || !(options.last_m > options.first_m) || options.count < 4) {
    return bad("the range of distances must begin above 0, be longer than 0 and hold at least 4 samples");
  }
  Sampler sampler{vision, render, context, options.count};
  const std::uint32_t even = options.sampling == Sampling::EqualSteps ? options.count : std::max(4U, options.count / 8);
  for (std::uint32_t i = 0; i < even; ++i) {
    const double t = static_cast<double>(i) / (even - 1);
    if (auto fault = sampler.take(options.first_m + t * (options.last_m - options.first_m))) return *std::move(fault);
  }
  for (std::uint32_t i = even; i < options.count; ++i) {
    if (auto fault = sampler.take(sampler.widest_gap())) return *std::move(fault);
  }
  return sampler.samples();
}

Result<std::vector<DetailSample>> sample_metric_at(const std::vector<double>& distances_m, const VisionModel& vision,
                                                   const RenderAtDistance& render, const Context& context) {
  if (distances_m.empty() || !(distances_m.front() > 0.0) || !std::is_sorted(distances_m.begin(), distances_m.end())) {
    return bad("distances must be above 0 and ascend");
  }
  Sampler sampler{vision, render, context, static_cast<std::uint32_t>(distances_m.size())};
  for (const double distance_m : distances_m) {
    if (auto fault = sampler.take(distance_m)) return *std::move(fault);
  }
  return sampler.samples();
}

std::vector<DetailSample> pool_sides(const std::vector<std::vector<DetailSample>>& sides) {
  std::vector<DetailSample> pooled = sides.front();
  double first_pixels = 0.0;
  for (const auto& side : sides) first_pixels += static_cast<double>(side.front().detail.object_pixels);
  for (std::size_t i = 0; i < pooled.size(); ++i) {
    VisibleDetail& sum = pooled[i].detail;
    sum = {};
    for (const auto& side : sides) {
      sum.object_pixels += side[i].detail.object_pixels;
      sum.imperceptible_pixels += side[i].detail.imperceptible_pixels;
    }
    pooled[i].metric = static_cast<double>(sum.object_pixels - sum.imperceptible_pixels) / first_pixels;
  }
  return pooled;
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
/// \file
/// How much of a model's detail can be seen from a distance, and at which distances discrete levels should therefore
/// switch. Source: Zhu, Zhao, Du, Zhang, "Quantitative analysis of discrete 3D geometrical detail levels based on
/// perceptual metric", Computers & Graphics 34 (2010); equations are named by its numbers.
///
/// Pure functions: images in, numbers out. Whoever calls brings the renderer (see `sample_perceptual_metric`).
///
///     render at distances -> sample_perceptual_metric -> fit_detail -> design_switches -> levels of a ProgressiveModel
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/image.h>
#include <lodestone/mesh.h>
#include <lodestone/progressive_model.h>
#include <lodestone/result.h>

namespace lodestone {

/// The screen and the eye before it. The defaults are the paper's desk (section 5.1).
struct Display {
  std::uint32_t width_px = 1280;
  std::uint32_t height_px = 1024;
  double dots_per_inch = 86.27;
  double viewing_distance_m = 0.5;        ///< from the eye to the screen
  double fov_y_rad = 0.5817182397077883;  ///< of the virtual camera, full vertical angle; 33.33 degrees
  double luminance_cd_m2 = 200.0;         ///< noted in reports; equation 14 holds for photopic levels
};

/// Pixels that one metre across covers at distance 1 m from the camera (the l r / 0.0254 of equations 7, 8 and 17).
[[nodiscard]] double focal_length_px(const Display& display) noexcept;

/// Equation 13: highest spatial frequency that the screen can show the eye; cycles per degree.
[[nodiscard]] double max_frequency_cpd(const Display& display) noexcept;

/// Equation 14 (Mannos and Sakrison): contrast sensitivity at a frequency in cycles per degree; 0.. about 1.
[[nodiscard]] double contrast_sensitivity(double frequency_cpd) noexcept;

/// Frequency at which the sensitivity is taken to peak; below it nothing is filtered (section 5.2).
inline constexpr double peak_frequency_cpd = 6.2;

/// Equation 2: distance of the camera from the centre of a sphere that just fills the field of view; metres.
[[nodiscard]] double first_distance_m(double radius_m, double fov_rad) noexcept;

/// Equation 8: distance at which that sphere has shrunk to one pixel; metres.
[[nodiscard]] double last_distance_m(double radius_m, double focal_px) noexcept;

/// Equation 17: deviation in metres that covers half a pixel at a distance: what may be simplified away there.
[[nodiscard]] double imperceptible_error_m(double distance_m, double focal_px) noexcept;

/// A building as the four sides of it are looked at.
struct Sides {
  double front_rad = 0.0;  ///< direction that the front faces: 0 = north (+y), clockwise seen from above
  Sphere bounds;           ///< about the middle of the box, relative to the origin; encloses every vertex in use

  [[nodiscard]] double back_rad() const noexcept;
  [[nodiscard]] double left_rad() const noexcept;  ///< to the left of who stands before the front
  [[nodiscard]] double right_rad() const noexcept;
};

/// Sides by orientation: along the direction that most wall area agrees on (modulo a right angle); the front is the
/// one of the four that most triangles face. South where there are no walls. O(triangles).
[[nodiscard]] Sides find_sides(const Mesh& mesh);

/// What an eye at the display's viewing distance can make of a picture: the picture without the detail that is too fine
/// (section 3.2: Daubechies 9/7 wavelet, contrast sensitivity by band, back). Holds the filters; thread-safe.
class VisionModel {
 public:
  explicit VisionModel(const Display& display);

  /// Wavelet levels used: the fewest whose next band would lie below the peak.
  [[nodiscard]] int levels() const noexcept { return levels_; }

  /// Of the display, equation 13.
  [[nodiscard]] double max_frequency_cpd() const noexcept { return max_frequency_cpd_; }

  /// Gain of the filter of band `level` (1 = finest) at a frequency inside that band; equals equation 14 over its peak.
  [[nodiscard]] double gain(int level, double frequency_cpd) const noexcept;

  /// Luminance picture (any channels; Rec. 709 weights on the 8-bit values) as the eye has it; one channel, 0..255.
  /// O(pixels). Errors: BadArgument for an empty picture.
  [[nodiscard]] Result<Image> simulate(const Image& rendered) const;

 private:
  static constexpr int half_taps = 8;
  /// Symmetric FIR of one band: the tap at distance 0..half_taps.
  struct Filter {
    std::array<double, half_taps + 1> taps{};
  };
  struct Band {
    std::size_t x, y, width, height;
  };
  void filter_band(std::vector<float>& plane, std::size_t stride, const Band& band, bool rows,
                   const Filter& filter) const;

  int levels_ = 0;
  double max_frequency_cpd_ = 0.0;
  std::vector<Filter> filters_;  ///< per level, finest first
};

/// One rendering for the metric: the picture, and which of its pixels belong to the object (one byte each, 0 = no).
struct ObjectPicture {
  Image image;
  std::vector<std::uint8_t> mask;
};

/// Pixels of an object, and those among them whose detail the eye loses.
struct VisibleDetail {
  std::uint64_t object_pixels = 0;         ///< P_n
  std::uint64_t imperceptible_pixels = 0;  ///< IP_n: the vision-simulated picture differs
};

/// Counts; equations 3 and 4. Errors: BadArgument if sizes disagree or no pixel belongs to the object.
[[nodiscard]] Result<VisibleDetail> visible_detail(const ObjectPicture& picture, const VisionModel& vision);

/// The metric at one distance.
struct DetailSample {
  double distance_m = 0.0;  ///< from the camera to the centre of the object
  double metric = 0.0;      ///< equation 5: (P_n - IP_n) / P_n1, 0..1
  VisibleDetail detail;
};

enum class Sampling : std::uint8_t {
  EqualSteps,  ///< as the paper: `count` samples at equal distances
  Adaptive,    ///< the same number, placed by halving where neighbours differ most
};

struct SamplingOptions {
  double first_m = 0.0;  ///< d1; its object pixels are P_n1
  double last_m = 0.0;   ///< usually d1 + 1000 m: beyond, hardly anything changes
  std::uint32_t count = 200;
  Sampling sampling = Sampling::EqualSteps;
};

/// Renders the object from a distance: flat shaded, static light, white background, no supersampling.
using RenderAtDistance = std::function<Result<ObjectPicture>(double distance_m)>;

/// Samples the metric, ordered by distance. Errors of the renderer pass through; Cancelled; BadArgument for a range
/// that is empty or a first picture without object.
[[nodiscard]] Result<std::vector<DetailSample>> sample_perceptual_metric(const SamplingOptions& options,
                                                                         const VisionModel& vision,
                                                                         const RenderAtDistance& render,
                                                                         const Context& context = {});

/// The same at given distances, ascending; the first is d1. For further sides at the distances of the first one.
[[nodiscard]] Result<std::vector<DetailSample>> sample_metric_at(const std::vector<double>& distances_m,
                                                                 const VisionModel& vision,
                                                                 const RenderAtDistance& render,
                                                                 const Context& context = {});

/// Several sides as one object: pixels of the same distances are added up. Precondition: at least one side, equal
/// distances.
[[nodiscard]] std::vector<DetailSample> pool_sides(const std::vector<std::vector<DetailSample>>& sides);

/// Equation 15: f(x) = a exp(b x) + c exp(d x), x in metres beyond d1. Falls: a, c >= 0 and b, d <= 0.
struct DetailFit {
  double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
  double r_square = 1.0;
  double rmse = 0.0;

  [[nodiscard]] double operator()(double x_m) const noexcept;
  /// Integral from 0 to x.
  [[nodiscard]] double integral(double x_m) const noexcept;
};

/// Least squares: the two factors linearly, the two rates by Nelder-Mead (NLopt) from several starts. `x` are metres
/// beyond the first sample. Needs at least four samples that are not all equal; a fit with R^2 below 0.95 carries a
/// warning.
[[nodiscard]] Result<DetailFit> fit_detail(const std::vector<DetailSample>& samples);

/// A plan of discrete levels. Level 0 serves up to d1; level i (1..) from `switch_m[i - 1]` (beyond d1) to the next.
struct SwitchPlan {
  std::string name;                      ///< "minimum redundancy", "equal 100 m", "exponential 2", ...
  std::vector<double> switch_m;          ///< metres beyond d1, ascending; the first is 0
  double redundancy = 0.0;               ///< equation 12 with TD_0 = 1
  double allowed_px = 0.5;               ///< deviation of each level on the screen at its distance; equation 17: half
  std::vector<Level> levels;             ///< of the model, if one was given
  std::vector<std::uint32_t> triangles;  ///< of each level, if a model was given
  double cost = 0.0;                     ///< equation 18, if a model was given
};

/// Equations 12 and 16: detail drawn but not seen, integrated over distance. `switch_m` as in SwitchPlan, `last_m`
/// beyond d1 too.
[[nodiscard]] double redundancy(const DetailFit& fit, const std::vector<double>& switch_m, double last_m);

/// The plan of `levels` levels (level 0 not counted, 1..16) with the least redundancy: Nelder-Mead with restarts. No
/// switch lies beyond `last_m`; one at `last_m` has nothing to gain.
[[nodiscard]] Result<SwitchPlan> design_switches(const DetailFit& fit, std::uint32_t levels, double last_m);

/// The same by dynamic programming over a fine grid: slower, and independent of any start; to check the other.
[[nodiscard]] SwitchPlan design_switches_by_grid(const DetailFit& fit, std::uint32_t levels, double last_m,
                                                 std::uint32_t grid = 1500);

/// Fewest levels after which one more would save less than `least_gain` of the redundancy that is left. A share of what
/// is left, because the second level alone saves nearly all of the first's; the default gives the paper's four.
[[nodiscard]] std::uint32_t choose_level_count(const DetailFit& fit, double last_m, double least_gain = 0.4);

/// Levels at equal distances, and at d1 * factor^i, as in Table 3; distances beyond d1.
[[nodiscard]] SwitchPlan equal_intervals(const DetailFit& fit, std::uint32_t levels, double interval_m, double last_m);
[[nodiscard]] SwitchPlan exponential_intervals(const DetailFit& fit, std::uint32_t levels, double factor,
                                               double first_m, double last_m);

/// Fills in levels, triangles and cost of a plan: each level is the coarsest of `model` that deviates by at most
/// `plan.allowed_px` at its distance. `last_m` is beyond d1.
void add_cost(SwitchPlan& plan, const ProgressiveModel& model, double first_m, double last_m, double focal_px);

/// The levels of a real model come in steps, which the fit does not know, and a switch may stand where there is next to
/// nothing coarser. One at a time, the switch that gains most goes to where it saves most of the cost, until no move
/// saves a hundredth; the first stays at d1. Costs and redundancy follow. Call after `add_cost`, with the same
/// distances.
void settle_switches(SwitchPlan& plan, const DetailFit& fit, const ProgressiveModel& model, double first_m,
                     double last_m, double focal_px);

/// Makes the levels of a plan as fine as `cost` allows: `plan.allowed_px`, between 0.001 and 64, becomes the least with
/// which it costs no more; what is left then refines the levels one by one, the farthest first.
void match_cost(SwitchPlan& plan, double cost, const ProgressiveModel& model, double first_m, double last_m,
                double focal_px);

/// The check of section 5.2 between a picture and another (its vision simulation, or a coarser level), over the object.
struct VisionCheck {
  double ssim = 1.0;              ///< structural similarity (Wang et al. 2004), mean over object pixels
  double noticeable_ratio = 0.0;  ///< share of object pixels that differ by more than a just noticeable difference
  Image difference;               ///< dark grey = equal, white = noticeable, black = not the object; one channel
};

/// The similarity is that of the pictures as `vision` has them. The share counts pixels where the pictures themselves
/// differ noticeably, after Daly 1993: in bands of an octave, the threshold is 2 % of the luminance around (at
/// least 1.5 of 255 values) over the sensitivity of the band, raised by the contrast that both pictures have there
/// already (exponent 0.7); bands are pooled by their fourth powers; a pixel whose own values are the same does not
/// count. Errors: BadArgument if sizes disagree or the mask is empty.
[[nodiscard]] Result<VisionCheck> check_vision(const Image& a, const Image& b, const std::vector<std::uint8_t>& mask,
                                               const VisionModel& vision);

/// The check of the vision model itself (Table 1 of the paper): structural similarity of a rendered picture and its
/// simulation as they are, and the share of object pixels whose loss an eye would notice.
[[nodiscard]] Result<VisionCheck> check_simulation(const ObjectPicture& picture, const VisionModel& vision);

/// Where the eye loses something (Figure 7): light grey = the same, the darker the more differs, white = not the
/// object.
[[nodiscard]] Result<Image> difference_map(const ObjectPicture& picture, const VisionModel& vision);

}  // namespace lodestone

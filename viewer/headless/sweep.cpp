// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>

#include <lodestone/metrics.h>
#include <lodestone/perception.h>

#include "stage.h"

namespace lodestone::render {
namespace {

constexpr double frame_step_s = 1.0 / 60.0;

// Wanted level at every frame, and the fixed levels on the same scale. Position 0 is the start, 1 the end; equal steps
// of position are equal factors of triangles, or of distance.
class Schedule {
 public:
  Schedule(const SweepOptions& options, const ProgressiveModel& model, const View& view)
      : frames_(options.frames),
        and_back_(options.and_back),
        model_(model),
        perceptual_(options.perceptual_m),
        plan_(options.plan) {
    if (perceptual_) {
      focal_px_ = focal_px(view);
      from_ = std::log(first_of(model, view));
      to_ = std::log(*options.perceptual_m);
    } else {
      const double source_triangles = model.info(model.record_count()).triangles;
      from_ = std::log(options.from_ratio * source_triangles);
      to_ = std::log(options.to_ratio * source_triangles);
    }
  }

  // Distance at which the model fills the picture.
  [[nodiscard]] static double first_of(const ProgressiveModel& model, const View& view) {
    return first_distance_m(0.5 * model.bounds().diagonal_m(), view.fov_y_rad);
  }

  [[nodiscard]] double position(std::uint32_t frame) const {
    const std::uint32_t leg = and_back_ ? (frames_ + 1) / 2 : frames_;
    if (leg < 2) return 0.0;
    const std::uint32_t step = frame < leg ? frame : frames_ - 1 - frame;
    return static_cast<double>(step) / (leg - 1);
  }
  [[nodiscard]] Level level_at(double position) const {
    const double wanted = std::exp(from_ + (to_ - from_) * position);
    if (plan_) return needed_level(*plan_, wanted * plan_->focal_px / focal_px_);
    if (perceptual_) return model_.level_of_error(imperceptible_error_m(wanted, focal_px_));
    return model_.level_of_triangles(static_cast<std::uint32_t>(std::lround(wanted)));
  }

 private:
  std::uint32_t frames_;
  bool and_back_;
  const ProgressiveModel& model_;
  bool perceptual_;
  const std::optional<LevelPlan>& plan_;
  double focal_px_ = 0.0;
  double from_ = 0.0;  // logarithms of triangles, or of metres
  double to_ = 0.0;
};

// Everything that the styles share: the stage, what is looked at, and the frame they draw into.
struct Set {
  Stage& stage;
  const ProgressiveModel& model;
  const Surfaces& surfaces;
  const Frame& frame;
  const View& view;
  const Look& look;

  void draw(const Geometry& geometry, const Frame& into) const {
    const Item item{.geometry = &geometry, .surfaces = &surfaces, .size_m = model.bounds().diagonal_m()};
    stage.renderer().draw(into, view, model.bounds(), {&item, 1}, look);
  }
};

// One way to show a level. draw() is timed, image() is not.
class Performer {
 public:
  virtual ~Performer() = default;
  virtual void draw(std::uint32_t frame) = 0;
  virtual Image image() = 0;
  [[nodiscard]] virtual std::size_t memory_bytes() const = 0;
};

class Continuous final : public Performer {
 public:
  Continuous(const Set& set, const Frame& second, std::shared_ptr<const ProgressiveModel> model,
             const Schedule& schedule, const SweepOptions& options)
      : set_(set),
        second_(second),
        schedule_(schedule),
        cursor_(model, {.motion = options.style == SweepStyle::Morph ? Motion::MorphFade : Motion::Hard,
                        .morph_seconds = options.morph_seconds,
                        .start_level = schedule.level_at(0.0)}),
        geometry_(set.stage.gl(), arrays_of(cursor_)) {
    cursor_.clear_dirty();
    if (cursor_.beside() != nullptr) beside_.emplace(set.stage.gl(), arrays_of(*cursor_.beside()));
  }

  void draw(std::uint32_t frame) override {
    cursor_.set_target(Target::level(schedule_.level_at(schedule_.position(frame))));
    if (frame > 0) cursor_.step({}, frame_step_s);
    geometry_.update(cursor_);
    set_.draw(geometry_, set_.frame);
    if (cursor_.fade() > 0.0F) {
      beside_->update(*cursor_.beside());
      set_.draw(*beside_, second_);
    }
  }
  Image image() override {
    if (cursor_.fade() <= 0.0F) return set_.stage.presenter().read(set_.frame);
    return set_.stage.presenter().read_blend(set_.frame, second_, static_cast<double>(cursor_.fade()));
  }
  [[nodiscard]] std::size_t memory_bytes() const override { return set_.model.memory_bytes() + cursor_.memory_bytes(); }

 private:
  const Set& set_;
  const Frame& second_;
  const Schedule& schedule_;
  Cursor cursor_;
  Geometry geometry_;
  std::optional<Geometry> beside_;
};

class Discrete final : public Performer {
 public:
  // `fade_frames` 1 = switch at once.
  Discrete(const Set& set, const Frame& second, const Schedule& schedule, std::uint32_t levels,
           std::uint32_t fade_frames)
      : set_(set), second_(second), schedule_(schedule), fade_frames_(fade_frames) {
    for (std::uint32_t i = 0; i < levels; ++i) {
      const double position = levels == 1 ? 0.0 : static_cast<double>(i) / (levels - 1);
      const Level level = schedule.level_at(position);
      auto& made = levels_.emplace_back(std::make_unique<Fixed>(set.model.extract(level)));
      made->geometry = std::make_unique<Geometry>(set.stage.gl(), made->sorted.arrays());
    }
  }

  void draw(std::uint32_t frame) override {
    const double place = schedule_.position(frame) * static_cast<double>(levels_.size() - 1);
    const auto wanted = static_cast<std::size_t>(std::lround(place));
    // A switch met while the one before still fades waits for it.
    if (wanted != to_ && faded_frames_ >= fade_frames_) {
      from_ = to_;
      to_ = wanted;
      faded_frames_ = 0;
    }
    faded_frames_ = std::min(faded_frames_ + 1, fade_frames_);
    set_.draw(*levels_[to_]->geometry, set_.frame);
    if (fading()) set_.draw(*levels_[from_]->geometry, second_);
  }
  Image image() override {
    if (!fading()) return set_.stage.presenter().read(set_.frame);
    const double old_share = 1.0 - static_cast<double>(faded_frames_) / fade_frames_;
    return set_.stage.presenter().read_blend(set_.frame, second_, old_share);
  }
  [[nodiscard]] std::size_t memory_bytes() const override {
    std::size_t sum = 0;
    for (const auto& level : levels_) sum += level->sorted.memory_bytes();
    return sum;
  }

 private:
  struct Fixed {
    explicit Fixed(Mesh m) : mesh(std::move(m)), sorted(mesh) {}
    Mesh mesh;
    SortedMesh sorted;
    std::unique_ptr<Geometry> geometry;
  };
  [[nodiscard]] bool fading() const { return faded_frames_ < fade_frames_ && from_ != to_; }

  const Set& set_;
  const Frame& second_;
  const Schedule& schedule_;
  std::vector<std::unique_ptr<Fixed>> levels_;
  std::size_t from_ = 0;
  std::size_t to_ = 0;
  std::uint32_t fade_frames_;
  std::uint32_t faded_frames_ = fade_frames_;
};

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size() - 1)))];
}

Result<SweepReport> perform(Performer& performer, Stage& stage, const SweepOptions& options, const Context& context) {
  SweepReport report{.frames = options.frames};
  std::vector<double> seconds;
  Image before;
  double pop_sum = 0.0;
  for (std::uint32_t frame = 0; frame < options.frames; ++frame) {
    if (context.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", ""};
    context.report("sweep", static_cast<double>(frame) / options.frames);
    const auto start = std::chrono::steady_clock::now();
    performer.draw(frame);
    stage.gl().finish();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    Image image = performer.image();
    if (frame > 0) {
      const double pop = block_pop(before, image);
      pop_sum += pop;
      if (pop > report.pop_max) {
        report.pop_max = pop;
        report.pop_max_frame = frame;
      }
    }
    if (options.on_frame) {
      if (auto status = options.on_frame(image, frame); !status) return status.error();
    }
    before = std::move(image);
  }
  if (options.frames > 1) report.pop_mean = pop_sum / (options.frames - 1);
  report.frame_seconds_p50 = percentile(seconds, 0.50);
  report.frame_seconds_p99 = percentile(seconds, 0.99);
  report.memory_bytes = performer.memory_bytes();
  return report;
}

Status check(const SweepOptions& options, const ProgressiveModel& model) {
  const auto refuse = [](const char* message) { return Error{ErrorCode::BadArgument, message, ""}; };
  const auto is_ratio = [](double r) { return r > 0.0 && r <= 1.0; };
  if (options.frames == 0) return refuse("a sweep needs at least one frame");
  if (!is_ratio(options.from_ratio) || !is_ratio(options.to_ratio)) {
    return refuse("a sweep goes between shares of the triangles above 0 and up to 1");
  }
  const bool fixed = options.style == SweepStyle::Discrete || options.style == SweepStyle::Fade;
  if (fixed && (options.discrete_levels < 1 || options.discrete_levels > 100)) {
    return refuse("discrete levels go from 1 to 100");
  }
  if (!(options.morph_seconds >= 0.0 && options.morph_seconds <= 10.0) ||
      !(options.fade_seconds >= 0.0 && options.fade_seconds <= 10.0)) {
    return refuse("morphing and fading take from 0 to 10 seconds");
  }
  if (model.face_slot_count() == 0) return refuse("the model has no triangles to show");
  if (!options.plan) return Done{};
  if (!options.perceptual_m) return refuse("a plan is swept by distance: say how far away the sweep ends");
  return check_level_plan(*options.plan, model);
}

}  // namespace

Result<SweepStyle> sweep_style(const std::string& name) {
  if (name == "morph") return SweepStyle::Morph;
  if (name == "hard") return SweepStyle::Hard;
  if (name == "discrete") return SweepStyle::Discrete;
  if (name == "fade") return SweepStyle::Fade;
  return Error{ErrorCode::BadArgument, "unknown style '" + name + "', use morph, hard, discrete or fade", ""};
}

Result<SweepReport> sweep(std::shared_ptr<const ProgressiveModel> model, const SweepOptions& options,
                          const Context& context) {
  if (auto status = check(options, *model); !status) return status.error();
  const Cursor finest{model, {.motion = Motion::Hard, .start_level = model->record_count()}};
  const auto view = view_of(options.render, model->bounds(), model->data().origin, arrays_of(finest));
  if (!view) return view.error();
  auto stage = Stage::create();
  if (!stage) return stage.error();
  const Gl& gl = (*stage)->gl();
  const auto frame = Frame::create(gl, frame_size(options.render));
  if (!frame) return frame.error();
  const Surfaces surfaces{gl, model->data()};
  const Set set{**stage, *model, surfaces, *frame, *view, options.render.look};
  if (options.perceptual_m && !(*options.perceptual_m > Schedule::first_of(*model, *view))) {
    return Error{ErrorCode::BadArgument, "the sweep must end farther away than where the model fills the picture", ""};
  }
  const Schedule schedule{options, *model, *view};

  Result<SweepReport> report = Error{};
  const auto second = Frame::create(gl, frame_size(options.render));
  if (!second) return second.error();
  if (options.style == SweepStyle::Morph || options.style == SweepStyle::Hard) {
    Continuous performer{set, *second, model, schedule, options};
    report = perform(performer, **stage, options, context);
  } else {
    const double fade_s = options.style == SweepStyle::Fade ? options.fade_seconds : 0.0;
    const auto fade_frames = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(std::lround(fade_s / frame_step_s)));
    Discrete performer{set, *second, schedule, options.discrete_levels, fade_frames};
    report = perform(performer, **stage, options, context);
  }
  if (report) report.warnings() = surfaces.warnings();
  return report;
}

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
#include <lodestone/formats.h>

#include <cstdio>

#include "camera_options.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Sweep final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "sweep"; }
  [[nodiscard]] std::string summary() const override {
    return "Move a model's level under a fixed camera and measure popping";
  }
  [[nodiscard]] std::string example() const override {
    return "lodestone sweep house.lode --frames 60 --from 1 --to 0.02 --morph-seconds 0.5 --size 320x240 --video "
           "house.gif";
  }
  void declare(Arguments& arguments) override;
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] Result<render::SweepOptions> options() const;
  [[nodiscard]] Status keep_frame(const Image& image, std::uint32_t frame, GifWriter* video) const;

  std::filesystem::path model_;
  std::filesystem::path folder_;
  std::filesystem::path video_;
  std::string style_ = "morph";
  std::uint32_t frames_ = 600;
  std::uint32_t levels_ = 5;
  double from_ = 1.0;
  double to_ = 0.02;
  double morph_s_ = render::SweepOptions{}.morph_seconds;
  bool and_back_ = false;
  std::optional<double> perceptual_m_;
  std::filesystem::path plan_;
  CameraOptions camera_{{960, 540}};
};

void Sweep::declare(Arguments& arguments) {
  arguments.file("MODEL", model_, "Progressive model (.lode)", Need::Required);
  arguments.count("--frames", frames_, 2, 100'000, "Frames, 1/60 s apart");
  arguments.number("--from", from_, 0.0, 1.0, "Share of the triangles at the start");
  arguments.number("--to", to_, 0.0, 1.0, "Share of the triangles at the end");
  arguments.length_m("--perceptual", perceptual_m_,
                     "Instead of shares: the levels that an eye needs from near to so far away");
  arguments.file("--plan", plan_, "With --perceptual: the levels that a plan made by 'distances' has measured",
                 Need::Optional);
  arguments.flag("--and-back", and_back_, "Half of the frames there, half back");
  arguments.choice("--style", style_, {"morph", "hard", "discrete", "fade"}, "How levels follow each other");
  arguments.count("--levels", levels_, 2, 100, "Fixed levels of discrete and fade");
  arguments.number(
      "--morph-seconds", morph_s_, 0.0, 10.0,
      "Time that one record glides in style morph; at most half of the way's, or what is seen lags behind");
  arguments.file("-o,--output", folder_, "Folder that keeps the frames as PNG", Need::Optional);
  arguments.file("--video", video_, "Animated GIF to write", Need::Optional);
  camera_.declare(arguments);
}

Result<render::SweepOptions> Sweep::options() const {
  const auto style = render::sweep_style(style_);
  if (!style) return style.error();
  render::SweepOptions options{.frames = frames_,
                               .from_ratio = from_,
                               .to_ratio = to_,
                               .and_back = and_back_,
                               .perceptual_m = perceptual_m_,
                               .style = *style,
                               .discrete_levels = levels_,
                               .morph_seconds = morph_s_};
  if (!plan_.empty()) {
    auto plan = read_level_plan(plan_);
    if (!plan) return plan.error();
    options.plan = std::move(*plan);
  }
  camera_.apply(options.render);
  return options;
}

Status Sweep::keep_frame(const Image& image, std::uint32_t frame, GifWriter* video) const {
  if (video != nullptr) {
    if (Status added = video->add(image); !added) return added;
  }
  if (folder_.empty()) return Done{};
  char name[32];
  std::snprintf(name, sizeof name, "frame_%05u.png", frame);
  return write_image(image, folder_ / name);
}

Status Sweep::run(Session& session) {
  if (!video_.empty() && video_.extension() != ".gif") {
    return Error{ErrorCode::BadArgument, "films are written as .gif", video_.string()};
  }
  auto options = this->options();
  if (!options) return options.error();
  auto model = read_model(model_, {}, session.context());
  session.keep(model);
  if (!model) return model.error();
  if (!folder_.empty()) {
    std::error_code fault;
    std::filesystem::create_directories(folder_, fault);
    if (fault) return Error{ErrorCode::Unreadable, "the folder cannot be made: " + fault.message(), folder_.string()};
  }
  std::optional<GifWriter> video;
  if (!video_.empty()) {
    // Browsers show at most 50 frames a second of a GIF; the sweep's own rate is 60.
    auto created = GifWriter::create(video_, 0.02);
    if (!created) return created.error();
    video.emplace(std::move(*created));
  }
  options->on_frame = [&](const Image& image, std::uint32_t frame) {
    return keep_frame(image, frame, video ? &*video : nullptr);
  };
  // At the rate of 60 frames a second that the verb promises.
  const double way_s = frames_ / (and_back_ ? 120.0 : 60.0);
  if (style_ == "morph" && morph_s_ > way_s / 2.0) {
    char line[160];
    std::snprintf(
        line, sizeof line,
        "a record glides for %.3g s and the way takes %.3g s: what is seen lags behind; take more --frames or "
        "fewer --morph-seconds",
        morph_s_, way_s);
    session.remark(line);
  }
  auto swept = render::sweep(*model, *options, session.context());
  session.keep(swept);
  if (!swept) {
    Error error = swept.error();
    if (error.where.empty()) error.where = model_.string();
    return error;
  }
  Report& report = session.report();
  report.set("style", style_);
  report.set("frames", swept->frames);
  report.set("pop_max", swept->pop_max);
  report.set("pop_mean", swept->pop_mean);
  report.set("pop_max_frame", swept->pop_max_frame);
  report.set("frame_seconds_p50", swept->frame_seconds_p50);
  report.set("frame_seconds_p99", swept->frame_seconds_p99);
  report.set("memory_bytes", std::uint64_t{swept->memory_bytes});
  return video ? video->finish() : Status{Done{}};
}

}  // namespace

std::unique_ptr<Verb> make_sweep() { return std::make_unique<Sweep>(); }

}  // namespace lodestone::cli

// SPDX-License-Identifier: MIT
#include <lodestone/discrete_levels.h>
#include <lodestone/formats.h>

#include <cstdio>
#include <sstream>

#include "distance_plots.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

using render::SwitchStudy;

class Distances final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "distances"; }
  [[nodiscard]] std::string summary() const override {
    return "Say at which distances discrete levels should switch, from what the eye can see";
  }
  [[nodiscard]] std::string example() const override {
    return "lodestone distances house.lode --levels 4 --samples 40 --screen 640x512 -o house_levels";
  }
  void declare(Arguments& arguments) override;
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] Result<render::StudyOptions> options() const;
  [[nodiscard]] Status write(const SwitchStudy& study, const ProgressiveModel& model) const;

  std::filesystem::path model_;
  std::filesystem::path folder_;
  std::string levels_ = "auto";
  std::string sides_ = "front";
  std::string sampling_ = "equal";
  std::uint32_t samples_ = render::StudyOptions{}.samples;
  std::uint32_t supersample_ = 1;
  PictureSize screen_{Display{}.width_px, Display{}.height_px};
  double dots_per_inch_ = Display{}.dots_per_inch;
  double fov_deg_ = 33.33;
  std::optional<double> viewing_distance_m_;
};

void Distances::declare(Arguments& arguments) {
  arguments.file("MODEL", model_, "Progressive model (.lode)", Need::Required);
  arguments.file("-o,--output", folder_, "Folder for plan.json and the plots", Need::Optional);
  arguments.word("--levels", levels_, "N|auto", "Levels beyond the first distance, 1 to 16; auto = by marginal gain");
  arguments.word("--sides", sides_, "LIST",
                 "What is looked at: front, back, left, right, all, or degrees clockwise from north, with commas");
  arguments.picture_size("--screen", screen_, "The screen in pixels");
  arguments.number("--dpi", dots_per_inch_, 1.0, 10'000.0, "Its dots per inch");
  arguments.length_m("--viewing-distance", viewing_distance_m_, "From the eye to the screen, 0.5 m if not given");
  arguments.number("--fov", fov_deg_, 1.0, 170.0, "Vertical field of view of the camera in degrees");
  arguments.count("--samples", samples_, 4, 100'000, "Distances at which the metric is measured");
  arguments.choice("--sampling", sampling_, {"equal", "adaptive"}, "Steps between them");
  arguments.count("--supersample", supersample_, 1, 4, "Samples per pixel and axis, 1 = off");
}

Result<render::StudyOptions> Distances::options() const {
  render::StudyOptions options;
  options.display.width_px = screen_.width_px;
  options.display.height_px = screen_.height_px;
  options.display.dots_per_inch = dots_per_inch_;
  options.display.fov_y_rad = glm::radians(fov_deg_);
  if (viewing_distance_m_) options.display.viewing_distance_m = *viewing_distance_m_;
  options.samples = samples_;
  options.supersample = supersample_;
  if (!folder_.empty()) options.needed_levels = 16;  // for plan.json
  if (sampling_ == "adaptive") options.sampling = Sampling::Adaptive;
  options.sides.clear();
  std::istringstream words{sides_};
  for (std::string side; std::getline(words, side, ',');) options.sides.push_back(side);
  if (levels_ != "auto") {
    const auto count = parse_count(levels_);
    if (!count || *count < 1 || *count > 16) {
      return Error{ErrorCode::BadArgument, "--levels takes 1 to 16 or auto, not '" + levels_ + "'", ""};
    }
    options.levels = static_cast<std::uint32_t>(*count);
  }
  return options;
}

std::vector<double> from_camera(const SwitchPlan& plan, double first_m) {
  std::vector<double> distances_m;
  for (const double beyond_m : plan.switch_m) distances_m.push_back(first_m + beyond_m);
  return distances_m;
}

void put(Report& report, const SwitchPlan& plan, double first_m) {
  report.set("switch_m", from_camera(plan, first_m));
  report.set("redundancy", plan.redundancy);
  report.set("triangles", plan.triangles);
  report.set("cost", plan.cost);
}

void put(Report& report, const render::PlanCheck& check) {
  std::vector<double> noticeable;
  std::vector<double> ssim;
  for (const render::LevelCheck& level : check.levels) {
    noticeable.push_back(level.noticeable_ratio);
    ssim.push_back(level.ssim);
  }
  report.set("noticeable_ratio", noticeable);
  report.set("ssim", ssim);
}

void put(Report& report, const DetailFit& fit) {
  report.set("a", fit.a);
  report.set("b", fit.b);
  report.set("c", fit.c);
  report.set("d", fit.d);
  report.set("r_square", fit.r_square);
  report.set("rmse", fit.rmse);
}

void add_plan(Report& report, const std::string& key, const SwitchPlan& plan, double first_m,
              const render::PlanCheck* check) {
  Report object;
  object.set("name", plan.name);
  put(object, plan, first_m);
  object.set("allowed_px", plan.allowed_px);
  if (check != nullptr) put(object, *check);
  report.add(key, object);
}

void put_sides(Report& report, const SwitchStudy& study) {
  for (const render::SideStudy& side : study.sides) {
    Report object;
    object.set("name", side.side.name);
    object.set("azimuth_deg", glm::degrees(side.side.azimuth_rad));
    Report fit;
    put(fit, side.fit);
    object.set("fit", fit);
    put(object, side.design, study.first_m);
    report.add("sides", object);
  }
}

void put(Report& report, const SwitchStudy& study) {
  Report fit;
  put(fit, study.fit);
  report.set("first_m", study.first_m);
  report.set("last_m", study.last_m);
  report.set("fit", fit);
  put(report, study.measured, study.first_m);  // what plan.json holds
  put(report, study.measured_check);
  Report design;
  put(design, study.design, study.first_m);
  report.set("design", design);
  Report settled;
  put(settled, study.plan, study.first_m);
  put(settled, study.plan_check);
  report.set("settled", settled);
  for (const SwitchPlan& plan : study.alternatives) add_plan(report, "alternatives", plan, study.first_m, nullptr);
  for (std::size_t i = 0; i < study.same_cost.size(); ++i) {
    add_plan(report, "same_cost", study.same_cost[i], study.first_m, &study.same_cost_checks[i]);
  }
  Report vision;
  vision.set("ssim", study.vision.ssim);
  vision.set("noticeable_ratio", study.vision.noticeable_ratio);
  report.set("vision", vision);
  put_sides(report, study);
  for (const render::NeededCheck& needed : study.needed) {
    Report object;
    object.set("distance_m", needed.check.distance_m);
    object.set("level", needed.level);
    object.set("triangles", needed.triangles);
    object.set("noticeable_ratio", needed.check.noticeable_ratio);
    report.add("needed", object);
  }
}

void put(Report& report, const Display& display) {
  Report screen;
  screen.set("width_px", display.width_px);
  screen.set("height_px", display.height_px);
  screen.set("dots_per_inch", display.dots_per_inch);
  screen.set("viewing_distance_m", display.viewing_distance_m);
  screen.set("fov_deg", glm::degrees(display.fov_y_rad));
  screen.set("luminance_cd_m2", display.luminance_cd_m2);
  screen.set("focal_px", focal_length_px(display));
  screen.set("max_frequency_cpd", max_frequency_cpd(display));
  report.set("display", screen);
}

std::string row(const std::string& name, const std::vector<std::string>& cells) {
  char text[64];
  std::snprintf(text, sizeof text, "%-30s", name.c_str());
  std::string line = text;
  for (const std::string& cell : cells) {
    std::snprintf(text, sizeof text, " %13s", cell.c_str());
    line += text;
  }
  return line + "\n";
}

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string plan_row(const SwitchPlan& plan, double first_m) {
  std::vector<std::string> cells{number("%.4g", plan.redundancy), number("%.5g", plan.cost)};
  for (std::size_t i = 0; i < plan.switch_m.size(); ++i) {
    cells.push_back(number("%.1f", first_m + plan.switch_m[i]) + ":" + std::to_string(plan.triangles[i]));
  }
  return row(plan.name, cells);
}

std::string check_row(const std::string& name, const SwitchPlan& plan, const render::PlanCheck& check) {
  std::vector<std::string> cells{"", number("%.5g", plan.cost)};
  for (const render::LevelCheck& level : check.levels) {
    cells.push_back(number("%.2f %%", 100.0 * level.noticeable_ratio));
  }
  return row(name, cells);
}

std::string fit_line(const DetailFit& fit) {
  char text[160];
  std::snprintf(text, sizeof text,
                "\nseen: %.4g exp(%.4g x) + %.4g exp(%.4g x) at x m beyond the first distance; R^2 %.4f, RMSE %.2g\n",
                fit.a, fit.b, fit.c, fit.d, fit.r_square, fit.rmse);
  return text;
}

// The fit, Tables 3 to 5 of the paper in one, then what an eye would notice at each switch. What is written comes
// first: the only plan that is sure to hold 99 % of the pixels below a just noticeable difference.
std::string table(const SwitchStudy& study) {
  std::string lines = fit_line(study.fit) + "\n" + row("plan", {"redundancy", "cost", "distance in m : triangles"});
  lines += plan_row(study.measured, study.first_m);
  if (study.plan.switch_m != study.design.switch_m) lines += plan_row(study.plan, study.first_m);
  lines += plan_row(study.design, study.first_m);
  for (const SwitchPlan& plan : study.alternatives) lines += plan_row(plan, study.first_m);
  lines += "\n" + row("noticeably different pixels", {"", "cost"});
  lines += check_row(study.measured.name, study.measured, study.measured_check);
  lines += check_row(study.plan.name, study.plan, study.plan_check);
  for (std::size_t i = 0; i < study.same_cost.size(); ++i) {
    lines += check_row(study.same_cost[i].name + ", cost of measured", study.same_cost[i], study.same_cost_checks[i]);
  }
  if (study.sides.size() > 1) {
    lines += "\n" + row("side", {"redundancy", "cost", "distance in m : triangles"});
    for (const render::SideStudy& side : study.sides) {
      SwitchPlan named = side.design;
      named.name = side.side.name;
      lines += plan_row(named, study.first_m);
    }
  }
  return lines;
}

Status Distances::write(const SwitchStudy& study, const ProgressiveModel& model) const {
  std::error_code fault;
  std::filesystem::create_directories(folder_, fault);
  if (fault) return Error{ErrorCode::Unreadable, "the folder cannot be made: " + fault.message(), folder_.string()};
  const SwitchPlan& plan = study.measured;
  LevelPlan file{.levels = {{0.0, model.record_count(), model.triangle_count(), 0.0}},
                 .last_m = study.last_m,
                 .radius_m = study.bounds.radius_m,
                 .focal_px = study.focal_px,
                 .height_px = double(screen_.height_px),
                 .width_px = double(screen_.width_px)};
  for (const render::NeededCheck& needed : study.needed) {
    file.needed.push_back({needed.check.distance_m, needed.level});
  }
  for (std::size_t i = 0; i < plan.levels.size(); ++i) {
    if (plan.levels[i] == file.levels.back().level) continue;  // nothing to switch to
    file.levels.push_back(
        {study.first_m + plan.switch_m[i], plan.levels[i], plan.triangles[i], model.error_m(plan.levels[i])});
  }
  if (Status written = write_level_plan(file, folder_ / "plan.json"); !written) return written;
  return write_distance_plots(study, model, folder_);
}

Status Distances::run(Session& session) {
  const auto options = this->options();
  if (!options) return options.error();
  auto model = read_model(model_, {}, session.context());
  session.keep(model);
  if (!model) return model.error();
  auto study = render::study_switch_distances(*model, *options, session.context());
  session.keep(study);
  if (!study) {
    Error error = study.error();
    error.where = model_.string();
    return error;
  }
  session.remark(supersample_ == 1 ? "supersampling: off" : "supersampling: " + std::to_string(supersample_));
  session.report().set("supersample", supersample_);
  put(session.report(), options->display);
  put(session.report(), *study);
  session.report().show(table(*study));
  return folder_.empty() ? Status{Done{}} : write(*study, **model);
}

}  // namespace

std::unique_ptr<Verb> make_distances() { return std::make_unique<Distances>(); }

}  // namespace lodestone::cli

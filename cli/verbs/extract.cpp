// SPDX-License-Identifier: MIT
#include <lodestone/discrete_levels.h>
#include <lodestone/formats.h>

#include <limits>

#include "level_choice.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Extract final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "extract"; }
  [[nodiscard]] std::string summary() const override {
    return "Write one level of a model as a mesh, or the levels of a plan";
  }
  [[nodiscard]] std::string example() const override {
    return "lodestone extract house.lode --ratio 0.1 -o house_10.glb";
  }
  void declare(Arguments& arguments) override {
    arguments.file("MODEL", model_, "Progressive model (.lode)", Need::Required);
    arguments.file("-o,--output", output_, "File to write: .obj, .ply or .glb; with --plan alone a folder",
                   Need::Required);
    level_.declare(arguments);
    arguments.file(
        "--plan", plan_,
        "All levels of a plan made by 'distances': GLB, MSFT_lod, 3D Tiles; with --perceptual the one it needs",
        Need::Optional);
    arguments.bytes("--bytes", bytes_, "Use only the first so many bytes of the file");
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] Status write_plan(const ProgressiveModel& model, Session& session) const;

  std::filesystem::path model_;
  std::filesystem::path output_;
  std::filesystem::path plan_;
  LevelChoice level_;
  std::uint64_t bytes_ = std::numeric_limits<std::uint64_t>::max();
};

Status Extract::run(Session& session) {
  const bool all_of_plan = !plan_.empty() && !level_.is_perceptual();
  if (level_.ways() + int{all_of_plan} != 1) {
    return Error{ErrorCode::BadArgument,
                 "extract needs exactly one of --triangles, --ratio, --error, --level, --perceptual (which may have a "
                 "--plan) and --plan",
                 ""};
  }
  if (bytes_ == 0) return Error{ErrorCode::BadArgument, "--bytes: no model is in no bytes", ""};
  auto model = read_model(model_, {.max_bytes = bytes_}, session.context());
  session.keep(model);
  if (!model) return model.error();
  if (all_of_plan) return write_plan(**model, session);
  const auto level = level_.in(**model, plan_);
  if (!level) return level.error();
  const Mesh mesh = (*model)->extract(*level);
  Report& report = session.report();
  report.set("level", *level);
  report.set("triangles", mesh.triangle_count());
  report.set("vertices", mesh.vertex_count());
  report.set("error_m", (*model)->error_m(*level));
  return write_mesh(mesh, output_, session.context());
}

Status Extract::write_plan(const ProgressiveModel& model, Session& session) const {
  const auto plan = read_level_plan(plan_);
  if (!plan) return plan.error();
  for (const PlannedLevel& planned : plan->levels) {
    Report level;
    level.set("from_m", planned.from_m);
    level.set("level", planned.level);
    level.set("triangles", planned.triangles);
    level.set("error_m", planned.error_m);
    session.report().add("levels", level);
  }
  return write_levels(model, *plan, output_, session.context());
}

}  // namespace

std::unique_ptr<Verb> make_extract() { return std::make_unique<Extract>(); }

}  // namespace lodestone::cli

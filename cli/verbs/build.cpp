// SPDX-License-Identifier: MIT
#include <lodestone/auto_build.h>

#include <chrono>

#include <lodestone/texture_colors.h>

#include "facet_report.h"
#include "mesh_input.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Build final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "build"; }
  [[nodiscard]] std::string summary() const override { return "Make a progressive model of a mesh"; }
  [[nodiscard]] std::string example() const override { return "lodestone build house.obj -o house.lode"; }
  void declare(Arguments& arguments) override;
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] EdgeCollapseOptions options() const;
  [[nodiscard]] FacetShiftOptions shift_options(const Mesh& source) const;
  [[nodiscard]] Result<std::shared_ptr<const ProgressiveModel>> build(const Mesh& source, Session& session) const;

  MeshInput input_;
  PlaneTolerance tolerance_;
  std::filesystem::path output_;
  std::string method_ = "auto";
  std::string placement_ = "optimal";
  std::string interior_ = "keep";
  std::string order_ = "one-by-one";
  std::string attributes_ = "all";
  bool lock_borders_ = false;
  bool reference_textures_ = false;
  std::uint32_t target_triangles_ = 0;
  std::optional<double> max_error_m_;
  std::optional<double> weld_m_;
  std::uint32_t quantize_bits_ = 0;
};

void Build::declare(Arguments& arguments) {
  input_.declare(arguments, "FILE", "Mesh to build from");
  arguments.file("-o,--output", output_, "Model to write (.lode)", Need::Required);
  arguments.choice("--method", method_, {"auto", "edge-collapse", "facet-shift"}, "How levels are made");
  arguments.choice("--placement", placement_, {"optimal", "on-edge", "midpoint", "end-point", "subset"},
                   "Where merged vertices go; subset plays back fastest");
  arguments.choice("--attributes", attributes_, {"all", "none"}, "Whether uv, normals and colours steer");
  arguments.flag("--lock-borders", lock_borders_, "Border vertices never move");
  arguments.count("--target-triangles", target_triangles_, 0, none,
                  "Stop at so many triangles, 0 = as few as possible");
  arguments.length_m("--max-error", max_error_m_, "Stop before the error exceeds this");
  tolerance_.declare(arguments);
  arguments.length_m("--weld", weld_m_, "Facet shift: points nearer than this are one, only equal ones if not given");
  arguments.choice("--interior", interior_, {"keep", "drop-first"},
                   "Whether what cannot be seen from outside goes first");
  arguments.choice("--order", order_, {"one-by-one", "together"}, "Windows of a facade coarsen so");
  arguments.count("--quantize", quantize_bits_, 0, 20, "Bits per coordinate in the file, 0 = lossless");
  arguments.flag("--reference-textures", reference_textures_, "Refer to texture files instead of embedding them");
}

EdgeCollapseOptions Build::options() const {
  EdgeCollapseOptions options{.target_triangles = target_triangles_};
  if (placement_ == "on-edge") options.placement = Placement::OnEdge;
  if (placement_ == "midpoint") options.placement = Placement::Midpoint;
  if (placement_ == "end-point") options.placement = Placement::EndPoint;
  if (placement_ == "subset") options.placement = Placement::Subset;
  if (attributes_ == "none") options.attributes = Attributes::None;
  if (lock_borders_) options.borders = Borders::Lock;
  if (max_error_m_) options.max_error_m = *max_error_m_;
  return options;
}

FacetShiftOptions Build::shift_options(const Mesh& source) const {
  FacetShiftOptions options{.tolerance = tolerance_.value(),
                            .texture_colors = mean_texture_colors(source),
                            .target_triangles = target_triangles_};
  if (weld_m_) options.weld_tolerance_m = *weld_m_;
  if (interior_ == "drop-first") options.interior = Interior::DropFirst;
  if (order_ == "together") options.order = ShiftOrder::Together;
  if (max_error_m_) options.max_error_m = *max_error_m_;
  return options;
}

Result<std::shared_ptr<const ProgressiveModel>> Build::build(const Mesh& source, Session& session) const {
  // The model, and why it is above the target if it is.
  const auto keep = [&](auto& built, const auto& sentence) -> Result<std::shared_ptr<const ProgressiveModel>> {
    session.keep(built);
    if (!built) return built.error();
    if (target_triangles_ > 0 && built->model->info(0).triangles > target_triangles_) {
      session.keep({Warning{sentence(), input_.file().string()}});
    }
    return built->model;
  };
  if (method_ == "facet-shift") {
    auto built = build_by_facet_shift(source, shift_options(source), session.context());
    if (built) report_shifts(built->report, session.report());
    return keep(built, [&] { return built->report.sentence; });
  }
  if (method_ == "edge-collapse") {
    auto built = build_by_edge_collapse(source, options(), session.context());
    return keep(built, [&] { return built->report.sentence; });
  }
  auto built = build_automatically(source, {.facet_shift = shift_options(source), .edge_collapse = options()},
                                   session.context());
  if (built) {
    session.remark("method: " + built->reason);
    if (built->facet_shift) report_shifts(*built->facet_shift, session.report());
  }
  return keep(built, [&] {
    if (!built->edge_collapse) return built->facet_shift->sentence;
    return built->edge_collapse->sentence;
  });
}

Status Build::run(Session& session) {
  // A slip such as `-o house.obj` must not put the model in the place of its source.
  if (output_.extension() != ".lode") {
    return Error{ErrorCode::BadArgument, "models are written as .lode", output_.string()};
  }
  if (auto writable = check_output(output_); !writable) return writable;
  auto loaded = input_.read(session);
  if (!loaded) return loaded.error();
  const Mesh source = std::move(loaded->mesh);

  const auto start = std::chrono::steady_clock::now();
  const auto built = build(source, session);
  const double build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!built) return built.error();
  const ProgressiveModel& model = **built;
  auto bytes = write_model(model, output_, {.quantize_bits = quantize_bits_, .embed_textures = !reference_textures_},
                           session.context());
  session.keep(bytes);
  if (!bytes) return bytes.error();

  const LevelInfo base = model.info(0);
  Report& report = session.report();
  report.set("method", model.data().method);
  report.set("triangles", source.triangle_count());
  report.set("vertices", source.vertex_count());
  report.set("records", model.record_count());
  report.set("base_triangles", base.triangles);
  report.set("base_error_m", base.error_m);
  report.set("file_bytes", *bytes);
  report.set("build_seconds", build_seconds);
  report.set("triangles_per_second", source.triangle_count() / build_seconds);
  for (const NamedLevel& named : model.data().named_levels) {
    const LevelInfo info = model.info(named.level);
    Report level;
    level.set("name", named.name);
    level.set("level", info.level);
    level.set("triangles", info.triangles);
    level.set("error_m", info.error_m);
    report.add("named_levels", level);
  }
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_build() { return std::make_unique<Build>(); }

}  // namespace lodestone::cli

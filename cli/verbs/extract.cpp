// SPDX-License-Identifier: MIT
#include <lodestone/formats.h>

#include "level_choice.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Extract final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "extract"; }
  [[nodiscard]] std::string summary() const override { return "Write one level of a model as a mesh"; }
  [[nodiscard]] std::string example() const override {
    return "lodestone extract house.lode --ratio 0.1 -o house_10.glb";
  }
  void declare(Arguments& arguments) override {
    arguments.file("MODEL", model_, "Progressive model (.lode)", Need::Required);
    arguments.file("-o,--output", output_, "File to write: .obj, .ply or .glb", Need::Required);
    level_.declare(arguments);
    arguments.bytes("--bytes", bytes_, "Use only the first so many bytes of the file");
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  std::filesystem::path model_;
  std::filesystem::path output_;
  LevelChoice level_;
  std::uint64_t bytes_ = 0;
};

Status Extract::run(Session& session) {
  if (level_.ways() != 1) {
    return Error{ErrorCode::BadArgument, "extract needs exactly one of --triangles, --ratio, --error and --level", ""};
  }
  auto model = read_model(model_, {.max_bytes = bytes_}, session.context());
  session.keep(model);
  if (!model) return model.error();
  const auto level = level_.in(**model);
  if (!level) return level.error();
  const Mesh mesh = (*model)->extract(*level);
  Report& report = session.report();
  report.set("level", *level);
  report.set("triangles", mesh.triangle_count());
  report.set("vertices", mesh.vertex_count());
  report.set("error_m", (*model)->error_m(*level));
  return write_mesh(mesh, output_, session.context());
}

}  // namespace

std::unique_ptr<Verb> make_extract() { return std::make_unique<Extract>(); }

}  // namespace lodestone::cli

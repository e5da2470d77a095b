// SPDX-License-Identifier: MIT
#include <lodestone/formats.h>
#include <lodestone/metrics.h>

#include "verbs.h"
#include "viewer/headless/headless.h"

namespace lodestone::cli {
namespace {

class Compare final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "compare"; }
  [[nodiscard]] std::string summary() const override { return "Tell how far two meshes are apart"; }
  [[nodiscard]] std::string example() const override { return "lodestone compare house.obj house_10.glb --images"; }
  void declare(Arguments& arguments) override {
    arguments.file("A", a_, "Mesh or .lode file, the source", Need::Required);
    arguments.file("B", b_, "Mesh or .lode file", Need::Required);
    arguments.count("--samples", options_.samples, 1, 1'000'000'000,
                    "Random samples on each side, besides all vertices");
    arguments.seed("--seed", options_.seed, "Another seed takes other samples");
    arguments.flag("--images", images_, "Compare pictures from six directions too");
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] Result<LoadedMesh> read(Session& session, const std::filesystem::path& file) const;

  std::filesystem::path a_, b_;
  DistanceOptions options_;
  bool images_ = false;
};

Result<LoadedMesh> Compare::read(Session& session, const std::filesystem::path& file) const {
  const LoadTextures textures = images_ ? LoadTextures::Encoded : LoadTextures::Reference;
  auto loaded = read_mesh(file, {.textures = textures}, session.context());
  session.keep(loaded);
  return loaded;
}

Status Compare::run(Session& session) {
  const auto a = read(session, a_);
  if (!a) return a.error();
  const auto b = read(session, b_);
  if (!b) return b.error();
  auto distance = lodestone::compare(a->mesh, b->mesh, options_, session.context());
  session.keep(distance);
  if (!distance) return distance.error();
  Report& report = session.report();
  report.set("hausdorff_m", distance->hausdorff_m);
  report.set("mean_m", distance->mean_m);
  report.set("rms_m", distance->rms_m);
  report.set("p999_m", distance->p999_m);
  report.set("diagonal_m", distance->diagonal_m);
  // Of the RMS, which is what simplifiers are compared by.
  report.set("ratio_to_diagonal", distance->rms_m / distance->diagonal_m);
  report.set("normal_deviation_deg", glm::degrees(distance->normal_deviation_rad));
  report.set_null("image_rms");
  if (images_) {
    auto image_rms = render::six_direction_rms(a->mesh, b->mesh);
    session.keep(image_rms);
    if (!image_rms) return image_rms.error();
    report.set("image_rms", *image_rms);
  }
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_compare() { return std::make_unique<Compare>(); }

}  // namespace lodestone::cli

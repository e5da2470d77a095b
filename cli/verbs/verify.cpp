// SPDX-License-Identifier: MIT
#include "mesh_input.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Verify final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "verify"; }
  [[nodiscard]] std::string summary() const override { return "Sweep a whole model and check every invariant"; }
  [[nodiscard]] std::string example() const override { return "lodestone verify house.lode --source house.obj"; }
  void declare(Arguments& arguments) override {
    arguments.file("MODEL", model_, "Progressive model (.lode)", Need::Required);
    source_.declare(arguments, "--source", "Mesh that the finest level must equal", Need::Optional);
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] std::string why(const std::string& difference) const;

  std::filesystem::path model_;
  MeshInput source_;
};

// A file that was quantised cannot be its source to the bit, and nothing is broken.
std::string Verify::why(const std::string& difference) const {
  const auto bits = quantize_bits_of(model_);
  if (!bits || *bits == 0) return difference;
  return "it was quantised to " + std::to_string(*bits) +
         " bits, build it without --quantize to keep the source exactly, or see how far it is with `lodestone compare`";
}

Status Verify::run(Session& session) {
  auto model = read_model(model_, {}, session.context());
  session.keep(model);
  if (!model) return model.error();
  const ModelReport found = validate(**model);
  Report& report = session.report();
  report.set("records", found.records);
  report.set("exact", found.exact);
  report.set("monotone", found.monotone);
  report.set("in_use_consistent", found.in_use_consistent);
  std::string fault = found.fault;
  if (!source_.given()) {
    report.set_null("source_matches");
  } else {
    const auto source = source_.read(session, LoadTextures::Reference);
    if (!source) return source.error();
    const std::string difference = compare_with_source(**model, source->mesh);
    report.set("source_matches", difference.empty());
    if (fault.empty() && !difference.empty()) fault = "differs from the source: " + why(difference);
  }
  if (!fault.empty()) return Error{ErrorCode::BadData, fault, model_.string()};
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_verify() { return std::make_unique<Verify>(); }

}  // namespace lodestone::cli

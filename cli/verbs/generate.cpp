// SPDX-License-Identifier: MIT
#include <lodestone/formats.h>
#include <lodestone/generate.h>

#include "verbs.h"

namespace lodestone::cli {
namespace {

class Generate final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "generate"; }
  [[nodiscard]] std::string summary() const override { return "Make seeded sample data of any size"; }
  [[nodiscard]] std::string example() const override {
    return "lodestone generate house --roof hip --triangles 20000 --texture-size 256 -o house.obj";
  }
  void declare(Arguments& arguments) override {
    arguments.choice("KIND", kind_, {"house", "street", "outcrop", "terrain"}, "What to make", Need::Required);
    arguments.file("-o,--output", output_, "File to write: .obj, .ply or .glb", Need::Required);
    arguments.count("--triangles", options_.triangles, 0, 100'000'000, "Triangles wanted, 0 = the kind's own number");
    arguments.count("--textures", options_.textures, 0, 10'000, "Texture images, 0 = the kind's own number");
    arguments.count("--texture-size", options_.texture_size_px, 16, 8192, "Width and height of a texture in pixels");
    arguments.count("--charts", options_.charts, 0, none, "Outcrop, terrain: uv charts, 0 = one per texture");
    arguments.seed("--seed", options_.seed, "Another seed gives another model");
    arguments.choice("--roof", roof_, {"flat", "gable", "hip", "spire"}, "Roof of a house");
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] Result<Mesh> make(const Context& context) const;

  std::string kind_;
  std::string roof_;
  std::filesystem::path output_;
  GenerateOptions options_;
};

Roof to_roof(const std::string& word) {
  if (word == "flat") return Roof::Flat;
  if (word == "hip") return Roof::Hip;
  if (word == "spire") return Roof::Spire;
  return Roof::Gable;
}

Result<Mesh> Generate::make(const Context& context) const {
  const bool built = kind_ == "house" || kind_ == "street";
  if (built && options_.charts != 0) {
    return Error{ErrorCode::BadArgument, "--charts is for outcrop and terrain, leave it out for " + kind_, ""};
  }
  if (kind_ == "house") return generate_house({options_, to_roof(roof_)}, context);
  if (!roof_.empty()) return Error{ErrorCode::BadArgument, "--roof is for a house, leave it out for " + kind_, ""};
  if (kind_ == "street") return generate_street(options_, context);
  if (kind_ == "outcrop") return generate_outcrop(options_, context);
  return generate_terrain(options_, context);
}

Status Generate::run(Session& session) {
  if (auto writable = check_output(output_); !writable) return writable;
  auto mesh = make(session.context());
  session.keep(mesh);
  if (!mesh) return mesh.error();
  session.report().set("vertices", mesh->vertex_count());
  session.report().set("triangles", mesh->triangle_count());
  session.report().set("textures", static_cast<std::uint32_t>(mesh->textures.size()));
  return write_mesh(*mesh, output_, session.context());
}

}  // namespace

std::unique_ptr<Verb> make_generate() { return std::make_unique<Generate>(); }

}  // namespace lodestone::cli

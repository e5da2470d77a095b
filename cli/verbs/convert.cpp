// SPDX-License-Identifier: MIT
#include "mesh_input.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Convert final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "convert"; }
  [[nodiscard]] std::string summary() const override { return "Write a mesh in another format"; }
  [[nodiscard]] std::string example() const override { return "lodestone convert house.obj -o house.glb"; }
  void declare(Arguments& arguments) override {
    input_.declare(arguments, "FILE", "Mesh, or .lode file (its finest level)");
    arguments.file("-o,--output", output_, "File to write: .obj, .ply or .glb", Need::Required);
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  MeshInput input_;
  std::filesystem::path output_;
};

Status Convert::run(Session& session) {
  const auto loaded = input_.read(session);
  if (!loaded) return loaded.error();
  session.report().set("vertices", loaded->mesh.vertex_count());
  session.report().set("triangles", loaded->mesh.triangle_count());
  return write_mesh(loaded->mesh, output_, session.context());
}

}  // namespace

std::unique_ptr<Verb> make_convert() { return std::make_unique<Convert>(); }

}  // namespace lodestone::cli

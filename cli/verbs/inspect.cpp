// SPDX-License-Identifier: MIT
#include <lodestone/facet_shift.h>

#include "facet_report.h"
#include "mesh_input.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Inspect final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "inspect"; }
  [[nodiscard]] std::string summary() const override { return "Read any input and say what it is"; }
  [[nodiscard]] std::string example() const override { return "lodestone inspect house.obj --json"; }
  void declare(Arguments& arguments) override {
    input_.declare(arguments, "FILE", "Mesh or .lode file");
    arguments.flag("--facets", facets_, "Tell walls, roofs, openings, and how their planes stand to each other");
    tolerance_.declare(arguments);
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  MeshInput input_;
  PlaneTolerance tolerance_;
  bool facets_ = false;
};

Status Inspect::run(Session& session) {
  const auto loaded = input_.read(session);
  if (!loaded) return loaded.error();
  const Mesh& mesh = loaded->mesh;
  const MeshReport found = lodestone::inspect(mesh);
  Box world;
  if (!found.bounds.empty()) {
    world.add(mesh.origin + found.bounds.min);
    world.add(mesh.origin + found.bounds.max);
  }
  Report& report = session.report();
  report.set("file", input_.file().string());
  report.set("format", loaded->info.format);
  report.set("vertices", mesh.vertex_count());
  report.set("corner_points", found.corner_points);
  report.set("triangles", mesh.triangle_count());
  report.set("materials", static_cast<std::uint32_t>(mesh.materials.size()));
  report.set("textures", static_cast<std::uint32_t>(mesh.textures.size()));
  report.set("features", static_cast<std::uint32_t>(mesh.features.size()));
  report.set("components", found.components);
  report.set("boundary_edges", found.boundary_edges);
  report.set("non_manifold_edges", found.non_manifold_edges);
  report.set("degenerate_triangles", found.degenerate_triangles);
  report.set("duplicate_triangles", found.duplicate_triangles);
  report.set("bounds_m", world);
  report.set("origin_m", mesh.origin);
  report.set("up_axis", loaded->info.up_axis);
  report.set("unit_m", loaded->info.unit_m);
  report.set("crs", mesh.crs);
  if (facets_) report_facets(facet_graph(mesh, {.tolerance = tolerance_.value()}), report);
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_inspect() { return std::make_unique<Inspect>(); }

}  // namespace lodestone::cli

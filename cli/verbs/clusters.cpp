// SPDX-License-Identifier: MIT
#include <cstdio>

#include <lodestone/cluster_file.h>
#include <lodestone/formats.h>

#include "mesh_input.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Clusters final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "clusters"; }
  [[nodiscard]] std::string summary() const override {
    return "Build a cluster graph: fine near the camera, coarse far away, no cracks";
  }
  [[nodiscard]] std::string example() const override { return "lodestone clusters house.obj -o house.lodg"; }
  void declare(Arguments& arguments) override {
    input_.declare(arguments, "FILE", "Mesh, or .lode file (its finest level)");
    arguments.file("-o,--output", output_, "File to write: .lodg", Need::Required);
    arguments.choice("--error", error_, {"distance", "area"}, "What a group's error is: distance, or the paper's area");
    arguments.choice("--attributes", attributes_, {"all", "none"}, "What besides the shape steers the simplification");
    arguments.count("--max-triangles", build_.max_triangles, 16, 255, "Triangles of a cluster, at most");
    arguments.count("--group-clusters", build_.group_clusters, 8, 24, "Clusters of a group, about");
    arguments.count("--position-bits", write_.position_bits, 8, 24, "Bits per coordinate along the longest side");
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  static void report(const ClusterGraph& graph, Session& session);

  MeshInput input_;
  std::filesystem::path output_;
  std::string error_ = "distance";
  std::string attributes_ = "all";
  ClusterOptions build_;
  ClusterWriteOptions write_;
};

Status Clusters::run(Session& session) {
  if (output_.extension() != ".lodg") {
    return Error{ErrorCode::BadArgument, "cluster graphs are written as .lodg files", output_.string()};
  }
  auto loaded = input_.read(session);
  if (!loaded) return loaded.error();
  build_.error = error_ == "area" ? ErrorMeasure::Area : ErrorMeasure::Distance;
  build_.attributes = attributes_ == "none" ? Attributes::None : Attributes::All;
  auto graph = build_cluster_graph(loaded->mesh, build_, session.context());
  session.keep(graph);
  if (!graph) return graph.error();
  loaded->mesh = {};
  const auto size = write_cluster_graph(*graph, output_, write_, session.context());
  if (!size) return size.error();
  report(*graph, session);
  session.report().set("pages", size->pages);
  session.report().set("page_bytes_max", size->page_bytes_max);
  session.report().set("file_bytes", size->file_bytes);
  return Done{};
}

void Clusters::report(const ClusterGraph& graph, Session& session) {
  std::uint32_t number = 0;
  std::string lines = "level  clusters  groups  triangles  fill    error\n";
  for (const ClusterLevel& level : graph.levels) {
    Report entry;
    entry.set("level", number);
    entry.set("clusters", level.clusters);
    entry.set("groups", level.groups);
    entry.set("triangles", level.triangles);
    entry.set("mean_fill", level.mean_fill);
    entry.set("error_m", level.error_m);
    session.report().add("levels", entry);
    char line[100];
    std::snprintf(line, sizeof line, "%5u  %8u  %6u  %9llu  %5.1f  %g m\n", number++, level.clusters, level.groups,
                  static_cast<unsigned long long>(level.triangles), level.mean_fill, level.error_m);
    lines += line;
  }
  session.report().show(lines);
  session.report().set("roots", static_cast<std::uint32_t>(graph.roots.size()));
  std::vector<Warning> warnings;
  for (const ClusterRoot& root : graph.roots) {
    if (!root.cause.empty())
      warnings.push_back({"a cluster has nothing coarser: " + root.cause, std::to_string(root.node)});
  }
  session.keep(std::move(warnings));
}

}  // namespace

std::unique_ptr<Verb> make_clusters() { return std::make_unique<Clusters>(); }

}  // namespace lodestone::cli

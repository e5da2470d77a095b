// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include <lodestone/cluster_file.h>
#include <lodestone/formats.h>

#include "camera_options.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

// Numbers between 0 and 1, the same everywhere (Halton 1960).
double halton(std::uint32_t index, std::uint32_t base) {
  double result = 0.0;
  for (double share = 1.0 / base; index > 0; index /= base, share /= base) result += share * (index % base);
  return result;
}

class Cut final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "cut"; }
  [[nodiscard]] std::string summary() const override { return "Cut a cluster graph for a camera and check the result"; }
  [[nodiscard]] std::string example() const override {
    return "lodestone cut house.lodg --eye 30,-40,20 --error-px 2 -o cut.ply";
  }
  void declare(Arguments& arguments) override;
  [[nodiscard]] Status run(Session& session) override;

 private:
  // What one camera gave; added up over several.
  struct Sums {
    std::uint64_t clusters = 0, triangles = 0, cracks = 0, t_junctions = 0, tested = 0;
    std::size_t pages = 0;
    double select_s = 0.0, max_error_px = 0.0;
  };

  [[nodiscard]] View view_of(const ClusterGraph& graph, std::uint32_t camera) const;
  void look(const View& view, Sums& sums);
  [[nodiscard]] Mesh cut_mesh(const View& view) const;
  void paint(Mesh& mesh) const;

  std::filesystem::path file_;
  std::filesystem::path output_;
  CameraOptions camera_;
  double error_px_ = 1.0;
  std::uint32_t triangles_ = 0;
  std::uint32_t random_ = 0;
  bool whole_ = false;
  bool morph_ = false;
  bool cluster_colors_ = false;

  ClusterGraph graph_;
  CutScratch scratch_;
  std::vector<NodeId> cut_;
  std::vector<std::uint8_t> border_;
};

void Cut::declare(Arguments& arguments) {
  arguments.file("GRAPH", file_, "Cluster graph (.lodg)", Need::Required);
  camera_.declare(arguments);
  arguments.number("--error-px", error_px_, 1e-6, 1e6, "Error on the screen that is allowed, in pixels");
  arguments.count("--triangles", triangles_, 0, 4'000'000'000U, "Triangles at most; 0 = no limit");
  arguments.flag("--whole", whole_, "Keep what lies outside the view as well");
  arguments.flag("--morph", morph_, "Groups on their way to the coarser level, as a viewer shows them");
  arguments.count("--random", random_, 0, 1'000'000, "Try so many cameras around the model");
  arguments.file("-o,--output", output_, "Write the (last) cut: .obj, .ply or .glb", Need::Optional);
  arguments.flag("--cluster-colors", cluster_colors_, "A colour for each cluster instead of its material");
}

View Cut::view_of(const ClusterGraph& graph, std::uint32_t camera) const {
  render::RenderOptions options;
  camera_.apply(options);
  const Sphere& all = graph.graph.groups[0].bounds;
  View view;
  view.width_px = options.width_px;
  view.height_px = options.height_px;
  view.fov_y_rad = options.camera.fov_y_rad;
  const double frame_m = all.radius_m / std::sin(view.fov_y_rad * 0.5);
  view.eye = all.center + frame_m * glm::normalize(glm::dvec3{0.6, -0.7, 0.4});
  if (options.camera.eye_m) view.eye = *options.camera.eye_m - graph.origin;
  glm::dvec3 target = options.camera.target_m ? *options.camera.target_m - graph.origin : all.center;
  if (random_ > 0) {
    const auto place = [&](std::uint32_t i) {
      return 2.0 * glm::dvec3{halton(i, 2), halton(i, 3), halton(i, 5)} - 1.0;
    };
    view.eye = all.center + 2.0 * all.radius_m * place(camera + 1);
    target = all.center + all.radius_m * place(camera + 7919);
  }
  view.forward = glm::length(target - view.eye) > 0.0 ? glm::normalize(target - view.eye) : glm::dvec3{0, 1, 0};
  if (std::abs(view.forward.z) > 0.999) view.up = {0.0, 1.0, 0.0};
  view.near_m = 1e-3 * all.radius_m;
  return view;
}

void Cut::look(const View& view, Sums& sums) {
  CutOptions options{.error_px = error_px_, .triangle_budget = triangles_};
  if (whole_ || random_ > 0) options.culling = Culling::None;  // a border of the view is no crack
  constexpr int repeats = 20;
  CutSummary summary;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < repeats; ++i) summary = select_cut(graph_.graph, view, options, scratch_, cut_);
  sums.select_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / repeats;
  std::set<PageId> pages;
  for (const GroupId g : scratch_.refined()) {
    const Range parts = graph_.graph.groups[g].parts;
    for (std::uint32_t p = parts.begin; p != parts.end; ++p) pages.insert(graph_.graph.parts[p].page);
  }
  sums.pages = std::max(sums.pages, pages.size());
  sums.clusters += cut_.size();
  sums.triangles += summary.triangle_count;
  sums.tested += summary.groups_tested;
  sums.max_error_px = std::max(sums.max_error_px, summary.max_error_px);
  // Faults are looked for in the whole cut: where the view ends there is no crack.
  if (options.culling == Culling::Frustum) {
    options.culling = Culling::None;
    CutScratch scratch;
    std::vector<NodeId> all;
    select_cut(graph_.graph, view, options, scratch, all);
    const CutFaults faults = find_faults(graph_, all, extract(graph_, all), border_);
    sums.cracks += faults.cracks;
    sums.t_junctions += faults.t_junctions;
    return;
  }
  const CutFaults faults = find_faults(graph_, cut_, cut_mesh(view), border_);
  sums.cracks += faults.cracks;
  sums.t_junctions += faults.t_junctions;
}

Mesh Cut::cut_mesh(const View& view) const {
  if (!morph_) return extract(graph_, cut_);
  std::vector<double> weights(graph_.graph.groups.size(), 0.0);
  for (const GroupId g : scratch_.refined()) weights[g] = morph_weight(graph_.graph, view, error_px_, g);
  return extract_morphed(graph_, cut_, weights);
}

void Cut::paint(Mesh& mesh) const {
  mesh.materials = {Material{}};
  mesh.textures.clear();
  mesh.face_materials.clear();
  mesh.vertices.uvs.clear();
  mesh.vertices.colors.clear();
  for (const NodeId n : cut_) {
    const auto channel = [&](std::uint32_t base) {
      return static_cast<std::uint8_t>(70.0 + 180.0 * halton(n + 1, base));
    };
    mesh.vertices.colors.insert(mesh.vertices.colors.end(), graph_.clusters[n].vertices.size(),
                                glm::u8vec4{channel(2), channel(3), channel(5), 255});
  }
}

Status Cut::run(Session& session) {
  auto graph = read_cluster_graph(file_, session.context());
  session.keep(graph);
  if (!graph) return graph.error();
  graph_ = std::move(graph).value();
  if (graph_.graph.empty()) return Error{ErrorCode::BadData, "the graph is empty", file_.string()};
  border_ = true_border(graph_);
  const std::uint32_t cameras = std::max(1U, random_);
  Sums sums;
  View view;
  for (std::uint32_t i = 0; i < cameras; ++i) {
    if (session.context().cancelled()) return Error{ErrorCode::Cancelled, "looking was cancelled", ""};
    session.context().report("cameras", static_cast<double>(i) / cameras);
    view = view_of(graph_, i);
    look(view, sums);
  }
  Report& report = session.report();
  report.set("cameras", cameras);
  report.set("clusters", sums.clusters / cameras);
  report.set("triangles", sums.triangles / cameras);
  report.set("groups_tested", sums.tested / cameras);
  report.set("select_seconds", sums.select_s / cameras);
  report.set("cracks", sums.cracks);
  report.set("t_junctions", sums.t_junctions);
  report.set("max_error_px", sums.max_error_px);
  report.set("pages", static_cast<std::uint32_t>(sums.pages));
  report.set("changed_border_edges", changed_border_edges(graph_));
  if (output_.empty()) return Done{};
  Mesh mesh = cut_mesh(view);
  if (cluster_colors_) paint(mesh);
  return write_mesh(mesh, output_, session.context());
}

}  // namespace

std::unique_ptr<Verb> make_cut() { return std::make_unique<Cut>(); }

}  // namespace lodestone::cli

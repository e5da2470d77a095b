// SPDX-License-Identifier: MIT
#include <algorithm>
#include <vector>

#include <lodestone/edge_collapse.h>

#include "collapse/engine.h"

namespace lodestone {
namespace {

// Applies records to the mesh they are made from. The engine may go on reading what they leave alone: materials.
class MeshSink final : public collapse::Sink {
 public:
  explicit MeshSink(Mesh& mesh) : mesh_(mesh), gone_(mesh.triangle_count(), 0) {}

  void record(const collapse::Edit& edit) override {
    for (const FaceId f : edit.faces) gone_[f] = 1;
    for (const auto& [corner, to] : edit.corners) mesh_.indices[corner] = to;
    move_vertices(edit, mesh_.vertices);
    error_m_ = std::max(error_m_, double{edit.error_m});
  }

  [[nodiscard]] double error_m() const noexcept { return error_m_; }

  void drop_gone() {
    std::size_t kept = 0;
    for (std::size_t f = 0; f < gone_.size(); ++f) {
      if (gone_[f] != 0) continue;
      for (std::size_t k = 0; k < 3; ++k) mesh_.indices[3 * kept + k] = mesh_.indices[3 * f + k];
      if (!mesh_.face_materials.empty()) mesh_.face_materials[kept] = mesh_.face_materials[f];
      if (!mesh_.face_features.empty()) mesh_.face_features[kept] = mesh_.face_features[f];
      ++kept;
    }
    mesh_.indices.resize(3 * kept);
    if (!mesh_.face_materials.empty()) mesh_.face_materials.resize(kept);
    if (!mesh_.face_features.empty()) mesh_.face_features.resize(kept);
    remove_unused(mesh_);
  }

 private:
  Mesh& mesh_;
  std::vector<std::uint8_t> gone_;
  double error_m_ = 0.0;
};

}  // namespace

Result<SimplifyResult> simplify(Mesh mesh, const EdgeCollapseOptions& options, const Context& context) {
  if (Status status = collapse::check(mesh, options); !status.ok()) return status.error();
  MeshSink sink{mesh};
  SimplifyResult result;
  result.report = collapse::run(mesh, options, context, sink);
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "simplification was cancelled", ""};
  result.error_m = sink.error_m();
  sink.drop_gone();
  result.mesh = std::move(mesh);
  return result;
}

}  // namespace lodestone

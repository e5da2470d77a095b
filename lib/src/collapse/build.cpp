// SPDX-License-Identifier: MIT
#include <lodestone/edge_collapse.h>

#include "collapse/build_log.h"
#include "collapse/engine.h"
#include "progressive/recorder.h"

namespace lodestone {
namespace {

class LogSink final : public collapse::Sink {
 public:
  explicit LogSink(const Mesh& source) : log_(value_words(source)) {}

  void record(const collapse::Edit& edit) override {
    log_.begin(edit.error_m);
    for (const FaceId f : edit.faces) log_.remove_face(f);
    for (const auto& [vertex, into] : edit.vertices) log_.remove_vertex(vertex, into);
    for (const auto& [corner, to] : edit.corners) log_.repoint(corner, to);
    const std::size_t words = edit.moved.empty() ? 0 : edit.values.size() / edit.moved.size();
    for (std::size_t i = 0; i < edit.moved.size(); ++i) {
      log_.move_vertex(edit.moved[i], edit.values.subspan(i * words, words));
    }
    log_.end();
  }

  [[nodiscard]] progressive::EditLog take() { return std::move(log_); }

 private:
  static std::uint32_t value_words(const Mesh& source) {
    const VertexArrays& v = source.vertices;
    return 3 + (v.normals.empty() ? 0 : 3) + (v.uvs.empty() ? 0 : 2) + (v.colors.empty() ? 0 : 1);
  }
  progressive::EditLog log_;
};

}  // namespace

progressive::EditLog collapse::collapse_log(const Mesh& source, const EdgeCollapseOptions& options,
                                            const Context& context, CollapseReport& report) {
  LogSink sink{source};
  report = run(source, options, context, sink);
  return sink.take();
}

Result<EdgeCollapseResult> build_by_edge_collapse(const Mesh& mesh, const EdgeCollapseOptions& options,
                                                  const Context& context) {
  if (Status status = collapse::check(mesh, options); !status.ok()) return status.error();
  EdgeCollapseResult result;
  progressive::EditLog log = collapse::collapse_log(mesh, options, context, result.report);
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "building was cancelled", ""};
  auto model = ProgressiveModel::from_data(progressive::record(mesh, std::move(log), "edge-collapse"));
  if (!model.ok()) return model.error();
  result.model = std::move(model).value();
  return result;
}

}  // namespace lodestone

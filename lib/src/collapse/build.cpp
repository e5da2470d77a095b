// SPDX-License-Identifier: MIT
#include <lodestone/edge_collapse.h>

#include <algorithm>
#include <limits>

#include "collapse/build_log.h"
#include "collapse/engine.h"
#include "progressive/recorder.h"

namespace lodestone {
namespace {

class LogSink final : public collapse::Sink {
 public:
  LogSink(const Mesh& source, const EdgeCollapseOptions& options) : log_(value_words(source)) {
    const std::size_t faces = source.triangle_count() - std::min(source.triangle_count(), options.target_triangles);
    const bool most_go = options.max_error_m == std::numeric_limits<double>::infinity();
    if (most_go) log_.reserve(faces / 2, options.placement != Placement::Subset);
  }

  void record(const collapse::Edit& edit) override {
    const auto size = [](const auto& part) { return static_cast<std::uint32_t>(part.size()); };
    const RecordEnds end{edit.error_m, size(edit.faces), size(edit.vertices), size(edit.corners), size(edit.moved)};
    log_.append({edit.faces, edit.vertices, edit.corners, edit.moved, edit.values, {&end, 1}, {}});
  }
  void records(const collapse::PassLog& log, std::size_t begin, std::size_t end) override {
    log_.append(log.run(begin, end));
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
  LogSink sink{source, options};
  report = run(source, options, context, sink);
  return sink.take();
}

Result<EdgeCollapseResult> build_by_edge_collapse(const Mesh& mesh, const EdgeCollapseOptions& options,
                                                  const Context& context) {
  if (Status status = collapse::check(mesh, options); !status.ok()) return status.error();
  EdgeCollapseResult result;
  progressive::EditLog log = collapse::collapse_log(mesh, options, context, result.report);
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "building was cancelled", ""};
  auto model = progressive::record_model(mesh, std::move(log), "edge-collapse", context);
  if (!model.ok()) return model.error();
  result.model = std::move(model).value();
  return result;
}

}  // namespace lodestone

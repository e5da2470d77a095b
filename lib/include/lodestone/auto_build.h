// SPDX-License-Identifier: MIT
/// \file
/// Chooses how a mesh becomes a progressive model, part by part: what is made of planes by facet shift, the rest by
/// edge collapse. A house with a statue before it, or a street with a scanned fountain, needs both.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <lodestone/edge_collapse.h>
#include <lodestone/facet_shift.h>

namespace lodestone {

struct AutoBuildOptions {
  /// A part is made of planes if at least this share of its area lies in surfaces of 1e-4 of it or more that are larger
  /// than three of its triangles on average. Buildings have 0.8 and more, scans and sculpture less than 0.2.
  double least_planar_share = 0.6;
  /// Connected parts (by corner points) of fewer triangles than this share of the whole go with the others: railings
  /// and bars vanish into what they hang on.
  double least_part_ratio = 0.02;
  FacetShiftOptions facet_shift;
  EdgeCollapseOptions edge_collapse;  ///< `frozen` must be empty
};

struct AutoBuildResult {
  std::shared_ptr<const ProgressiveModel> model;  ///< its method: "facet-shift", "edge-collapse" or "mixed"
  std::string reason;                             ///< which for what, and why: one sentence
  std::optional<FacetShiftReport> facet_shift;    ///< where it was used
  std::optional<CollapseReport> edge_collapse;
};

/// Both kinds of records are merged into one stack by their errors; target and largest error are those of
/// `facet_shift`, of the whole model. Time and memory are those of the two builders. Errors: BadData, BadArgument,
/// Cancelled, as theirs.
[[nodiscard]] Result<AutoBuildResult> build_automatically(const Mesh& mesh, const AutoBuildOptions& options = {},
                                                          const Context& context = {});

}  // namespace lodestone

// SPDX-License-Identifier: MIT
// The pictures of the verb `distances`.
#pragma once

#include <filesystem>

#include <lodestone/progressive_model.h>

#include "viewer/headless/switch_study.h"

namespace lodestone::cli {

// metric.png (samples and fit), redundancy.png (detail drawn but not seen), triangles.png (allocation over distance, by
// plan), rendered.png, seen.png and difference.png (the vision model at d1).
[[nodiscard]] Status write_distance_plots(const render::SwitchStudy& study, const ProgressiveModel& model,
                                          const std::filesystem::path& folder);

}  // namespace lodestone::cli

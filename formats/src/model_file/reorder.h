// SPDX-License-Identifier: MIT
// Records that do not depend on each other, put into an order that packs well.
//
// Based on: Hoppe 1998 ("Efficient implementation of progressive meshes": independent splits in the order of the
// vertices they split), Pajarola and Rossignac 2000 (splits in batches). Differs: works on any slot edits, and only
// within windows of nearly equal error, so that every level keeps its meaning.
#pragma once

#include <lodestone/progressive_model.h>

namespace lodestone::model_file {

// Errors within a window are at most a quarter larger than they need be: a level claims the error of its window's
// start.
inline constexpr float window_error_ratio = 0.8F;

// The same base, the same finest level, the same levels at the ends of windows and at named levels; slots renumbered.
// Precondition: `data` is that of a valid model. O(records log records).
[[nodiscard]] ModelData reorder(const ModelData& data);

}  // namespace lodestone::model_file

// SPDX-License-Identifier: MIT
// The door: nothing but data that passed here, or that a builder of ours made, is ever played.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <lodestone/progressive_model.h>

#include "progressive/stack.h"

namespace lodestone::progressive {

// What one replay of the stack from base to finest found.
struct Replay {
  std::vector<StackPosition> checkpoints;  // one per checkpoint_spacing records, from level 0
  StackPosition end;
  Box bounds;
};
inline constexpr std::uint32_t checkpoint_spacing = 256;

// Replays the stack, checking every count, index, value and error before it is used. Never reads outside the arrays,
// whatever they hold. O(records + slots).
[[nodiscard]] Result<Replay> check(const ModelData& data);

// A model of what the recorder just made of a valid mesh with these bounds and finite values. Its records are counted,
// not replayed: that check() finds nothing is asserted only, because a replay takes as long as recording.
[[nodiscard]] std::shared_ptr<const ProgressiveModel> trusted_model(ModelData data, const Box& bounds);

}  // namespace lodestone::progressive

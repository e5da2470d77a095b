// SPDX-License-Identifier: MIT
// A tiny producer of stacks: seeded random edits of any mesh, with no regard for shape. It exercises every kind of
// record on every family of meshes without the collapse engine.
#pragma once

#include <cstdint>
#include <memory>

#include <lodestone/progressive_model.h>

#include "progressive/recorder.h"

namespace lodestone::test {

struct ProducerOptions {
  std::uint64_t seed = 1;
  std::uint32_t records = 100'000;  // stops earlier when nothing is left
  double keep_ratio = 0.1;          // stops at this share of the faces
  double move_share = 0.0;          // of collapses that move the vertex that stays
  double vanish_share = 0.0;        // of records that take a patch of faces away
  double nudge_share = 0.0;         // of records that only move vertices, many of them
};

[[nodiscard]] progressive::EditLog random_log(const Mesh& source, const ProducerOptions& options);

// random_log, recorded; fails the running test if the model is refused.
[[nodiscard]] std::shared_ptr<const ProgressiveModel> random_model(const Mesh& source, const ProducerOptions& options);

}  // namespace lodestone::test

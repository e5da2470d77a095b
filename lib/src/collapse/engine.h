// SPDX-License-Identifier: MIT
// The greedy loop: passes over the edges until the target is reached, each record handed to a sink in order.
#pragma once

#include <lodestone/edge_collapse.h>

#include "collapse/pass_log.h"

namespace lodestone::collapse {

class Sink {
 public:
  virtual ~Sink() = default;
  virtual void record(const Edit& edit) = 0;
};

// Errors: BadData from validate(mesh), BadArgument.
[[nodiscard]] Status check(const Mesh& mesh, const EdgeCollapseOptions& options);

// Precondition: check() is ok. Stops early, without a report, when the context is cancelled.
CollapseReport run(const Mesh& source, const EdgeCollapseOptions& options, const Context& context, Sink& sink);

}  // namespace lodestone::collapse

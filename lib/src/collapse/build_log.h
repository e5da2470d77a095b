// SPDX-License-Identifier: MIT
// The records of an edge collapse, before they become a model.
#pragma once

#include <lodestone/edge_collapse.h>

#include "progressive/recorder.h"

namespace lodestone::collapse {

// Precondition: check() is ok. Of no use if the context was cancelled.
[[nodiscard]] progressive::EditLog collapse_log(const Mesh& source, const EdgeCollapseOptions& options,
                                                const Context& context, CollapseReport& report);

}  // namespace lodestone::collapse

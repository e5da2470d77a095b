// SPDX-License-Identifier: MIT
// Runs a reader whose library cannot be trusted with hostile bytes in a process of its own.
#pragma once

#include <functional>

#include "reader.h"

namespace lodestone {

// Forks, calls `read` in the child, and brings its result back. A crash, a hang (over a minute and a second per MB of
// input) or a hunger for memory (over 1 GB and 64 times the input, or Context::max_memory_bytes) there is an Error
// here; cancelling ends the child at once. `read` must not use worker threads: the child has none.
[[nodiscard]] Result<LoadedMesh> run_isolated(const Input& input, const Context& context,
                                              const std::function<Result<LoadedMesh>()>& read);

}  // namespace lodestone

// SPDX-License-Identifier: MIT
// Small detached parts vanish as records of their own.
#pragma once

#include "collapse/pass_log.h"
#include "collapse/working_mesh.h"

namespace lodestone::collapse {

// Logs the parts of few faces that lie, with all they stood for, within `limit_m` of what stays, nearest first, and
// takes them out of `mesh`. Stops once `most_faces` faces went. Returns the largest error logged.
float prune_parts(WorkingMesh& mesh, double limit_m, std::uint32_t most_faces, PassLog& log);

}  // namespace lodestone::collapse

// SPDX-License-Identifier: MIT
// Small detached parts vanish as records of their own.
#pragma once

#include "collapse/last_faces.h"
#include "collapse/pass_log.h"
#include "collapse/working_mesh.h"

namespace lodestone::collapse {

// Logs the parts of few faces that lie, with all they stood for, within `limit_m` of what stays, nearest first, and
// takes them out of `mesh`. Stops once `most_faces` faces went. `last_faces` is counted anew.
struct Pruned {
  float largest_m = 0.0F;  // error logged
  bool some_wait = false;  // because of what went: the same search would find more
};
Pruned prune_parts(WorkingMesh& mesh, double limit_m, std::uint32_t most_faces, LastFaces& last_faces,
                   const Context& context, PassLog& log);

}  // namespace lodestone::collapse

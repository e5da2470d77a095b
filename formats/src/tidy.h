// SPDX-License-Identifier: MIT
// What every mesh goes through after its reader and before it leaves read_mesh.
#pragma once

#include "reader.h"

namespace lodestone {

// Makes `mesh` hold the invariants of mesh.h that files break: no number that is not finite (faces with such a corner
// go, uvs become 0), no place astray (strays.h; its faces go), no face that names a missing vertex, unit normals
// (missing or broken ones are taken from the faces), a material where there are faces.
void tidy(Mesh& mesh, Warnings& warnings);

}  // namespace lodestone

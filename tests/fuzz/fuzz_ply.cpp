// SPDX-License-Identifier: MIT
#include "doors.h"

LODESTONE_MESH_DOOR("fuzz.ply")

// SPDX-License-Identifier: MIT
// What lodestone-osgb answers over its socket when it serves a tree of OpenSceneGraph files. Asked are lines, "index"
// or "tile NAME"; an answer is its length in bytes (64 bits) and these fields.
#pragma once

#include <string>

#include <lodestone/result.h>

#include "meshes/parcel.h"

namespace lodestone {

struct OsgbAnswer {
  bool ok = false;
  Error error;
  std::string index;  // a tileset.json
  Mesh mesh;
};

template <class Archive>
void answer_fields(Archive& archive, OsgbAnswer& answer) {
  archive.plain(answer.ok);
  archive.plain(answer.error.code);
  archive.array(answer.error.message);
  archive.array(answer.error.where);
  archive.array(answer.index);
  mesh_fields(archive, answer.mesh);
}

}  // namespace lodestone

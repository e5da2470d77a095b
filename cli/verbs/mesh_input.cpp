// SPDX-License-Identifier: MIT
#include "mesh_input.h"

namespace lodestone::cli {

void MeshInput::declare(Arguments& arguments, const std::string& name, const std::string& help, Need need) {
  arguments.file(name, file_, help, need);
  arguments.choice("--up", up_, {"from-file", "y", "z"}, "Axis that points up in the mesh file");
  arguments.length_m("--unit", unit_m_, "Length of one unit of the mesh file");
  arguments.text("--crs", crs_, "Coordinate reference system, such as EPSG:25832, where the file names none");
}

Result<LoadedMesh> MeshInput::read(Session& session, LoadTextures textures) const {
  if (unit_m_ == 0.0) return Error{ErrorCode::BadArgument, "--unit: a unit of no length measures nothing", ""};
  ReadOptions options{.unit_m = unit_m_.value_or(0.0), .crs = crs_.value_or(""), .textures = textures};
  if (up_ == "y") options.up = UpAxis::Y;
  if (up_ == "z") options.up = UpAxis::Z;
  auto loaded = read_mesh(file_, options, session.context());
  session.keep(loaded);
  return loaded;
}

}  // namespace lodestone::cli

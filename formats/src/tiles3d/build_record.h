// SPDX-License-Identifier: MIT
// What a build was made from, as build.json in its folder keeps it: whether another one may go on with its tiles.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/mesh.h>
#include <lodestone/result.h>
#include <lodestone/tileset_writer.h>

namespace lodestone {

// The text of build.json: hashes of the mesh, of the options, and of each photograph's bytes, all of which are read.
// Errors: Cancelled.
[[nodiscard]] Result<std::string> record_build(const Mesh& mesh, const TilesetOptions& options, const Context& context);

// Photographs that turned out to be damaged, by name, and why: kept too, so that each run that goes on tells of them.
using DamagedPhotographs = std::map<std::string, std::string>;
[[nodiscard]] std::string with_damaged(const std::string& record, const DamagedPhotographs& damaged);
[[nodiscard]] DamagedPhotographs damaged_photographs(const std::string& found);

// The photographs in which two records differ, by name. Errors: BadArgument without a place where they differ in more.
[[nodiscard]] Result<std::vector<std::string>> changed_photographs(const std::string& found, const std::string& wanted);

}  // namespace lodestone

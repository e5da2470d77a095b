// SPDX-License-Identifier: MIT
// A tree of OpenSceneGraph files for a program that cannot have OpenSceneGraph in its own process.
#pragma once

namespace lodestone::osgb {

// Answers on standard input, which is a socket, until it is closed (tiles3d/osgb_answer.h). Returns the status to end
// with.
[[nodiscard]] int serve(const char* root);

}  // namespace lodestone::osgb

// SPDX-License-Identifier: MIT
// One function per verb, each in a file of its own.
#pragma once

#include <memory>

#include "frame/verb.h"

namespace lodestone::cli {

[[nodiscard]] std::unique_ptr<Verb> make_inspect();
[[nodiscard]] std::unique_ptr<Verb> make_generate();
[[nodiscard]] std::unique_ptr<Verb> make_convert();
[[nodiscard]] std::unique_ptr<Verb> make_build();
[[nodiscard]] std::unique_ptr<Verb> make_verify();
[[nodiscard]] std::unique_ptr<Verb> make_play();
[[nodiscard]] std::unique_ptr<Verb> make_extract();
[[nodiscard]] std::unique_ptr<Verb> make_sweep();
[[nodiscard]] std::unique_ptr<Verb> make_render();
[[nodiscard]] std::unique_ptr<Verb> make_compare();
[[nodiscard]] std::unique_ptr<Verb> make_outcrop();
[[nodiscard]] std::unique_ptr<Verb> make_clusters();
[[nodiscard]] std::unique_ptr<Verb> make_cut();
[[nodiscard]] std::unique_ptr<Verb> make_distances();
[[nodiscard]] std::unique_ptr<Verb> make_terrain();
[[nodiscard]] std::unique_ptr<Verb> make_view();

}  // namespace lodestone::cli

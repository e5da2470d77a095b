// SPDX-License-Identifier: MIT
#include "verbs/verbs.h"

int main(int argc, char** argv) {
  using namespace lodestone::cli;
  Verbs verbs;
  verbs.push_back(make_inspect());
  verbs.push_back(make_generate());
  verbs.push_back(make_convert());
  verbs.push_back(make_build());
  verbs.push_back(make_verify());
  verbs.push_back(make_play());
  verbs.push_back(make_extract());
  verbs.push_back(make_sweep());
  verbs.push_back(make_render());
  verbs.push_back(make_compare());
  verbs.push_back(make_outcrop());
  verbs.push_back(make_clusters());
  verbs.push_back(make_cut());
  verbs.push_back(make_distances());
  verbs.push_back(make_terrain());
  verbs.push_back(make_view());
  return run_program(verbs, argc, argv);
}

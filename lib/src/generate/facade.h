// SPDX-License-Identifier: MIT
// Walls and what is cut into them.
#pragma once

#include <vector>

#include "generate/draft.h"
#include "generate/palette.h"

namespace lodestone::generate {

// A vertical plane with coordinates of its own: u along it (to the right, seen from outside), `out` towards the
// eye, z up. `along` is a unit vector of the lattice; out = along x up.
struct Facade {
  Point origin{0, 0, 0};
  Point2 along{1, 0};
  [[nodiscard]] Point out() const { return {along.y, -along.x, 0}; }
  [[nodiscard]] Point at(int u, int z, int out_by = 0) const {
    return origin + Point{along.x * u, along.y * u, z} + out() * out_by;
  }
  [[nodiscard]] Frame frame(int u, int z) const;    // metres: x along, y up, z out
  [[nodiscard]] Frame upright(int u, int z) const;  // metres: x along, y into the wall, z up
};

enum class Leaf : std::uint8_t { Window, FrenchWindow, Door, Louvre };

// A hole in a wall with what stands in it. Lattice lengths.
struct Opening {
  int u0 = 0, u1 = 0, z0 = 0, z1 = 0;  // z1: where the arch springs, or the top
  int arch = 0;                        // rise of the arch, 0 = flat
  Leaf leaf = Leaf::Window;
  int columns = 2, rows = 3;  // panes
};

// Everything that a house is made of while it is drawn.
struct House {
  Mesh* mesh = nullptr;
  Palette palette;
  std::string prefix;  // of feature ids
  FeatureId building = 0;
  Body body;
  Parts parts;

  FeatureId feature(const std::string& id, const char* semantic_class, FeatureId parent) {
    return add_feature(*mesh, prefix + id, semantic_class, parent);
  }
};

// Adds a piece of wall (outline in (u, z), counter-clockwise) with openings, recessed, framed and divided into panes.
void add_wall(House& house, const Facade& facade, const Loop2& outline, const std::vector<Opening>& openings,
              Look look);

}  // namespace lodestone::generate

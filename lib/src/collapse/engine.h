// SPDX-License-Identifier: MIT
// The greedy loop: passes over the edges until the target is reached, each record handed to a sink in order.
#pragma once

#include <span>

#include <lodestone/edge_collapse.h>

#include "collapse/pass_log.h"

namespace lodestone::collapse {

class Sink {
 public:
  virtual ~Sink() = default;
  virtual void record(const Edit& edit) = 0;
  // Records [begin, end) of the log, in order; for sinks that can take many at once.
  virtual void records(const PassLog& log, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) record(log.edit(i));
  }
};

// For sinks that keep a mesh up to date: gives the moved vertices their new values.
void move_vertices(const Edit& edit, VertexArrays& values);

// Errors: BadData from validate(mesh), BadArgument.
[[nodiscard]] Status check(const Mesh& mesh, const EdgeCollapseOptions& options);

// What may become of the way surfaces meet, in soup from the start, elsewhere where nothing else is possible.
enum class Contacts : std::uint8_t {
  MayChange,  // anything; of two equal faces one goes
  MayTouch,   // surfaces may come to touch; both of two equal faces stay, so that what is closed stays closed
};
enum class Scruples : std::uint8_t { UntilStuck, None };

// What a piece of a larger work brings along.
struct Start {
  std::span<const float> deviation_m = {};  // per vertex: of the surface there from what it stands for already
  double quota = 0.0;                       // share of the points that may go in one pass; 0 = by their number
  Contacts contacts = Contacts::MayChange;
  Scruples scruples = Scruples::UntilStuck;  // None: as if it were soup
};

// Precondition: check() is ok. The sink may change positions, looks and indices of the source meanwhile, but no
// material. Stops early, without a report, when the context is cancelled.
CollapseReport run(const Mesh& source, const EdgeCollapseOptions& options, const Context& context, Sink& sink,
                   const Start& start = {});

}  // namespace lodestone::collapse

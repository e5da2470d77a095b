// SPDX-License-Identifier: MIT
// Planes of buildings on the command line: how exactly they are planes, and what was found of them.
#pragma once

#include <lodestone/facet_shift.h>

#include "frame/verb.h"

namespace lodestone::cli {

class PlaneTolerance {
 public:
  void declare(Arguments& arguments);
  [[nodiscard]] SurfaceTolerance value() const;

 private:
  double angle_deg_ = 1.0;
  std::optional<double> offset_m_;
};

// Key "facets": surfaces and area by class, families, steps and roofs; and a few lines for people.
void report_facets(const FacetGraph& graph, Report& report);

// Key "facet_shift": what was done, and whether the block was reached or what holds the model above it.
void report_shifts(const FacetShiftReport& done, Report& report);

}  // namespace lodestone::cli

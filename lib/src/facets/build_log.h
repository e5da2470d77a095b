// SPDX-License-Identifier: MIT
// The records of a facet shift, before they become a model.
#pragma once

#include <lodestone/facet_shift.h>

#include "progressive/recorder.h"

namespace lodestone::facets {

// `source` is cut at its T-junctions first; the log is about what it is then. Precondition: validate(source). Of no use
// if the context was cancelled.
[[nodiscard]] progressive::EditLog shift_log(Mesh& source, const FacetShiftOptions& options, const Context& context,
                                             FacetShiftReport& report);

// Names the levels of CityGML in a model.
void name_levels(ModelData& data, bool reached_block);

}  // namespace lodestone::facets

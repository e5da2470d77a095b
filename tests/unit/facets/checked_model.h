// SPDX-License-Identifier: MIT
#pragma once

#include <lodestone/progressive_model.h>

#include <catch2/catch.hpp>

namespace lodestone::test {

// Exact, monotone, its flags in order, and at its finest level the source.
inline void check_model(const ProgressiveModel& model, const Mesh& source) {
  const ModelReport report = validate(model);
  CHECK(report.fault.empty());
  CHECK(report.exact);
  CHECK(report.monotone);
  CHECK(report.in_use_consistent);
  CHECK(compare_with_source(model, source) == "");
}

}  // namespace lodestone::test

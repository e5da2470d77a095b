// SPDX-License-Identifier: MIT
// Which edges are worth collapsing in this pass: a quick estimate for every edge, then a limit.
#pragma once

#include <cstdint>
#include <vector>

#include "collapse/symmetric3.h"
#include "collapse/working_mesh.h"

namespace lodestone::collapse {

// An edge and its estimated cost as the bits of a non-negative float, which sort like the number.
struct Candidate {
  std::uint32_t key = 0;
  std::uint32_t u = 0;
  std::uint32_t v = 0;
};

// How lines are found and weighed.
struct LineRules {
  const Mesh& source;
  const EdgeCollapseOptions& options;
  bool looks_matter = false;  // seams and material borders are lines
  double weight = 1.0;
};

// Sums the quadric of every point in the range over its faces and the lines there, sets its flags, and adds its edges
// to `edges`, costs unknown. Ranges may be summed at once.
void sum_quadrics(WorkingMesh& mesh, const LineRules& rules, Range points, std::vector<Symmetric3>& quadrics,
                  std::vector<Candidate>& edges);

// How many edges cost how much, in steps of a sixteenth.
class CostHistogram {
 public:
  void add(std::uint32_t key) noexcept { ++counts_[key >> shift]; }
  void add(const CostHistogram& other) noexcept;
  // Keys below this belong to the `share` (0..1) of least cost.
  [[nodiscard]] std::uint32_t limit(double share) const noexcept;

 private:
  static constexpr std::uint32_t shift = 19;  // what is left: exponent and 4 bits of mantissa
  std::vector<std::uint32_t> counts_ = std::vector<std::uint32_t>(std::size_t{1} << (32 - shift), 0);
};

// Estimates and counts the edges that sum_quadrics() listed for the range, once it is done for all, and drops those
// that can never collapse here: both ends frozen, or a neighbour of either outside the range.
void estimate_costs(const WorkingMesh& mesh, const std::vector<Symmetric3>& quadrics, Placement placement,
                    std::vector<Candidate>& edges, CostHistogram& histogram);

}  // namespace lodestone::collapse

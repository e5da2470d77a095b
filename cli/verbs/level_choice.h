// SPDX-License-Identifier: MIT
// The ways to name one level of a model on the command line.
#pragma once

#include <optional>
#include <string>

#include <lodestone/progressive_model.h>

#include "frame/verb.h"

namespace lodestone::cli {

class LevelChoice {
 public:
  void declare(Arguments& arguments);

  // How many of the ways were used.
  [[nodiscard]] int ways() const noexcept;
  // Precondition: ways() is 1.
  [[nodiscard]] Result<Level> in(const ProgressiveModel& model) const;

 private:
  std::optional<std::uint32_t> triangles_;
  std::optional<double> ratio_;
  std::optional<double> error_m_;
  std::optional<std::string> level_;
  std::optional<double> perceptual_m_;
};

}  // namespace lodestone::cli

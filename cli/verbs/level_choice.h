// SPDX-License-Identifier: MIT
// The ways to name one level of a model on the command line.
#pragma once

#include <filesystem>
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
  // By --perceptual.
  [[nodiscard]] bool is_perceptual() const noexcept { return perceptual_m_.has_value(); }
  // Precondition: ways() is 1. `plan_file`, with --perceptual: the plan of 'distances' that says what is needed; empty
  // = half a pixel.
  [[nodiscard]] Result<Level> in(const ProgressiveModel& model, const std::filesystem::path& plan_file = {}) const;

 private:
  std::optional<std::uint32_t> triangles_;
  std::optional<double> ratio_;
  std::optional<double> error_m_;
  std::optional<std::string> level_;
  std::optional<double> perceptual_m_;
};

}  // namespace lodestone::cli

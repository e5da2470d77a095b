// SPDX-License-Identifier: MIT
// A verb of the program: one call of the library, its options and what it reports.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "arguments.h"
#include "session.h"

namespace lodestone::cli {

class Verb {
 public:
  virtual ~Verb() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual std::string summary() const = 0;
  // A command line that works as it stands, after a `generate` where it needs a file.
  [[nodiscard]] virtual std::string example() const = 0;

  virtual void declare(Arguments& arguments) = 0;
  [[nodiscard]] virtual Status run(Session& session) = 0;
};

using Verbs = std::vector<std::unique_ptr<Verb>>;

// Parses the command line, runs the verb it names and returns the program's exit code.
[[nodiscard]] int run_program(const Verbs& verbs, int argc, char** argv);

}  // namespace lodestone::cli

// SPDX-License-Identifier: MIT
#include <lodestone/result.h>

namespace lodestone {

std::string to_line(const Error& error) {
  return error.where.empty() ? error.message : error.where + ": " + error.message;
}

std::string to_line(const Warning& warning) {
  std::string line = warning.where.empty() ? warning.message : warning.where + ": " + warning.message;
  if (warning.count > 1) line += " (" + std::to_string(warning.count) + " times)";
  return line;
}

}  // namespace lodestone

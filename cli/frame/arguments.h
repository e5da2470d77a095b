// SPDX-License-Identifier: MIT
// What a verb asks of its command line. A verb names its options and the variables they go to; parsing, help texts and
// messages are done in one place (arguments.cpp, the only file that names the parser library).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "units.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own name
class App;
}

namespace lodestone::cli {

enum class Need { Optional, Required };

class Arguments {
 public:
  explicit Arguments(CLI::App& app) : app_(app) {}

  // Without dashes: taken by position. The present value of a variable is its default and is shown in the help.
  void file(const std::string& names, std::filesystem::path& value, const std::string& help, Need need);
  void choice(const std::string& names, std::string& value, const std::vector<std::string>& choices,
              const std::string& help, Need need = Need::Optional);
  void text(const std::string& names, std::optional<std::string>& value, const std::string& help);
  void flag(const std::string& names, bool& value, const std::string& help);
  // A word that the verb itself looks at; `type` stands for it in the help.
  void word(const std::string& names, std::string& value, const std::string& type, const std::string& help);

  void count(const std::string& names, std::uint32_t& value, std::uint32_t min, std::uint32_t max,
             const std::string& help);
  void count(const std::string& names, std::optional<std::uint32_t>& value, std::uint32_t min, std::uint32_t max,
             const std::string& help);
  void seed(const std::string& names, std::uint64_t& value, const std::string& help);
  void number(const std::string& names, double& value, double min, double max, const std::string& help);
  void number(const std::string& names, std::optional<double>& value, double min, double max, const std::string& help);
  void length_m(const std::string& names, std::optional<double>& value, const std::string& help);
  void bytes(const std::string& names, std::uint64_t& value, const std::string& help);
  void point_m(const std::string& names, std::optional<glm::dvec3>& value, const std::string& help);
  void picture_size(const std::string& names, PictureSize& value, const std::string& help);

 private:
  CLI::App& app_;
};

}  // namespace lodestone::cli

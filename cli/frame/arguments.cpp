// SPDX-License-Identifier: MIT
#include "arguments.h"

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>

namespace lodestone::cli {
namespace {

// Adds an option whose word is turned into a value by `parse`; its message becomes the parser's.
template <class Value, class Parse>
CLI::Option* add(CLI::App& app, const std::string& names, Value& value, Parse parse, const std::string& type,
                 const std::string& help) {
  return app
      .add_option_function<std::string>(
          names,
          [&value, parse, names](const std::string& word) {
            auto parsed = parse(word);
            if (!parsed) throw CLI::ValidationError(names, parsed.error().message);
            value = *parsed;
          },
          help)
      ->type_name(type);
}

template <class Number>
std::string shortest(Number value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

template <class Number>
Error outside(const std::string& word, Number min, Number max) {
  return {ErrorCode::BadArgument, "'" + word + "' is not between " + shortest(min) + " and " + shortest(max), ""};
}

auto count_parser(std::uint32_t min, std::uint32_t max) {
  return [min, max](const std::string& word) -> Result<std::uint32_t> {
    const auto parsed = parse_count(word);
    if (!parsed) return parsed.error();
    if (*parsed < min || *parsed > max) return outside(word, min, max);
    return static_cast<std::uint32_t>(*parsed);
  };
}

auto number_parser(double min, double max) {
  return [min, max](const std::string& word) -> Result<double> {
    auto parsed = parse_number(word);
    if (parsed && (*parsed < min || *parsed > max)) return outside(word, min, max);
    return parsed;
  };
}

}  // namespace

void Arguments::file(const std::string& names, std::filesystem::path& value, const std::string& help, Need need) {
  app_.add_option(names, value, help)->type_name(names.front() == '-' ? "FILE" : "")->required(need == Need::Required);
}

void Arguments::choice(const std::string& names, std::string& value, const std::vector<std::string>& choices,
                       const std::string& help, Need need) {
  auto* option = app_.add_option(names, value, help)->required(need == Need::Required);
  option->type_name("")->check(CLI::IsMember(choices));
  if (!value.empty()) option->default_str(value);
}

void Arguments::text(const std::string& names, std::optional<std::string>& value, const std::string& help) {
  add(
      app_, names, value, [](const std::string& word) -> Result<std::string> { return word; }, "TEXT", help);
}

void Arguments::flag(const std::string& names, bool& value, const std::string& help) {
  app_.add_flag(names, value, help);
}

void Arguments::word(const std::string& names, std::string& value, const std::string& type, const std::string& help) {
  app_.add_option(names, value, help)->type_name(type)->default_str(value);
}

void Arguments::count(const std::string& names, std::uint32_t& value, std::uint32_t min, std::uint32_t max,
                      const std::string& help) {
  add(app_, names, value, count_parser(min, max), "N", help)->default_str(std::to_string(value));
}

void Arguments::count(const std::string& names, std::optional<std::uint32_t>& value, std::uint32_t min,
                      std::uint32_t max, const std::string& help) {
  add(app_, names, value, count_parser(min, max), "N", help);
}

void Arguments::seed(const std::string& names, std::uint64_t& value, const std::string& help) {
  add(app_, names, value, parse_count, "N", help)->default_str(std::to_string(value));
}

void Arguments::number(const std::string& names, double& value, double min, double max, const std::string& help) {
  add(app_, names, value, number_parser(min, max), "R", help)->default_str(shortest(value));
}

void Arguments::number(const std::string& names, std::optional<double>& value, double min, double max,
                       const std::string& help) {
  add(app_, names, value, number_parser(min, max), "R", help);
}

void Arguments::length_m(const std::string& names, std::optional<double>& value, const std::string& help) {
  const auto parse = [](const std::string& word) -> Result<double> {
    auto parsed = parse_length_m(word);
    if (parsed && *parsed < 0.0) return Error{ErrorCode::BadArgument, "'" + word + "' is below zero", ""};
    return parsed;
  };
  add(app_, names, value, parse, "LENGTH", help);
}

void Arguments::bytes(const std::string& names, std::uint64_t& value, const std::string& help) {
  add(app_, names, value, parse_bytes, "SIZE", help);
}

void Arguments::point_m(const std::string& names, std::optional<glm::dvec3>& value, const std::string& help) {
  add(app_, names, value, parse_point_m, "X,Y,Z", help);
}

void Arguments::picture_size(const std::string& names, PictureSize& value, const std::string& help) {
  add(app_, names, value, parse_picture_size, "WxH", help)
      ->default_str(std::to_string(value.width_px) + "x" + std::to_string(value.height_px));
}

}  // namespace lodestone::cli

// SPDX-License-Identifier: MIT
#include "units.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>

namespace lodestone::cli {
namespace {

struct Unit {
  std::string_view name;
  double factor;
};
constexpr Unit length_units[] = {{"", 1.0}, {"m", 1.0}, {"mm", 1e-3}, {"cm", 1e-2}, {"km", 1e3}};
constexpr Unit byte_units[] = {{"", 1.0},    {"b", 1.0},      {"kb", 1e3},     {"mb", 1e6},     {"gb", 1e9},
                               {"tb", 1e12}, {"kib", 0x1p10}, {"mib", 0x1p20}, {"gib", 0x1p30}, {"tib", 0x1p40}};
constexpr Unit count_units[] = {{"", 1.0}, {"k", 1e3}, {"M", 1e6}};

Error bad(const std::string& text, const std::string& wanted) {
  return {ErrorCode::BadArgument, "'" + text + "' is not " + wanted, ""};
}

// A number and one of the units behind it. NaN and infinity are no numbers here.
Result<double> parse_with_unit(const std::string& text, std::span<const Unit> units, const std::string& wanted) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, fault] = std::from_chars(text.data(), end, value);
  if (fault != std::errc{} || !std::isfinite(value)) return bad(text, wanted);
  const std::string_view suffix{rest, static_cast<std::size_t>(end - rest)};
  for (const Unit& unit : units) {
    if (unit.name == suffix) return value * unit.factor;
  }
  return bad(text, wanted);
}

Result<std::uint64_t> whole(const Result<double>& value, const std::string& text, const std::string& wanted) {
  if (!value) return value.error();
  if (*value < 0.0 || *value > 0x1p53 || *value != std::floor(*value)) return bad(text, wanted);
  return static_cast<std::uint64_t>(*value);
}

}  // namespace

Result<double> parse_length_m(const std::string& text) {
  return parse_with_unit(text, length_units, "a length such as 2mm, 3cm, 0.5m or 1km");
}

Result<double> parse_number(const std::string& text) { return parse_with_unit(text, {length_units, 1}, "a number"); }

Result<std::uint64_t> parse_bytes(const std::string& text) {
  const std::string wanted = "a size such as 4096, 512MB or 2GiB";
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto value = parse_with_unit(lower, byte_units, wanted);
  return value ? whole(value, text, wanted) : bad(text, wanted);
}

Result<std::uint64_t> parse_count(const std::string& text) {
  const std::string wanted = "a whole number such as 50000, 50k or 2M";
  return whole(parse_with_unit(text, count_units, wanted), text, wanted);
}

Result<glm::dvec3> parse_point_m(const std::string& text) {
  glm::dvec3 point{0.0};
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = text.find(',', begin);
    if ((comma == std::string::npos) != (axis == 2)) return bad(text, "a point X,Y,Z");
    const auto value = parse_length_m(text.substr(begin, comma - begin));
    if (!value) return bad(text, "a point X,Y,Z");
    point[axis] = *value;
    begin = comma + 1;
  }
  return point;
}

Result<PictureSize> parse_picture_size(const std::string& text) {
  constexpr std::uint64_t max_px = 16384;
  const std::string wanted = "a picture size such as 1280x720, each side 1 to 16384";
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) return bad(text, wanted);
  const auto width = parse_count(text.substr(0, cross));
  const auto height = parse_count(text.substr(cross + 1));
  if (!width || !height || *width < 1 || *height < 1 || *width > max_px || *height > max_px) return bad(text, wanted);
  return PictureSize{static_cast<std::uint32_t>(*width), static_cast<std::uint32_t>(*height)};
}

}  // namespace lodestone::cli

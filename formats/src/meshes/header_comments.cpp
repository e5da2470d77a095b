// SPDX-License-Identifier: MIT
#include "header_comments.h"

#include <charconv>
#include <cmath>

#include "line_reader.h"

namespace lodestone {
namespace {

bool contains(std::string_view text, std::string_view word) { return text.find(word) != text.npos; }

std::optional<glm::dvec3> three_numbers_after(std::string_view text, std::string_view word) {
  const std::size_t at = text.find(word);
  if (at == text.npos) return std::nullopt;
  Words words{text.substr(at + word.size())};
  glm::dvec3 v{0.0};
  for (int i = 0; i < 3; ++i) {
    if (!words.number(v[i]) || !std::isfinite(v[i])) return std::nullopt;
  }
  return v;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

void HeaderComments::read(std::string_view comment) {
  std::string text{comment};
  for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
  if (auto found = three_numbers_after(text, "offset subtracted:")) offset = found;
  if (auto found = three_numbers_after(text, "origin:")) origin = found;
  if (const std::size_t at = text.find("epsg:"); at != std::string::npos) {
    std::size_t last = at + 5;
    while (last < text.size() && last < at + 15 && is_digit(text[last])) ++last;
    if (last > at + 5) crs = "EPSG:" + text.substr(at + 5, last - at - 5);
  }
  if (contains(text, "y up") || contains(text, "y-up")) up = UpAxis::Y;
  if (contains(text, "z up") || contains(text, "z-up")) up = UpAxis::Z;
}

void HeaderComments::place(Mesh& mesh, const glm::dvec3& at) const {
  mesh.origin = at + offset.value_or(glm::dvec3{0.0});
  mesh.crs = crs;
}

std::string place_comments(const Mesh& mesh, std::string_view prefix) {
  std::string text = std::string{prefix} + "Z up, metres\n";
  if (mesh.origin != glm::dvec3{0.0}) {
    text.append(prefix).append("origin:");
    for (int a = 0; a < 3; ++a) {
      char digits[32];
      const auto [last, error] = std::to_chars(digits, digits + sizeof digits, mesh.origin[a]);
      text.append(" ").append(digits, last);
    }
    text += '\n';
  }
  if (!mesh.crs.empty() && mesh.crs.find_first_of("\r\n") == std::string::npos) {
    text.append(prefix).append("crs ").append(mesh.crs).append("\n");
  }
  return text;
}

}  // namespace lodestone

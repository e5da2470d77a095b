// SPDX-License-Identifier: MIT
// The looks that a CityGML file gives its polygons: appearance module of CityGML 2.0 (section 9 of OGC 12-019).
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "city_builder.h"

namespace lodestone::gis {

// "bldg:Window" -> "Window"
[[nodiscard]] std::string_view local_name(const pugi::xml_node& node) noexcept;
// The gml:id, empty if there is none.
[[nodiscard]] std::string_view gml_id(const pugi::xml_node& node) noexcept;
// Whitespace-separated numbers; what is not a number ends the list. Not-a-number is kept for the caller to judge.
[[nodiscard]] std::vector<double> numbers(std::string_view text);

class Appearances {
 public:
  // Walks the whole document. One theme is used (the first that textures something, else the first); others are
  // named in a warning.
  Appearances(const pugi::xml_node& root, Warnings& warnings);

  // The look of a polygon: its own, else that of the nearest enclosing geometry that has one.
  [[nodiscard]] Look look_of(const pugi::xml_node& polygon) const;
  // uv of a ring of `polygon`, in the file's order with the closing point; empty if it is not textured.
  [[nodiscard]] std::vector<glm::vec2> uvs_of(const pugi::xml_node& ring) const;

 private:
  struct Texture {
    std::string uri;
  };
  void add_material(const pugi::xml_node& material);
  void add_texture(const pugi::xml_node& texture);

  std::unordered_map<std::string_view, glm::vec4> colors_;        // by target id
  std::unordered_map<std::string_view, std::string> textures_;    // image by target id
  std::unordered_map<std::string_view, std::string_view> rings_;  // coordinate text by ring id
};

}  // namespace lodestone::gis

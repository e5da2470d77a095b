// SPDX-License-Identifier: MIT
#include "citygml_appearance.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

namespace lodestone::gis {
namespace {

// "#id" or "file#id" -> "id"
std::string_view target_id(std::string_view uri) noexcept {
  while (!uri.empty() && static_cast<unsigned char>(uri.front()) <= ' ') uri.remove_prefix(1);
  while (!uri.empty() && static_cast<unsigned char>(uri.back()) <= ' ') uri.remove_suffix(1);
  const std::size_t hash = uri.rfind('#');
  return hash == std::string_view::npos ? uri : uri.substr(hash + 1);
}

pugi::xml_node child(const pugi::xml_node& node, std::string_view name) noexcept {
  for (const pugi::xml_node c : node.children()) {
    if (local_name(c) == name) return c;
  }
  return {};
}

struct Theme {
  std::vector<pugi::xml_node> materials;
  std::vector<pugi::xml_node> textures;
};

struct ThemeCollector final : pugi::xml_tree_walker {
  std::vector<std::pair<std::string, Theme>> themes;  // in file order
  bool georeferenced = false;

  bool for_each(pugi::xml_node& node) override {
    const std::string_view name = local_name(node);
    if (name == "X3DMaterial") {
      theme_of(node).materials.push_back(node);
    } else if (name == "ParameterizedTexture") {
      theme_of(node).textures.push_back(node);
    } else if (name == "GeoreferencedTexture") {
      georeferenced = true;
    }
    return true;
  }

  Theme& theme_of(const pugi::xml_node& data) {
    const std::string name = child(data.parent().parent(), "theme").text().get();
    for (auto& [known, theme] : themes) {
      if (known == name) return theme;
    }
    return themes.emplace_back(name, Theme{}).second;
  }
};

}  // namespace

std::string_view local_name(const pugi::xml_node& node) noexcept {
  const std::string_view name = node.name();
  const std::size_t colon = name.rfind(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

std::string_view gml_id(const pugi::xml_node& node) noexcept {
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    const std::string_view name = attribute.name();
    if (name == "gml:id" || name == "id" || (name.size() > 3 && name.substr(name.size() - 3) == ":id")) {
      return attribute.value();
    }
  }
  return {};
}

std::vector<double> numbers(std::string_view text) {
  std::vector<double> list;
  const char* at = text.data();
  const char* end = at + text.size();
  while (true) {
    while (at != end && (static_cast<unsigned char>(*at) <= ' ' || *at == '+')) ++at;
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error == std::errc::result_out_of_range) value = std::nan("");
    if (next == at) return list;
    list.push_back(value);
    at = next;
  }
}

Appearances::Appearances(const pugi::xml_node& root, Warnings& warnings) {
  ThemeCollector collector;
  pugi::xml_node start = root;
  start.traverse(collector);
  if (collector.georeferenced) warnings.add("georeferenced textures are not supported and were left out");
  if (collector.themes.empty()) return;
  const auto textured = std::find_if(collector.themes.begin(), collector.themes.end(),
                                     [](const auto& entry) { return !entry.second.textures.empty(); });
  const auto& used = textured == collector.themes.end() ? collector.themes.front() : *textured;
  for (const auto& entry : collector.themes) {
    if (&entry != &used)
      warnings.add("appearance theme '" + entry.first + "' was left out; '" + used.first + "' is used");
  }
  for (const auto& material : used.second.materials) add_material(material);
  for (const auto& texture : used.second.textures) add_texture(texture);
}

void Appearances::add_material(const pugi::xml_node& material) {
  if (child(material, "isFront").text().as_bool(true) == false) return;
  glm::vec4 color{1.0F};
  const auto diffuse = numbers(child(material, "diffuseColor").text().get());
  if (diffuse.size() >= 3) {
    for (int c = 0; c < 3; ++c)
      color[c] = std::clamp(static_cast<float>(diffuse[static_cast<std::size_t>(c)]), 0.0F, 1.0F);
  }
  const float transparency = child(material, "transparency").text().as_float(0.0F);
  color.a = std::clamp(1.0F - transparency, 0.0F, 1.0F);
  for (int c = 0; c < 4; ++c) {
    if (std::isnan(color[c])) color[c] = 1.0F;
  }
  for (const pugi::xml_node& target : material.children()) {
    if (local_name(target) == "target") colors_.try_emplace(target_id(target.text().get()), color);
  }
}

void Appearances::add_texture(const pugi::xml_node& texture) {
  if (child(texture, "isFront").text().as_bool(true) == false) return;
  const std::string uri = child(texture, "imageURI").text().get();
  for (const pugi::xml_node& target : texture.children()) {
    if (local_name(target) != "target") continue;
    std::string_view id = target_id(target.attribute("uri").value());
    if (id.empty()) id = target_id(target.text().get());
    textures_.try_emplace(id, uri);
    for (const pugi::xml_node& coordinates : child(target, "TexCoordList").children()) {
      if (local_name(coordinates) != "textureCoordinates") continue;
      rings_.try_emplace(target_id(coordinates.attribute("ring").value()), coordinates.text().get());
    }
  }
}

Look Appearances::look_of(const pugi::xml_node& polygon) const {
  Look look;
  bool colored = false;
  bool textured = false;
  for (pugi::xml_node node = polygon; node; node = node.parent()) {
    const std::string_view id = gml_id(node);
    if (id.empty()) continue;
    if (const auto color = colors_.find(id); !colored && color != colors_.end()) {
      look.color = color->second;
      colored = true;
    }
    if (const auto texture = textures_.find(id); !textured && texture != textures_.end()) {
      look.texture_uri = texture->second;
      textured = true;
    }
    if (colored && textured) break;
  }
  if (!look.texture_uri.empty()) {
    look.name = std::filesystem::path{look.texture_uri}.stem().string();
  } else {
    look.name = colored ? "color" : "default";
  }
  return look;
}

std::vector<glm::vec2> Appearances::uvs_of(const pugi::xml_node& ring) const {
  const auto entry = rings_.find(gml_id(ring));
  if (entry == rings_.end() || gml_id(ring).empty()) return {};
  const auto values = numbers(entry->second);
  std::vector<glm::vec2> uvs;
  for (std::size_t i = 0; i + 1 < values.size(); i += 2) uvs.emplace_back(values[i], values[i + 1]);
  return uvs;
}

}  // namespace lodestone::gis

// SPDX-License-Identifier: MIT
// CityJSON 1.0, 1.1 and 2.0, and CityJSONSeq (one JSON object a line): every surface geometry, templates, semantic
// surfaces, materials and textures. Of several levels of detail each object's highest is taken, and none where its
// children have a higher one.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "city_builder.h"

namespace lodestone {
namespace gis {
namespace {

using Json = nlohmann::json;

const Json& member(const Json& object, const char* key) {
  static const Json null;
  if (!object.is_object()) return null;
  const auto entry = object.find(key);
  return entry == object.end() ? null : *entry;
}

std::string text(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string{}; }

std::optional<std::size_t> index_of(const Json& value, std::size_t size) {
  if (!value.is_number_integer() && !value.is_number_unsigned()) return std::nullopt;
  const auto i = value.get<std::int64_t>();
  if (i < 0 || static_cast<std::uint64_t>(i) >= size) return std::nullopt;
  return static_cast<std::size_t>(i);
}

double number(const Json& value, double otherwise) { return value.is_number() ? value.get<double>() : otherwise; }

// "2.2" and 2.2 alike; 0 if there is none.
double lod_of(const Json& geometry) {
  const Json& lod = member(geometry, "lod");
  if (lod.is_number()) return lod.get<double>();
  const std::string word = text(lod);
  return word.empty() ? 0.0 : std::strtod(word.c_str(), nullptr);
}

// How many arrays lie around one surface in `boundaries`: MultiSurface 1, Solid 2, MultiSolid 3.
int nesting_of(const std::string& type) {
  if (type == "MultiSurface" || type == "CompositeSurface") return 0;
  if (type == "Solid") return 1;
  if (type == "MultiSolid" || type == "CompositeSolid") return 2;
  return -1;
}

// What the surfaces of one geometry need to find their place, meaning and look.
struct Scope {
  const std::vector<glm::dvec3>* points;
  glm::dmat4 transform;
  FeatureId feature;
  const Json* appearance;
};

class CityJsonReader {
 public:
  CityJsonReader(const Input& input, const ReadOptions& options) : input_(input), builder_(input, options) {}

  Status add_document(const Json& document) {
    const std::string type = text(member(document, "type"));
    if (type == "CityJSON") {
      const std::string version = text(member(document, "version"));
      if (version.substr(0, 2) != "1." && version.substr(0, 2) != "2.") {
        return Error{ErrorCode::Unsupported, "is CityJSON version '" + version + "'; versions 1.0 to 2.0 are read",
                     input_.name()};
      }
      root_ = Json::object();
      for (const char* key : {"transform", "appearance", "geometry-templates"}) root_[key] = member(document, key);
      const Json& metadata = member(document, "metadata");
      if (const auto crs = text(member(metadata, "referenceSystem")); !crs.empty()) builder_.set_crs(crs);
      read_templates();
    } else if (type != "CityJSONFeature") {
      return Error{ErrorCode::BadData, "is JSON but not CityJSON: its type is '" + type + "'", input_.name()};
    }
    const auto points = read_points(member(document, "vertices"), true);
    const Json& appearance =
        member(document, "appearance").is_object() ? member(document, "appearance") : member(root_, "appearance");
    read_objects(member(document, "CityObjects"), points, appearance);
    return Done{};
  }

  Result<LoadedMesh> finish(const Context& context) { return builder_.finish("cityjson", context); }

 private:
  std::vector<glm::dvec3> read_points(const Json& list, bool transformed) {
    glm::dvec3 scale{1.0};
    glm::dvec3 translate{0.0};
    if (const Json& transform = member(root_, "transform"); transformed && transform.is_object()) {
      const Json& s = member(transform, "scale");
      const Json& t = member(transform, "translate");
      for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        if (s.is_array() && s.size() == 3) scale[axis] = number(s[i], 1.0);
        if (t.is_array() && t.size() == 3) translate[axis] = number(t[i], 0.0);
      }
    }
    std::vector<glm::dvec3> points;
    if (!list.is_array()) return points;
    points.reserve(list.size());
    for (const Json& p : list) {
      glm::dvec3 at{std::nan("")};
      if (p.is_array() && p.size() >= 3) at = {number(p[0], at.x), number(p[1], at.x), number(p[2], at.x)};
      points.push_back(at * scale + translate);
    }
    return points;
  }

  void read_templates() {
    const Json& templates = member(root_, "geometry-templates");
    template_points_ = read_points(member(templates, "vertices-templates"), false);
  }

  void read_objects(const Json& objects, const std::vector<glm::dvec3>& points, const Json& appearance) {
    if (!objects.is_object()) return;
    // Children after their parents, so that features can name them; names sort the rest.
    std::unordered_map<std::string, FeatureId> features;
    for (const auto& [id, object] : objects.items()) read_feature(objects, id, features, 0);
    std::unordered_map<std::string, double> lods;  // of an object and all below it
    for (const auto& [id, object] : objects.items()) {
      if (builder_.full()) return;
      const double lod = highest_lod(object);
      if (lod < highest_lod_with_children(objects, id, lods)) continue;
      for (const Json& geometry : member(object, "geometry")) {
        if (lod_of(geometry) == lod) {
          read_geometry(geometry, {&points, glm::dmat4{1.0}, features[id], &appearance}, id);
        }
      }
    }
  }

  FeatureId read_feature(const Json& objects, const std::string& id,
                         std::unordered_map<std::string, FeatureId>& features, int depth) {
    if (const auto known = features.find(id); known != features.end()) return known->second;
    const Json& object = objects[id];
    FeatureId parent = none;
    if (const Json& parents = member(object, "parents"); parents.is_array() && !parents.empty() && depth < 32) {
      const std::string name = text(parents[0]);
      if (name != id && objects.contains(name)) parent = read_feature(objects, name, features, depth + 1);
      if (const auto known = features.find(id); known != features.end()) return known->second;  // a circle of parents
    }
    const FeatureId feature = builder_.add_feature(id, text(member(object, "type")), parent);
    features.emplace(id, feature);
    return feature;
  }

  static double highest_lod(const Json& object) {
    double lod = -1.0;
    for (const Json& geometry : member(object, "geometry")) lod = std::max(lod, lod_of(geometry));
    return lod;
  }

  static double highest_lod_with_children(const Json& objects, const std::string& id,
                                          std::unordered_map<std::string, double>& known) {
    const auto object = objects.find(id);
    if (object == objects.end()) return -1.0;
    const auto [entry, fresh] = known.try_emplace(id, highest_lod(*object));  // entered first: ends circles
    if (!fresh) return entry->second;
    double lod = entry->second;
    for (const Json& child : member(*object, "children")) {
      lod = std::max(lod, highest_lod_with_children(objects, text(child), known));
    }
    return known[id] = lod;
  }

  void read_geometry(const Json& geometry, Scope scope, const std::string& id) {
    const std::string type = text(member(geometry, "type"));
    if (type == "GeometryInstance") return read_instance(geometry, scope, id);
    const int nesting = nesting_of(type);
    if (nesting < 0) {
      if (type != "MultiPoint" && type != "MultiLineString") {
        builder_.warnings().add("geometry of type '" + type + "' is not known and was left out", id);
      }
      return;
    }
    std::vector<FeatureId> surfaces;
    const Json& semantics = member(geometry, "semantics");
    read_semantics(member(semantics, "surfaces"), scope.feature, id, surfaces);
    read_level(member(geometry, "boundaries"), member(semantics, "values"), theme_values(member(geometry, "material")),
               theme_values(member(geometry, "texture")), nesting, scope, surfaces, id);
  }

  void read_semantics(const Json& list, FeatureId object, const std::string& id, std::vector<FeatureId>& surfaces) {
    if (!list.is_array()) return;
    for (std::size_t i = 0; i < list.size(); ++i) {
      // A parent may come later in the list; then the object stands in for it.
      const auto parent = index_of(member(list[i], "parent"), surfaces.size());
      surfaces.push_back(builder_.add_feature(id + "#" + std::to_string(i), text(member(list[i], "type")),
                                              parent ? surfaces[*parent] : object));
    }
  }

  // {"theme": {"values": [...]}} or {"theme": {"value": n}}: the first theme by name.
  static const Json& theme_values(const Json& themes) {
    static const Json null;
    if (!themes.is_object() || themes.empty()) return null;
    const Json& theme = themes.begin().value();
    const Json& values = member(theme, "values");
    return values.is_null() ? member(theme, "value") : values;
  }

  static const Json& at(const Json& values, std::size_t i) {
    static const Json null;
    if (!values.is_array()) return values;  // one value for all
    return i < values.size() ? values[i] : null;
  }

  void read_level(const Json& boundaries, const Json& semantics, const Json& materials, const Json& textures,
                  int nesting, const Scope& scope, const std::vector<FeatureId>& surfaces, const std::string& id) {
    if (!boundaries.is_array()) return;
    for (std::size_t i = 0; i < boundaries.size(); ++i) {
      if (nesting > 0) {
        read_level(boundaries[i], at(semantics, i), at(materials, i), at(textures, i), nesting - 1, scope, surfaces,
                   id);
      } else {
        read_surface(boundaries[i], at(semantics, i), at(materials, i), at(textures, i), scope, surfaces, id);
      }
    }
  }

  void read_surface(const Json& rings, const Json& semantic, const Json& material, const Json& texture,
                    const Scope& scope, const std::vector<FeatureId>& surfaces, const std::string& id) {
    if (!rings.is_array() || builder_.full()) return;
    Polygon polygon;
    polygon.feature = scope.feature;
    if (const auto surface = index_of(semantic, surfaces.size())) polygon.feature = surfaces[*surface];
    Look look = material_look(*scope.appearance, material);
    for (std::size_t r = 0; r < rings.size(); ++r) {
      polygon.rings.push_back(read_ring(rings[r], at(texture, r), scope, look, id));
    }
    polygon.material = builder_.material(look);
    if (!polygon.rings.empty()) builder_.add(std::move(polygon), id);
  }

  Ring read_ring(const Json& indices, const Json& texture, const Scope& scope, Look& look, const std::string& id) {
    Ring ring;
    if (!indices.is_array()) return ring;
    for (const Json& index : indices) {
      const auto i = index_of(index, scope.points->size());
      if (!i) {
        builder_.warnings().add("a boundary names a vertex that is not there; the point was left out", id);
        continue;
      }
      ring.points.emplace_back(scope.transform * glm::dvec4{(*scope.points)[*i], 1.0});
    }
    if (!texture.is_array() || texture.size() != ring.points.size() + 1) return ring;
    const Json& images = member(*scope.appearance, "textures");
    const Json& uvs = member(*scope.appearance, "vertices-texture");
    if (!images.is_array() || !uvs.is_array()) return ring;
    const auto image = index_of(texture[0], images.size());
    if (!image) return ring;
    for (std::size_t i = 1; i < texture.size(); ++i) {
      const auto uv = index_of(texture[i], uvs.size());
      if (!uv || !uvs[*uv].is_array() || uvs[*uv].size() < 2) {
        ring.uvs.clear();
        builder_.warnings().add("a ring names a texture coordinate that is not there; its texture was left out", id);
        return ring;
      }
      ring.uvs.emplace_back(number(uvs[*uv][0], 0.0), number(uvs[*uv][1], 0.0));
    }
    look.texture_uri = text(member(images[*image], "image"));
    look.name = std::filesystem::path{look.texture_uri}.stem().string();
    return ring;
  }

  static Look material_look(const Json& appearance, const Json& index) {
    Look look;
    look.name = "default";
    const Json& list = member(appearance, "materials");
    const auto i = list.is_array() ? index_of(index, list.size()) : std::nullopt;
    if (!i) return look;
    const Json& material = list[*i];
    look.name = text(member(material, "name"));
    if (const Json& color = member(material, "diffuseColor"); color.is_array() && color.size() >= 3) {
      for (int c = 0; c < 3; ++c) {
        look.color[c] = std::clamp(static_cast<float>(number(color[static_cast<std::size_t>(c)], 1.0)), 0.0F, 1.0F);
      }
    }
    look.color.a = std::clamp(1.0F - static_cast<float>(number(member(material, "transparency"), 0.0)), 0.0F, 1.0F);
    return look;
  }

  void read_instance(const Json& instance, Scope scope, const std::string& id) {
    const Json& templates = member(member(root_, "geometry-templates"), "templates");
    const auto which = templates.is_array() ? index_of(member(instance, "template"), templates.size()) : std::nullopt;
    const Json& boundaries = member(instance, "boundaries");
    const Json& matrix = member(instance, "transformationMatrix");
    const auto anchor =
        boundaries.is_array() && !boundaries.empty() ? index_of(boundaries[0], scope.points->size()) : std::nullopt;
    if (!which || !anchor || text(member(templates[*which], "type")) == "GeometryInstance") {
      builder_.warnings().add("a geometry instance names a template or a vertex that is not there", id);
      return;
    }
    if (matrix.is_array() && matrix.size() == 16) {
      for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
          scope.transform[column][row] =
              number(matrix[4 * static_cast<std::size_t>(row) + static_cast<std::size_t>(column)], 0.0);
        }
      }
    }
    scope.transform[3] += glm::dvec4{(*scope.points)[*anchor], 0.0};
    scope.points = &template_points_;
    scope.appearance = &member(root_, "appearance");
    read_geometry(templates[*which], scope, id);
  }

  const Input& input_;
  CityBuilder builder_;
  Json root_;  // what is not of the city's objects, which may be most of the memory
  std::vector<glm::dvec3> template_points_;
};

}  // namespace
}  // namespace gis

Result<LoadedMesh> read_cityjson(const Input& input, const ReadOptions& options, const Context& context) {
  constexpr std::uint64_t max_document_bytes = 2ULL << 30;  // the document is held in memory, about ten times its size
  if (input.size() > max_document_bytes) return too_large(input, "bytes", input.size(), max_document_bytes);
  const auto bytes = input.read_all();
  if (!bytes) return bytes.error();
  gis::CityJsonReader reader{input, options};
  try {
    const std::string_view all{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    auto whole = nlohmann::json::parse(all, nullptr, false);
    if (!whole.is_discarded()) {
      if (const auto status = reader.add_document(whole); !status) return status.error();
      return reader.finish(context);
    }
    // Several documents, one a line; a fault in the first is a fault of the file.
    std::size_t line_count = 0;
    for (std::size_t begin = 0; begin < all.size();) {
      if (context.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", input.name()};
      const std::size_t end = std::min(all.find('\n', begin), all.size());
      const std::string_view line = all.substr(begin, end - begin);
      begin = end + 1;
      ++line_count;
      if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
      if (const auto status = reader.add_document(nlohmann::json::parse(line)); !status) return status.error();
    }
    return reader.finish(context);
  } catch (const nlohmann::json::exception& fault) {
    return Error{ErrorCode::BadData, std::string{"is not valid JSON: "} + fault.what(), input.name()};
  }
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
// CityGML 2.0 (OGC 12-019): buildings and every other city object with surface geometry, semantic surfaces as
// features, X3D materials and parameterised textures.
//
// In GML an element that begins with a capital letter is an object, one in lower case a property of the object around
// it; that rule alone finds city objects in every module, application domain extensions included. Of several levels of
// detail each object's highest is taken, and none where its parts have a higher one.
#include <algorithm>
#include <cctype>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "citygml_appearance.h"

namespace lodestone {
namespace gis {
namespace {

constexpr int max_depth = 64;  // of nesting, xlinks included

// N of a property named lodNGeometry, lodNMultiSurface, lodNSolid, lodNImplicitRepresentation, ...; else -1.
int lod_of(std::string_view property) noexcept {
  const bool is_lod = property.size() > 4 && property.substr(0, 3) == "lod" && property[3] >= '0' && property[3] <= '4';
  return is_lod ? property[3] - '0' : -1;
}

bool is_object(std::string_view name) noexcept {
  return !name.empty() && std::isupper(static_cast<unsigned char>(name.front())) != 0;
}

struct NodeHash {
  std::size_t operator()(const pugi::xml_node& node) const noexcept { return node.hash_value(); }
};

class CityGmlReader {
 public:
  CityGmlReader(const pugi::xml_node& root, const Input& input, const ReadOptions& options)
      : root_(root),
        builder_(input, options),
        appearances_(root, builder_.warnings()),
        max_visits_(10'000'000 + input.size() / 32) {
    index_ids(root, 0);
  }

  Result<LoadedMesh> read(const Context& context) {
    for (const pugi::xml_node& member : root_.children()) {
      if (context.cancelled() || builder_.full()) break;
      const std::string_view name = local_name(member);
      if (name == "boundedBy") find_crs(member, 0);
      if (name != "cityObjectMember" && name != "featureMember") continue;
      for (const pugi::xml_node& object : member.children()) {
        if (is_object(local_name(object))) read_object(object, none, 0);
      }
    }
    return builder_.finish("citygml", context);
  }

 private:
  void index_ids(const pugi::xml_node& node, int depth) {
    for (const pugi::xml_node& child : node.children()) {
      if (const auto id = gml_id(child); !id.empty()) ids_.try_emplace(id, child);
      if (depth < 4 * max_depth) index_ids(child, depth + 1);
    }
  }

  void find_crs(const pugi::xml_node& node, int depth) {
    if (const char* name = node.attribute("srsName").value(); *name != '\0') builder_.set_crs(name);
    for (const pugi::xml_node& child : node.children()) {
      if (depth < 4) find_crs(child, depth + 1);
    }
  }

  // What xlink:href names, or the node itself.
  pugi::xml_node resolve(const pugi::xml_node& node) {
    const std::string_view href = node.attribute("xlink:href").value();
    if (href.empty()) return node;
    const auto target = ids_.find(href.front() == '#' ? href.substr(1) : href);
    if (target != ids_.end()) return target->second;
    builder_.warnings().add("a reference leads nowhere (xlink:href)", std::string{href});
    return {};
  }

  // References may multiply (two links to a group that holds two links, and so on): an end to that.
  bool may_visit() {
    if (++visits_ == max_visits_) builder_.warnings().add("references multiply without end; the rest was left out");
    return visits_ < max_visits_;
  }

  static bool is_geometry_property(std::string_view name) noexcept { return lod_of(name) >= 0 || name == "tin"; }

  // A city object: first its parts, so that a surface that both name counts as the part's; then its own geometry.
  // Returns the highest level of detail met, -1 if there is no geometry.
  int read_object(const pugi::xml_node& object, FeatureId parent, int depth) {
    if (depth > max_depth) return -1;
    const std::string id{gml_id(object)};
    const FeatureId feature = builder_.add_feature(id, std::string{local_name(object)}, parent);
    int parts_lod = -1;
    int own_lod = -1;
    for (const pugi::xml_node& property : object.children()) {
      const std::string_view name = local_name(property);
      if (is_geometry_property(name)) {
        own_lod = std::max(own_lod, std::max(lod_of(name), 0));
        continue;
      }
      if (is_object(name)) continue;  // not a property: malformed
      for (const pugi::xml_node& part : property.children()) {
        const std::string_view part_name = local_name(part);
        if (!is_object(part_name) || part_name == "Envelope" || part_name == "Address") continue;
        if (holds_geometry(part, 0)) parts_lod = std::max(parts_lod, read_object(part, feature, depth + 1));
      }
    }
    if (own_lod < parts_lod) return parts_lod;
    for (const pugi::xml_node& property : object.children()) {
      const std::string_view name = local_name(property);
      if (is_geometry_property(name) && std::max(lod_of(name), 0) == own_lod) {
        read_geometry(property, {glm::dmat4{1.0}, feature, false}, 0);
      }
    }
    return std::max(own_lod, parts_lod);
  }

  static bool holds_geometry(const pugi::xml_node& node, int depth) {
    for (const pugi::xml_node& child : node.children()) {
      if (is_geometry_property(local_name(child))) return true;
      if (depth < max_depth && holds_geometry(child, depth + 1)) return true;
    }
    return false;
  }

  struct Placement {
    glm::dmat4 transform;
    FeatureId feature;
    bool reversed;
  };

  void read_geometry(const pugi::xml_node& holder, Placement place, int depth) {
    if (depth > max_depth || builder_.full() || !may_visit()) return;
    if (std::find(open_.begin(), open_.end(), holder) != open_.end()) {
      builder_.warnings().add("references go round in a circle; they were followed once");
      return;
    }
    open_.push_back(holder);
    for (const pugi::xml_node& link : holder.children()) {
      const pugi::xml_node node = link.attribute("xlink:href") ? resolve(link) : link;
      if (!node) continue;
      const std::string_view name = local_name(node);
      if (name == "Polygon" || name == "PolygonPatch" || name == "Triangle" || name == "Rectangle") {
        read_polygon(node, place);
      } else if (name == "ImplicitGeometry") {
        read_implicit(node, place, depth);
      } else if (name == "OrientableSurface") {
        Placement turned = place;
        turned.reversed ^= std::string_view{node.attribute("orientation").value()} == "-";
        read_geometry(node, turned, depth + 1);
      } else {
        read_geometry(node, place, depth + 1);
      }
    }
    if (holder.attribute("xlink:href")) read_linked(holder, place, depth);
    open_.pop_back();
  }

  // A property without content that names a geometry elsewhere: <surfaceMember xlink:href="#id"/>.
  void read_linked(const pugi::xml_node& holder, const Placement& place, int depth) {
    const pugi::xml_node target = resolve(holder);
    if (!target || target == holder) return;
    const std::string_view name = local_name(target);
    if (name == "Polygon" || name == "PolygonPatch" || name == "Triangle" || name == "Rectangle") {
      read_polygon(target, place);
    } else {
      read_geometry(target, place, depth + 1);
    }
  }

  void read_implicit(const pugi::xml_node& node, Placement place, int depth) {
    pugi::xml_node geometry;
    for (const pugi::xml_node& property : node.children()) {
      const std::string_view name = local_name(property);
      if (name == "transformationMatrix") {
        const auto m = numbers(property.text().get());
        if (m.size() != 16) {
          builder_.warnings().add("an implicit geometry's transformationMatrix has not 16 numbers; it was left out");
          return;
        }
        for (int row = 0; row < 4; ++row) {
          for (int column = 0; column < 4; ++column) {
            place.transform[column][row] = m[4 * static_cast<std::size_t>(row) + static_cast<std::size_t>(column)];
          }
        }
      } else if (name == "relativeGMLGeometry") {
        geometry = property;
      } else if (name == "referencePoint") {
        const auto p = numbers(property.first_child().first_child().text().get());
        if (p.size() == 3) reference_ = {p[0], p[1], p[2]};
      } else if (name == "libraryObject") {
        builder_.warnings().add("an implicit geometry names a file of its own (libraryObject), which is not read");
      }
    }
    if (!geometry) return;
    place.transform[3] += glm::dvec4{reference_, 0.0};
    in_template_ = true;  // the same polygons may be placed many times
    read_geometry(geometry, place, depth + 1);
    in_template_ = false;
    reference_ = glm::dvec3{0.0};
  }

  void read_polygon(const pugi::xml_node& node, const Placement& place) {
    if (!in_template_ && !seen_.insert(node).second) return;
    Polygon polygon;
    polygon.feature = place.feature;
    polygon.reversed = place.reversed;
    const Look look = appearances_.look_of(node);
    polygon.material = builder_.material(look);
    for (const pugi::xml_node& property : node.children()) {
      const std::string_view name = local_name(property);
      if (name != "exterior" && name != "interior") continue;
      for (const pugi::xml_node& ring : property.children()) {
        if (local_name(ring) == "LinearRing") polygon.rings.push_back(read_ring(ring, place, look));
      }
    }
    if (!polygon.rings.empty()) builder_.add(std::move(polygon), std::string{gml_id(node)});
  }

  Ring read_ring(const pugi::xml_node& node, const Placement& place, const Look& look) {
    std::vector<double> values;
    for (const pugi::xml_node& child : node.children()) {
      const std::string_view name = local_name(child);
      if (name == "posList" || name == "pos" || name == "coordinates") {
        std::string text = child.text().get();
        if (name == "coordinates") std::replace(text.begin(), text.end(), ',', ' ');
        const auto more = numbers(text);
        values.insert(values.end(), more.begin(), more.end());
      }
    }
    if (values.size() % 3 != 0) {
      builder_.warnings().add("a ring's coordinates do not come in threes; the rest was left out",
                              std::string{gml_id(node)});
    }
    Ring ring;
    for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
      const glm::dvec4 p = place.transform * glm::dvec4{values[i], values[i + 1], values[i + 2], 1.0};
      ring.points.emplace_back(p);
    }
    if (!look.texture_uri.empty()) {
      ring.uvs = appearances_.uvs_of(node);
      if (!ring.uvs.empty() && ring.uvs.size() + 1 == ring.points.size()) ring.uvs.push_back(ring.uvs.front());
      if (ring.uvs.size() != ring.points.size()) {
        if (!ring.uvs.empty()) {
          builder_.warnings().add("a ring has not as many texture coordinates as points; they were left out",
                                  std::string{gml_id(node)});
        }
        ring.uvs.clear();
      }
    }
    return ring;
  }

  pugi::xml_node root_;
  CityBuilder builder_;
  Appearances appearances_;
  std::unordered_map<std::string_view, pugi::xml_node> ids_;
  std::unordered_set<pugi::xml_node, NodeHash> seen_;
  glm::dvec3 reference_{0.0};
  bool in_template_ = false;
  std::vector<pugi::xml_node> open_;  // geometries being read, from the outermost
  std::uint64_t visits_ = 0;
  std::uint64_t max_visits_;
};

}  // namespace
}  // namespace gis

Result<LoadedMesh> read_citygml(const Input& input, const ReadOptions& options, const Context& context) {
  constexpr std::uint64_t max_document_bytes = 4ULL
                                               << 30;  // the document is held in memory, about three times its size
  if (input.size() > max_document_bytes) return too_large(input, "bytes", input.size(), max_document_bytes);
  auto bytes = input.read_all();
  if (!bytes) return bytes.error();
  pugi::xml_document document;
  const auto parsed = document.load_buffer_inplace(bytes->data(), bytes->size());
  if (!parsed) {
    return Error{ErrorCode::BadData, std::string{"is not well-formed XML: "} + parsed.description(),
                 input.name() + ", byte " + std::to_string(parsed.offset)};
  }
  const pugi::xml_node root = document.document_element();
  if (gis::local_name(root) != "CityModel") {
    return Error{ErrorCode::BadData,
                 "is XML but not CityGML: its root is '" + std::string{root.name()} + "', not CityModel", input.name()};
  }
  return gis::CityGmlReader{root, input, options}.read(context);
}

}  // namespace lodestone

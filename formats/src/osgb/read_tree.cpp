// SPDX-License-Identifier: MIT
#include "osgb/read_tree.h"

#include <osg/Geode>
#include <osg/MatrixTransform>
#include <osgDB/ReadFile>

#include <array>
#include <cstdio>

#include "osgb/item_mesh.h"
#include "osgb/switching.h"
#include "tiles3d/tileset_json.h"

namespace lodestone::osgb {
namespace {

namespace fs = std::filesystem;

void collect(osg::Node& node, const osg::Matrixd& place, std::vector<Item>& items) {
  if (auto* paged = dynamic_cast<osg::PagedLOD*>(&node)) {
    if (paged->getNumChildren() > 0) items.push_back({paged->getChild(paged->getNumChildren() - 1), place, paged});
    return;
  }
  osg::Group* group = node.asGroup();
  if (group == nullptr || dynamic_cast<osg::Geode*>(&node) != nullptr) {
    items.push_back({&node, place, nullptr});
    return;
  }
  osg::Matrixd inside = place;
  if (osg::Transform* transform = node.asTransform()) transform->computeLocalToWorldMatrix(inside, nullptr);
  for (unsigned i = 0; i < group->getNumChildren(); ++i) collect(*group->getChild(i), inside, items);
}

// The number of the last file of a PagedLOD; those of its children that are in its own file have none.
std::optional<unsigned> file_number(const Item& item) {
  if (!item.paged) return std::nullopt;
  for (unsigned i = item.paged->getNumFileNames(); i-- > 0;) {
    if (!item.paged->getFileName(i).empty()) return i;
  }
  return std::nullopt;
}

// At which the file takes the place of what is shown.
double error_m(const osg::PagedLOD& paged, unsigned file) {
  const bool middle = paged.getCenterMode() == osg::LOD::USER_DEFINED_CENTER && paged.getRadius() > 0.0F;
  const double radius_m = middle ? double(paged.getRadius()) : double(paged.getBound().radius());
  if (file >= paged.getNumRanges()) return 0.0;
  return paged.getRangeMode() == osg::LOD::PIXEL_SIZE_ON_SCREEN
             ? error_at_size_m(radius_m, double(paged.getMinRange(file)))
             : error_at_distance_m(radius_m, double(paged.getMaxRange(file)));
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

std::string box_json(const Box& box) {
  const glm::dvec3 c = box.center();
  const glm::dvec3 h = 0.5 * box.size();
  return "[" + number(c.x) + "," + number(c.y) + "," + number(c.z) + "," + number(h.x) + ",0,0,0," + number(h.y) +
         ",0,0,0," + number(h.z) + "]";
}

std::string tile_json_of(const Box& box, double geometric_error, const std::string& name, const std::string& children) {
  return R"({"boundingVolume":{"box":)" + box_json(box) + R"(},"geometricError":)" + number(geometric_error) +
         R"(,"content":{"uri":")" + name + "\"}" + (children.empty() ? "" : ",\"children\":[" + children + "]") + "}";
}

void add(const Box& part, Box& box) {
  if (part.empty()) return;
  box.add(part.min);
  box.add(part.max);
}

bool is_plain(const std::string& name) {
  return std::none_of(name.begin(), name.end(),
                      [](char c) { return c == '"' || c == '\\' || c == '#' || static_cast<unsigned char>(c) < 0x20; });
}

}  // namespace

TreeReader::TreeReader(const fs::path& root) : folder_(root.parent_path()), root_(root.filename().string()) {
  keep_textures_encoded();
}

Result<std::vector<Item>> TreeReader::read(const std::string& file) {
  const fs::path path = folder_ / file;
  std::error_code fault;
  if (!fs::exists(path, fault)) return Error{ErrorCode::NotFound, "there is no such file", path.string()};
  const osg::ref_ptr<osg::Node> node = osgDB::readRefNodeFile(path.string());
  if (!node) return Error{ErrorCode::BadData, "OpenSceneGraph cannot read it", path.string()};
  std::vector<Item> items;
  const osg::MatrixTransform* top = node->asTransform() != nullptr ? node->asTransform()->asMatrixTransform() : nullptr;
  if (file != root_ || top == nullptr) {
    collect(*node, osg::Matrixd{}, items);
  } else {
    const osg::Vec3d at = top->getMatrix().getTrans();
    origin_ = {at.x(), at.y(), at.z()};
    for (unsigned i = 0; i < top->getNumChildren(); ++i) {
      collect(*node->asGroup()->getChild(i), osg::Matrixd{}, items);
    }
  }
  const bool moved = std::any_of(items.begin(), items.end(),
                                 [](const Item& item) { return file_number(item) && !item.place.isIdentity(); });
  if (moved) return Error{ErrorCode::Unsupported, "there is a transform above its paged tiles", path.string()};
  if (items.empty()) return Error{ErrorCode::BadData, "there is nothing in it to show", path.string()};
  return items;
}

// Of the items of a file that refines something. One that cannot be read is listed all the same, so that loading it
// tells why.
Result<std::string> TreeReader::children_json(const std::string& file, unsigned depth, Box& box) {
  if (!is_plain(file)) return Error{ErrorCode::BadData, "it refers to a file with an odd name", file};
  if (!walked_.insert(file).second) return Error{ErrorCode::BadData, "two tiles are refined by one file", file};
  const auto items = read(file);
  if (!items) return tile_json_of(box, 0.0, file + "#0", "");
  std::string out;
  for (std::size_t i = 0; i < items->size(); ++i) {
    Box own;
    auto one = tile_json((*items)[i], file, file + '#' + std::to_string(i), depth, own);
    if (!one) return one.error();
    add(own, box);
    if (!out.empty()) out += ',';
    out += *one;
  }
  return out;
}

Result<std::string> TreeReader::tile_json(const Item& item, const std::string& file, const std::string& name,
                                          unsigned depth, Box& box) {
  constexpr unsigned most_depth = 256;
  if (depth > most_depth) return Error{ErrorCode::BadData, "files are nested too deeply", file};
  box = bounds_of(item);
  const auto number_of_file = file_number(item);
  if (!number_of_file) return tile_json_of(box, 0.0, name, "");
  const std::string below =
      (fs::path{file}.parent_path() / item.paged->getFileName(*number_of_file)).lexically_normal().generic_string();
  auto children = children_json(below, depth + 1, box);
  if (!children) return children.error();
  return tile_json_of(box, client_error_px * error_m(*item.paged, *number_of_file), name, *children);
}

Result<std::string> TreeReader::index() {
  if (!is_plain(root_)) return Error{ErrorCode::BadArgument, "a name without quotes and # is needed", root_};
  walked_ = {root_};
  const auto items = read(root_);
  if (!items) return items.error();
  Box box;
  std::string root;
  if (items->size() == 1) {
    auto one = tile_json(items->front(), root_, root_ + "#0", 0, box);
    if (!one) return one.error();
    root = *one;
  } else {
    // One tile above them that shows them all; errors are made to grow where the graph is put together.
    std::string children;
    double geometric_error = 0.0;
    for (std::size_t i = 0; i < items->size(); ++i) {
      Box own;
      auto one = tile_json((*items)[i], root_, root_ + '#' + std::to_string(i), 1, own);
      if (!one) return one.error();
      add(own, box);
      if (const auto file = file_number((*items)[i])) {
        geometric_error = std::max(geometric_error, client_error_px * error_m(*(*items)[i].paged, *file));
      }
      children += (i == 0 ? "" : ",") + *one;
    }
    root = tile_json_of(box, geometric_error, root_, geometric_error > 0.0 ? children : "");
  }
  return R"({"asset":{"version":"1.1","extras":{"origin":[)" + number(origin_.x) + "," + number(origin_.y) + "," +
         number(origin_.z) + R"(]}},"geometricError":)" + number(client_error_px * box.diagonal_m()) + R"(,"root":)" +
         root + "}";
}

Result<Mesh> TreeReader::tile(const std::string& name) {
  const std::size_t mark = name.rfind('#');
  const std::string file = name.substr(0, mark);
  if (file != last_file_) {
    auto items = read(file);
    if (!items) return items.error();
    last_file_ = file;
    last_items_ = std::move(*items);
  }
  if (mark == std::string::npos) return mesh_of(last_items_, file);
  const std::size_t number = std::strtoul(name.c_str() + mark + 1, nullptr, 10);
  if (number >= last_items_.size()) return Error{ErrorCode::BadData, "there are fewer tiles in it", name};
  return mesh_of({&last_items_[number], 1}, name);
}

}  // namespace lodestone::osgb

// SPDX-License-Identifier: MIT
// lodestone-osgb: a tileset of ours as a tree of OpenSceneGraph files, by OSG's own library, and such trees read. A
// program of its own because that library brings libGL along, which must not meet OSMesa in one process.
//
//     lodestone-osgb TILESET.json FOLDER      writes FOLDER/main.osgb and FOLDER/Data/*.osgb
//     lodestone-osgb --serve MAIN.osgb        answers a program of ours on standard input, tile by tile
//
// Based on: Ao et al. 2025, sections 3.5.1 and 3.5.2 (PagedLOD, switching by pixel size).
// Differs: the threshold is not the size of the tile's texture but the size at which the tile's error reaches a pixel.
#include <osg/Geode>
#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <osg/PagedLOD>
#include <osg/Texture2D>
#include <osgDB/ReadFile>
#include <osgDB/Registry>
#include <osgDB/WriteFile>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include <lodestone/outcrop.h>
#include <lodestone/tile_loader.h>

#include "osgb/serve.h"
#include "osgb/switching.h"

namespace {

namespace fs = std::filesystem;
using lodestone::GroupId;
using lodestone::Mesh;
using lodestone::NodeId;

class Writer {
 public:
  Writer(const lodestone::TilePyramid& pyramid, fs::path folder) : pyramid_(pyramid), folder_(std::move(folder)) {
    options_ = new osgDB::Options("WriteImageHint=IncludeFile Compressor=zlib");
    options_->getDatabasePathList().push_back((folder_ / "work").string());
    // A node's children are the fine side of the group that it was made by.
    const lodestone::LodGraph& graph = pyramid.graph();
    made_by_.assign(graph.nodes.size(), lodestone::none);
    for (const lodestone::LodLink& link : graph.links) {
      for (NodeId n = link.nodes.begin; n < link.nodes.end; ++n) made_by_[n] = link.maker;
    }
  }
  bool write();

 private:
  [[nodiscard]] std::string children_name(NodeId tile) const {
    return fs::path{pyramid_.name(tile)}.stem().string() + "_children.osgb";
  }
  osg::ref_ptr<osg::Node> node_of(NodeId tile, bool in_root);
  osg::ref_ptr<osg::Geode> geode_of(NodeId tile, const Mesh& mesh);
  osg::ref_ptr<osg::StateSet> look_of(NodeId tile, const Mesh& mesh);
  bool write_children(NodeId tile);
  bool fail(const std::string& what) {
    std::fprintf(stderr, "lodestone-osgb: %s\n", what.c_str());
    return false;
  }

  const lodestone::TilePyramid& pyramid_;
  fs::path folder_;
  osg::ref_ptr<osgDB::Options> options_;
  std::vector<GroupId> made_by_;
  bool failed_ = false;
};

// The photograph's bytes go into the file as they are: OSG takes them from a file of the image's name, which it looks
// for in the options' folders. The name is written too, so it must say nothing of where the file was made.
osg::ref_ptr<osg::StateSet> Writer::look_of(NodeId tile, const Mesh& mesh) {
  osg::ref_ptr<osg::StateSet> state = new osg::StateSet;
  if (mesh.textures.empty() || !mesh.textures.front().encoded) return state;
  const lodestone::Texture& texture = mesh.textures.front();
  const bool png = texture.mime_type == "image/png";
  const std::string name = fs::path{pyramid_.name(tile)}.stem().string() + (png ? ".png" : ".jpg");
  const fs::path file = folder_ / "work" / name;
  std::ofstream{file, std::ios::binary}.write(reinterpret_cast<const char*>(texture.encoded->data()),
                                              static_cast<std::streamsize>(texture.encoded->size()));
  osg::ref_ptr<osg::Image> image = osgDB::readRefImageFile(file.string());
  if (!image) {
    failed_ = !fail(file.string() + ": the texture cannot be read by OpenSceneGraph, install its image plugins");
    return state;
  }
  image->setFileName(name);
  osg::ref_ptr<osg::Texture2D> picture = new osg::Texture2D{image};
  picture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR_MIPMAP_LINEAR);
  picture->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
  picture->setWrap(osg::Texture::WRAP_S, osg::Texture::CLAMP_TO_EDGE);
  picture->setWrap(osg::Texture::WRAP_T, osg::Texture::CLAMP_TO_EDGE);
  picture->setUnRefImageDataAfterApply(true);
  state->setTextureAttributeAndModes(0, picture);
  state->setMode(GL_LIGHTING, osg::StateAttribute::OFF);  // light is in the photograph already
  return state;
}

osg::ref_ptr<osg::Geometry> arrays_of(const Mesh& mesh) {
  osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
  osg::ref_ptr<osg::Vec3Array> positions = new osg::Vec3Array;
  for (const auto& p : mesh.vertices.positions) {
    const glm::dvec3 at = mesh.origin + glm::dvec3{p};
    positions->push_back(osg::Vec3(static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)));
  }
  geometry->setVertexArray(positions);
  if (!mesh.vertices.normals.empty()) {
    osg::ref_ptr<osg::Vec3Array> normals = new osg::Vec3Array;
    for (const auto& n : mesh.vertices.normals) normals->push_back(osg::Vec3(n.x, n.y, n.z));
    geometry->setNormalArray(normals, osg::Array::BIND_PER_VERTEX);
  }
  if (!mesh.vertices.uvs.empty()) {
    osg::ref_ptr<osg::Vec2Array> uvs = new osg::Vec2Array;
    for (const auto& uv : mesh.vertices.uvs) uvs->push_back(osg::Vec2(uv.x, uv.y));
    geometry->setTexCoordArray(0, uvs);
  }
  geometry->setUseDisplayList(false);
  geometry->setUseVertexBufferObjects(true);
  return geometry;
}

// Of faces with this base colour: one for all, unless vertices have their own.
osg::ref_ptr<osg::Array> colors_of(const Mesh& mesh, const glm::vec4& base) {
  osg::ref_ptr<osg::Vec4ubArray> colors = new osg::Vec4ubArray;
  const bool own = !mesh.vertices.colors.empty();
  const auto append = [&](const glm::vec4& color) {
    const glm::vec4 c = glm::clamp(color, 0.0F, 1.0F) * 255.0F + 0.5F;
    const auto byte = [](float value) { return static_cast<unsigned char>(value); };
    colors->push_back(osg::Vec4ub(byte(c.r), byte(c.g), byte(c.b), byte(c.a)));
  };
  if (!own) append(base);
  for (const auto& c : mesh.vertices.colors) append(base * glm::vec4{c} / 255.0F);
  colors->setNormalize(true);
  colors->setBinding(own ? osg::Array::BIND_PER_VERTEX : osg::Array::BIND_OVERALL);
  return colors;
}

// What looks alike is one geometry, all over the same vertices. Skirts are apart, under their name.
osg::ref_ptr<osg::Geode> Writer::geode_of(NodeId tile, const Mesh& mesh) {
  struct Kind {
    bool textured, skirt;
    glm::vec4 color;
  };
  std::vector<Kind> kinds;
  std::vector<osg::ref_ptr<osg::DrawElementsUInt>> faces;
  for (lodestone::FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const lodestone::Material& material = mesh.materials[mesh.face_material(f)];
    const Kind kind{material.texture != lodestone::none, is_skirt(mesh, f), material.base_color};
    const auto known = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& k) {
      return k.textured == kind.textured && k.skirt == kind.skirt && k.color == kind.color;
    });
    const auto at = static_cast<std::size_t>(known - kinds.begin());
    if (known == kinds.end()) {
      kinds.push_back(kind);
      faces.emplace_back(new osg::DrawElementsUInt(GL_TRIANGLES));
    }
    for (std::size_t k = 0; k < 3; ++k) faces[at]->push_back(mesh.indices[3 * std::size_t{f} + k]);
  }
  osg::ref_ptr<osg::Geode> geode = new osg::Geode;
  const osg::ref_ptr<osg::Geometry> arrays = arrays_of(mesh);
  osg::ref_ptr<osg::StateSet> photograph;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry(*arrays);
    geometry->addPrimitiveSet(faces[i]);
    const bool white = mesh.vertices.colors.empty() && kinds[i].color == glm::vec4{1.0F};
    if (!white) geometry->setColorArray(colors_of(mesh, kinds[i].color));
    if (kinds[i].textured && !photograph) photograph = look_of(tile, mesh);
    if (kinds[i].textured) geometry->setStateSet(photograph);
    if (kinds[i].skirt) geometry->setName(lodestone::skirt_name);
    geode->addDrawable(geometry);
  }
  return geode;
}

osg::ref_ptr<osg::Node> Writer::node_of(NodeId tile, bool in_root) {
  const auto mesh = pyramid_.load(tile, lodestone::LoadTextures::Encoded);
  if (!mesh) {
    failed_ = !fail(to_line(mesh.error()));
    return nullptr;
  }
  osg::ref_ptr<osg::Geode> geode = geode_of(tile, *mesh);
  if (made_by_[tile] == lodestone::none) return geode;
  const lodestone::Sphere& bounds = pyramid_.graph().nodes[tile].bounds;
  const float switch_px =
      lodestone::osgb::threshold_px(bounds.radius_m, pyramid_.graph().groups[made_by_[tile]].error_m);
  osg::ref_ptr<osg::PagedLOD> paged = new osg::PagedLOD;
  paged->setRangeMode(osg::LOD::PIXEL_SIZE_ON_SCREEN);
  paged->setCenterMode(osg::LOD::USER_DEFINED_CENTER);
  paged->setCenter(osg::Vec3d(bounds.center.x, bounds.center.y, bounds.center.z));
  paged->setRadius(static_cast<float>(bounds.radius_m));
  paged->addChild(geode, 0.0F, switch_px);
  paged->setFileName(1, (in_root ? "Data/" : "") + children_name(tile));
  paged->setRange(1, switch_px, std::numeric_limits<float>::max());
  paged->setDatabasePath("");
  return paged;
}

bool Writer::write_children(NodeId tile) {
  const lodestone::Range children = pyramid_.graph().groups[made_by_[tile]].nodes;
  osg::ref_ptr<osg::Group> group = new osg::Group;
  for (NodeId n = children.begin; n < children.end; ++n) {
    const osg::ref_ptr<osg::Node> node = node_of(n, false);
    if (failed_) return false;
    group->addChild(node);
  }
  const fs::path file = folder_ / "Data" / children_name(tile);
  return osgDB::writeNodeFile(*group, file.string(), options_.get()) || fail(file.string() + ": cannot be written");
}

bool Writer::write() {
  std::error_code fault;
  for (const char* name : {"Data", "work"}) fs::create_directories(folder_ / name, fault);
  if (fault) return fail(folder_.string() + ": cannot be made: " + fault.message());
  const lodestone::LodGraph& graph = pyramid_.graph();
  for (NodeId n = 0; n < graph.nodes.size(); ++n) {
    if (made_by_[n] != lodestone::none && !write_children(n)) return false;
  }
  // Last: a folder with a main.osgb is whole.
  const glm::dvec3& origin = pyramid_.origin();
  osg::ref_ptr<osg::MatrixTransform> root =
      new osg::MatrixTransform(osg::Matrix::translate(origin.x, origin.y, origin.z));
  const lodestone::Range roots = graph.groups.front().nodes;
  for (NodeId n = roots.begin; n < roots.end; ++n) {
    const osg::ref_ptr<osg::Node> node = node_of(n, true);
    if (failed_) return false;
    root->addChild(node);
  }
  const fs::path file = folder_ / "main.osgb";
  const bool written = osgDB::writeNodeFile(*root, file.string(), options_.get());
  fs::remove_all(folder_ / "work", fault);
  return written || fail(file.string() + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view{argv[1]} == "--serve") return lodestone::osgb::serve(argv[2]);
  if (argc != 3) {
    std::fprintf(stderr, "usage: lodestone-osgb TILESET.json FOLDER | lodestone-osgb --serve MAIN.osgb\n");
    return 1;
  }
  const auto pyramid = lodestone::TilePyramid::open(argv[1]);
  if (!pyramid) {
    std::fprintf(stderr, "lodestone-osgb: %s\n", to_line(pyramid.error()).c_str());
    return 2;
  }
  return Writer{**pyramid, argv[2]}.write() ? 0 : 2;
}

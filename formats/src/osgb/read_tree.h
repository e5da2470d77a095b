// SPDX-License-Identifier: MIT
// A tree of OpenSceneGraph files as a pyramid of tiles: which there are, and each as a mesh.
#pragma once

#include <osg/Matrixd>
#include <osg/PagedLOD>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <lodestone/mesh.h>
#include <lodestone/result.h>

namespace lodestone::osgb {

// What is drawn whole: a PagedLOD with what it shows before its file is there, or geometry that nothing refines.
struct Item {
  osg::ref_ptr<osg::Node> content;
  osg::Matrixd place;  // in the frame of its file
  osg::ref_ptr<osg::PagedLOD> paged;
};

// Tiles are named FILE#ITEM, FILE relative to the root's folder; FILE alone is all of its items. The frame is that
// below the root's own transform, whose translation is the origin. Of a PagedLOD the last child that is in the file is
// shown, and its last file refines it. A transform in the root file above PagedLODs, other than the root itself, is
// refused: their files would not know of it.
class TreeReader {
 public:
  explicit TreeReader(const std::filesystem::path& root);

  // Walks through all files, without their textures; a tileset.json whose contents are those names.
  [[nodiscard]] Result<std::string> index();
  // Textures as the bytes they have in the file, or as pixels.
  [[nodiscard]] Result<Mesh> tile(const std::string& name);

 private:
  [[nodiscard]] Result<std::vector<Item>> read(const std::string& file);
  [[nodiscard]] Result<std::string> tile_json(const Item& item, const std::string& file, const std::string& name,
                                              unsigned depth, Box& box);
  [[nodiscard]] Result<std::string> children_json(const std::string& file, unsigned depth, Box& box);

  std::filesystem::path folder_;
  std::string root_;
  glm::dvec3 origin_{0.0};
  std::set<std::string> walked_;
  std::string last_file_;  // siblings are asked for one after the other
  std::vector<Item> last_items_;
};

}  // namespace lodestone::osgb

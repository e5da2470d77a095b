// SPDX-License-Identifier: MIT
#include "osgb/item_mesh.h"

#include <osg/Geometry>
#include <osg/Texture>
#include <osg/TriangleIndexFunctor>
#include <osgDB/FileNameUtils>
#include <osgDB/FileUtils>
#include <osgDB/Registry>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>

#include <lodestone/outcrop.h>

namespace lodestone::osgb {
namespace {

using Bytes = std::vector<std::uint8_t>;

// An image that was not decoded.
class EncodedImage final : public osg::Image {
 public:
  explicit EncodedImage(Bytes bytes) : encoded(std::make_shared<const Bytes>(std::move(bytes))) {}
  std::shared_ptr<const Bytes> encoded;
};

class Keeper final : public osgDB::ReaderWriter {
 public:
  Keeper() {
    for (const char* kind : {"jpg", "jpeg", "png", "webp"}) supportsExtension(kind, "kept as it is");
  }
  ReadResult readImage(std::istream& stream, const osgDB::Options*) const override {
    return new EncodedImage{Bytes{std::istreambuf_iterator<char>{stream}, {}}};
  }
  ReadResult readImage(const std::string& name, const osgDB::Options* options) const override {
    if (!acceptsExtension(osgDB::getLowerCaseFileExtension(name))) return ReadResult::FILE_NOT_HANDLED;
    std::ifstream stream{osgDB::findDataFile(name, options), std::ios::binary};
    return stream ? readImage(stream, options) : ReadResult{ReadResult::FILE_NOT_FOUND};
  }
};

struct Fault {
  std::string message;
};

// Walks through what an item shows, with the places and textures that hold there.
class Walk {
 public:
  using Visit = std::function<void(const osg::Geometry&, const osg::Matrixd&, const osg::Image*)>;
  explicit Walk(Visit visit) : visit_(std::move(visit)) {}
  void operator()(const osg::Node& node, osg::Matrixd place, const osg::Image* look) {
    if (const osg::StateSet* state = node.getStateSet()) {
      const auto* texture =
          dynamic_cast<const osg::Texture*>(state->getTextureAttribute(0, osg::StateAttribute::TEXTURE));
      if (texture != nullptr) look = texture->getImage(0);
    }
    const osg::Drawable* drawable = node.asDrawable();
    if (drawable != nullptr && drawable->asGeometry() != nullptr) visit_(*drawable->asGeometry(), place, look);
    if (const osg::Transform* transform = node.asTransform()) transform->computeLocalToWorldMatrix(place, nullptr);
    const osg::Group* group = node.asGroup();
    for (unsigned i = 0; group != nullptr && i < group->getNumChildren(); ++i) {
      (*this)(*group->getChild(i), place, look);
    }
  }

 private:
  Visit visit_;
};

struct Faces {
  void operator()(unsigned a, unsigned b, unsigned c) {
    for (const unsigned corner : {a, b, c}) corners.push_back(corner);
  }
  std::vector<unsigned> corners;
};

template <class Array>
const Array* per_vertex(const osg::Array* array, std::size_t count) {
  const auto* typed = dynamic_cast<const Array*>(array);
  const bool fits = typed != nullptr && typed->size() >= count && typed->getBinding() != osg::Array::BIND_OVERALL;
  return fits ? typed : nullptr;
}

Image pixels_of(const osg::Image& image) {
  std::uint32_t channels = 0;
  if (image.getPixelFormat() == GL_LUMINANCE) channels = 1;
  if (image.getPixelFormat() == GL_LUMINANCE_ALPHA) channels = 2;
  if (image.getPixelFormat() == GL_RGB) channels = 3;
  if (image.getPixelFormat() == GL_RGBA) channels = 4;
  if (channels == 0 || image.getDataType() != GL_UNSIGNED_BYTE || image.data() == nullptr) {
    throw Fault{"a texture is in a form that is not known, compressed for graphics cards perhaps"};
  }
  const auto width = static_cast<std::uint32_t>(image.s());
  const auto height = static_cast<std::uint32_t>(image.t());
  Image out{.width = width, .height = height, .channels = channels, .pixels = {}};
  const bool bottom_up = image.getOrigin() == osg::Image::BOTTOM_LEFT;
  for (std::uint32_t row = 0; row < height; ++row) {
    const unsigned char* from = image.data(0, static_cast<unsigned>(bottom_up ? height - 1 - row : row));
    out.pixels.insert(out.pixels.end(), from, from + std::size_t{width} * channels);
  }
  return out;
}

class Builder {
 public:
  void add(const osg::Geometry& geometry, const osg::Matrixd& place, const osg::Image* look);
  Mesh finish();

 private:
  MaterialId material_of(const osg::Image* look, const glm::vec4& color, bool skirt);
  void add_positions(const osg::Array* array, const osg::Matrixd& place);
  void add_looks(const osg::Geometry& geometry, const osg::Matrixd& place, std::size_t count);

  Mesh mesh_;
  std::vector<const osg::Image*> images_;  // per texture
  bool has_normals_ = false;
  bool has_uvs_ = false;
  bool has_colors_ = false;
};

// Of a geometry without colours of its vertices' own.
glm::vec4 overall_color(const osg::Geometry& geometry) {
  const osg::Array* array = geometry.getColorArray();
  if (array == nullptr || array->getBinding() != osg::Array::BIND_OVERALL || array->getNumElements() == 0) {
    return glm::vec4{1.0F};
  }
  if (const auto* bytes = dynamic_cast<const osg::Vec4ubArray*>(array)) {
    const osg::Vec4ub& c = bytes->front();
    return glm::vec4{c.r(), c.g(), c.b(), c.a()} / 255.0F;
  }
  if (const auto* floats = dynamic_cast<const osg::Vec4Array*>(array)) {
    const osg::Vec4& c = floats->front();
    return glm::clamp(glm::vec4{c.r(), c.g(), c.b(), c.a()}, 0.0F, 1.0F);
  }
  return glm::vec4{1.0F};
}

MaterialId Builder::material_of(const osg::Image* look, const glm::vec4& color, bool skirt) {
  const auto seen = std::find(images_.begin(), images_.end(), look);
  const auto texture_at = look != nullptr ? static_cast<std::uint32_t>(seen - images_.begin()) : none;
  for (MaterialId m = 0; m < mesh_.materials.size(); ++m) {
    const Material& material = mesh_.materials[m];
    if (material.texture == texture_at && material.base_color == color && (material.name == skirt_name) == skirt) {
      return m;
    }
  }
  Material material;
  material.base_color = color;
  material.texture = texture_at;
  if (look != nullptr && seen == images_.end()) {
    images_.push_back(look);
    Texture texture;
    texture.name = std::to_string(mesh_.textures.size());
    if (const auto* encoded = dynamic_cast<const EncodedImage*>(look)) {
      texture.encoded = encoded->encoded;
    } else {
      texture.image = std::make_shared<const Image>(pixels_of(*look));
    }
    mesh_.textures.push_back(std::move(texture));
  }
  material.name = look != nullptr ? "texture " + mesh_.textures[texture_at].name : "plain";
  if (skirt) material.name = skirt_name;
  mesh_.materials.push_back(std::move(material));
  return static_cast<MaterialId>(mesh_.materials.size() - 1);
}

void Builder::add_positions(const osg::Array* array, const osg::Matrixd& place) {
  const auto append = [&](const auto& positions) {
    for (const auto& p : positions) {
      const osg::Vec3d at = osg::Vec3d(p) * place;
      mesh_.vertices.positions.emplace_back(static_cast<float>(at.x()), static_cast<float>(at.y()),
                                            static_cast<float>(at.z()));
    }
  };
  if (const auto* floats = dynamic_cast<const osg::Vec3Array*>(array)) return append(*floats);
  if (const auto* doubles = dynamic_cast<const osg::Vec3dArray*>(array)) return append(*doubles);
  throw Fault{"vertices are in a form that is not known"};
}

// Every vertex gets all of them; what no geometry has is dropped in the end.
void Builder::add_looks(const osg::Geometry& geometry, const osg::Matrixd& place, std::size_t count) {
  VertexArrays& v = mesh_.vertices;
  const auto* normals = per_vertex<osg::Vec3Array>(geometry.getNormalArray(), count);
  const auto* uvs = per_vertex<osg::Vec2Array>(geometry.getTexCoordArray(0), count);
  const auto* colors = per_vertex<osg::Vec4ubArray>(geometry.getColorArray(), count);
  has_normals_ = has_normals_ || normals != nullptr;
  has_uvs_ = has_uvs_ || uvs != nullptr;
  has_colors_ = has_colors_ || colors != nullptr;
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3 n{0.0F};
    if (normals != nullptr) {
      osg::Vec3d turned = osg::Matrixd::transform3x3(osg::Vec3d((*normals)[i]), place);
      if (!place.isIdentity()) turned.normalize();
      n = glm::vec3{glm::dvec3{turned.x(), turned.y(), turned.z()}};
    }
    v.normals.push_back(n);
    v.uvs.push_back(uvs != nullptr ? glm::vec2{(*uvs)[i].x(), (*uvs)[i].y()} : glm::vec2{0.0F});
    const osg::Vec4ub c = colors != nullptr ? (*colors)[i] : osg::Vec4ub(255, 255, 255, 255);
    v.colors.emplace_back(c.r(), c.g(), c.b(), c.a());
  }
}

void Builder::add(const osg::Geometry& geometry, const osg::Matrixd& place, const osg::Image* look) {
  const osg::Array* array = geometry.getVertexArray();
  if (array == nullptr || array->getNumElements() == 0) return;
  const std::size_t first = mesh_.vertices.positions.size();
  const std::size_t count = array->getNumElements();
  osg::TriangleIndexFunctor<Faces> faces;
  geometry.accept(faces);
  add_positions(array, place);
  add_looks(geometry, place, count);
  const MaterialId material = material_of(look, overall_color(geometry), geometry.getName() == skirt_name);
  for (std::size_t f = 0; f + 2 < faces.corners.size(); f += 3) {
    const auto* corners = &faces.corners[f];
    if (std::any_of(corners, corners + 3, [&](unsigned corner) { return corner >= count; })) {
      throw Fault{"a triangle refers to a vertex that does not exist"};
    }
    for (std::size_t k = 0; k < 3; ++k) mesh_.indices.push_back(static_cast<VertexId>(first + corners[k]));
    mesh_.face_materials.push_back(material);
  }
}

Mesh Builder::finish() {
  if (!has_normals_) mesh_.vertices.normals.clear();
  if (!has_uvs_) mesh_.vertices.uvs.clear();
  if (!has_colors_) mesh_.vertices.colors.clear();
  return std::move(mesh_);
}

}  // namespace

void keep_textures_encoded() { osgDB::Registry::instance()->addReaderWriter(new Keeper); }

Box bounds_of(const Item& item) {
  Box box;
  Walk walk{[&](const osg::Geometry& geometry, const osg::Matrixd& place, const osg::Image*) {
    const osg::BoundingBox own = geometry.getBoundingBox();
    for (unsigned corner = 0; own.valid() && corner < 8; ++corner) {
      const osg::Vec3d at = osg::Vec3d(own.corner(corner)) * place;
      box.add(glm::dvec3{at.x(), at.y(), at.z()});
    }
  }};
  walk(*item.content, item.place, nullptr);
  return box;
}

Result<Mesh> mesh_of(std::span<const Item> items, const std::string& name) {
  Builder builder;
  Walk walk{[&](const osg::Geometry& geometry, const osg::Matrixd& place, const osg::Image* look) {
    builder.add(geometry, place, look);
  }};
  try {
    for (const Item& item : items) walk(*item.content, item.place, nullptr);
  } catch (const Fault& fault) {
    return Error{ErrorCode::Unsupported, fault.message, name};
  }
  return builder.finish();
}

}  // namespace lodestone::osgb

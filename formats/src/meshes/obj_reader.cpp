// SPDX-License-Identifier: MIT
// Wavefront OBJ, read in one pass through a block of memory.
#include <algorithm>
#include <cmath>
#include <map>

#include "axes.h"
#include "header_comments.h"
#include "line_reader.h"
#include "mtl.h"
#include "polygon_faces.h"
#include "strays.h"
#include "wedges.h"

namespace lodestone {
namespace {

constexpr std::size_t max_features = 1U << 24;

class ObjReader {
 public:
  ObjReader(const Input& input, const ReadOptions& options, const Context& context,
            const std::optional<glm::dvec3>& origin)
      : input_{input}, options_{options}, context_{context}, lines_{input, context} {
    if (origin) set_origin(*origin);
  }

  [[nodiscard]] Status read();
  [[nodiscard]] Result<LoadedMesh> finish();

  // The origin that a second pass should use because floats relative to this pass's lose precision.
  [[nodiscard]] std::optional<glm::dvec3> better_origin() const;

 private:
  using Corner = WedgeKey;

  [[nodiscard]] Status statement(std::string_view line);
  void read_vertex(Words& words);
  void read_color(Words& words, double fourth);
  void read_face(Words& words);
  void add_triangle(const Corner& a, const Corner& b, const Corner& c);
  [[nodiscard]] bool read_corner(const char*& at, const char* end, Corner& corner);
  void use_material(std::string_view name);
  void load_library(Words& words);
  void begin_group(std::string_view kind, std::string_view name);
  void set_origin(const glm::dvec3& origin) {
    origin_ = origin;
    origin_known_ = true;
    for (int a = 0; a < 3; ++a) exact_[a] = origin[a] == 0.0;
  }
  void finish_materials();

  const Input& input_;
  const ReadOptions& options_;
  const Context& context_;
  LineReader lines_;
  HeaderComments header_;
  Warnings warnings_;
  Mesh mesh_;

  glm::dvec3 origin_{0.0};
  bool origin_known_ = false;
  bool exact_[3] = {true, true, true};
  Box box_;
  VertexArrays pool_;  // as listed in the file; not parallel
  WedgeTable wedges_;
  bool has_uv_ = false;
  bool has_normal_ = false;

  MtlLibrary library_;
  std::map<std::string, MaterialId, std::less<>> material_ids_;
  MaterialId material_ = none;
  std::map<std::string, FeatureId, std::less<>> feature_ids_;
  FeatureId object_ = none;
  FeatureId feature_ = none;

  std::vector<Corner> corners_;
  std::vector<glm::dvec3> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

Status ObjReader::read() {
  std::string_view line;
  while (lines_.next(line)) {
    if (auto done = statement(line); !done) return done;
  }
  return lines_.status();
}

Status ObjReader::statement(std::string_view line) {
  Words words{line};
  words.skip_blanks();
  const char* at = words.position();
  if (at == words.end()) return Done{};
  if (*at == '#') {
    if (box_.empty()) header_.read(line);
    return Done{};
  }
  const std::string_view key = words.next();
  if (key == "v") {
    read_vertex(words);
    if (pool_.positions.size() > options_.max_vertices) {
      return too_large(input_, "vertices", pool_.positions.size(), options_.max_vertices);
    }
  } else if (key == "vt") {
    glm::vec2 uv{0.0F};
    if (words.number(uv.x)) (void)words.number(uv.y);
    pool_.uvs.push_back(uv);
  } else if (key == "vn") {
    glm::vec3 n{0.0F};
    if (words.number(n.x) && words.number(n.y)) (void)words.number(n.z);
    pool_.normals.push_back(n);
  } else if (key == "f" || key == "fo") {
    read_face(words);
    if (mesh_.indices.size() / 3 > options_.max_triangles) {
      return too_large(input_, "triangles", mesh_.indices.size() / 3, options_.max_triangles);
    }
  } else if (key == "usemtl") {
    use_material(words.rest());
  } else if (key == "mtllib") {
    load_library(words);
  } else if (key == "g" || key == "o") {
    begin_group(key, words.rest());
  } else if (key == "l" || key == "p") {
    warnings_.add("lines and points are left out", lines_.place());
  } else if (key != "s" && key != "usemap" && key != "mg" && key != "vp") {
    warnings_.add("a statement of a kind that is not read was left out", lines_.place());
  }
  return Done{};
}

void ObjReader::read_vertex(Words& words) {
  if (!origin_known_) {
    Words ahead = words;
    glm::dvec3 first{0.0};
    for (int a = 0; a < 3; ++a) (void)ahead.number(first[a]);
    constexpr double most = 1e10;  // beyond it, beside the others' rounding nothing would be left of the others
    if (glm::any(glm::greaterThan(glm::abs(first), glm::dvec3{most}))) first = glm::dvec3{0.0};
    Box only;
    only.add(first);
    set_origin(header_.origin ? *header_.origin : (header_.offset ? glm::dvec3{0.0} : choose_origin(only)));
  }
  glm::vec3 p{std::numeric_limits<float>::quiet_NaN()};
  glm::dvec3 whole{p};
  for (int a = 0; a < 3; ++a) {
    // Relative to zero the text is rounded once, straight to float: a coordinate written by us comes back bit for bit.
    if (exact_[a]) {
      if (!words.number(p[a])) break;
      whole[a] = p[a];
    } else {
      if (!words.number(whole[a])) break;
      p[a] = static_cast<float>(whole[a] - origin_[a]);
    }
  }
  if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) {
    box_.add(whole);
  } else {
    warnings_.add("a vertex is not three finite numbers; its faces are left out", lines_.place());
  }
  pool_.positions.push_back(p);
  double fourth = 0.0;
  if (words.number(fourth)) {
    read_color(words, fourth);
  } else if (!pool_.colors.empty()) {
    pool_.colors.emplace_back(255, 255, 255, 255);
  }
}

// "x y z r g b"; a single fourth number is a weight, which only curves use.
void ObjReader::read_color(Words& words, double fourth) {
  double green = 0.0;
  double blue = 0.0;
  const bool is_color = words.number(green) && words.number(blue);
  if (!is_color && pool_.colors.empty()) return;
  pool_.colors.resize(pool_.positions.size(), glm::u8vec4{255});
  if (!is_color) return;
  const double scale = fourth > 1.0 || green > 1.0 || blue > 1.0 ? 1.0 : 255.0;  // some write 0..255
  const auto byte = [&](double c) {
    return std::isfinite(c) ? static_cast<std::uint8_t>(std::lround(std::clamp(c * scale, 0.0, 255.0)))
                            : std::uint8_t{0};
  };
  pool_.colors.back() = {byte(fourth), byte(green), byte(blue), 255};
}

// One index; negative ones count back from the last element read. 0 if it is no number or out of 32 bits.
std::int64_t read_index(const char*& at, const char* end) {
  const bool negative = at != end && *at == '-';
  if (negative || (at != end && *at == '+')) ++at;
  std::int64_t value = 0;
  while (at != end && *at >= '0' && *at <= '9') {
    value = std::min<std::int64_t>(value * 10 + (*at - '0'), 1LL << 40);
    ++at;
  }
  return negative ? -value : value;
}

std::uint32_t resolve(std::int64_t index, std::size_t count) {
  if (index > 0 && static_cast<std::uint64_t>(index) <= count) return static_cast<std::uint32_t>(index - 1);
  if (index < 0 && static_cast<std::uint64_t>(-index) <= count) {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(count) + index);
  }
  return none;
}

// "v", "v/vt", "v//vn" or "v/vt/vn". False if the position does not exist.
bool ObjReader::read_corner(const char*& at, const char* end, Corner& corner) {
  const char* first = at;
  corner.position = resolve(read_index(at, end), pool_.positions.size());
  if (at == first) {
    while (at != end && *at != ' ' && *at != '\t') ++at;
    return false;
  }
  corner.uv = none;
  corner.normal = none;
  if (at != end && *at == '/') {
    const char* number = ++at;
    const std::int64_t uv = read_index(at, end);
    if (at != number) {
      corner.uv = resolve(uv, pool_.uvs.size());
      if (corner.uv == none) warnings_.add("a face names a texture coordinate that does not exist", lines_.place());
    }
    if (at != end && *at == '/') {
      number = ++at;
      const std::int64_t normal = read_index(at, end);
      if (at != number) {
        corner.normal = resolve(normal, pool_.normals.size());
        if (corner.normal == none) warnings_.add("a face names a normal that does not exist", lines_.place());
      }
    }
  }
  while (at != end && *at != ' ' && *at != '\t') ++at;
  return corner.position != none;
}

void ObjReader::read_face(Words& words) {
  corners_.clear();
  const char* at = words.position();
  const char* end = words.end();
  bool good = true;
  for (;;) {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
    if (at == end || *at == '#') break;
    Corner corner;
    if (!read_corner(at, end, corner)) {
      warnings_.add("a face names a vertex that does not exist (yet); it is left out", lines_.place());
      good = false;
      break;
    }
    corners_.push_back(corner);
  }
  if (!good) return;
  if (corners_.size() < 3) {
    warnings_.add("a face has fewer than three corners; it is left out", lines_.place());
    return;
  }
  for (const Corner& c : corners_) {
    if (!std::isfinite(pool_.positions[c.position].x + pool_.positions[c.position].y + pool_.positions[c.position].z)) {
      warnings_.add("a face has a corner that is not a finite number; it is left out", lines_.place());
      return;
    }
  }
  if (corners_.size() == 3) {
    add_triangle(corners_[0], corners_[1], corners_[2]);
    return;
  }
  points_.clear();
  for (const Corner& c : corners_) points_.emplace_back(pool_.positions[c.position]);
  split_polygon(points_, triangles_);
  for (const auto& t : triangles_) add_triangle(corners_[t[0]], corners_[t[1]], corners_[t[2]]);
}

void ObjReader::add_triangle(const Corner& a, const Corner& b, const Corner& c) {
  if (material_ == none) use_material("default");
  const bool first_with_feature = feature_ != none && mesh_.face_features.empty();
  if (first_with_feature) mesh_.face_features.assign(mesh_.indices.size() / 3, none);
  if (feature_ != none || !mesh_.face_features.empty()) mesh_.face_features.push_back(feature_);
  const bool first_of_second = material_ != 0 && mesh_.face_materials.empty();
  if (first_of_second) mesh_.face_materials.assign(mesh_.indices.size() / 3, 0);
  if (material_ != 0 || !mesh_.face_materials.empty()) mesh_.face_materials.push_back(material_);
  for (const Corner* corner : {&a, &b, &c}) {
    has_uv_ |= corner->uv != none;
    has_normal_ |= corner->normal != none;
    mesh_.indices.push_back(wedges_.vertex(*corner));
  }
}

void ObjReader::use_material(std::string_view name) {
  if (const auto found = material_ids_.find(name); found != material_ids_.end()) {
    material_ = found->second;
    return;
  }
  material_ = static_cast<MaterialId>(mesh_.materials.size());
  Material material;
  material.name = name;
  mesh_.materials.push_back(std::move(material));
  material_ids_.emplace(name, material_);
}

void ObjReader::load_library(Words& words) {
  for (const std::string& name : library_names(input_.folder(), words.rest())) {
    const auto file = find_beside(input_.folder(), name);
    auto library = file ? Input::open(*file, options_.max_file_bytes)
                        : Result<Input>{Error{ErrorCode::NotFound, "there is no such file", name}};
    if (!library) {
      warnings_.add("the material library \"" + name + "\" cannot be read: " + library.error().message, lines_.place());
      continue;
    }
    read_mtl(*library, input_.folder(), context_, library_, warnings_);
  }
}

void ObjReader::begin_group(std::string_view kind, std::string_view name) {
  const bool is_object = kind == "o";
  if (is_object) object_ = none;
  feature_ = object_;
  if (name.empty() || name == "default" || mesh_.features.size() >= max_features) return;
  std::string id{name};
  const FeatureId parent = is_object ? none : object_;
  if (parent != none && mesh_.features[parent].id != id) id = mesh_.features[parent].id + '/' + id;
  const auto [at, is_new] = feature_ids_.try_emplace(id, static_cast<FeatureId>(mesh_.features.size()));
  if (is_new) {
    Feature feature;
    feature.id = id;
    feature.parent = parent;
    mesh_.features.push_back(std::move(feature));
  }
  feature_ = at->second;
  if (is_object) object_ = feature_;
}

std::optional<glm::dvec3> ObjReader::better_origin() const {
  if (header_.origin || header_.offset || box_.empty()) return std::nullopt;
  constexpr double keeps_0_1_mm_m = 838.0;  // a float of this size has a last place of 0.06 mm
  const auto reach_m = [&](const Box& box, int a) {
    return std::max(std::abs(box.min[a] - origin_[a]), std::abs(box.max[a] - origin_[a]));
  };
  if (std::max({reach_m(box_, 0), reach_m(box_, 1), reach_m(box_, 2)}) <= keeps_0_1_mm_m) return std::nullopt;
  // A stray vertex at (0, 0, 0), which no face names, must not pull the origin away from the surface.
  const Box used = box_without_strays(wedges_.size(), [&](std::size_t w) {
    return glm::dvec3{pool_.positions[wedges_.key(static_cast<VertexId>(w)).position]} + origin_;
  });
  const glm::dvec3 wanted = choose_origin(used);
  for (int a = 0; a < 3 && !used.empty(); ++a) {
    const double reach = reach_m(used, a);
    if (wanted[a] != origin_[a] && reach > keeps_0_1_mm_m) return wanted;
  }
  return std::nullopt;
}

void ObjReader::finish_materials() {
  for (Material& material : mesh_.materials) {
    const auto found = library_.find(material.name);
    if (found == library_.end()) {
      if (material.name != "default") {
        warnings_.add("the material \"" + material.name + "\" is not defined", input_.name());
      }
      continue;
    }
    material.base_color = found->second.color;
    if (found->second.texture.empty()) continue;
    material.texture = add_texture_file(mesh_, found->second.texture, input_, options_, warnings_, found->second.place);
    if (found->second.mask.empty()) continue;
    material.alpha_cutoff = 0.5F;
    if (found->second.mask == found->second.texture) continue;
    warnings_.add("a mask that is not the texture itself is not used, only the texture's own alpha",
                  found->second.place);
  }
}

Result<LoadedMesh> ObjReader::finish() {
  if (pool_.positions.empty()) return Error{ErrorCode::BadData, "holds no vertices; it is no OBJ file", input_.name()};
  wedges_.close();
  const std::size_t count = wedges_.size();
  VertexArrays& out = mesh_.vertices;
  // One array after the other, each freeing what it was made from, so that the peak stays near the result's own size.
  const auto gather = [&](auto& pool, auto& to, auto index_of, auto missing) {
    to.resize(count, missing);
    for (std::size_t w = 0; w < count; ++w) {
      const std::uint32_t from = index_of(wedges_.key(static_cast<VertexId>(w)));
      if (from != none) to[w] = pool[from];
    }
    pool = {};
  };
  gather(
      pool_.positions, out.positions, [](const WedgeKey& k) { return k.position; }, glm::vec3{0.0F});
  if (has_normal_) {
    gather(
        pool_.normals, out.normals, [](const WedgeKey& k) { return k.normal; }, glm::vec3{0.0F});
  }
  if (has_uv_)
    gather(
        pool_.uvs, out.uvs, [](const WedgeKey& k) { return k.uv; }, glm::vec2{0.0F});
  if (!pool_.colors.empty()) {
    gather(
        pool_.colors, out.colors, [](const WedgeKey& k) { return k.position; }, glm::u8vec4{255});
  }
  finish_materials();
  header_.place(mesh_, origin_);
  return {to_lodestone_axes(std::move(mesh_), "obj", header_.up, 1.0, options_), warnings_.take()};
}

}  // namespace

Result<LoadedMesh> read_obj(const Input& input, const ReadOptions& options, const Context& context) {
  std::optional<glm::dvec3> origin;
  for (int pass = 0;; ++pass) {
    ObjReader reader{input, options, context, origin};
    if (auto done = reader.read(); !done) return done.error();
    if (pass == 0) origin = reader.better_origin();
    if (pass == 1 || !origin) return reader.finish();
  }
}

}  // namespace lodestone

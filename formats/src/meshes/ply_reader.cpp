// SPDX-License-Identifier: MIT
// Stanford PLY: text and binary of either byte order, with what scanners and MeshLab add to it (texture coordinates per
// vertex or per corner, texture files in comments, colours, triangle strips).
#include <algorithm>
#include <array>
#include <cmath>

#include "axes.h"
#include "header_comments.h"
#include "mesh_count.h"
#include "ply_body.h"
#include "polygon_faces.h"
#include "strays.h"

namespace lodestone {
namespace {

enum class Role : std::uint8_t {
  Other,
  X,
  Y,
  Z,
  Nx,
  Ny,
  Nz,
  Red,
  Green,
  Blue,
  Alpha,
  U,
  V,
  Indices,
  CornerUv,
  TextureNumber
};

struct Property {
  Role role = Role::Other;
  PlyType type = PlyType::Float32;
  std::optional<PlyType> count_type;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding : std::uint8_t { Text, LittleEndian, BigEndian };

struct Header {
  Encoding encoding = Encoding::Text;
  std::vector<Element> elements;
  std::vector<std::string> textures;
  HeaderComments comments;
  std::uint64_t size_bytes = 0;
};

std::optional<PlyType> type_named(std::string_view word) {
  static constexpr std::array<std::pair<std::string_view, PlyType>, 16> names{{
      {"char", PlyType::Int8},
      {"int8", PlyType::Int8},
      {"uchar", PlyType::UInt8},
      {"uint8", PlyType::UInt8},
      {"short", PlyType::Int16},
      {"int16", PlyType::Int16},
      {"ushort", PlyType::UInt16},
      {"uint16", PlyType::UInt16},
      {"int", PlyType::Int32},
      {"int32", PlyType::Int32},
      {"uint", PlyType::UInt32},
      {"uint32", PlyType::UInt32},
      {"float", PlyType::Float32},
      {"float32", PlyType::Float32},
      {"double", PlyType::Float64},
      {"float64", PlyType::Float64},
  }};
  for (const auto& [name, type] : names) {
    if (name == word) return type;
  }
  return std::nullopt;
}

Role role_named(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Role>, 28> names{{
      {"x", Role::X},
      {"y", Role::Y},
      {"z", Role::Z},
      {"nx", Role::Nx},
      {"ny", Role::Ny},
      {"nz", Role::Nz},
      {"normal_x", Role::Nx},
      {"normal_y", Role::Ny},
      {"normal_z", Role::Nz},
      {"red", Role::Red},
      {"green", Role::Green},
      {"blue", Role::Blue},
      {"alpha", Role::Alpha},
      {"diffuse_red", Role::Red},
      {"diffuse_green", Role::Green},
      {"diffuse_blue", Role::Blue},
      {"r", Role::Red},
      {"g", Role::Green},
      {"b", Role::Blue},
      {"s", Role::U},
      {"t", Role::V},
      {"u", Role::U},
      {"v", Role::V},
      {"texture_u", Role::U},
      {"texture_v", Role::V},
      {"vertex_indices", Role::Indices},
      {"vertex_index", Role::Indices},
      {"texcoord", Role::CornerUv},
  }};
  for (const auto& [known, role] : names) {
    if (known == name) return role;
  }
  if (name == "texture_s") return Role::U;
  if (name == "texture_t") return Role::V;
  if (name == "texnumber") return Role::TextureNumber;
  return Role::Other;
}

Error bad(const LineReader& lines, std::string what) {
  return Error{ErrorCode::BadData, std::move(what), lines.place()};
}

Status read_property(Words& words, const LineReader& lines, Element& element) {
  Property property;
  std::string_view word = words.next();
  if (word == "list") {
    property.count_type = type_named(words.next());
    if (!property.count_type) return bad(lines, "a list's count has an unknown type");
    word = words.next();
  }
  const auto type = type_named(word);
  if (!type) return bad(lines, "a property has an unknown type");
  property.type = *type;
  property.role = role_named(words.next());
  constexpr std::size_t max_properties = 1024;
  if (element.properties.size() >= max_properties) return bad(lines, "an element has more than 1024 properties");
  element.properties.push_back(property);
  return Done{};
}

Status read_element(Words& words, const LineReader& lines, Header& header) {
  Element element;
  element.name = words.next();
  double count = -1.0;
  if (!words.number(count) || !(count >= 0.0) || count > 1e15 || count != std::floor(count)) {
    return bad(lines, "an element has no valid count");
  }
  element.count = static_cast<std::uint64_t>(count);
  constexpr std::size_t max_elements = 1024;
  if (header.elements.size() >= max_elements) return bad(lines, "there are more than 1024 elements");
  header.elements.push_back(std::move(element));
  return Done{};
}

Status read_header_line(Words& words, std::string_view key, const LineReader& lines, Header& header) {
  if (key == "format") {
    const std::string_view name = words.next();
    if (name == "ascii")
      header.encoding = Encoding::Text;
    else if (name == "binary_little_endian")
      header.encoding = Encoding::LittleEndian;
    else if (name == "binary_big_endian")
      header.encoding = Encoding::BigEndian;
    else
      return Error{ErrorCode::Unsupported, "the PLY encoding is not known", lines.place()};
    return Done{};
  }
  if (key == "element") return read_element(words, lines, header);
  if (key == "property") {
    if (header.elements.empty()) return bad(lines, "a property stands before any element");
    return read_property(words, lines, header.elements.back());
  }
  if (key == "comment" || key == "obj_info") {
    Words ahead = words;
    const std::string_view first = ahead.next();
    if (first == "TextureFile" || first == "texture" || first == "texture:")
      header.textures.emplace_back(ahead.rest());
    else
      header.comments.read(words.rest());
  }
  return Done{};
}

Result<Header> read_header(LineReader& lines) {
  Header header;
  std::string_view line;
  if (!lines.next(line) || Words{line}.next() != "ply")
    return bad(lines, "is no PLY file: it does not begin with \"ply\"");
  while (lines.next(line)) {
    Words words{line};
    const std::string_view key = words.next();
    if (key == "end_header") {
      header.size_bytes = lines.offset();
      return header;
    }
    if (auto done = read_header_line(words, key, lines, header); !done) return done.error();
  }
  if (!lines.status()) return lines.status().error();
  return bad(lines, "the header has no end");
}

bool has(const Element& element, Role role) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& p) { return p.role == role; });
}

// That the rest of the file can hold.
std::uint64_t most_elements(const Header& header, const Element& element, const Input& input) {
  std::uint64_t least = 0;
  for (const Property& p : element.properties) {
    least += header.encoding == Encoding::Text ? 2 : size_bytes(p.count_type.value_or(p.type));
  }
  const std::uint64_t rest = input.size() - std::min(input.size(), header.size_bytes) + 1;
  return least > 0 ? rest / least : 0;
}

class PlyReader {
 public:
  PlyReader(const Input& input, const ReadOptions& options, const Header& header)
      : input_{input}, options_{options}, header_{header} {}

  template <class Body>
  [[nodiscard]] Status read(Body& body);
  [[nodiscard]] Result<LoadedMesh> finish();

 private:
  [[nodiscard]] Status check_counts(const Element& element) const;
  template <class Body>
  [[nodiscard]] Status read_vertices(Body& body, const Element& element);
  template <class Body>
  [[nodiscard]] Status read_faces(Body& body, const Element& element);
  template <class Body>
  [[nodiscard]] Status read_list(Body& body, const Property& property, std::vector<double>& values) const;
  template <class Body>
  [[nodiscard]] Status skip(Body& body, const Element& element) const;
  template <class Body>
  [[nodiscard]] Error ended(const Body& body) const;

  void add_face(const std::string& place);
  void add_strips(const std::string& place);
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  [[nodiscard]] bool valid(double index) const {
    return index >= 0.0 && index < static_cast<double>(positions_.size()) && index == std::floor(index);
  }
  void add_materials();

  const Input& input_;
  const ReadOptions& options_;
  const Header& header_;
  Warnings warnings_;
  Mesh mesh_;
  std::vector<glm::dvec3> positions_;
  std::vector<double> indices_;  // of the face at hand
  std::vector<double> corner_uvs_;
  std::uint32_t texture_number_ = 0;
  std::uint32_t most_texture_number_ = 0;
  bool per_corner_ = false;       // uvs per corner: vertices are split, then merged again
  std::vector<VertexId> source_;  // with per_corner_: the file's vertex of each of ours
  std::vector<glm::vec2> split_uvs_;
  std::vector<glm::dvec3> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

// A count that the rest of the file cannot hold is refused before any memory is taken for it.
Status PlyReader::check_counts(const Element& element) const {
  if (element.count <= most_elements(header_, element, input_)) return Done{};
  return Error{ErrorCode::BadData,
               "claims " + std::to_string(element.count) + " of \"" + element.name +
                   "\", more than its bytes can hold; it is cut off or damaged",
               input_.name()};
}

template <class Body>
Error PlyReader::ended(const Body& body) const {
  if (body.cancelled()) return body.error();
  return Error{ErrorCode::BadData, "ends early, or holds something that is no number", body.place()};
}

template <class Body>
Status PlyReader::read(Body& body) {
  for (const Element& element : header_.elements) {
    if (element.properties.empty()) continue;
    if (auto good = check_counts(element); !good) return good;
    Status done = [&]() -> Status {
      if (element.name == "vertex" && positions_.empty()) return read_vertices(body, element);
      if (element.name == "face" || element.name == "tristrips") return read_faces(body, element);
      return skip(body, element);
    }();
    if (!done) return done;
  }
  return Done{};
}

template <class Body>
Status PlyReader::read_list(Body& body, const Property& property, std::vector<double>& values) const {
  values.clear();
  double count = 0.0;
  if (!body.value(*property.count_type, count)) return ended(body);
  if (!(count >= 0.0) || count > static_cast<double>(input_.size())) {
    return Error{ErrorCode::BadData, "a list has an impossible length", body.place()};
  }
  for (auto left = static_cast<std::size_t>(count); left > 0; --left) {
    double value = 0.0;
    if (!body.value(property.type, value)) return ended(body);
    values.push_back(value);
  }
  return Done{};
}

template <class Body>
Status PlyReader::skip(Body& body, const Element& element) const {
  std::vector<double> values;
  double value = 0.0;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const Property& p : element.properties) {
      if (p.count_type) {
        if (auto done = read_list(body, p, values); !done) return done;
      } else if (!body.value(p.type, value)) {
        return ended(body);
      }
    }
  }
  return Done{};
}

template <class Body>
Status PlyReader::read_vertices(Body& body, const Element& element) {
  if (element.count > options_.max_vertices) {
    return too_large(input_, "vertices", element.count, options_.max_vertices);
  }
  if (!has(element, Role::X) || !has(element, Role::Y) || !has(element, Role::Z)) {
    return Error{ErrorCode::BadData, "its vertices have no x, y and z", input_.name()};
  }
  VertexArrays& out = mesh_.vertices;
  const auto count = static_cast<std::size_t>(element.count);
  positions_.resize(count, glm::dvec3{0.0});
  if (has(element, Role::Nx)) out.normals.resize(count, glm::vec3{0.0F});
  if (has(element, Role::U)) out.uvs.resize(count, glm::vec2{0.0F});
  if (has(element, Role::Red)) out.colors.resize(count, glm::u8vec4{255});
  std::vector<double> list;
  for (std::size_t i = 0; i < count; ++i) {
    for (const Property& p : element.properties) {
      double value = 0.0;
      if (p.count_type) {
        if (auto done = read_list(body, p, list); !done) return done;
        continue;
      }
      if (!body.value(p.type, value)) return ended(body);
      const auto offset = [&](Role first) { return static_cast<int>(p.role) - static_cast<int>(first); };
      if (p.role >= Role::X && p.role <= Role::Z)
        positions_[i][offset(Role::X)] = value;
      else if (p.role >= Role::Nx && p.role <= Role::Nz && !out.normals.empty()) {
        out.normals[i][offset(Role::Nx)] = static_cast<float>(value);
      } else if (p.role >= Role::Red && p.role <= Role::Alpha && !out.colors.empty()) {
        const bool is_share = p.type == PlyType::Float32 || p.type == PlyType::Float64;
        const double byte = is_share ? value * 255.0 : (size_bytes(p.type) == 2 ? value / 257.0 : value);
        out.colors[i][offset(Role::Red)] =
            static_cast<std::uint8_t>(std::lround(std::clamp(std::isfinite(byte) ? byte : 0.0, 0.0, 255.0)));
      } else if ((p.role == Role::U || p.role == Role::V) && !out.uvs.empty()) {
        out.uvs[i][offset(Role::U)] = static_cast<float>(value);
      }
    }
  }
  return Done{};
}

template <class Body>
Status PlyReader::read_faces(Body& body, const Element& element) {
  if (element.count > options_.max_triangles) {
    return too_large(input_, "faces", element.count, options_.max_triangles);
  }
  const bool strips = element.name == "tristrips";
  per_corner_ = per_corner_ || (has(element, Role::CornerUv) && mesh_.indices.empty());
  std::vector<double> other;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    indices_.clear();
    corner_uvs_.clear();
    texture_number_ = 0;
    for (const Property& p : element.properties) {
      if (p.count_type) {
        auto& list = p.role == Role::Indices ? indices_ : (p.role == Role::CornerUv ? corner_uvs_ : other);
        if (auto done = read_list(body, p, list); !done) return done;
        continue;
      }
      double value = 0.0;
      if (!body.value(p.type, value)) return ended(body);
      if (p.role == Role::TextureNumber && value >= 0.0 && value < 65536.0) {
        texture_number_ = static_cast<std::uint32_t>(value);
      }
    }
    if (strips)
      add_strips(body.place());
    else
      add_face(body.place());
    if (mesh_.indices.size() / 3 > options_.max_triangles) {
      return too_large(input_, "triangles", mesh_.indices.size() / 3, options_.max_triangles);
    }
  }
  return Done{};
}

void PlyReader::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  for (const std::uint32_t corner : {a, b, c}) {
    const auto vertex = static_cast<VertexId>(indices_[corner]);
    if (!per_corner_) {
      mesh_.indices.push_back(vertex);
      continue;
    }
    glm::vec2 uv{0.0F};
    if (2 * std::size_t{corner} + 1 < corner_uvs_.size()) {
      uv = {static_cast<float>(corner_uvs_[2 * corner]), static_cast<float>(corner_uvs_[2 * corner + 1])};
    }
    mesh_.indices.push_back(static_cast<VertexId>(source_.size()));
    source_.push_back(vertex);
    split_uvs_.push_back(uv);
  }
  most_texture_number_ = std::max(most_texture_number_, texture_number_);
  if (texture_number_ != 0 && mesh_.face_materials.empty()) {
    mesh_.face_materials.assign(mesh_.indices.size() / 3 - 1, 0);
  }
  if (texture_number_ != 0 || !mesh_.face_materials.empty()) mesh_.face_materials.push_back(texture_number_);
}

void PlyReader::add_face(const std::string& place) {
  if (!std::all_of(indices_.begin(), indices_.end(), [&](double i) { return valid(i); })) {
    warnings_.add("a face names a vertex that does not exist; it is left out", place);
    return;
  }
  if (indices_.size() < 3) {
    warnings_.add("a face has fewer than three corners; it is left out", place);
    return;
  }
  if (indices_.size() == 3) {
    add_triangle(0, 1, 2);
    return;
  }
  points_.clear();
  for (const double i : indices_) points_.push_back(positions_[static_cast<std::size_t>(i)]);
  if (!std::all_of(points_.begin(), points_.end(),
                   [](const glm::dvec3& p) { return std::isfinite(p.x + p.y + p.z); })) {
    warnings_.add("a face has a corner that is not a finite number; it is left out", place);
    return;
  }
  split_polygon(points_, triangles_);
  for (const auto& t : triangles_) add_triangle(t[0], t[1], t[2]);
}

// Strips of triangles, ended by -1; every second triangle turns the other way, and those without area only steer.
void PlyReader::add_strips(const std::string& place) {
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < indices_.size(); ++i) {
    if (indices_[i] < 0.0) {
      first = i + 1;
      continue;
    }
    if (i < first + 2) continue;
    const std::array<std::uint32_t, 3> t =
        (i - first) % 2 == 0 ? std::array{i - 2, i - 1, i} : std::array{i - 1, i - 2, i};
    if (!valid(indices_[t[0]]) || !valid(indices_[t[1]]) || !valid(indices_[t[2]])) {
      warnings_.add("a strip names a vertex that does not exist; its triangle is left out", place);
    } else if (indices_[t[0]] != indices_[t[1]] && indices_[t[1]] != indices_[t[2]] &&
               indices_[t[0]] != indices_[t[2]]) {
      add_triangle(t[0], t[1], t[2]);
    }
  }
}

void PlyReader::add_materials() {
  const std::size_t count = std::max<std::size_t>(header_.textures.size(), std::size_t{most_texture_number_} + 1);
  for (std::size_t i = 0; i < count; ++i) {
    Material material;
    material.name = count == 1 ? "default" : "texture" + std::to_string(i);
    if (i < header_.textures.size()) {
      material.texture = add_texture_file(mesh_, header_.textures[i], input_, options_, warnings_);
    }
    mesh_.materials.push_back(std::move(material));
  }
}

Result<LoadedMesh> PlyReader::finish() {
  // Of the surface: a stray vertex must not pull the origin away from it.
  const Box box = box_without_strays(mesh_.indices.size(), [&](std::size_t i) {
    const VertexId v = mesh_.indices[i];
    return positions_[per_corner_ ? source_[v] : v];
  });
  const HeaderComments& comments = header_.comments;
  const glm::dvec3 origin =
      comments.origin ? *comments.origin : (comments.offset ? glm::dvec3{0.0} : choose_origin(box));
  VertexArrays& out = mesh_.vertices;
  out.positions.reserve(positions_.size());
  for (const auto& p : positions_) out.positions.emplace_back(p - origin);
  positions_ = {};
  if (per_corner_) {
    const auto split = [&](auto& array) {
      if (array.empty()) return;
      std::remove_reference_t<decltype(array)> all;
      all.reserve(source_.size());
      for (const VertexId v : source_) all.push_back(array[v]);
      array = std::move(all);
    };
    split(out.positions);
    split(out.normals);
    split(out.colors);
    out.uvs = std::move(split_uvs_);
    merge_identical_vertices(mesh_);
  }
  add_materials();
  comments.place(mesh_, origin);
  return {to_lodestone_axes(std::move(mesh_), "ply", comments.up, 1.0, options_), warnings_.take()};
}

// Triangles of the polygons whose lists fill the rest of a binary file.
std::uint64_t triangles_of(const Element& faces, std::uint64_t list_bytes) {
  std::uint64_t head = 0;
  std::uint64_t corner = 0;
  for (const Property& p : faces.properties) {
    head += size_bytes(p.count_type.value_or(p.type));
    if (p.count_type) corner += size_bytes(p.type) * (p.role == Role::CornerUv ? 2 : 1);
  }
  const std::uint64_t corners = corner == 0 ? 0 : (list_bytes - std::min(list_bytes, head * faces.count)) / corner;
  return std::max(faces.count, corners - std::min(corners, 2 * faces.count));
}

}  // namespace

Result<MeshCount> count_ply(const Input& input, const Context& context) {
  LineReader lines{input, context};
  auto header = read_header(lines);
  if (!header) return header.error();
  MeshCount count;
  std::uint64_t rest = input.size() - std::min(input.size(), header->size_bytes);
  bool per_corner = false;
  for (Element& element : header->elements) {
    element.count = std::min(element.count, most_elements(*header, element, input));
    if (element.name == "vertex") {
      count.vertices = element.count;
      count.vertex_bytes = 12U + (has(element, Role::U) ? 8U : 0U) + (has(element, Role::Nx) ? 12U : 0U) +
                           (has(element, Role::Red) ? 4U : 0U);
      std::uint64_t one = 0;
      for (const Property& p : element.properties) one += size_bytes(p.count_type.value_or(p.type));
      rest -= std::min(rest, one * element.count);
    } else if (element.name == "face") {
      const bool alone = header->elements.size() == 2 && header->encoding != Encoding::Text;
      count.triangles = alone ? triangles_of(element, rest) : element.count;
      per_corner = has(element, Role::CornerUv);
    } else if (element.name == "tristrips" && !element.properties.empty()) {
      count.triangles = rest / (header->encoding == Encoding::Text ? 2 : size_bytes(element.properties.front().type));
    }
  }
  const auto triangles = static_cast<double>(count.triangles);
  const auto vertices = static_cast<double>(count.vertices);
  // Coordinates are read in double; arrays of corners grow.
  count.reading_bytes = (36.0 + count.vertex_bytes) * vertices + (per_corner ? 280.0 : 40.0) * triangles;
  if (per_corner) {  // vertices are split where the texture is
    count.vertex_bytes += 8U;
    count.vertices += count.vertices / 4;
  }
  for (const std::string& name : header->textures) {
    if (auto file = find_beside(input.folder(), name)) count.textures.push_back(std::move(*file));
  }
  return count;
}

Result<LoadedMesh> read_ply(const Input& input, const ReadOptions& options, const Context& context) {
  LineReader lines{input, context};
  auto header = read_header(lines);
  if (!header) return header.error();
  PlyReader reader{input, options, *header};
  const auto done = [&]() -> Status {
    if (header->encoding == Encoding::Text) {
      PlyText body{lines};
      return reader.read(body);
    }
    PlyBinary body{input, context, header->size_bytes,
                   header->encoding == Encoding::LittleEndian ? std::endian::little : std::endian::big};
    return reader.read(body);
  }();
  if (!done) return done.error();
  return reader.finish();
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include <string_view>

#include "reader.h"
#include "tidy.h"

namespace lodestone {
namespace {

// The code in well-known text ("EPSG" and a number, the last of them names the whole system), else its name.
std::string crs_of_text(std::string_view text) {
  constexpr std::string_view authority = "\"EPSG\",";
  if (const std::size_t at = text.rfind(authority); at != text.npos) {
    std::string code;
    for (const char c : text.substr(at + authority.size())) {
      if (c >= '0' && c <= '9') {
        code += c;
      } else if (c != '"' && c != ' ') {
        break;
      }
    }
    if (!code.empty()) return "EPSG:" + code;
  }
  const std::size_t begin = text.find('"');
  const std::size_t end = begin == text.npos ? begin : text.find('"', begin + 1);
  return end == text.npos ? std::string{} : std::string{text.substr(begin + 1, end - begin - 1)};
}

// What a .prj file beside the mesh says.
std::string crs_beside(const Input& input) {
  constexpr std::uint64_t most_bytes = 1U << 16U;
  auto place = input.file();
  if (place.empty()) return {};
  const auto prj = Input::open(place.replace_extension(".prj"), most_bytes);
  const auto bytes = prj ? prj->read_all() : Error{};
  if (!bytes) return {};
  return crs_of_text({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

// Says what the reader left out, if anything: that may have been all.
Error no_faces(const Input& input, const std::vector<Warning>& warnings) {
  std::string message = "has no face that can be used";
  if (!warnings.empty()) message += " (" + warnings.front().message + ")";
  return Error{ErrorCode::BadData, message + "; a surface of triangles or polygons is needed", input.name()};
}

}  // namespace

Result<LoadedMesh> read_with(ReadFunction reader, const Input& input, const ReadOptions& options,
                             const Context& context) {
  if (input.size() == 0) return Error{ErrorCode::BadData, "is empty", input.name()};
  auto loaded = reader(input, options, context);
  if (!loaded) return loaded;
  Mesh& mesh = loaded->mesh;
  if (mesh.vertices.positions.size() > options.max_vertices) {
    return too_large(input, "vertices", mesh.vertices.positions.size(), options.max_vertices);
  }
  if (mesh.indices.size() / 3 > options.max_triangles) {
    return too_large(input, "triangles", mesh.indices.size() / 3, options.max_triangles);
  }
  if (!options.crs.empty()) mesh.crs = options.crs;
  if (mesh.crs.empty()) mesh.crs = crs_beside(input);
  Warnings warnings;
  warnings.add_all(std::move(loaded.warnings()));
  tidy(mesh, warnings);
  if (mesh.indices.empty()) return no_faces(input, warnings.take());
  if (auto valid = validate(mesh); !valid) {
    return Error{ErrorCode::BadData, valid.error().message + " (" + valid.error().where + ")", input.name()};
  }
  std::vector<Warning> list = warnings.take();
  for (Warning& warning : list) {
    if (warning.where.empty()) warning.where = input.name();
  }
  return {std::move(*loaded), std::move(list)};
}

}  // namespace lodestone

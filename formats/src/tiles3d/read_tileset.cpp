// SPDX-License-Identifier: MIT
// Based on: OGC 3D Tiles 1.1 (22-025r4), section 7 (tileset JSON), and 1.0 (batched models).
#include "tiles3d/read_tileset.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include <lodestone/tile_loader.h>

#include "images/codecs.h"
#include "reader.h"
#include "tiles3d/fetch.h"

namespace lodestone {
namespace {

using Json = nlohmann::json;
constexpr std::uint64_t most_tile_bytes = 1ULL << 30;
constexpr std::size_t most_tiles = 4'000'000;
constexpr std::uint32_t most_depth = 512;

struct Fault {
  std::string message;
};

double finite(const Json& json) {
  const auto value = json.get<double>();
  if (!std::isfinite(value)) throw Fault{"a number is not finite"};
  return value;
}

Box box_of(const Json& volume) {
  Box box;
  if (volume.contains("box")) {
    const Json& b = volume.at("box");
    if (b.size() != 12) throw Fault{"a box has 12 numbers"};
    const auto vector = [&](std::size_t i) { return glm::dvec3{finite(b[i]), finite(b[i + 1]), finite(b[i + 2])}; };
    const glm::dvec3 half = glm::abs(vector(3)) + glm::abs(vector(6)) + glm::abs(vector(9));
    box.add(vector(0) - half);
    box.add(vector(0) + half);
  } else if (volume.contains("sphere")) {
    const Json& s = volume.at("sphere");
    if (s.size() != 4) throw Fault{"a sphere has 4 numbers"};
    const glm::dvec3 center{finite(s[0]), finite(s[1]), finite(s[2])};
    box.add(center - std::abs(finite(s[3])));
    box.add(center + std::abs(finite(s[3])));
  } else {
    throw Fault{"only boxes and spheres are understood as bounding volumes"};
  }
  return box;
}

// A name below the folder, without a way out of it.
std::string safe_uri(const std::string& uri) {
  const std::filesystem::path path{uri};
  const bool leaves = std::any_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; });
  if (path.is_absolute() || leaves || uri.find(':') != std::string::npos) {
    throw Fault{"the content \"" + uri + "\" is not a file below the tileset"};
  }
  return uri;
}

void add_tile(const Json& json, std::uint32_t parent, std::uint32_t depth, Tileset& out) {
  if (depth > most_depth) throw Fault{"tiles are nested too deeply"};
  if (out.tiles.size() >= most_tiles) throw Fault{"there are too many tiles"};
  const auto id = static_cast<std::uint32_t>(out.tiles.size());
  TilesetTile tile;
  tile.parent = parent;
  tile.level = depth;
  tile.bounds = box_of(json.at("boundingVolume"));
  tile.geometric_error = finite(json.at("geometricError"));
  if (json.contains("content")) tile.uri = safe_uri(json.at("content").at("uri").get<std::string>());
  if (parent != none) out.tiles[parent].children.push_back(id);
  out.tiles.push_back(std::move(tile));
  out.level_count = std::max(out.level_count, depth + 1);
  if (!json.contains("children")) return;
  for (const Json& child : json.at("children")) add_tile(child, id, depth + 1, out);
}

Tileset tileset_of(const Json& json) {
  Tileset out;
  const Json& root = json.at("root");
  add_tile(root, none, 0, out);
  for (TilesetTile& tile : out.tiles) tile.level = out.level_count - 1 - tile.level;
  if (root.contains("transform")) {
    const Json& t = root.at("transform");
    if (t.size() != 16) throw Fault{"a transform has 16 numbers"};
    out.origin = {finite(t[12]), finite(t[13]), finite(t[14])};
  }
  const Json extras = json.at("asset").value("extras", Json::object());
  out.open_edges = extras.value("openEdges", out.open_edges);
  if (extras.contains("origin")) {
    const Json& o = extras.at("origin");
    if (o.size() != 3) throw Fault{"an origin has 3 numbers"};
    out.origin = {finite(o[0]), finite(o[1]), finite(o[2])};
  }
  return out;
}

Result<std::span<const std::uint8_t>> payload_of(std::span<const std::uint8_t> bytes, const std::string& name) {
  constexpr std::size_t head_bytes = 28;
  if (bytes.size() < 4 || std::memcmp(bytes.data(), "b3dm", 4) != 0) return bytes;
  const Error cut{ErrorCode::BadData, "the batched model is cut off", name};
  if (bytes.size() < head_bytes) return cut;
  std::uint64_t skip = head_bytes;
  for (std::size_t at = 12; at < head_bytes; at += 4) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + at, sizeof length);
    skip += length;
  }
  if (skip > bytes.size()) return cut;
  return bytes.subspan(skip);
}

}  // namespace

Result<Tileset> parse_tileset(std::span<const std::uint8_t> bytes, const std::string& name) {
  try {
    return tileset_of(Json::parse(bytes.begin(), bytes.end()));
  } catch (const Fault& fault) {
    return Error{ErrorCode::BadData, fault.message, name};
  } catch (const Json::exception& fault) {
    return Error{ErrorCode::BadData, std::string{"it is no tileset: "} + fault.what(), name};
  }
}

Result<Tileset> read_tileset(const std::filesystem::path& file) {
  const auto bytes = fetch(file, most_tileset_bytes);
  if (!bytes) return bytes.error();
  auto tileset = parse_tileset(*bytes, file.string());
  if (tileset) tileset->folder = file.parent_path();
  return tileset;
}

bool is_osgb(const std::filesystem::path& file) { return file.extension() == ".osgb"; }

bool is_tileset_file(const std::filesystem::path& file) {
  if (is_osgb(file)) return true;
  if (file.extension() != ".json") return false;
  if (is_address(file)) return true;
  const auto input = Input::open(file, most_tileset_bytes);
  if (!input) return false;
  // A tileset's first keys may come in any order; the error of some tile comes early in each.
  constexpr std::size_t head_bytes = 1U << 16;
  Bytes head(std::min<std::uint64_t>(head_bytes, input->size()));
  head.resize(input->read(0, head));
  const std::string_view text{reinterpret_cast<const char*>(head.data()), head.size()};
  return text.find("\"geometricError\"") != std::string_view::npos;
}

Result<Mesh> parse_tile(std::span<const std::uint8_t> bytes, const std::filesystem::path& file,
                        const ReadOptions& options) {
  const auto payload = payload_of(bytes, file.string());
  if (!payload) return payload.error();
  const Input glb = Input::from_bytes(*payload, file.stem().string() + ".glb", file.parent_path());
  auto loaded = read_with(read_gltf, glb, options, {});
  if (!loaded) return Error{loaded.error().code, loaded.error().message, file.string()};
  return std::move(loaded->mesh);
}

Result<LoadedTile> read_tile(const Tileset& tileset, std::uint32_t tile, LoadTextures textures, TileCache* cache) {
  const std::string& uri = tileset.tiles[tile].uri;
  const std::filesystem::path file = tileset.folder / uri;
  std::optional<Bytes> copy = cache != nullptr ? cache->find(uri) : std::nullopt;
  Result<Bytes> bytes = copy ? Result<Bytes>{std::move(*copy)} : fetch(file, most_tile_bytes);
  if (!bytes) return bytes.error();
  auto mesh = parse_tile(*bytes, file, {.textures = textures});
  if (!mesh) return mesh.error();
  if (cache != nullptr && !copy) cache->keep(uri, *bytes);
  return LoadedTile{std::move(*mesh), bytes->size()};
}

}  // namespace lodestone

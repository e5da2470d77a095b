// SPDX-License-Identifier: MIT
// A tile as a client sees it: decoded from its bytes, and rasterised by arithmetic that shares nothing with the
// library's own proof of its error.
#pragma once

#include <lodestone/terrain.h>
#include <lodestone/terrain_files.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>
#include <vector>

namespace lodestone::test {

struct ClientTile {
  TileId id;
  QuantizedMesh mesh;
  double claimed_error_m = 0.0;
  bool placeholder = false;
};
using ClientTiles = std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, ClientTile>;  // zoom, y, x

inline ClientTiles client_tiles(const TerrainPyramid& pyramid) {
  ClientTiles tiles;
  std::mutex mutex;
  const Status status = pyramid.build(
      pyramid.all_tiles(),
      [&](const TerrainTile& tile) -> Status {
        auto mesh = decode_quantized_mesh(encode_quantized_mesh(tile));
        if (!mesh) return mesh.error();
        const std::lock_guard lock{mutex};
        tiles[{tile.id.zoom, tile.id.y, tile.id.x}] = {tile.id, *std::move(mesh), tile.max_error_m, tile.placeholder};
        return Done{};
      },
      {.max_workers = 2});
  REQUIRE(status.ok());
  return tiles;
}

struct ClientError {
  double most_m = 0.0;
  std::size_t covered = 0;  // posts
  bool over_void = false;   // a triangle covers a post without data
  bool sound = true;        // every triangle has an area, counter-clockwise
};

// Every triangle against every post that it covers, borders included.
inline ClientError client_error(const QuantizedMesh& mesh, const std::vector<float>& posts_m) {
  constexpr int side = tile_intervals + 1;
  constexpr double unit = static_cast<double>(quantized_max) / tile_intervals;
  ClientError error;
  std::vector<std::uint8_t> covered(posts_m.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const std::uint32_t a = mesh.triangles[t], b = mesh.triangles[t + 1], c = mesh.triangles[t + 2];
    const double ax = mesh.u[a], ay = mesh.v[a], bx = mesh.u[b], by = mesh.v[b], cx = mesh.u[c], cy = mesh.v[c];
    const double area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    error.sound = error.sound && area > 0.0;
    const auto first = [&](double p, double q, double r) {
      return static_cast<int>(std::ceil(std::min({p, q, r}) / unit - 1e-9));
    };
    const auto last = [&](double p, double q, double r) { return static_cast<int>(std::max({p, q, r}) / unit + 1e-9); };
    for (int j = first(ay, by, cy); j <= last(ay, by, cy); ++j) {
      for (int i = first(ax, bx, cx); i <= last(ax, bx, cx); ++i) {
        const double x = i * unit, y = j * unit;
        const double to_b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area;
        const double to_c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area;
        if (!(std::min({to_b, to_c, 1.0 - to_b - to_c}) >= -1e-12)) continue;
        const double height_m = mesh.height_m(a) + to_b * (mesh.height_m(b) - mesh.height_m(a)) +
                                to_c * (mesh.height_m(c) - mesh.height_m(a));
        const auto post = static_cast<std::size_t>(j * side + i);
        covered[post] = 1;
        if (std::isnan(posts_m[post])) {
          error.over_void = true;
        } else {
          error.most_m = std::max(error.most_m, std::fabs(height_m - static_cast<double>(posts_m[post])));
        }
      }
    }
  }
  error.covered = static_cast<std::size_t>(std::count(covered.begin(), covered.end(), 1));
  return error;
}

// Along one border of a decoded tile, in the order in which the file lists it.
struct ClientBorder {
  std::vector<std::uint16_t> along;
  std::vector<double> height_m;
  std::vector<glm::vec3> normal;
  bool listed = true;  // all vertices with that coordinate, and no other
};
inline ClientBorder client_border(const QuantizedMesh& mesh, const std::vector<std::uint32_t>& list,
                                  const std::vector<std::uint16_t>& across, int at,
                                  const std::vector<std::uint16_t>& along) {
  ClientBorder border;
  for (const std::uint32_t i : list) {
    border.listed = border.listed && across[i] == at;
    border.along.push_back(along[i]);
    border.height_m.push_back(mesh.height_m(i));
    border.normal.push_back(mesh.normals[i]);
  }
  border.listed =
      border.listed && static_cast<std::size_t>(std::count(across.begin(), across.end(), at)) == list.size();
  return border;
}

// Where both have a border from end to end: the same vertices and normals, heights equal to a micrometre.
inline bool meet(const ClientBorder& a, const ClientBorder& b) {
  if (!a.listed || !b.listed || a.along != b.along || a.normal != b.normal) return false;
  for (std::size_t i = 0; i < a.height_m.size(); ++i) {
    if (!(std::fabs(a.height_m[i] - b.height_m[i]) <= 1e-6)) return false;
  }
  return true;
}

// All borders between neighbours of a zoom, around the globe; how many there are.
inline std::size_t check_client_borders(const ClientTiles& tiles) {
  std::size_t borders = 0;
  for (const auto& [key, tile] : tiles) {
    const QuantizedMesh& mesh = tile.mesh;
    const auto east = tiles.find({tile.id.zoom, tile.id.y, (tile.id.x + 1) % (2U << tile.id.zoom)});
    if (east != tiles.end()) {
      const QuantizedMesh& other = east->second.mesh;
      CHECK(meet(client_border(mesh, mesh.east, mesh.u, quantized_max, mesh.v),
                 client_border(other, other.west, other.u, 0, other.v)));
      ++borders;
    }
    const auto north = tiles.find({tile.id.zoom, tile.id.y + 1, tile.id.x});
    if (north != tiles.end()) {
      const QuantizedMesh& other = north->second.mesh;
      CHECK(meet(client_border(mesh, mesh.north, mesh.v, quantized_max, mesh.u),
                 client_border(other, other.south, other.v, 0, other.u)));
      ++borders;
    }
  }
  return borders;
}

// Every tile of a pyramid within its tolerance and half a step, which is what it says of itself as well.
inline void check_client_errors(const TerrainPyramid& pyramid, const ClientTiles& tiles, bool complete) {
  for (const auto& [key, tile] : tiles) {
    if (tile.placeholder) continue;
    const auto posts_m = pyramid.posts(tile.id);
    REQUIRE(posts_m.ok());
    const ClientError error = client_error(tile.mesh, *posts_m);
    CHECK(error.sound);
    CHECK_FALSE(error.over_void);
    if (complete) CHECK(error.covered == posts_m->size());
    CHECK(error.most_m <= pyramid.tolerance_m(tile.id.zoom) + 0.5 * pyramid.height_step_m(tile.id.zoom) + 1e-6);
    CHECK(error.most_m == Approx(tile.claimed_error_m).margin(1e-3));
  }
}

}  // namespace lodestone::test

// SPDX-License-Identifier: MIT
// Reading a large OBJ: ours beside tinyobjloader and assimp, each in a process of its own so that peak memory is its
// own.
//   bench_read_obj [FILE.obj]     without a file: a grid of 2.9 million triangles with uvs and normals is made
// Prints JSON: MB per CPU second and peak memory of every reader, and the size of our mesh in memory.
#include <assimp/scene.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tiny_obj_loader.h>
#include <unistd.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <lodestone/formats.h>

namespace {

using lodestone::Mesh;

Mesh bumpy_grid(std::uint32_t side) {
  Mesh mesh;
  mesh.materials.emplace_back();
  mesh.materials[0].name = "stone";
  for (std::uint32_t y = 0; y <= side; ++y) {
    for (std::uint32_t x = 0; x <= side; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(side);
      const float v = static_cast<float>(y) / static_cast<float>(side);
      mesh.vertices.positions.emplace_back(100.0F * u, 100.0F * v, std::sin(29.0F * u) * std::cos(31.0F * v));
      mesh.vertices.uvs.emplace_back(u, v);
    }
  }
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * (side + 1) + x;
      for (const std::uint32_t v : {a, a + 1, a + side + 2, a, a + side + 2, a + side + 1}) mesh.indices.push_back(v);
    }
  }
  lodestone::compute_normals(mesh);
  return mesh;
}

std::size_t bytes_of(const Mesh& mesh) {
  const auto& v = mesh.vertices;
  return v.positions.size() * sizeof v.positions[0] + v.normals.size() * sizeof v.normals[0] +
         v.uvs.size() * sizeof v.uvs[0] + (mesh.indices.size() + mesh.face_materials.size()) * 4;
}

struct Cost {
  bool good = false;
  double cpu_s = 0.0;
  double peak_mb = 0.0;
};

Cost run_alone(const std::function<bool()>& work) {
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work() ? 0 : 1);
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {WIFEXITED(status) && WEXITSTATUS(status) == 0, seconds(usage.ru_utime) + seconds(usage.ru_stime),
          static_cast<double>(usage.ru_maxrss) / 1024.0};
}

bool read_with_callbacks(const std::string& file) {
  std::ifstream stream{file};
  tinyobj::callback_t callbacks;
  callbacks.vertex_cb = [](void*, float, float, float, float) {};
  callbacks.normal_cb = [](void*, float, float, float) {};
  callbacks.texcoord_cb = [](void*, float, float, float) {};
  callbacks.index_cb = [](void*, tinyobj::index_t*, int) {};
  return tinyobj::LoadObjWithCallback(stream, callbacks);
}

}  // namespace

int main(int argc, char** argv) {
  std::string file = argc > 1 ? argv[1] : "";
  const auto made = std::filesystem::temp_directory_path() / ("lodestone-bench-" + std::to_string(::getpid()) + ".obj");
  if (file.empty()) {
    file = made.string();
    if (!run_alone([&] { return lodestone::write_mesh(bumpy_grid(1200), made).ok(); }).good) return 2;
  }
  const double mb = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
  const auto sink = std::filesystem::path{made}.replace_extension(".size");
  const auto ours = [&] {
    const auto read = lodestone::read_mesh(file, {.textures = lodestone::LoadTextures::Reference});
    if (read) std::ofstream{sink} << bytes_of(read->mesh);
    return read.ok();
  };
  const std::pair<const char*, std::function<bool()>> readers[] = {
      {"lodestone", ours},
      {"tinyobjloader callbacks, nothing kept", [&] { return read_with_callbacks(file); }},
      {"tinyobjloader ObjReader", [&] { return tinyobj::ObjReader{}.ParseFromFile(file); }},
      {"assimp", [&] { return Assimp::Importer{}.ReadFile(file, 0) != nullptr; }},
  };
  std::printf("{\"bench\": \"read_obj\", \"file_mb\": %.1f, \"readers\": [", mb);
  const char* comma = "";
  for (const auto& [name, work] : readers) {
    Cost best;
    for (int round = 0; round < 3; ++round) {
      const Cost cost = run_alone(work);
      if (!best.good || cost.cpu_s < best.cpu_s) best = cost;
    }
    std::printf("%s\n  {\"name\": \"%s\", \"good\": %s, \"mb_per_cpu_s\": %.0f, \"peak_mb\": %.0f}", comma, name,
                best.good ? "true" : "false", mb / best.cpu_s, best.peak_mb);
    comma = ",";
  }
  std::size_t own_bytes = 0;
  std::ifstream{sink} >> own_bytes;
  std::printf("\n], \"our_mesh_mb\": %.0f}\n", static_cast<double>(own_bytes) / 1e6);
  std::error_code ignored;
  for (const char* extension : {".obj", ".mtl", ".size"}) {
    std::filesystem::remove(std::filesystem::path{made}.replace_extension(extension), ignored);
  }
  return 0;
}

// SPDX-License-Identifier: MIT
// What a .lode file weighs and how fast it is written and read, Draco (single resolution) beside it.
//
//     bench_file MESH
//
// Builds the whole stack of MESH with subset placement and prints one JSON object: bytes per source vertex lossless
// with positions and normals; bits per vertex and splits/s positions only at 10, 12, 14 and 16 bits, with Draco's bits
// and triangles/s at the same bits. Rates are the best of five runs in processor time of the thread, which a busy
// machine disturbs least. `read` is read_model() in all: file, checksums, unpacking, decoding, and the check of every
// record; `decode` is the same without that check.
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>

#include "processor_clock.h"

namespace {

using namespace lodestone;

constexpr int runs = 5;

template <class Work>
double best_seconds(Work&& work) {
  double best = 1e9;
  for (int i = 0; i < runs; ++i) {
    const double start = thread_seconds();
    work();
    best = std::min(best, thread_seconds() - start);
  }
  return best;
}

[[noreturn]] void fail(const std::string& line) {
  std::fprintf(stderr, "bench_file: %s\n", line.c_str());
  std::exit(2);
}

std::shared_ptr<const ProgressiveModel> build(const Mesh& mesh) {
  auto built = build_by_edge_collapse(mesh, {.placement = Placement::Subset});
  if (!built) fail(to_line(built.error()));
  return built->model;
}

struct Figures {
  std::uint64_t bytes = 0;
  double write_s = 0.0, read_s = 0.0, check_s = 0.0;
};

Figures measure(const ProgressiveModel& model, std::uint32_t bits) {
  const auto file = std::filesystem::temp_directory_path() / "bench_file.lode";
  Figures figures;
  figures.write_s = best_seconds([&] {
    const auto bytes = write_model(model, file, {.quantize_bits = bits});
    if (!bytes) fail(to_line(bytes.error()));
    figures.bytes = *bytes;
  });
  std::shared_ptr<const ProgressiveModel> back;
  figures.read_s = best_seconds([&] {
    auto read = read_model(file);
    if (!read) fail(to_line(read.error()));
    back = std::move(read).value();
  });
  figures.check_s = best_seconds([&] {
    if (!ProgressiveModel::from_data(back->data())) fail("a model that was read does not check");
  });
  figures.check_s -= best_seconds([&] { const ModelData copy = back->data(); });
  std::filesystem::remove(file);
  return figures;
}

void print(const ProgressiveModel& model, const Figures& f) {
  const double vertices = model.vertex_slot_count();
  const double records = model.record_count();
  std::printf("\"bytes\": %llu, \"bytes_per_vertex\": %.2f, \"bits_per_vertex\": %.2f,",
              static_cast<unsigned long long>(f.bytes), static_cast<double>(f.bytes) / vertices,
              8.0 * static_cast<double>(f.bytes) / vertices);
  std::printf(
      " \"write_splits_per_second\": %.3g, \"read_splits_per_second\": %.3g, \"decode_splits_per_second\": %.3g",
      records / f.write_s, records / f.read_s, records / (f.read_s - f.check_s));
}

void print_draco(const Mesh& mesh, std::uint32_t bits) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(mesh.triangle_count()));
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const auto at = [&](std::size_t c) { return &mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + c]]; };
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(f), at(0), at(1), at(2));
  }
  const std::unique_ptr<draco::Mesh> soup = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, static_cast<int>(bits));
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(*soup, &buffer).ok()) fail("Draco cannot encode the mesh");
  const double decode_s = best_seconds([&] {
    draco::DecoderBuffer in;
    in.Init(buffer.data(), buffer.size());
    draco::Decoder decoder;
    if (!decoder.DecodeMeshFromBuffer(&in).ok()) fail("Draco cannot decode what it encoded");
  });
  std::printf("\"draco_bits_per_vertex\": %.2f, \"draco_vertices_per_second\": %.3g",
              8.0 * static_cast<double>(buffer.size()) / mesh.vertex_count(), mesh.vertex_count() / decode_s);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "bench_file: usage: bench_file MESH\n");
    return 1;
  }
  auto loaded = read_mesh(argv[1]);
  if (!loaded) fail(to_line(loaded.error()));
  Mesh mesh = std::move(loaded->mesh);
  if (mesh.vertices.normals.empty()) compute_normals(mesh, std::numbers::pi);
  std::printf("{\"mesh\": \"%s\", \"vertices\": %u, \"triangles\": %u,\n  \"lossless_with_normals\": {", argv[1],
              mesh.vertex_count(), mesh.triangle_count());
  const auto with_normals = build(mesh);
  print(*with_normals, measure(*with_normals, 0));
  mesh.vertices.normals.clear();
  const auto bare = build(mesh);
  std::printf("},\n  \"lossless_positions\": {");
  print(*bare, measure(*bare, 0));
  for (const std::uint32_t bits : {10U, 12U, 14U, 16U}) {
    std::printf("},\n  \"quantized_%u\": {", bits);
    print(*bare, measure(*bare, bits));
    std::printf(", ");
    print_draco(mesh, bits);
  }
  std::printf("}\n}\n");
  return 0;
}

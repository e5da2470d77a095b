// SPDX-License-Identifier: MIT
/// \file
/// Files in and out. The kind of a file is told by its content, else by its name.
///
/// Readers tolerate what real files get wrong (missing textures, wrong case in names, negative indices, n-gons with
/// holes, duplicate and degenerate faces, NaN) and list it as warnings, or refuse with file and place. They never
/// crash, hang or grow without bound on any bytes: counts and sizes are capped (ReadOptions) and checked after
/// decoding. Writers write beside the target and rename, so a failed or cancelled call leaves the old file as it was.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/image.h>
#include <lodestone/mesh.h>
#include <lodestone/progressive_model.h>
#include <lodestone/result.h>

namespace lodestone {

/// Which way is up in the file; everything is turned to Z up on reading.
enum class UpAxis : std::uint8_t { FromFile, Y, Z };

enum class LoadTextures : std::uint8_t {
  Reference,  ///< paths only
  Encoded,    ///< the files' bytes
  Decoded,    ///< pixels too
};

struct ReadOptions {
  UpAxis up = UpAxis::FromFile;  ///< FromFile: the format's rule (glTF Y, CityGML Z), OBJ and PLY Z unless stated
  double unit_m = 0.0;           ///< metres per file unit; 0 = the format's rule, else 1
  /// Coordinate reference system such as "EPSG:25832"; empty = what the file says, else what a .prj file (well-known
  /// text) beside it says.
  std::string crs;
  LoadTextures textures = LoadTextures::Encoded;
  /// Caps. Beyond them a file is refused (TooLarge) instead of filling the memory.
  std::uint64_t max_vertices = 400'000'000;
  std::uint64_t max_triangles = 400'000'000;
  std::uint64_t max_file_bytes = 64ULL << 30;
  std::uint64_t max_texture_pixels = 1ULL << 28;
};

/// What a reader learned besides the mesh.
struct SourceInfo {
  std::string format;   ///< "obj", "ply", "gltf", "3ds", "cityjson", "citygml", "lode", or assimp's name
  std::string up_axis;  ///< "Y" or "Z": as it was in the file
  double unit_m = 1.0;  ///< metres per unit of the file
};

struct LoadedMesh {
  Mesh mesh;
  SourceInfo info;
};

/// Whether the writers below could put a file there: its folder exists and may be written, and nothing but a plain file
/// has its name (devices, pipes and folders are never replaced). To be asked before long work. Leaves nothing behind.
[[nodiscard]] Status check_output(const std::filesystem::path& file);

/// Reads OBJ+MTL, PLY, glTF 2.0 / GLB (also packed with Draco or meshopt), 3DS, CityJSON 1.1 and 2.0, CityGML 2.0, and
/// else assimp reads (IFC, ...); no face is an error. A .lode file gives its finest level, a .lodg file its leaves.
[[nodiscard]] Result<LoadedMesh> read_mesh(const std::filesystem::path& file, const ReadOptions& options = {},
                                           const Context& context = {});

/// Writes OBJ+MTL, PLY or GLB by the name's extension. Textures go beside an OBJ or PLY, inside a GLB.
/// World coordinates are kept: OBJ and PLY get them in full; GLB carries the origin as a node translation.
/// Features of faces are groups in an OBJ; in a GLB they are ids of vertices with a table of ids, classes and parents
/// (EXT_mesh_features, EXT_structural_metadata), for which vertices are split where features meet; PLY has none.
[[nodiscard]] Status write_mesh(const Mesh& mesh, const std::filesystem::path& file, const Context& context = {});

struct ModelWriteOptions {
  /// Bits per coordinate of the longest side of the model's box, at most 20; 0 = lossless. On a grid normals get as
  /// many bits per octahedral coordinate (8 to 12), uvs steps of 1/4096; records are reordered within windows of nearly
  /// equal error, and every level's error grows by half the diagonal of a cell.
  std::uint32_t quantize_bits = 0;
  /// Put textures into the file (else refer to them by path).
  bool embed_textures = true;
};

struct ModelReadOptions {
  /// Use only the first so many bytes: the coarse part of the model; 0 = all.
  std::uint64_t max_bytes = 0;
};

/// .lode files: docs/FILE_FORMAT.md. Any prefix of a file that holds the base is a usable, coarser model; a file that
/// was cut short reads as one, with a warning. write_model() returns the bytes written; cost about 1 us a record and
/// the size of the file in memory. read_model() checks every byte and every record.
[[nodiscard]] Result<std::uint64_t> write_model(const ProgressiveModel& model, const std::filesystem::path& file,
                                                const ModelWriteOptions& options = {}, const Context& context = {});
[[nodiscard]] Result<std::shared_ptr<const ProgressiveModel>> read_model(const std::filesystem::path& file,
                                                                         const ModelReadOptions& options = {},
                                                                         const Context& context = {});

/// To how many bits per coordinate a .lode file was quantised, 0 = lossless. Reads the header only.
[[nodiscard]] Result<std::uint32_t> quantize_bits_of(const std::filesystem::path& file);

/// True if the file begins like a .lode file.
[[nodiscard]] bool is_model_file(const std::filesystem::path& file);

/// JPEG, PNG, WebP, and what stb reads (BMP, GIF, and TGA by its name), told by content. EXIF orientation is
/// applied, CMYK turned to RGB, 16 bits cut to 8. `source` is named in errors.
[[nodiscard]] Result<Image> decode_image(std::span<const std::uint8_t> bytes, const std::string& source,
                                         std::uint64_t max_pixels = 1ULL << 28);
[[nodiscard]] Result<Image> read_image(const std::filesystem::path& file);
/// PNG, JPEG or WebP by the name's extension; `quality` 1..100 for the latter two.
[[nodiscard]] Status write_image(const Image& image, const std::filesystem::path& file, int quality = 90);
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_jpeg(const Image& image, int quality = 90);
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_png(const Image& image);
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_webp(const Image& image, int quality = 90);

/// Writes an animated GIF that loops for ever, frame by frame, so that a long film needs the memory of one frame.
/// Every frame has the size of the first; each gets its own 255 colours. Nothing is left behind unless finish()
/// succeeds.
///
///     auto film = lodestone::GifWriter::create("sweep.gif", 1.0 / 25.0);
///     for (...) film->add(frame);
///     film->finish();
class GifWriter {
 public:
  /// `frame_s`: how long a frame is shown, in seconds; GIF rounds it to hundredths, viewers show at most 50 a second.
  [[nodiscard]] static Result<GifWriter> create(const std::filesystem::path& file, double frame_s);
  GifWriter(GifWriter&&) noexcept;
  GifWriter& operator=(GifWriter&&) noexcept;
  ~GifWriter();
  [[nodiscard]] Status add(const Image& frame);
  [[nodiscard]] Status finish();

 private:
  struct State;
  explicit GifWriter(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};
/// All frames at once.
[[nodiscard]] Status write_gif(std::span<const Image> frames, const std::filesystem::path& file, double frame_s);

}  // namespace lodestone

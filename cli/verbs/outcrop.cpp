// SPDX-License-Identifier: MIT
#include <lodestone/tileset_writer.h>

#include "mesh_input.h"
#include "run_program.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Outcrop final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "outcrop"; }
  [[nodiscard]] std::string summary() const override { return "Make a pyramid of textured tiles of an outcrop"; }
  [[nodiscard]] std::string example() const override { return "lodestone outcrop cliff.obj -o cliff_tiles"; }
  void declare(Arguments& arguments) override;
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] TilesetOptions options() const;
  [[nodiscard]] Status turn_into_osgb(const std::filesystem::path& tiles) const;
  static void describe(Session& session, const TilesetReport& written);

  MeshInput input_;
  std::filesystem::path output_;
  std::string as_ = "3dtiles";
  std::string split_ = "auto";
  std::string image_ = "jpeg";
  std::string compression_ = "none";
  std::string version_ = "1.1";
  double ratio_ = 0.0;
  double texture_ratio_ = 0.0;
  std::uint64_t tile_bytes_ = 0;
  std::uint32_t quality_ = 90;
  bool resume_ = false;
};

void Outcrop::declare(Arguments& arguments) {
  input_.declare(arguments, "FILE", "Textured mesh");
  arguments.file("-o,--output", output_, "Folder to write", Need::Required);
  arguments.choice("--as", as_, {"3dtiles", "osgb"}, "Kind of tiles; osgb is OpenSceneGraph's");
  arguments.number("--ratio", ratio_, 0.0, 0.95, "Triangles kept from level to level, 0 = as the textures ask");
  arguments.number("--texture-ratio", texture_ratio_, 0.0, 0.95,
                   "Texture width kept from level to level, 0 = --ratio, or a half");
  arguments.bytes("--tile-bytes", tile_bytes_, "Bytes of a tile to aim at, 0 = by the size of the whole");
  arguments.choice("--split", split_, {"auto", "texture", "space"}, "How images are cut into tiles");
  arguments.choice("--image", image_, {"jpeg", "png", "webp"}, "Format of the tiles' textures");
  arguments.count("--quality", quality_, 1, 100,
                  "Of JPEG and WebP; JPEG from 90 on keeps the full resolution of colours");
  arguments.choice("--compress", compression_, {"none", "meshopt"},
                   "Vertices and triangles: meshopt needs clients that know EXT_meshopt_compression");
  arguments.choice("--tiles-version", version_, {"1.1", "1.0"}, "3D Tiles: glb, or b3dm for older clients");
  arguments.flag("--resume", resume_, "Go on with a build that was stopped");
}

TilesetOptions Outcrop::options() const {
  TilesetOptions options;
  options.pyramid.ratio = ratio_;
  options.pyramid.texture_ratio = texture_ratio_;
  options.pyramid.tile_bytes = tile_bytes_;
  if (split_ == "texture") options.pyramid.split = TileSplit::Texture;
  if (split_ == "space") options.pyramid.split = TileSplit::Space;
  if (image_ == "png") options.image = TileImage::Png;
  if (image_ == "webp") options.image = TileImage::Webp;
  if (compression_ == "meshopt") options.compression = TileCompression::Meshopt;
  if (version_ == "1.0") options.version = TilesVersion::V10;
  options.jpeg_quality = static_cast<int>(quality_);
  options.resume = resume_;
  return options;
}

void Outcrop::describe(Session& session, const TilesetReport& written) {
  std::uint32_t in_space = 0;
  for (const OutcropSegment& segment : written.segments) {
    if (segment.split == TileSplit::Space) ++in_space;
  }
  Report& report = session.report();
  report.set("segments", static_cast<std::uint32_t>(written.segments.size()));
  report.set("segments_split_in_space", in_space);
  report.set("kept_tiles", written.kept_tiles);
  report.set("degenerate_triangles", written.degenerate_triangles);
  report.set("geometry_seconds", written.geometry_seconds);
  report.set("decode_seconds", written.decode_seconds);
  report.set("resample_seconds", written.resample_seconds);
  report.set("encode_seconds", written.encode_seconds);
  report.set("decoded_megapixels", written.decoded_megapixels);
  report.set("encoded_megapixels", written.encoded_megapixels);
  report.set("geometry_workers", written.geometry_workers);
  report.set("photograph_workers", written.photograph_workers);
  std::uint32_t number = 0;
  for (const OutcropLevel& level : written.levels) {
    Report one;
    one.set("level", number++);
    one.set("tiles", level.tiles);
    one.set("triangles", level.triangles);
    one.set("geometric_error_m", level.geometric_error_m);
    one.set("texture_scale", level.texture_scale);
    one.set("border_share", static_cast<double>(level.border_triangles) / level.triangles);
    report.add("pyramid", one);
  }
}

// By OpenSceneGraph's own library, in a program of its own.
Status Outcrop::turn_into_osgb(const std::filesystem::path& tiles) const {
  const std::string program = find_program("lodestone-osgb", ".").string();
  const auto ended = run_to_end({program, (tiles / "tileset.json").string(), output_.string()});
  if (!ended) return Error{ErrorCode::Unsupported, "cannot be started, build it with OpenSceneGraph", program};
  if (ended->status == 0) return Done{};
  std::string message = ended->last_words.substr(0, ended->last_words.find('\n'));
  if (message.empty()) message = "OpenSceneGraph ended without a word";
  return Error{ErrorCode::Unreadable, message, output_.string()};
}

std::uint64_t bytes_below(const std::filesystem::path& folder) {
  std::error_code fault;
  std::uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator{folder, fault}) {
    if (entry.is_regular_file(fault)) bytes += entry.file_size(fault);
  }
  return bytes;
}

// Of what is wrong inside the mesh's file the writer knows a triangle, or the name of an image, but no file.
std::string in_file(const std::string& where, const std::filesystem::path& file) {
  std::error_code fault;
  if (std::filesystem::exists(where, fault)) return where;
  return file.string() + (where.empty() ? "" : ", " + where);
}

void tell_of_fewer_workers(Session& session, const TilesetReport& written) {
  if (!written.fewer_workers) return;
  session.remark(
      "to keep to --max-memory, fewer threads worked than asked for: " + std::to_string(written.geometry_workers) +
      " on the levels, " + std::to_string(written.photograph_workers) + " on photographs");
}

Status Outcrop::run(Session& session) {
  const bool osgb = as_ == "osgb";
  if (osgb && image_ == "webp") {
    return Error{ErrorCode::BadArgument, "OpenSceneGraph does not read WebP, take --image jpeg or png", ""};
  }
  const std::filesystem::path tiles = osgb ? output_ / "3dtiles" : output_;
  if (Status fits = outcrop_fits(input_.file(), options(), session.context()); !fits) return fits.error();
  auto loaded = input_.read(session, LoadTextures::Reference);
  if (!loaded) return loaded.error();
  auto written = write_outcrop(std::move(loaded->mesh), tiles, options(), session.context());
  for (Warning& warning : written.warnings()) warning.where = in_file(warning.where, input_.file());
  session.keep(written);
  if (!written) {
    Error error = written.error();
    const bool of_input = error.code == ErrorCode::BadData || error.code == ErrorCode::TooLarge;
    if (of_input) error.where = in_file(error.where, input_.file());
    return or_resume(error, output_);
  }
  const auto check = check_tileset(tiles / "tileset.json", session.context());
  if (!check) {  // what cannot be read is not to be taken for whole
    std::error_code fault;
    std::filesystem::remove(tiles / "tileset.json", fault);
    Error error = check.error();
    if (written->kept_tiles > 0) error.message += "; without --resume all tiles are made anew";
    return error;
  }
  std::vector<Warning> faults;
  for (const std::string& fault : check->faults) faults.push_back({fault, output_.string()});
  session.keep(std::move(faults));
  tell_of_fewer_workers(session, *written);
  if (osgb) {
    if (Status status = turn_into_osgb(tiles); !status) return status;
    std::error_code fault;
    std::filesystem::remove_all(tiles, fault);
    written->bytes = bytes_below(output_);
  }
  Report& report = session.report();
  report.set("tiles", written->tiles);
  report.set("levels", static_cast<std::uint32_t>(written->levels.size()));
  report.set("bytes", written->bytes);
  report.set("root_error_m", written->root_error_m);
  report.set("source_triangles", written->source_triangles);
  report.set("seams_open", check->seams_open);
  describe(session, *written);
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_outcrop() { return std::make_unique<Outcrop>(); }

}  // namespace lodestone::cli

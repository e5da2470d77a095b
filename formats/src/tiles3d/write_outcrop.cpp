// SPDX-License-Identifier: MIT
// Based on: Ao et al. 2025, section 3.5.1 (storage).
// Differs: every tile is a job of its own, written beside its name and renamed, so a build that was stopped goes on
// where it was. Photographs are decoded once: all tiles that show only that image are cut from it level by level; what
// coarser tiles of several images need of it waits in the folder `work` until the end.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>

#include "images/codecs.h"
#include "meshes/writers.h"
#include "tiles3d/build_record.h"
#include "tiles3d/jobs.h"
#include "tiles3d/kept_files.h"
#include "tiles3d/outcrop_memory.h"
#include "tiles3d/photographs.h"
#include "tiles3d/tileset_json.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

double thread_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Adds the time until its end to a sum.
class Stopwatch {
 public:
  Stopwatch(std::mutex& mutex, double& sum) : mutex_(mutex), sum_(sum) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() {
    const double spent = thread_seconds() - start_;
    const std::scoped_lock lock{mutex_};
    sum_ += spent;
  }

 private:
  std::mutex& mutex_;
  double& sum_;
  double start_ = thread_seconds();
};

Error cannot_make(const fs::path& folder, const std::error_code& fault) {
  return {ErrorCode::Unreadable, "the folder cannot be made: " + fault.message(), folder.string()};
}

// One grid for all tiles: steps of a sixteenth of a millimetre at most, and a millionth of a small outcrop.
int position_exponent(const OutcropPyramid& pyramid) {
  constexpr int longest_step = -14;
  constexpr int steps_of_diagonal = 20;  // bits
  constexpr int most_steps = 23;         // on either side of the origin
  const Box& box = pyramid.tiles().back().bounds;
  const glm::dvec3 reach = glm::max(glm::abs(box.min), glm::abs(box.max));
  const double farthest = std::max({reach.x, reach.y, reach.z});
  const int wanted = std::min(longest_step, std::ilogb(std::max(box.diagonal_m(), 1e-9)) - steps_of_diagonal);
  return std::max(wanted, std::ilogb(std::max(farthest, 1e-9)) + 1 - most_steps);
}

// Steps of 1/64 texel.
int uv_exponent(const TileTexture& texture) {
  constexpr int bits_of_texel = 6;
  return -bits_of_texel - std::ilogb(static_cast<double>(std::max({texture.width, texture.height, 1U}))) - 1;
}

class OutcropWriter {
 public:
  OutcropWriter(fs::path folder, const TilesetOptions& options, const Context& context)
      : folder_(std::move(folder)), options_(options), context_(context) {
    quiet_.cancel = context.cancel;
  }
  Result<TilesetReport> write(Mesh mesh);

 private:
  [[nodiscard]] Status prepare_folder(const std::string& record);
  [[nodiscard]] Result<bool> may_keep_tiles(const std::string& found, const std::string& record);
  [[nodiscard]] Status write_record() const;
  void clean(const fs::path& folder, bool tiles) const;
  void leave_no_trace() const;
  void sort_tiles();
  [[nodiscard]] std::vector<std::uint32_t> largest_first() const;
  [[nodiscard]] Status write_photograph(std::uint32_t segment);
  [[nodiscard]] Result<Image> photograph_of(std::uint32_t texture);
  [[nodiscard]] Status write_joined(std::uint32_t tile);
  [[nodiscard]] Status write_tile(std::uint32_t tile, std::span<const SegmentImages* const> images);
  [[nodiscard]] Status put_texture(TileContent& content, std::span<const SegmentImages* const> images);
  [[nodiscard]] Box box_of(const Mesh& mesh) const;
  [[nodiscard]] Status store_level(const SegmentImages& images) const;
  [[nodiscard]] Result<SegmentImages> load_level(std::uint32_t segment, std::uint32_t level) const;
  [[nodiscard]] fs::path work_file(std::uint32_t segment, std::uint32_t level) const {
    return folder_ / "work" / ("S" + std::to_string(segment) + "_L" + std::to_string(level));
  }
  [[nodiscard]] fs::path tile_file(std::uint32_t tile) const {
    return folder_ / tile_name(*pyramid_, tile, options_.version);
  }
  [[nodiscard]] bool is_done(const fs::path& file) const { return options_.resume && is_whole_file(file); }
  [[nodiscard]] bool photograph_is_done(std::uint32_t segment) const;
  void tile_finished(bool kept);
  [[nodiscard]] Status finish();

  fs::path folder_;
  bool made_folder_ = false;  // it was not there before
  const TilesetOptions& options_;
  const Context& context_;
  Context quiet_;  // cancels, but does not report: for jobs that run beside each other
  MemoryPlan plan_;
  std::shared_ptr<const OutcropPyramid> pyramid_;
  std::vector<Texture> textures_;
  std::vector<std::map<std::uint32_t, std::vector<std::uint32_t>>> alone_;  // per segment: tiles of each level
  std::vector<std::vector<std::uint8_t>> joined_levels_;  // per segment and level: a joined tile needs its image
  std::vector<std::uint32_t> joined_;                     // tiles of several segments, or without texture
  std::vector<Box> boxes_;                                // per tile: of what it shows; each is written by one job
  std::mutex mutex_;
  std::uint32_t done_ = 0;
  TilesetReport report_;
  std::vector<Warning> warnings_;
  std::string record_;  // of what the build is made from
  DamagedPhotographs damaged_;
};

// Removes what a build of ours left: half-written files, and tiles unless they are to be kept.
void OutcropWriter::clean(const fs::path& folder, bool tiles) const {
  std::error_code fault;
  for (const auto& entry : fs::directory_iterator{folder, fault}) {
    const std::string name = entry.path().filename().string();
    const bool half = name.find(".part") != std::string::npos;
    const bool tile = name.starts_with('L') && (name.ends_with(".glb") || name.ends_with(".b3dm"));
    if (half || (tiles && tile)) fs::remove(entry.path(), fault);
  }
}

// Where only photographs have changed, as those that were mended, the same outcrop is built anew.
Result<bool> OutcropWriter::may_keep_tiles(const std::string& found, const std::string& record) {
  if (!options_.resume || found.empty()) return false;
  const auto changed = changed_photographs(found, record);
  if (!changed) return Error{changed.error().code, changed.error().message, folder_.string()};
  if (changed->empty()) {
    damaged_ = damaged_photographs(found);
    return true;
  }
  for (const std::string& name : *changed) {
    warnings_.push_back({"the photograph is another one since, so all tiles are made anew", name});
  }
  return false;
}

Status OutcropWriter::prepare_folder(const std::string& record) {
  std::error_code fault;
  std::ifstream stream{folder_ / "build.json", std::ios::binary};
  const std::string found{std::istreambuf_iterator<char>{stream}, {}};
  const auto keep = may_keep_tiles(found, record);
  if (!keep) return keep.error();
  made_folder_ = !fs::exists(folder_, fault);
  for (const char* name : {"tiles", "work"}) {
    fs::create_directories(folder_ / name, fault);
    if (fault) return cannot_make(folder_ / name, fault);
  }
  clean(folder_, false);
  if (!*keep) fs::remove_all(folder_ / "work", fault);
  fs::create_directories(folder_ / "work", fault);
  clean(folder_ / "work", false);
  clean(folder_ / "tiles", !*keep);
  fs::remove(folder_ / "tileset.json", fault);
  record_ = record;
  return write_record();
}

Status OutcropWriter::write_record() const {
  const std::string text = damaged_.empty() ? record_ : with_damaged(record_, damaged_);
  return write_whole_file(folder_ / "build.json", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// Of a build that ended before its first tile.
void OutcropWriter::leave_no_trace() const {
  std::error_code fault;
  if (!fs::is_empty(folder_ / "tiles", fault) || fault) return;
  fs::remove(folder_ / "build.json", fault);
  for (const char* name : {"work", "tiles"}) fs::remove(folder_ / name, fault);  // if empty
  if (made_folder_) fs::remove(folder_, fault);
}

void OutcropWriter::sort_tiles() {
  boxes_.resize(pyramid_->tiles().size());
  const std::size_t segments = pyramid_->segments().size();
  alone_.resize(segments);
  joined_levels_.assign(segments, std::vector<std::uint8_t>(pyramid_->levels().size(), 0));
  for (std::uint32_t i = 0; i < pyramid_->tiles().size(); ++i) {
    const OutcropTile& tile = pyramid_->tiles()[i];
    if (tile.segments.size() == 1 && pyramid_->segments()[tile.segments.front()].texture != none) {
      alone_[tile.segments.front()][tile.level].push_back(i);
    } else {
      joined_.push_back(i);
      for (const std::uint32_t s : tile.segments) joined_levels_[s][tile.level] = 1;
    }
  }
}

void OutcropWriter::tile_finished(bool kept) {
  const std::scoped_lock lock{mutex_};
  ++done_;
  if (kept) ++report_.kept_tiles;
  context_.report("tiles", static_cast<double>(done_) / static_cast<double>(pyramid_->tiles().size()));
}

// Raw pixels: they live for one build.
Status OutcropWriter::store_level(const SegmentImages& images) const {
  const Image& image = images.image();
  auto out = OutputFile::create(work_file(images.segment(), images.level()));
  if (!out) return out.error();
  const std::uint32_t head[] = {image.width, image.height, image.channels};
  out->write(head, sizeof head);
  out->write(image.pixels.data(), image.pixels.size());
  return out->commit();
}

Result<SegmentImages> OutcropWriter::load_level(std::uint32_t segment, std::uint32_t level) const {
  const fs::path file = work_file(segment, level);
  std::ifstream stream{file, std::ios::binary};
  std::uint32_t head[3] = {};
  stream.read(reinterpret_cast<char*>(head), sizeof head);
  const glm::uvec2 size = pyramid_->image_size(segment, level);
  const Error damaged{ErrorCode::BadData, "a file of this build is damaged, start without --resume", file.string()};
  if (!stream || head[0] > size.x || head[1] > size.y || head[2] == 0 || head[2] > 4) return damaged;
  Image image{head[0], head[1], head[2], {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) * image.height * image.channels);
  stream.read(reinterpret_cast<char*>(image.pixels.data()), static_cast<std::streamsize>(image.pixels.size()));
  if (!stream) return damaged;
  return SegmentImages{segment, level, std::move(image)};
}

Status OutcropWriter::put_texture(TileContent& content, std::span<const SegmentImages* const> images) {
  Image pixels;
  {
    const Stopwatch watch{mutex_, report_.resample_seconds};
    pixels = compose(content.texture, images);
  }
  const Stopwatch watch{mutex_, report_.encode_seconds};
  const bool webp = options_.image == TileImage::Webp;
  const bool png = options_.image == TileImage::Png || (!webp && pixels.channels % 2 == 0);
  auto bytes = webp  ? encode_webp(pixels, options_.jpeg_quality)
               : png ? encode_png(pixels)
                     : encode_jpeg(pixels, options_.jpeg_quality);
  if (!bytes) return bytes.error();
  Texture& texture = content.mesh.textures.front();
  texture.mime_type = webp ? "image/webp" : (png ? "image/png" : "image/jpeg");
  texture.encoded = std::make_shared<const std::vector<std::uint8_t>>(std::move(*bytes));
  const std::scoped_lock lock{mutex_};
  report_.encoded_megapixels += 1e-6 * static_cast<double>(pixels.width) * pixels.height;
  return Done{};
}

// The glb of a tile in a batched model of one batch.
Status wrap_as_b3dm(const fs::path& glb, const fs::path& file) {
  std::ifstream stream{glb, std::ios::binary};
  std::string payload{std::istreambuf_iterator<char>{stream}, {}};
  std::string table = R"({"BATCH_LENGTH":0})";
  constexpr std::size_t head_bytes = 28;
  table.resize((head_bytes + table.size() + 7) / 8 * 8 - head_bytes, ' ');
  payload.resize((payload.size() + 7) / 8 * 8, '\0');
  const std::uint32_t head[] = {0x6d643362U,  // "b3dm"
                                1,
                                static_cast<std::uint32_t>(head_bytes + table.size() + payload.size()),
                                static_cast<std::uint32_t>(table.size()),
                                0,
                                0,
                                0};
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  out->write(head, sizeof head);
  out->write(table);
  out->write(payload);
  return out->commit();
}

// Packed vertices lie up to half a step away.
Box OutcropWriter::box_of(const Mesh& mesh) const {
  Box box;
  for (const glm::vec3& p : mesh.vertices.positions) box.add(glm::dvec3{p});
  const bool packed = options_.compression == TileCompression::Meshopt;
  const double slack_m = packed ? std::ldexp(0.5, position_exponent(*pyramid_)) : 0.0;
  return {box.min - slack_m, box.max + slack_m};
}

Status OutcropWriter::write_tile(std::uint32_t tile, std::span<const SegmentImages* const> images) {
  TileContent content = pyramid_->content(tile);
  pyramid_->add_skirt(tile, content.mesh);
  boxes_[tile] = box_of(content.mesh);
  content.mesh.origin = glm::dvec3{0.0};  // the root's transform carries it
  content.mesh.crs.clear();
  if (!content.texture.pieces.empty()) {
    if (Status status = put_texture(content, images); !status) return status;
  }
  const fs::path file = tile_file(tile);
  const GltfLevel only{&content.mesh, 0.0};
  const bool plain = options_.version == TilesVersion::V11;
  const fs::path glb = plain ? file : folder_ / "work" / (file.stem().string() + ".glb");
  GltfStyle style{.look = GltfLook::Photograph};
  if (options_.compression == TileCompression::Meshopt) {
    style.packing = GltfPacking{position_exponent(*pyramid_), uv_exponent(content.texture)};
  }
  if (Status status = write_gltf_levels({&only, 1}, glb, quiet_, style); !status) return status;
  if (!plain) {
    if (Status status = wrap_as_b3dm(glb, file); !status) return status;
    std::error_code fault;
    fs::remove(glb, fault);
  }
  tile_finished(false);
  return Done{};
}

bool OutcropWriter::photograph_is_done(std::uint32_t segment) const {
  for (const auto& [level, tiles] : alone_[segment]) {
    for (const std::uint32_t tile : tiles) {
      if (!is_done(tile_file(tile))) return false;
    }
  }
  const bool all_joined =
      std::all_of(joined_.begin(), joined_.end(), [&](std::uint32_t tile) { return is_done(tile_file(tile)); });
  for (std::uint32_t level = 0; level < joined_levels_[segment].size() && !all_joined; ++level) {
    if (joined_levels_[segment][level] != 0 && !is_done(work_file(segment, level))) return false;
  }
  return true;
}

// White, as faces without one are, where it is damaged. What was whole when it was measured and is gone now is no
// damage, nor is what memory does not do for.
Result<Image> OutcropWriter::photograph_of(std::uint32_t texture) {
  const TextureInfo& info = plan_.images[texture];
  const Stopwatch watch{mutex_, report_.decode_seconds};
  auto decoded = [&]() -> Result<Image> {
    try {
      return decode_texture(textures_[texture]);
    } catch (const std::bad_alloc&) {
      Error error = no_memory_for(info.width_px, info.height_px);
      error.where = name_of(textures_[texture]);
      return error;
    }
  }();
  const std::scoped_lock lock{mutex_};
  if (decoded && (decoded->width != info.width_px || decoded->height != info.height_px)) {
    return Error{ErrorCode::BadData, "the image changed its size while it was used", name_of(textures_[texture])};
  }
  if (decoded) {
    report_.decoded_megapixels += 1e-6 * static_cast<double>(decoded->width) * decoded->height;
    return decoded;
  }
  const Error& error = decoded.error();
  const bool of_file = error.code == ErrorCode::NotFound || error.code == ErrorCode::Unreadable;
  if (of_file || error.code == ErrorCode::TooLarge) return error;
  damaged_[textures_[texture].name] = error.message;
  if (Status status = write_record(); !status) return status.error();
  Image white{info.width_px, info.height_px, 3, {}};
  white.pixels.assign(std::size_t{white.width} * white.height * white.channels, 255);
  return white;
}

Status OutcropWriter::write_photograph(std::uint32_t segment) {
  if (photograph_is_done(segment)) {
    for (const auto& [level, tiles] : alone_[segment]) {
      for (std::size_t i = 0; i < tiles.size(); ++i) tile_finished(true);
    }
    return Done{};
  }
  auto photograph = photograph_of(pyramid_->segments()[segment].texture);
  if (!photograph) return photograph.error();
  const auto timed = [&](auto work) {
    const Stopwatch watch{mutex_, report_.resample_seconds};
    return work();
  };
  SegmentImages images = timed([&] { return SegmentImages{*pyramid_, segment, std::move(*photograph)}; });
  for (std::uint32_t level = 0; level < pyramid_->levels().size() && !context_.cancelled(); ++level) {
    const auto tiles = alone_[segment].find(level);
    const bool here = tiles != alone_[segment].end();
    const bool later = joined_levels_[segment][level] != 0;
    if (!here && !later) continue;
    timed([&] { return images.go_to(*pyramid_, level); });
    if (later && !is_done(work_file(segment, level))) {
      if (Status status = store_level(images); !status) return status;
    }
    if (!here) continue;
    const SegmentImages* only[] = {&images};
    Status status = run_jobs(tiles->second.size(), plan_.tile_workers, quiet_, [&](std::size_t i) -> Status {
      const std::uint32_t tile = tiles->second[i];
      if (!is_done(tile_file(tile))) return write_tile(tile, only);
      tile_finished(true);
      return Done{};
    });
    if (!status) return status;
  }
  return Done{};
}

Status OutcropWriter::write_joined(std::uint32_t tile) {
  if (is_done(tile_file(tile))) {
    tile_finished(true);
    return Done{};
  }
  std::vector<SegmentImages> images;
  for (const std::uint32_t s : pyramid_->tiles()[tile].segments) {
    if (pyramid_->segments()[s].texture == none) continue;
    auto loaded = load_level(s, pyramid_->tiles()[tile].level);
    if (!loaded) return loaded.error();
    images.push_back(std::move(*loaded));
  }
  std::vector<const SegmentImages*> pointers(images.size());
  std::transform(images.begin(), images.end(), pointers.begin(), [](const SegmentImages& one) { return &one; });
  return write_tile(tile, pointers);
}

// Segments with an image, so that no large one is left for the end, when other workers have nothing to do.
std::vector<std::uint32_t> OutcropWriter::largest_first() const {
  const auto& segments = pyramid_->segments();
  std::vector<std::uint32_t> order;
  for (std::uint32_t s = 0; s < segments.size(); ++s) {
    if (segments[s].texture != none) order.push_back(s);
  }
  const auto pixels = [&](std::uint32_t s) { return std::uint64_t{segments[s].width_px} * segments[s].height_px; };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return pixels(a) > pixels(b); });
  return order;
}

Status OutcropWriter::finish() {
  for (const Texture& texture : textures_) {
    const auto found = damaged_.find(texture.name);
    if (found != damaged_.end()) warnings_.push_back(plain_warning(found->second, name_of(texture)));
  }
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    if (!boxes_[i].empty()) continue;  // else it was kept from an earlier build
    TileContent content = pyramid_->content(i);
    pyramid_->add_skirt(i, content.mesh);
    boxes_[i] = box_of(content.mesh);
  }
  if (Status status = write_tileset_json(*pyramid_, folder_ / "tileset.json", options_.version, boxes_, warnings_);
      !status) {
    return status;
  }
  std::error_code fault;
  fs::remove_all(folder_ / "work", fault);
  for (const auto& entry : fs::recursive_directory_iterator{folder_, fault}) {
    if (entry.is_regular_file(fault)) report_.bytes += entry.file_size(fault);
  }
  report_.tiles = static_cast<std::uint32_t>(pyramid_->tiles().size());
  report_.root_error_m = pyramid_->tiles().back().error_m;
  report_.levels = pyramid_->levels();
  report_.segments = pyramid_->segments();
  return Done{};
}

Result<TilesetReport> OutcropWriter::write(Mesh mesh) {
  report_.source_triangles = mesh.triangle_count();
  report_.degenerate_triangles = degenerate_triangle_count(mesh);
  if (report_.degenerate_triangles == report_.source_triangles) {
    return Error{ErrorCode::BadData, "no triangle of the outcrop has an area", ""};
  }
  auto plan = plan_memory_of(mesh, options_.pyramid, context_, warnings_);
  if (!plan) return plan.error();
  plan_ = std::move(*plan);
  report_.geometry_workers = plan_.geometry_workers;
  report_.photograph_workers = plan_.photograph_workers;
  report_.fewer_workers = plan_.fewer;
  const auto record = record_build(mesh, options_, context_);
  if (!record) return record.error();
  textures_ = mesh.textures;
  for (Texture& texture : mesh.textures) texture = {.name = texture.name};
  if (Status status = prepare_folder(*record); !status) return status.error();
  timespec before{};
  timespec after{};
  ::clock_gettime(CLOCK_MONOTONIC, &before);
  Context building = context_;
  building.max_workers = plan_.geometry_workers;
  auto pyramid = OutcropPyramid::build(std::move(mesh), plan_.images, options_.pyramid, building);
  ::clock_gettime(CLOCK_MONOTONIC, &after);
  if (!pyramid) {
    leave_no_trace();
    return pyramid.error();
  }
  report_.geometry_seconds =
      static_cast<double>(after.tv_sec - before.tv_sec) + 1e-9 * static_cast<double>(after.tv_nsec - before.tv_nsec);
  warnings_.insert(warnings_.end(), pyramid.warnings().begin(), pyramid.warnings().end());
  pyramid_ = std::move(*pyramid);
  sort_tiles();
  const auto joined_workers = joined_at_once(*pyramid_, joined_, plan_, context_);
  if (!joined_workers) {
    leave_no_trace();
    return joined_workers.error();
  }
  const std::vector<std::uint32_t> order = largest_first();
  Status status = run_jobs(order.size(), plan_.photograph_workers, context_,
                           [&](std::size_t i) { return write_photograph(order[i]); });
  if (!status) return status.error();
  status = run_jobs(joined_.size(), *joined_workers, context_, [&](std::size_t i) { return write_joined(joined_[i]); });
  if (!status) return status.error();
  if (Status done = finish(); !done) return done.error();
  return {std::move(report_), std::move(warnings_)};
}

}  // namespace

Result<TilesetReport> write_outcrop(Mesh mesh, const fs::path& folder, const TilesetOptions& options,
                                    const Context& context) {
  if (options.jpeg_quality < 1 || options.jpeg_quality > 100) {
    return Error{ErrorCode::BadArgument, "the JPEG quality must be 1 to 100", ""};
  }
  return OutcropWriter{folder, options, context}.write(std::move(mesh));
}

}  // namespace lodestone

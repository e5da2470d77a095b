// SPDX-License-Identifier: MIT
// Order of blocks: base, previews of textures, records from coarse to fine, textures from small to large.
#include <algorithm>
#include <cmath>
#include <limits>

#include <lodestone/formats.h>

#include "header.h"
#include "images/codecs.h"
#include "output_file.h"
#include "reader.h"
#include "reorder.h"
#include "stack_codec.h"

namespace lodestone {
namespace {

using namespace model_file;

constexpr std::uint32_t max_grid_bits = 20;
// A block is a quarter of the records before it, within these bounds: prefixes are fine-grained where files are small,
// and tables cost little where they are large.
constexpr std::uint32_t min_block_records = 1024;
constexpr std::uint32_t max_block_records = 32768;

struct TextureBytes {
  std::uint32_t texture = 0;
  std::shared_ptr<const std::vector<std::uint8_t>> bytes;
};

// Of the longer side of a preview. All of them stand before the first record, so many textures get small ones.
std::uint32_t preview_size_px(std::size_t textures) { return textures <= 16 ? 64 : textures <= 128 ? 32 : 16; }

class ModelWriter {
 public:
  ModelWriter(const ModelData& data, const Context& context) : data_(data), context_(context) {}

  Result<std::uint64_t> write(const std::filesystem::path& file, const ModelWriteOptions& options, const Box& box) {
    describe(options, box);
    gather_textures(file, options.embed_textures);
    if (const Status done = gather_previews(); !done) return done.error();
    if (const Status done = encode(); !done) return done.error();
    for (const TextureBytes& t : embedded_) add_texture(t);
    return store(file);
  }

 private:
  void describe(const ModelWriteOptions& options, const Box& box) {
    header_.generator = "lodestone " LODESTONE_VERSION;
    header_.surroundings = data_;
    header_.method = data_.method;
    header_.named_levels = data_.named_levels;
    header_.normals = !data_.vertices.normals.empty();
    header_.uvs = !data_.vertices.uvs.empty();
    header_.colors = !data_.vertices.colors.empty();
    header_.features = !data_.face_features.empty();
    header_.records = static_cast<std::uint32_t>(data_.shapes.size());
    header_.vertices = data_.vertices.size();
    header_.faces = data_.face_begin.back();
    if (options.quantize_bits > 0) header_.grid = choose_grid(box, data_.vertices, options.quantize_bits);
  }

  void gather_textures(const std::filesystem::path& file, bool embed) {
    for (std::uint32_t i = 0; i < data_.textures.size(); ++i) {
      const Texture& texture = data_.textures[i];
      Texture& stated = header_.surroundings.textures[i];
      stated.image.reset();
      stated.encoded.reset();
      const std::filesystem::path path{texture.path};
      if (!embed && !path.empty()) {
        stated.path = path.lexically_proximate(file.parent_path()).generic_string();
        continue;
      }
      auto bytes = bytes_of(texture, stated.mime_type);
      if (bytes == nullptr) {
        warnings_.add("a texture could not be embedded; the file refers to it by path", texture.name);
        stated.path = path.lexically_proximate(file.parent_path()).generic_string();
        continue;
      }
      if (!embed) warnings_.add("a texture has no path to refer to; it is embedded", texture.name);
      stated.path.clear();
      embedded_.push_back({i, std::move(bytes)});
    }
    std::stable_sort(embedded_.begin(), embedded_.end(),
                     [](const auto& a, const auto& b) { return a.bytes->size() < b.bytes->size(); });
  }

  // A texture that is hardly larger than its preview comes early itself.
  Status gather_previews() {
    const std::uint32_t longest_px = preview_size_px(embedded_.size());
    std::vector<TextureBytes> late;
    for (TextureBytes& t : embedded_) {
      if (context_.cancelled()) return Error{ErrorCode::Cancelled, "writing was cancelled", {}};
      auto preview = encode_preview(*t.bytes, data_.textures[t.texture].name, longest_px);
      if (preview && 2 * preview->size() >= t.bytes->size()) {
        previews_.push_back(std::move(t));
        continue;
      }
      if (preview) previews_.push_back({t.texture, std::make_shared<const Bytes>(std::move(preview).value())});
      late.push_back(std::move(t));
    }
    embedded_ = std::move(late);
    return Done{};
  }

  static std::shared_ptr<const std::vector<std::uint8_t>> bytes_of(const Texture& texture, std::string& mime_type) {
    if (texture.encoded != nullptr) return texture.encoded;
    if (texture.image != nullptr && !texture.image->empty()) {
      auto png = encode_png(*texture.image);
      mime_type = "image/png";
      if (png) return std::make_shared<const std::vector<std::uint8_t>>(std::move(png).value());
      return nullptr;
    }
    if (texture.path.empty()) return nullptr;
    const auto input = Input::open(texture.path, max_texture_bytes);
    if (!input) return nullptr;
    auto all = input->read_all();
    return all ? std::make_shared<const std::vector<std::uint8_t>>(std::move(all).value()) : nullptr;
  }

  Status encode() {
    StackWriter stack{data_, header_.grid};
    auto columns = std::make_unique<WrittenColumns>();
    stack.base(*columns);
    add_block(BlockKind::Base, 0, *columns);
    for (const TextureBytes& t : previews_) add_texture(t);
    const auto records = static_cast<std::uint32_t>(data_.shapes.size());
    for (std::uint32_t done = 0; done < records;) {
      if (context_.cancelled()) return Error{ErrorCode::Cancelled, "writing was cancelled", {}};
      context_.report("encode", static_cast<double>(done) / records);
      const std::uint32_t count = std::min(std::clamp(done / 4, min_block_records, max_block_records), records - done);
      stack.records(count, *columns);
      add_block(BlockKind::Records, count, *columns);
      done += count;
    }
    return Done{};
  }

  void add_block(BlockKind kind, std::uint32_t count, WrittenColumns& columns) {
    packed_.push_back(pack_columns(columns));
    const PackedBlock& block = packed_.back();
    header_.blocks.push_back({.kind = kind,
                              .compressed = block.compressed,
                              .count = count,
                              .stored_bytes = block.bytes.size(),
                              .raw_bytes = block.raw_bytes,
                              .checksum = checksum(block.bytes)});
    for (ColumnWriter& column : columns) column.clear();
  }

  void add_texture(const TextureBytes& t) {
    header_.blocks.push_back({.kind = BlockKind::Texture,
                              .compressed = false,
                              .count = t.texture,
                              .stored_bytes = t.bytes->size(),
                              .raw_bytes = t.bytes->size(),
                              .checksum = checksum(*t.bytes)});
  }

  Result<std::uint64_t> store(const std::filesystem::path& file) {
    auto out = OutputFile::create(file);
    if (!out) return out.error();
    const Bytes head = write_header(header_);
    std::uint64_t bytes = head.size();
    out->write(head.data(), head.size());
    const auto put = [&](const Bytes& block) {
      out->write(block.data(), block.size());
      bytes += block.size();
    };
    put(packed_.front().bytes);
    for (const TextureBytes& t : previews_) put(*t.bytes);
    for (std::size_t i = 1; i < packed_.size(); ++i) put(packed_[i].bytes);
    for (const TextureBytes& t : embedded_) {
      if (context_.cancelled()) return Error{ErrorCode::Cancelled, "writing was cancelled", file.string()};
      put(*t.bytes);
    }
    if (const Status done = out->commit(); !done) return done.error();
    return {bytes, warnings_.take()};
  }

  static constexpr std::uint64_t max_texture_bytes = 1ULL << 32;

  const ModelData& data_;
  const Context& context_;
  Header header_;
  std::vector<PackedBlock> packed_;
  std::vector<TextureBytes> previews_;
  std::vector<TextureBytes> embedded_;
  Warnings warnings_;
};

}  // namespace

Result<std::uint64_t> write_model(const ProgressiveModel& model, const std::filesystem::path& file,
                                  const ModelWriteOptions& options, const Context& context) {
  if (options.quantize_bits > max_grid_bits) {
    return Error{ErrorCode::BadArgument, "positions can be quantised to at most 20 bits", file.string()};
  }
  if (options.quantize_bits == 0) return ModelWriter{model.data(), context}.write(file, options, model.bounds());
  // Snapping moves a vertex by half the diagonal of a cell at most; every level says so.
  ModelData data = reorder(model.data());
  const double half_cell_m =
      std::sqrt(3.0) / 2.0 * choose_grid(model.bounds(), data.vertices, options.quantize_bits).step_m;
  for (ErrorStep& step : data.errors) {
    step.error_m = std::nextafter(static_cast<float>(step.error_m + half_cell_m), std::numeric_limits<float>::max());
  }
  return ModelWriter{data, context}.write(file, options, model.bounds());
}

}  // namespace lodestone

// SPDX-License-Identifier: MIT
#include <cstring>

#include <lodestone/formats.h>

#include "header.h"
#include "reader.h"
#include "stack_codec.h"

namespace lodestone {
namespace {

using namespace model_file;

class ModelReader {
 public:
  ModelReader(const Input& input, std::uint64_t max_bytes, const Context& context)
      : input_(input),
        context_(context),
        available_(max_bytes == 0 ? input.size() : std::min(max_bytes, input.size())),
        asked_for_less_(max_bytes != 0 && max_bytes < input.size()) {}

  Result<std::uint32_t> quantize_bits() {
    if (auto fault = read_front()) return *std::move(fault);
    return header_.grid.bits;
  }

  Result<std::shared_ptr<const ProgressiveModel>> read() {
    if (auto fault = read_front()) return *std::move(fault);
    if (auto fault = load_blocks()) return *std::move(fault);
    if (auto fault = decode()) return *std::move(fault);
    auto model = ProgressiveModel::from_data(std::move(data_));
    if (!model) return Error{model.error().code, model.error().message, input_.name() + ", " + model.error().where};
    return {std::move(model).value(), warnings_.take()};
  }

 private:
  using Fault = std::optional<Error>;

  struct LoadedBlock {
    Bytes raw;
    std::uint32_t count = 0;
    BlockSummary summary;
    ReadColumns columns;
  };

  [[nodiscard]] Error bad(std::string message, ErrorCode code = ErrorCode::BadData) const {
    return Error{code, std::move(message), input_.name()};
  }
  [[nodiscard]] static std::string name_of(std::size_t block) { return "block " + std::to_string(block); }

  Fault read_bytes(std::uint64_t size, Bytes& out) {
    out.resize(size);
    if (input_.read(offset_, out) != size) return bad("the file could not be read", ErrorCode::Unreadable);
    offset_ += size;
    return std::nullopt;
  }

  Fault read_front() {
    Bytes bytes;
    if (auto fault = read_bytes(std::min<std::uint64_t>(prologue_bytes, available_), bytes)) return fault;
    std::uint64_t size = 0;
    if (auto fault = header_size(bytes, size)) return bad(fault->message, fault->code);
    if (size > available_) return bad(too_short());
    offset_ = 0;
    if (auto fault = read_bytes(size, bytes)) return fault;
    if (auto fault = model_file::read_header(bytes, header_)) return bad(fault->message, fault->code);
    static_cast<Surroundings&>(data_) = header_.surroundings;
    data_.method = header_.method;
    return std::nullopt;
  }

  [[nodiscard]] std::string too_short() const {
    return asked_for_less_ ? "so few bytes do not hold the base of the model; ask for more"
                           : "the file ends before the base of the model; copy it again";
  }

  // Reads and unpacks what is there: all blocks of a whole file, the first ones of a prefix.
  Fault load_blocks() {
    bool complete = true;
    for (std::size_t i = 0; i < header_.blocks.size(); ++i) {
      const BlockEntry& entry = header_.blocks[i];
      if (entry.stored_bytes > available_ - offset_) {
        complete = false;
        break;
      }
      if (context_.cancelled()) return bad("reading was cancelled", ErrorCode::Cancelled);
      Bytes stored;
      if (auto fault = read_bytes(entry.stored_bytes, stored)) return fault;
      if (checksum(stored) != entry.checksum) return bad(name_of(i) + " is damaged; copy the file again");
      if (entry.kind == BlockKind::Texture) {
        take_texture(entry.count, std::move(stored));
      } else if (auto fault = load_block(i, std::move(stored))) {
        return fault;
      }
    }
    if (blocks_.empty()) return bad(too_short());
    if (!complete && !asked_for_less_) {
      warnings_.add("the file is cut short; the model is coarser than it was written", input_.name());
    }
    return std::nullopt;
  }

  // A preview is replaced by what comes later.
  void take_texture(std::uint32_t index, Bytes stored) {
    Texture& texture = data_.textures[index];
    texture.mime_type = image_mime_type(stored);
    if (texture.mime_type.empty()) texture.mime_type = header_.surroundings.textures[index].mime_type;
    texture.encoded = std::make_shared<const Bytes>(std::move(stored));
  }

  Fault load_block(std::size_t i, Bytes stored) {
    const BlockEntry& entry = header_.blocks[i];
    if ((entry.kind == BlockKind::Base) != blocks_.empty()) return bad(name_of(i) + " is out of order");
    auto block = std::make_unique<LoadedBlock>();
    block->count = entry.count;
    block->raw.resize(entry.raw_bytes);
    if (!entry.compressed) {
      block->raw = std::move(stored);
    } else if (!unpack(stored, block->raw)) {
      return bad(name_of(i) + " does not unpack");
    }
    if (!split_columns(block->raw, block->columns)) return bad(name_of(i) + " has no valid table of columns");
    auto summary = read_summary(block->columns);
    if (!summary || block->count != block->columns[Kind].left()) return bad(name_of(i) + " has no valid summary");
    block->summary = *std::move(summary);
    blocks_.push_back(std::move(block));
    return std::nullopt;
  }

  // Face ranges just long enough for the blocks that are there.
  Fault lay_out_faces() {
    std::vector<std::uint64_t> counts(header_.surroundings.materials.size(), 0);
    for (const auto& block : blocks_) {
      for (const auto& [material, count] : block->summary.faces) {
        if (material >= counts.size()) return bad("a block names no material");
        counts[material] += count;
      }
    }
    data_.face_begin.assign(1, 0);
    std::uint64_t total = 0;
    for (const std::uint64_t count : counts) {
      total += count;
      if (total >= none / 3) return bad("there are too many faces");
      data_.face_begin.push_back(static_cast<FaceId>(total));
    }
    return std::nullopt;
  }

  Fault decode() {
    if (auto fault = lay_out_faces()) return fault;
    std::uint64_t vertices = 0;
    std::uint64_t records = 0;
    for (const auto& block : blocks_) {
      vertices += block->summary.vertices;
      records += block->count;
    }
    if (vertices >= none || records >= none) return bad("there are too many vertices");
    StackReader stack{data_,
                      header_.grid,
                      {.normals = header_.normals,
                       .uvs = header_.uvs,
                       .colors = header_.colors,
                       .features = header_.features,
                       .vertices = static_cast<std::uint32_t>(vertices),
                       .records = static_cast<std::uint32_t>(records)}};
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      if (context_.cancelled()) return bad("reading was cancelled", ErrorCode::Cancelled);
      context_.report("decode", static_cast<double>(i) / static_cast<double>(blocks_.size()));
      LoadedBlock& block = *blocks_[i];
      std::string fault =
          i == 0 ? stack.base(block.summary, block.columns) : stack.records(block.count, block.summary, block.columns);
      if (!fault.empty()) return bad(fault + ", " + name_of(i));
      blocks_[i].reset();
    }
    for (const NamedLevel& named : header_.named_levels) {
      if (named.level <= data_.shapes.size()) data_.named_levels.push_back(named);
    }
    load_referenced_textures();
    return std::nullopt;
  }

  void load_referenced_textures() {
    for (Texture& texture : data_.textures) {
      if (texture.encoded != nullptr || texture.path.empty()) continue;
      const auto path = find_beside(input_.folder(), texture.path);
      const auto image = path ? Input::open(*path, max_texture_bytes) : Error{};
      auto bytes = image ? image->read_all() : Error{};
      if (!bytes) {
        warnings_.add("a texture is not where the file says", texture.path);
        continue;
      }
      texture.path = path->string();
      texture.encoded = std::make_shared<const Bytes>(std::move(bytes).value());
    }
  }

  static constexpr std::uint64_t max_texture_bytes = 1ULL << 32;

  const Input& input_;
  const Context& context_;
  std::uint64_t available_;
  bool asked_for_less_;
  std::uint64_t offset_ = 0;
  Header header_;
  ModelData data_;
  std::vector<std::unique_ptr<LoadedBlock>> blocks_;
  Warnings warnings_;
};

}  // namespace

Result<std::shared_ptr<const ProgressiveModel>> read_model(const std::filesystem::path& file,
                                                           const ModelReadOptions& options, const Context& context) {
  constexpr std::uint64_t any_size = ~0ULL;
  const auto input = Input::open(file, any_size);
  if (!input) return input.error();
  return ModelReader{*input, options.max_bytes, context}.read();
}

Result<std::uint32_t> quantize_bits_of(const std::filesystem::path& file) {
  const auto input = Input::open(file, ~0ULL);
  if (!input) return input.error();
  return ModelReader{*input, 0, {}}.quantize_bits();
}

bool is_model_file(const std::filesystem::path& file) {
  const auto input = Input::open(file, ~0ULL);
  std::uint8_t front[sizeof(lode_file.magic)] = {};
  return input && input->read(0, front) == sizeof(front) && std::memcmp(front, lode_file.magic, sizeof(front)) == 0;
}

}  // namespace lodestone

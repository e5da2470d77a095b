// SPDX-License-Identifier: MIT
#include "stack_codec.h"

#include <cassert>

#include "edit_words.h"
#include "look_ahead.h"
#include "record_codec.h"
#include "stores.h"

namespace lodestone::model_file {
namespace {

ValueLayout coded_layout(const VertexArrays& vertices, const Grid& grid) {
  return layout_of(vertices, grid.bits == 0 ? 3 : 2);
}

}  // namespace

class StackWriter::Implementation {
 public:
  virtual ~Implementation() = default;
  virtual void base(WrittenColumns& columns) = 0;
  virtual void records(std::uint32_t count, WrittenColumns& columns) = 0;
};

class StackReader::Implementation {
 public:
  virtual ~Implementation() = default;
  virtual std::string base(const BlockSummary& summary, ReadColumns& columns) = 0;
  virtual std::string records(std::uint32_t count, const BlockSummary& summary, ReadColumns& columns) = 0;
};

namespace {

template <class Space>
class Writer final : public StackWriter::Implementation {
 public:
  Writer(const ModelData& data, const Grid& grid)
      : data_(data),
        grid_(grid),
        layout_(coded_layout(data.vertices, grid)),
        codec_(data, layout_, WriteStore<Space>{data, grid_, layout_}),
        faces_(data.base_face_counts.size(), 0) {
    codec_.open_block(data.vertices.size());
  }

  void base(WrittenColumns& columns) override {
    ColumnSink io{&columns};
    std::vector<VertexId> indices = data_.base_indices;
    [[maybe_unused]] const char* fault = codec_.base(io, data_.base_vertex_count, data_.base_face_counts, indices);
    assert(fault == nullptr);
    faces_ = data_.base_face_counts;
    vertices_ = data_.base_vertex_count;
    summary(io, 0);
  }

  void records(std::uint32_t count, WrittenColumns& columns) override {
    ColumnSink io{&columns};
    std::fill(faces_.begin(), faces_.end(), 0);
    vertices_ = 0;
    for (std::uint32_t i = 0; i < count; ++i) record(io);
    summary(io, level_);
  }

 private:
  void record(ColumnSink& io) {
    const std::uint8_t shape = data_.shapes[level_++];
    const RecordKind kind = kind_of(shape);
    [[maybe_unused]] const char* fault = nullptr;
    if (kind == RecordKind::Edit) {
      io.code(Kind, static_cast<std::uint32_t>(kind));
      fault = codec_.edit(io, load_edit());
    } else {
      load_fan(shape, kind);
      const std::uint32_t word = codec_.kind_word(fan_);
      io.code(Kind, word);
      fault = codec_.fan(io, word, fan_);
      ++vertices_;
      faces_[fan_.material] += kind == RecordKind::FanBoth ? 2 : 1;
    }
    assert(fault == nullptr);
  }

  void load_fan(std::uint8_t shape, RecordKind kind) {
    fan_.kind = kind;
    fan_.moves = (shape & RecordShape::moves_flag) != 0;
    fan_.material = data_.fan_materials.empty() ? 0 : data_.fan_materials[fan_record_++];
    fan_.count = shape & RecordShape::corner_mask;
    for (std::uint32_t i = 0; i < fan_.count; ++i) fan_.corners[i] = load_corner(data_, fan_corner_++);
  }

  Edit& load_edit() {
    const std::uint32_t* block = &data_.edits[edit_word_];
    const EditWords words{block};
    edit_ = {block[1], block[2], block[3], block[4], block[5], {words.body().begin(), words.body().end()}};
    edit_word_ += words.length();
    vertices_ += edit_.vertices;
    words.for_each_group([&](MaterialId m, auto faces) { faces_[m] += static_cast<std::uint32_t>(faces.size() / 3); });
    return edit_;
  }

  // Closes a block that reaches `level`.
  void summary(ColumnSink& io, Level level) {
    std::uint32_t steps = 0;
    for (; error_ < data_.errors.size() && data_.errors[error_].level <= level; ++error_, ++steps) {
      codec_.error_step(io, data_.errors[error_]);
    }
    io.code(Summary, vertices_);
    io.code(Summary, steps);
    const auto used = std::count_if(faces_.begin(), faces_.end(), [](std::uint32_t count) { return count > 0; });
    io.code(Summary, static_cast<std::uint32_t>(used));
    for (MaterialId m = 0; m < faces_.size(); ++m) {
      if (faces_[m] == 0) continue;
      io.code(Summary, m);
      io.code(Summary, faces_[m]);
    }
  }

  const ModelData& data_;
  Grid grid_;
  ValueLayout layout_;
  RecordCodec<Space, ColumnSink, WriteStore<Space>> codec_;
  Fan fan_;
  Edit edit_;
  Level level_ = 0;
  std::size_t fan_corner_ = 0, fan_record_ = 0, edit_word_ = 0, error_ = 0;
  std::uint32_t vertices_ = 0;        // added by the block so far
  std::vector<std::uint32_t> faces_;  // the same per material
};

template <class Space>
class Reader final : public StackReader::Implementation {
 public:
  Reader(ModelData& data, const Grid& grid, const ValueLayout& layout, const StackReader::Contents& contents)
      : data_(data), grid_(grid), codec_(data, layout, ReadStore<Space>{data, grid_, layout, contents.features}) {
    codec_.reserve(contents.vertices);
    data.shapes.reserve(contents.records);
  }

  std::string base(const BlockSummary& summary, ReadColumns& columns) override {
    ColumnSource io{&columns};
    std::uint64_t faces = 0;
    data_.base_face_counts.assign(data_.face_begin.size() - 1, 0);
    for (const auto& [material, count] : summary.faces) {
      data_.base_face_counts[material] = count;
      faces += count;
    }
    if (3 * faces > columns[Split].left()) return "the base has too few indices";
    codec_.open_block(summary.vertices);
    data_.base_vertex_count = summary.vertices;
    data_.base_indices.resize(3 * faces);
    const char* fault = codec_.base(io, summary.vertices, data_.base_face_counts, data_.base_indices);
    return fault != nullptr ? fault : close(io, summary);
  }

  std::string records(std::uint32_t count, const BlockSummary& summary, ReadColumns& columns) override {
    ColumnSource io{&columns};
    codec_.open_block(summary.vertices);
    if (count != columns[Kind].left()) return "a block has another number of records than it should";
    LookAhead ahead{columns, codec_.last_split()};
    for (std::uint32_t i = 0; i < LookAhead::lead; ++i) codec_.fetch_ahead(ahead);
    for (std::uint32_t i = 0; i < count; ++i) {
      codec_.fetch_ahead(ahead);
      if (const char* fault = record(io); fault != nullptr) return fault;
    }
    return close(io, summary);
  }

 private:
  const char* record(ColumnSource& io) {
    const std::uint32_t word = io.code(Kind, 0);
    const auto kind = static_cast<RecordKind>(word & 3U);
    if (kind == RecordKind::Edit) {
      if (word != static_cast<std::uint32_t>(kind)) return "a record is of no known kind";
      if (const char* fault = codec_.edit(io, edit_); fault != nullptr) return fault;
      store_edit();
      return nullptr;
    }
    fan_.kind = kind;
    fan_.moves = (word & 4U) != 0;
    if (const char* fault = codec_.fan(io, word, fan_); fault != nullptr) return fault;
    data_.shapes.push_back(static_cast<std::uint8_t>(fan_.count |
                                                     static_cast<unsigned>(kind) << RecordShape::kind_shift |
                                                     (fan_.moves ? RecordShape::moves_flag : 0U)));
    keep_corners();
    if (data_.base_face_counts.size() > 1) data_.fan_materials.push_back(static_cast<std::uint16_t>(fan_.material));
    return nullptr;
  }

  // The array is kept longer than it is, by at least one fan, until the block ends.
  void keep_corners() {
    const std::size_t most = std::size_t{4} * max_fan_corners;
    if (data_.fan_corners.size() < corner_end_ + most) data_.fan_corners.resize(2 * (corner_end_ + most));
    std::uint8_t* to = &data_.fan_corners[corner_end_];
    for (std::uint32_t i = 0; i < fan_.count; ++i, to += data_.corner_bytes) {
      // Four bytes even where three count; the next corner follows on.
      for (std::uint32_t b = 0; b < 4; ++b) to[b] = static_cast<std::uint8_t>(fan_.corners[i] >> (8 * b));
    }
    corner_end_ += std::size_t{fan_.count} * data_.corner_bytes;
  }

  void store_edit() {
    const auto length = static_cast<std::uint32_t>(EditWords<const std::uint32_t>::head_words + edit_.words.size() + 1);
    data_.shapes.push_back(
        static_cast<std::uint8_t>(static_cast<unsigned>(RecordKind::Edit) << RecordShape::kind_shift));
    data_.edits.insert(data_.edits.end(),
                       {length, edit_.vertices, edit_.faces, edit_.groups, edit_.corners, edit_.moves});
    data_.edits.insert(data_.edits.end(), edit_.words.begin(), edit_.words.end());
    data_.edits.push_back(length);
  }

  std::string close(ColumnSource& io, const BlockSummary& summary) {
    for (std::uint32_t i = 0; i < summary.error_steps; ++i) data_.errors.push_back(codec_.error_step(io, {}));
    data_.fan_corners.resize(corner_end_);
    if (!codec_.full()) return "a block adds fewer vertices than it should";
    for (const ColumnReader& column : *io.columns) {
      if (column.overrun() || column.left() != 0) return "a block holds more or less than its records";
    }
    return {};
  }

  ModelData& data_;
  Grid grid_;
  RecordCodec<Space, ColumnSource, ReadStore<Space>> codec_;
  Fan fan_;
  Edit edit_;
  std::size_t corner_end_ = 0;  // bytes of data_.fan_corners in use
};

}  // namespace

StackWriter::StackWriter(const ModelData& data, const Grid& grid) {
  if (grid.bits == 0) {
    implementation_ = std::make_unique<Writer<FloatSpace>>(data, grid);
  } else {
    implementation_ = std::make_unique<Writer<GridSpace>>(data, grid);
  }
}
StackWriter::~StackWriter() = default;
void StackWriter::base(WrittenColumns& columns) { implementation_->base(columns); }
void StackWriter::records(std::uint32_t count, WrittenColumns& columns) { implementation_->records(count, columns); }

StackReader::StackReader(ModelData& data, const Grid& grid, const Contents& contents) {
  ValueLayout layout{.normals = contents.normals, .uvs = contents.uvs, .colors = contents.colors};
  layout.normal_words = contents.normals ? (grid.bits == 0 ? 3 : 2) : 0;
  constexpr std::uint64_t three_byte_corners = 1ULL << 24U;
  data.corner_bytes = 3ULL * data.face_begin.back() <= three_byte_corners ? 3 : 4;
  if (grid.bits == 0) {
    implementation_ = std::make_unique<Reader<FloatSpace>>(data, grid, layout, contents);
  } else {
    implementation_ = std::make_unique<Reader<GridSpace>>(data, grid, layout, contents);
  }
}
StackReader::~StackReader() = default;
std::string StackReader::base(const BlockSummary& summary, ReadColumns& columns) {
  return implementation_->base(summary, columns);
}
std::string StackReader::records(std::uint32_t count, const BlockSummary& summary, ReadColumns& columns) {
  return implementation_->records(count, summary, columns);
}

std::optional<BlockSummary> read_summary(ReadColumns& columns) {
  ColumnReader& column = columns[Summary];
  BlockSummary summary;
  summary.vertices = column.get();
  summary.error_steps = column.get();
  const std::uint32_t materials = column.get();
  if (column.left() != 2ULL * materials || summary.error_steps > columns[ErrorLevel].left() ||
      summary.vertices > columns[NewValues].left() + columns[EditMerge].left()) {
    return std::nullopt;
  }
  // A face takes a token at least half its own: two in a fan, three in an edit or the base.
  const std::uint64_t most = 2 * columns[Kind].left() + columns[EditFace].left() + columns[Split].left();
  std::uint64_t faces = 0;
  for (std::uint32_t i = 0; i < materials; ++i) {
    const MaterialId m = column.get();
    if (!summary.faces.empty() && m <= summary.faces.back().first) return std::nullopt;
    summary.faces.emplace_back(m, column.get());
    faces += summary.faces.back().second;
  }
  if (column.overrun() || faces > most) return std::nullopt;
  return summary;
}

}  // namespace lodestone::model_file

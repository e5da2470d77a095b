// SPDX-License-Identifier: MIT
// What a producer (collapse/build, facets) hands over: slot edits in coarsening order, in the numbering of the source
// mesh. The recorder sorts slots by removal time and turns the log into a ProgressiveModel's stack.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/progressive_model.h>

#include "base/edit_run.h"

namespace lodestone::progressive {

// A flat log of slot edits. One record: begin(), then any mix of the four verbs, then end(). Rules, asserted by
// record():
//   - a face or vertex is removed once and not mentioned afterwards;
//   - after end(), no remaining face names a removed vertex;
//   - errors may come in any order: record() makes them monotone by running maximum.
// Cost: 16 bytes a record + 4 per removed face + 8 per removed vertex or re-pointed corner + 4 + 4 * value_words per
// move.
class EditLog {
 public:
  // `value_words` as ModelData::value_words() of the source's arrays.
  explicit EditLog(std::uint32_t value_words) : value_words_(value_words) {}

  void begin(float error_m);
  void remove_face(FaceId face);
  // `merges_into`: the vertex it lies upon when it goes (where a geomorph takes it): one that remains, or one removed
  // by the same record, or itself or `none`: it stays where it is.
  void remove_vertex(VertexId vertex, VertexId merges_into);
  void repoint(CornerId corner, VertexId to);
  // `words`: value_words() 32-bit words of the new value, in the order position, normal, uv, colour.
  void move_vertex(VertexId vertex, std::span<const std::uint32_t> words);
  void end();
  // Makes one record of all from number `first` on, with the largest of their errors.
  void join_from(std::uint32_t first);
  // Takes in the records of another log, which is about other faces and vertices: their numbers begin at `first_face`
  // and `first_vertex` here. By ascending error, its own first, each log in its own order; no more records once
  // `most_faces_gone` are gone.
  void merge(const EditLog& other, FaceId first_face, VertexId first_vertex, std::uint64_t most_faces_gone);

  // Not together with the verbs above, but merge() and join_from() may follow.
  void append(const EditRun& run);
  // Makes room for so many records of ordinary collapses.
  void reserve(std::size_t records, bool moving);

  // Whether all values that vertices move to are.
  [[nodiscard]] bool finite(const VertexArrays& arrays) const;

  [[nodiscard]] std::uint32_t record_count() const noexcept { return static_cast<std::uint32_t>(records_.size()); }

  // Records of one pass and lane (see EditRun).
  struct Stretch {
    Range records;
    std::uint32_t pass = 0;
    std::uint32_t lane = 0;
  };
  // All records in order, not too many in one stretch.
  [[nodiscard]] std::vector<Stretch> stretches() const;

  // What record `i` holds, as ranges of the log's arrays.
  struct Spans {
    std::span<FaceId> faces;
    std::span<RemovedVertex> vertices;
    std::span<RepointedCorner> corners;
    std::uint32_t first_move = 0, moves_end = 0;
  };
  [[nodiscard]] Spans spans(std::uint32_t i) noexcept {
    const RecordEnds from = i == 0 ? RecordEnds{} : records_[i - 1];
    const RecordEnds& to = records_[i];
    return {{faces_.data() + from.faces, faces_.data() + to.faces},
            {vertices_.data() + from.vertices, vertices_.data() + to.vertices},
            {corners_.data() + from.corners, corners_.data() + to.corners},
            from.moves,
            to.moves};
  }

 private:
  friend class Recorder;
  friend class Encoder;
  std::uint32_t value_words_;
  std::vector<Stretch> appended_;  // empty: all of one pass and lane
  std::vector<RecordEnds> records_;
  std::vector<FaceId> faces_;
  std::vector<RemovedVertex> vertices_;
  std::vector<RepointedCorner> corners_;
  std::vector<VertexId> moved_;
  std::vector<std::uint32_t> values_;
};

// Sorts slots, encodes fans and edits, quantises errors to steps (rounded up, at most 0.2 % apart) and returns the
// data of a model whose finest level is `source`, face for face. O(log + mesh).
// Cancelling leaves it undone: ask context.cancelled() afterwards.
[[nodiscard]] ModelData record(const Mesh& source, EditLog&& log, std::string method, const Context& context = {});

// The same as a finished model, without the replay that from_data() owes to data of strangers. Precondition: the source
// is valid. Errors: Cancelled; BadData if a vertex moves to a value that is not finite.
[[nodiscard]] Result<std::shared_ptr<const ProgressiveModel>> record_model(const Mesh& source, EditLog&& log,
                                                                           std::string method, const Context& context);

}  // namespace lodestone::progressive

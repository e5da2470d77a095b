// SPDX-License-Identifier: MIT
#include <sys/mman.h>
#include <unistd.h>

#include <lodestone/cluster_file.h>

#include "cluster_file/page_codec.h"
#include "doors.h"

namespace {

// Checksums keep damaged bytes away from the decoder of pages, so it gets them directly as well.
void decode_as_page(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone::cluster_file;
  ReadColumns columns;
  if (!lodestone::model_file::split_columns({data, size}, columns)) return;
  Codec codec;
  codec.normals = codec.uvs = codec.colors = true;
  Carry carry;
  for (std::uint32_t vertices = 3; vertices < 255; vertices += 50) {
    Piece piece;
    piece.section_ends = {1, vertices / 2};
    if (!decode(codec, vertices, true, carry, columns, piece)) return;
    for (const std::uint8_t index : piece.indices) {
      if (index >= vertices) __builtin_trap();
    }
  }
}

}  // namespace

// A graph that was read must keep its promises.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  decode_as_page(data, size);
  const int file = ::memfd_create("fuzz.lodg", 0);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) return 0;
  const auto graph = lodestone::read_cluster_graph("/proc/self/fd/" + std::to_string(file));
  ::close(file);
  if (graph.ok() && !validate(graph->graph).ok()) __builtin_trap();
  return 0;
}

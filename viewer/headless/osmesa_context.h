// SPDX-License-Identifier: MIT
// A software OpenGL context, current in the thread that made it for as long as it lives.
#pragma once

#include <memory>

#include <lodestone/result.h>

namespace lodestone::render {

class OsmesaContext {
 public:
  /// Unsupported if OSMesa cannot make a 3.3 core context.
  [[nodiscard]] static Result<std::unique_ptr<OsmesaContext>> create();
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;
  ~OsmesaContext();

  [[nodiscard]] static void* address(const char* name);
  /// Lets go of what the shader compiler keeps, 6 MB: once those programs are made that every picture needs. It comes
  /// back with the next one.
  static void release_compiler();

 private:
  OsmesaContext() = default;
  void* context_ = nullptr;
  unsigned char pixel_[4 * 16 * 16] = {};  ///< OSMesa wants a buffer; everything is drawn into framebuffer objects
};

}  // namespace lodestone::render

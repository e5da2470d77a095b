// SPDX-License-Identifier: MIT
// A linked shader program with its uniform locations.
#pragma once

#include <string>

#include <lodestone/result.h>

#include "gl.h"

namespace lodestone::render {

class Program {
 public:
  /// Compiles and links; `geometry` may be null. `defines` is put after each `#version` line. Unsupported with the
  /// driver's log if it refuses.
  [[nodiscard]] static Result<Program> create(const Gl& gl, const char* vertex, const char* geometry,
                                              const char* fragment, const std::string& defines = {});
  Program(Program&& other) noexcept;
  Program& operator=(Program&& other) noexcept;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  void use() const { gl_->use_program(id_); }
  [[nodiscard]] GLint uniform(const char* name) const { return gl_->get_uniform_location(id_, name); }

 private:
  Program(const Gl& gl, GLuint id) noexcept : gl_(&gl), id_(id) {}
  const Gl* gl_;
  GLuint id_ = 0;
};

}  // namespace lodestone::render

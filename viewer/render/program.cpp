// SPDX-License-Identifier: MIT
#include "program.h"

#include <array>
#include <utility>

namespace lodestone::render {
namespace {

Error refused(const std::string& stage, const std::string& log) {
  return Error{ErrorCode::Unsupported, "the graphics driver refused the " + stage + ": " + log, ""};
}

// 0 and the log on failure.
GLuint compile(const Gl& gl, GLenum stage, const char* source, const std::string& defines, std::string& log) {
  const std::string head = "#version 330 core\n" + defines;
  const std::array<const char*, 2> parts{head.c_str(), source};
  const GLuint shader = gl.create_shader(stage);
  gl.shader_source(shader, static_cast<GLsizei>(parts.size()), parts.data(), nullptr);
  gl.compile_shader(shader);
  GLint ok = 0;
  gl.get_shader_iv(shader, GL_COMPILE_STATUS, &ok);
  if (ok != 0) return shader;
  std::array<char, 1024> text{};
  gl.get_shader_info_log(shader, static_cast<GLsizei>(text.size()), nullptr, text.data());
  log = text.data();
  gl.delete_shader(shader);
  return 0;
}

}  // namespace

Result<Program> Program::create(const Gl& gl, const char* vertex, const char* geometry, const char* fragment,
                                const std::string& defines) {
  struct Stage {
    GLenum kind;
    const char* source;
    const char* name;
  };
  const std::array<Stage, 3> stages{{{GL_VERTEX_SHADER, vertex, "vertex shader"},
                                     {GL_GEOMETRY_SHADER, geometry, "geometry shader"},
                                     {GL_FRAGMENT_SHADER, fragment, "fragment shader"}}};
  Program program{gl, gl.create_program()};
  for (const Stage& stage : stages) {
    if (stage.source == nullptr) continue;
    std::string log;
    const GLuint shader = compile(gl, stage.kind, stage.source, defines, log);
    if (shader == 0) return refused(stage.name, log);
    gl.attach_shader(program.id_, shader);
    gl.delete_shader(shader);  // freed with the program
  }
  gl.link_program(program.id_);
  GLint ok = 0;
  gl.get_program_iv(program.id_, GL_LINK_STATUS, &ok);
  if (ok == 0) {
    std::array<char, 1024> text{};
    gl.get_program_info_log(program.id_, static_cast<GLsizei>(text.size()), nullptr, text.data());
    return refused("shader program", text.data());
  }
  return program;
}

Program::Program(Program&& other) noexcept : gl_(other.gl_), id_(std::exchange(other.id_, 0)) {}

Program& Program::operator=(Program&& other) noexcept {
  std::swap(gl_, other.gl_);
  std::swap(id_, other.id_);
  return *this;
}

Program::~Program() {
  if (id_ != 0) gl_->delete_program(id_);
}

}  // namespace lodestone::render

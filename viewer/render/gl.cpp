// SPDX-License-Identifier: MIT
#include "gl.h"

#include <string>

namespace lodestone::render {

Result<Gl> load_gl(const GlAddress& address) {
  Gl gl;
  std::string missing;
#define LODESTONE_GL_LOAD(type, name, member)              \
  gl.member = reinterpret_cast<type>(address("gl" #name)); \
  if (gl.member == nullptr && missing.empty()) missing = "gl" #name;
  LODESTONE_GL_FUNCTIONS(LODESTONE_GL_LOAD)
#undef LODESTONE_GL_LOAD
  if (!missing.empty()) {
    return Error{ErrorCode::Unsupported, "the graphics driver lacks " + missing + " (OpenGL 3.3 core is needed)", ""};
  }
  GLint major = 0;
  GLint minor = 0;
  gl.get_integer_v(GL_MAJOR_VERSION, &major);
  gl.get_integer_v(GL_MINOR_VERSION, &minor);
  if (major < 3 || (major == 3 && minor < 3)) {
    return Error{ErrorCode::Unsupported,
                 "the graphics driver offers OpenGL " + std::to_string(major) + "." + std::to_string(minor) +
                     " and 3.3 core is needed",
                 ""};
  }
  return gl;
}

}  // namespace lodestone::render

// SPDX-License-Identifier: MIT
// The OpenGL 3.3 core functions this project calls, as a table filled through the window system's "get address"
// function. Nothing links libGL: OSMesa exports gl* symbols of its own, and one process must not see two of them.
#pragma once

#include <GL/glcorearb.h>

#include <functional>

#include <lodestone/result.h>

namespace lodestone::render {

// type, GL name without the prefix, member
#define LODESTONE_GL_FUNCTIONS(X)                                                                              \
  X(PFNGLACTIVETEXTUREPROC, ActiveTexture, active_texture)                                                     \
  X(PFNGLATTACHSHADERPROC, AttachShader, attach_shader)                                                        \
  X(PFNGLBINDBUFFERPROC, BindBuffer, bind_buffer)                                                              \
  X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer, bind_framebuffer)                                               \
  X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer, bind_renderbuffer)                                            \
  X(PFNGLBINDTEXTUREPROC, BindTexture, bind_texture)                                                           \
  X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray, bind_vertex_array)                                              \
  X(PFNGLBLENDFUNCSEPARATEPROC, BlendFuncSeparate, blend_func_separate)                                        \
  X(PFNGLBLITFRAMEBUFFERPROC, BlitFramebuffer, blit_framebuffer)                                               \
  X(PFNGLBUFFERDATAPROC, BufferData, buffer_data)                                                              \
  X(PFNGLBUFFERSUBDATAPROC, BufferSubData, buffer_sub_data)                                                    \
  X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus, check_framebuffer_status)                         \
  X(PFNGLCLEARPROC, Clear, clear)                                                                              \
  X(PFNGLCLEARCOLORPROC, ClearColor, clear_color)                                                              \
  X(PFNGLCOMPILESHADERPROC, CompileShader, compile_shader)                                                     \
  X(PFNGLCREATEPROGRAMPROC, CreateProgram, create_program)                                                     \
  X(PFNGLCREATESHADERPROC, CreateShader, create_shader)                                                        \
  X(PFNGLDELETEBUFFERSPROC, DeleteBuffers, delete_buffers)                                                     \
  X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers, delete_framebuffers)                                      \
  X(PFNGLDELETEPROGRAMPROC, DeleteProgram, delete_program)                                                     \
  X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers, delete_renderbuffers)                                   \
  X(PFNGLDELETESHADERPROC, DeleteShader, delete_shader)                                                        \
  X(PFNGLDELETETEXTURESPROC, DeleteTextures, delete_textures)                                                  \
  X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays, delete_vertex_arrays)                                     \
  X(PFNGLDEPTHFUNCPROC, DepthFunc, depth_func)                                                                 \
  X(PFNGLDEPTHMASKPROC, DepthMask, depth_mask)                                                                 \
  X(PFNGLDISABLEPROC, Disable, disable)                                                                        \
  X(PFNGLDISABLEVERTEXATTRIBARRAYPROC, DisableVertexAttribArray, disable_vertex_attrib_array)                  \
  X(PFNGLDRAWARRAYSPROC, DrawArrays, draw_arrays)                                                              \
  X(PFNGLDRAWELEMENTSPROC, DrawElements, draw_elements)                                                        \
  X(PFNGLENABLEPROC, Enable, enable)                                                                           \
  X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray, enable_vertex_attrib_array)                     \
  X(PFNGLFINISHPROC, Finish, finish)                                                                           \
  X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer, framebuffer_renderbuffer)                       \
  X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D, framebuffer_texture_2d)                               \
  X(PFNGLGENBUFFERSPROC, GenBuffers, gen_buffers)                                                              \
  X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers, gen_framebuffers)                                               \
  X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers, gen_renderbuffers)                                            \
  X(PFNGLGENTEXTURESPROC, GenTextures, gen_textures)                                                           \
  X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays, gen_vertex_arrays)                                              \
  X(PFNGLGENERATEMIPMAPPROC, GenerateMipmap, generate_mipmap)                                                  \
  X(PFNGLGETERRORPROC, GetError, get_error)                                                                    \
  X(PFNGLGETINTEGERVPROC, GetIntegerv, get_integer_v)                                                          \
  X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog, get_program_info_log)                                       \
  X(PFNGLGETPROGRAMIVPROC, GetProgramiv, get_program_iv)                                                       \
  X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog, get_shader_info_log)                                          \
  X(PFNGLGETSHADERIVPROC, GetShaderiv, get_shader_iv)                                                          \
  X(PFNGLGETSTRINGPROC, GetString, get_string)                                                                 \
  X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation, get_uniform_location)                                     \
  X(PFNGLLINKPROGRAMPROC, LinkProgram, link_program)                                                           \
  X(PFNGLPIXELSTOREIPROC, PixelStorei, pixel_store_i)                                                          \
  X(PFNGLREADPIXELSPROC, ReadPixels, read_pixels)                                                              \
  X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage, renderbuffer_storage)                                   \
  X(PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC, RenderbufferStorageMultisample, renderbuffer_storage_multisample) \
  X(PFNGLSHADERSOURCEPROC, ShaderSource, shader_source)                                                        \
  X(PFNGLTEXIMAGE2DPROC, TexImage2D, tex_image_2d)                                                             \
  X(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D, tex_sub_image_2d)                                                   \
  X(PFNGLTEXPARAMETERIPROC, TexParameteri, tex_parameter_i)                                                    \
  X(PFNGLUNIFORM1FPROC, Uniform1f, uniform_1f)                                                                 \
  X(PFNGLUNIFORM1IPROC, Uniform1i, uniform_1i)                                                                 \
  X(PFNGLUNIFORM3FPROC, Uniform3f, uniform_3f)                                                                 \
  X(PFNGLUNIFORM4FPROC, Uniform4f, uniform_4f)                                                                 \
  X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv, uniform_matrix_4fv)                                           \
  X(PFNGLUSEPROGRAMPROC, UseProgram, use_program)                                                              \
  X(PFNGLVERTEXATTRIB3FPROC, VertexAttrib3f, vertex_attrib_3f)                                                 \
  X(PFNGLVERTEXATTRIB4FPROC, VertexAttrib4f, vertex_attrib_4f)                                                 \
  X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer, vertex_attrib_pointer)                                  \
  X(PFNGLVIEWPORTPROC, Viewport, viewport)

struct Gl {
#define LODESTONE_GL_MEMBER(type, name, member) type member = nullptr;
  LODESTONE_GL_FUNCTIONS(LODESTONE_GL_MEMBER)
#undef LODESTONE_GL_MEMBER
};

/// Address of a GL function of the current context, or null.
using GlAddress = std::function<void*(const char*)>;

/// Fills the table. Unsupported if a function is missing or the context is older than 3.3 (named in the message).
[[nodiscard]] Result<Gl> load_gl(const GlAddress& address);

}  // namespace lodestone::render

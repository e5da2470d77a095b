// SPDX-License-Identifier: MIT
// The only file that names OSMesa: its header declares the gl* functions that the function table replaces.
#include "osmesa_context.h"

#include <GL/osmesa.h>

#include <array>

namespace lodestone::render {

Result<std::unique_ptr<OsmesaContext>> OsmesaContext::create() {
  constexpr std::array<int, 13> wanted{OSMESA_FORMAT,
                                       OSMESA_RGBA,
                                       OSMESA_DEPTH_BITS,
                                       0,
                                       OSMESA_STENCIL_BITS,
                                       0,
                                       OSMESA_PROFILE,
                                       OSMESA_CORE_PROFILE,
                                       OSMESA_CONTEXT_MAJOR_VERSION,
                                       3,
                                       OSMESA_CONTEXT_MINOR_VERSION,
                                       3,
                                       0};
  std::unique_ptr<OsmesaContext> made{new OsmesaContext};
  made->context_ = OSMesaCreateContextAttribs(wanted.data(), nullptr);
  if (made->context_ == nullptr ||
      OSMesaMakeCurrent(static_cast<OSMesaContext>(made->context_), made->pixel_, GL_UNSIGNED_BYTE, 16, 16) == 0) {
    return Error{ErrorCode::Unsupported, "OSMesa cannot make an OpenGL 3.3 core context, install a newer Mesa", ""};
  }
  return made;
}

OsmesaContext::~OsmesaContext() {
  if (context_ != nullptr) OSMesaDestroyContext(static_cast<OSMesaContext>(context_));
}

void* OsmesaContext::address(const char* name) { return reinterpret_cast<void*>(OSMesaGetProcAddress(name)); }

}  // namespace lodestone::render

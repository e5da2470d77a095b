// SPDX-License-Identifier: MIT
// The only file that names OSMesa: its header declares the gl* functions that the function table replaces. The library
// is loaded when a picture is first asked for: it brings LLVM along, 50 MB and a tenth of a second that reading or
// building a model should not pay.
#include "osmesa_context.h"

#include <GL/osmesa.h>
#include <dlfcn.h>
#include <malloc.h>

#include <array>

namespace lodestone::render {
namespace {

struct Osmesa {
  decltype(&OSMesaCreateContextAttribs) create_context = nullptr;
  decltype(&OSMesaMakeCurrent) make_current = nullptr;
  decltype(&OSMesaDestroyContext) destroy_context = nullptr;
  decltype(&OSMesaGetProcAddress) address = nullptr;
};

template <class Function>
void load(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
}

// Null functions where it is not installed. Never unloaded: its threads outlive a context.
const Osmesa& osmesa() {
  static const Osmesa loaded = [] {
    Osmesa found;
    if (void* library = ::dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL)) {
      load(library, "OSMesaCreateContextAttribs", found.create_context);
      load(library, "OSMesaMakeCurrent", found.make_current);
      load(library, "OSMesaDestroyContext", found.destroy_context);
      load(library, "OSMesaGetProcAddress", found.address);
    }
    return found;
  }();
  return loaded;
}

}  // namespace

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
  const Osmesa& library = osmesa();
  if (library.create_context == nullptr || library.make_current == nullptr || library.destroy_context == nullptr ||
      library.address == nullptr) {
    return Error{ErrorCode::Unsupported, "OSMesa (libOSMesa.so.8) is not there, install libosmesa6", ""};
  }
  std::unique_ptr<OsmesaContext> made{new OsmesaContext};
  made->context_ = library.create_context(wanted.data(), nullptr);
  if (made->context_ == nullptr ||
      library.make_current(static_cast<OSMesaContext>(made->context_), made->pixel_, GL_UNSIGNED_BYTE, 16, 16) == 0) {
    return Error{ErrorCode::Unsupported, "OSMesa cannot make an OpenGL 3.3 core context, install a newer Mesa", ""};
  }
  return made;
}

OsmesaContext::~OsmesaContext() {
  const auto destroy = osmesa().destroy_context;
  if (context_ != nullptr && destroy != nullptr) destroy(static_cast<OSMesaContext>(context_));
}

void* OsmesaContext::address(const char* name) {
  const auto find = osmesa().address;
  return find == nullptr ? nullptr : reinterpret_cast<void*>(find(name));
}

// Of OpenGL 4.1, or ARB_ES2_compatibility; OSMesa has no address for what it lacks.
void OsmesaContext::release_compiler() {
  const auto release = reinterpret_cast<PFNGLRELEASESHADERCOMPILERPROC>(address("glReleaseShaderCompiler"));
  if (release == nullptr) return;
  release();
#ifdef __GLIBC__
  ::malloc_trim(0);  // to the system: what comes next may not fit into the gaps
#endif
}

}  // namespace lodestone::render

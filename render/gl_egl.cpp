// EGL without a surface: the same drivers where OSMesa is gone, and a graphics card where there is
// one.
#include "render/gl_context.h"

#include "engine/core/error.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

namespace rend {

namespace {

class SurfacelessContext final : public GlContext {
 public:
  SurfacelessContext() {
    void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library)
      throw Error("EGL", "library libEGL.so.1 not found (packages libegl1, libgl1-mesa-dri)");
    load(library, "eglGetProcAddress", find_);
    load(library, "eglInitialize", initialize_);
    load(library, "eglBindAPI", bind_api_);
    load(library, "eglCreateContext", create_);
    load(library, "eglDestroyContext", destroy_);
    load(library, "eglMakeCurrent", bind_);
    const auto platform =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(find_("eglGetPlatformDisplayEXT"));
    if (!platform) throw Error("EGL", "eglGetPlatformDisplayEXT is missing");
    display_ = platform(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    EGLint major = 0, minor = 0;
    if (display_ == EGL_NO_DISPLAY || !initialize_(display_, &major, &minor))
      throw Error("EGL", "the surfaceless platform does not start");
    bind_api_(EGL_OPENGL_API);
    for (const auto& [want_major, want_minor] : {std::pair{4, 5}, {4, 1}, {3, 3}}) {
      const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                   want_major,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   want_minor,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_NONE};
      context_ = create_(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
      if (context_ != EGL_NO_CONTEXT) return;
    }
    throw Error("EGL", "no core context of OpenGL 3.3 or later");
  }

  ~SurfacelessContext() override {
    bind_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    destroy_(display_, context_);
  }

  const char* name() const override { return "egl"; }

  void make_current() override {
    if (!bind_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw Error("EGL", "the context cannot be made current");
  }

  void* address(const char* function) const override {
    return reinterpret_cast<void*>(find_(function));
  }

 private:
  template <class Function>
  static void load(void* library, const char* symbol, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library, symbol));
    if (!function) throw Error("EGL", std::string("the library lacks ") + symbol);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  decltype(&::eglGetProcAddress) find_ = nullptr;
  decltype(&::eglInitialize) initialize_ = nullptr;
  decltype(&::eglBindAPI) bind_api_ = nullptr;
  decltype(&::eglCreateContext) create_ = nullptr;
  decltype(&::eglDestroyContext) destroy_ = nullptr;
  decltype(&::eglMakeCurrent) bind_ = nullptr;
};

}  // namespace

std::unique_ptr<GlContext> make_egl_context() { return std::make_unique<SurfacelessContext>(); }

}  // namespace rend

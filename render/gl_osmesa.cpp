// OSMesa: Mesa's software rasteriser drawing into memory.
#include "render/gl_context.h"

#include "engine/core/error.h"

#include <dlfcn.h>

namespace rend {

namespace {

constexpr int kFormat = 0x22, kDepthBits = 0x30, kStencilBits = 0x31, kAccumBits = 0x32;
constexpr int kProfile = 0x33, kCoreProfile = 0x34, kMajor = 0x36, kMinor = 0x37;
constexpr int kRgba = 0x1908, kUnsignedByte = 0x1401;
constexpr int kSide =
    16;  // the window buffer is never drawn to: all drawing goes to framebuffer objects

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext() {
    void* library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    if (!library) library = dlopen("libOSMesa.so", RTLD_NOW | RTLD_LOCAL);
    if (!library) throw Error("OSMesa", "library libOSMesa.so.8 not found (package libosmesa6)");
    const auto create = reinterpret_cast<void* (*)(const int*, void*)>(
        dlsym(library, "OSMesaCreateContextAttribs"));
    destroy_ = reinterpret_cast<void (*)(void*)>(dlsym(library, "OSMesaDestroyContext"));
    bind_ = reinterpret_cast<unsigned char (*)(void*, void*, unsigned, int, int)>(
        dlsym(library, "OSMesaMakeCurrent"));
    find_ = reinterpret_cast<void* (*)(const char*)>(dlsym(library, "OSMesaGetProcAddress"));
    if (!create || !destroy_ || !bind_ || !find_)
      throw Error("OSMesa", "the library is too old: core contexts are missing");
    for (const auto& [major, minor] : {std::pair{4, 5}, {4, 1}, {3, 3}}) {
      const int attributes[] = {kFormat, kRgba,      kDepthBits, 0,        kStencilBits,
                                0,       kAccumBits, 0,          kProfile, kCoreProfile,
                                kMajor,  major,      kMinor,     minor,    0};
      context_ = create(attributes, nullptr);
      if (context_) return;
    }
    throw Error("OSMesa", "no core context of OpenGL 3.3 or later");
  }

  ~OsMesaContext() override { destroy_(context_); }

  const char* name() const override { return "osmesa"; }

  void make_current() override {
    if (!bind_(context_, window_, kUnsignedByte, kSide, kSide))
      throw Error("OSMesa", "the context cannot be made current");
  }

  void* address(const char* function) const override { return find_(function); }

 private:
  void* context_ = nullptr;
  void (*destroy_)(void*) = nullptr;
  unsigned char (*bind_)(void*, void*, unsigned, int, int) = nullptr;
  void* (*find_)(const char*) = nullptr;
  unsigned char window_[4 * kSide * kSide] = {};
};

}  // namespace

std::unique_ptr<GlContext> make_osmesa_context() { return std::make_unique<OsMesaContext>(); }

}  // namespace rend

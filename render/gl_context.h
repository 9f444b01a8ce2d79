// A current OpenGL context without a window; two libraries can provide one, chosen at run time.
#pragma once

#include "render/renderer.h"

#include <memory>
#include <string>

namespace rend {

/// An OpenGL core context of version 3.3 or later.
class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual const char* name() const = 0;
  /// Makes the context current on the calling thread. @throws Error when the driver refuses.
  virtual void make_current() = 0;
  /// Address of an OpenGL entry point, nullptr when the driver lacks it.
  virtual void* address(const char* function) const = 0;
};

/// @throws Error with the reason when the library or a context is missing.
std::unique_ptr<GlContext> make_osmesa_context();
std::unique_ptr<GlContext> make_egl_context();

}  // namespace rend

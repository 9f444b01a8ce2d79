// The OpenGL entry points in use, as a table filled from a context; included by raster*.cpp only.
#pragma once

#include "render/gl_context.h"

#include <GL/glcorearb.h>

#define REND_GL_FUNCTIONS(X)                                                                       \
  X(ActiveTexture, ACTIVETEXTURE)                                                                  \
  X(AttachShader, ATTACHSHADER)                                                                    \
  X(BindBuffer, BINDBUFFER)                                                                        \
  X(BindFramebuffer, BINDFRAMEBUFFER)                                                              \
  X(BindRenderbuffer, BINDRENDERBUFFER)                                                            \
  X(BindVertexArray, BINDVERTEXARRAY) X(BufferData, BUFFERDATA)                                    \
      X(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS) X(Clear, CLEAR) X(                         \
          ClearBufferfv, CLEARBUFFERFV) X(ClearBufferuiv, CLEARBUFFERUIV)                          \
          X(CompileShader, COMPILESHADER) X(CreateProgram, CREATEPROGRAM) X(                       \
              CreateShader, CREATESHADER) X(CullFace, CULLFACE) X(DeleteShader, DELETESHADER)      \
              X(DepthFunc, DEPTHFUNC) X(Disable, DISABLE) X(DrawArrays, DRAWARRAYS) X(             \
                  DrawBuffer, DRAWBUFFER) X(DrawElements, DRAWELEMENTS) X(Enable, ENABLE)          \
                  X(EnableVertexAttribArray, ENABLEVERTEXATTRIBARRAY) X(                           \
                      FramebufferRenderbuffer, FRAMEBUFFERRENDERBUFFER) X(FrontFace, FRONTFACE)    \
                      X(GenBuffers, GENBUFFERS) X(GenFramebuffers, GENFRAMEBUFFERS) X(             \
                          GenRenderbuffers, GENRENDERBUFFERS) X(GenVertexArrays, GENVERTEXARRAYS)  \
                          X(GetError, GETERROR) X(GetIntegerv, GETINTEGERV) X(                     \
                              GetProgramInfoLog, GETPROGRAMINFOLOG) X(GetProgramiv, GETPROGRAMIV)  \
                              X(GetShaderInfoLog, GETSHADERINFOLOG) X(GetShaderiv, GETSHADERIV) X( \
                                  GetString, GETSTRING) X(GetUniformLocation, GETUNIFORMLOCATION)  \
                                  X(LinkProgram, LINKPROGRAM) X(PixelStorei, PIXELSTOREI)          \
                                      X(ReadBuffer, READBUFFER) X(ReadPixels, READPIXELS)          \
                                          X(RenderbufferStorage, RENDERBUFFERSTORAGE)              \
                                              X(ShaderSource, SHADERSOURCE)                        \
                                                  X(Uniform1f, UNIFORM1F) X(Uniform3f, UNIFORM3F)  \
                                                      X(UniformMatrix4fv, UNIFORMMATRIX4FV)        \
                                                          X(UseProgram, USEPROGRAM)                \
                                                              X(VertexAttribPointer,               \
                                                                VERTEXATTRIBPOINTER)               \
                                                                  X(Viewport, VIEWPORT)

namespace rend {

struct GlFunctions {
#define REND_GL_MEMBER(name, NAME) PFNGL##NAME##PROC name = nullptr;
  REND_GL_FUNCTIONS(REND_GL_MEMBER)
#undef REND_GL_MEMBER
};

/// @throws Error naming the first entry point the driver lacks.
GlFunctions load_gl_functions(const GlContext& context);

}  // namespace rend

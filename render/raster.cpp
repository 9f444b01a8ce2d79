// OpenGL passes: G-buffer and depth maps, into framebuffer objects that are read back.
#include "render/raster.h"

#include "engine/core/error.h"
#include "render/gl_functions.h"
#include "render/raster_shaders.h"

#include <fmt/format.h>

#include <algorithm>

namespace rend {

GlFunctions load_gl_functions(const GlContext& context) {
  GlFunctions gl;
#define REND_GL_LOAD(entry, NAME)                                               \
  gl.entry = reinterpret_cast<PFNGL##NAME##PROC>(context.address("gl" #entry)); \
  if (!gl.entry) throw Error(context.name(), "the driver lacks gl" #entry);
  REND_GL_FUNCTIONS(REND_GL_LOAD)
#undef REND_GL_LOAD
  return gl;
}

namespace {

struct Target {
  GLuint frame = 0, color = 0, depth = 0;
  int width = 0, height = 0;
};

struct Shapes {
  GLuint array = 0, vertices = 0, indices = 0;
  GLsizei count = 0;
};

class Device {
 public:
  explicit Device(std::unique_ptr<GlContext> context)
      : context_(std::move(context)),
        gl((context_->make_current(), load_gl_functions(*context_))) {}

  void make_current() { context_->make_current(); }

  std::string describe() const {
    const auto text = [&](GLenum name) {
      const auto* s = reinterpret_cast<const char*>(gl.GetString(name));
      return std::string(s ? s : "unknown");
    };
    return fmt::format("{}, OpenGL {}, {}", context_->name(), text(GL_VERSION), text(GL_RENDERER));
  }

  GLuint program(const std::string& vertex, const std::string& fragment) const {
    const GLuint program = gl.CreateProgram();
    for (const auto& [type, source] :
         {std::pair<GLenum, const std::string&>{GL_VERTEX_SHADER, vertex},
          {GL_FRAGMENT_SHADER, fragment}}) {
      const GLuint shader = gl.CreateShader(type);
      const char* text = source.c_str();
      gl.ShaderSource(shader, 1, &text, nullptr);
      gl.CompileShader(shader);
      GLint good = 0;
      gl.GetShaderiv(shader, GL_COMPILE_STATUS, &good);
      if (!good) {
        char log[1000] = "";
        gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
        throw Error(context_->name(), std::string("a shader does not compile: ") + log);
      }
      gl.AttachShader(program, shader);
      gl.DeleteShader(shader);
    }
    gl.LinkProgram(program);
    GLint good = 0;
    gl.GetProgramiv(program, GL_LINK_STATUS, &good);
    if (!good) {
      char log[1000] = "";
      gl.GetProgramInfoLog(program, sizeof log, nullptr, log);
      throw Error(context_->name(), std::string("a shader does not link: ") + log);
    }
    return program;
  }

  /// Binds the target, first (re)making it at this size. `color` false: depth only.
  void bind(Target& target, int width, int height, bool color) const {
    if (!target.frame) {
      gl.GenFramebuffers(1, &target.frame);
      gl.GenRenderbuffers(1, &target.depth);
      if (color) gl.GenRenderbuffers(1, &target.color);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, target.frame);
    if (target.width != width || target.height != height) {
      gl.BindRenderbuffer(GL_RENDERBUFFER, target.depth);
      gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
      gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                 target.depth);
      if (color) {
        gl.BindRenderbuffer(GL_RENDERBUFFER, target.color);
        gl.RenderbufferStorage(GL_RENDERBUFFER, GL_R32UI, width, height);
        gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                   target.color);
      }
      gl.DrawBuffer(color ? GL_COLOR_ATTACHMENT0 : GL_NONE);
      gl.ReadBuffer(color ? GL_COLOR_ATTACHMENT0 : GL_NONE);
      if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error(context_->name(), fmt::format("no framebuffer of {} x {}", width, height));
      target.width = width;
      target.height = height;
    }
    gl.Viewport(0, 0, width, height);
    const GLfloat farthest = 1;
    const GLuint nothing[4] = {0, 0, 0, 0};
    gl.ClearBufferfv(GL_DEPTH, 0, &farthest);
    if (color) gl.ClearBufferuiv(GL_COLOR, 0, nothing);
  }

  void set(GLuint program, const char* name, const Mat4f& m) const {
    gl.UniformMatrix4fv(gl.GetUniformLocation(program, name), 1, GL_FALSE, m.data());
  }
  void set(GLuint program, const char* name, const Vec3f& v) const {
    gl.Uniform3f(gl.GetUniformLocation(program, name), v.x(), v.y(), v.z());
  }
  void set(GLuint program, const char* name, float v) const {
    gl.Uniform1f(gl.GetUniformLocation(program, name), v);
  }

  void check(const char* doing) const {
    const GLenum error = gl.GetError();
    if (error != GL_NO_ERROR)
      throw Error(context_->name(), fmt::format("OpenGL error {:#x} while {}", error, doing));
  }

 private:
  std::unique_ptr<GlContext> context_;

 public:
  const GlFunctions gl;
};

std::unique_ptr<Device> open_device(GlBackend backend) {
  std::string reasons;
  const auto attempt = [&](std::unique_ptr<GlContext> (*make)()) -> std::unique_ptr<Device> {
    try {
      auto device = std::make_unique<Device>(make());
      // A driver that starts but does not draw shows itself here, not in the first frame of a run.
      const GlFunctions& gl = device->gl;
      Target target;
      device->bind(target, 16, 16, true);
      GLuint array = 0;
      gl.GenVertexArrays(1, &array);
      gl.BindVertexArray(array);
      gl.UseProgram(device->program(kTestVertexShader, kTestFragmentShader));
      gl.DrawArrays(GL_TRIANGLES, 0, 3);
      GLuint inside = 0, outside = 1;
      gl.ReadPixels(2, 2, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_INT, &inside);
      gl.ReadPixels(14, 14, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_INT, &outside);
      device->check("drawing a first triangle");
      if (inside != 0xc0ffee11u || outside != 0)
        throw Error("OpenGL", "a test triangle does not come back as drawn");
      return device;
    } catch (const Error& error) {
      reasons += (reasons.empty() ? "" : "; ") + std::string(error.what());
      return nullptr;
    }
  };
  std::unique_ptr<Device> device;
  if (backend != GlBackend::egl) device = attempt(make_osmesa_context);
  if (!device && backend != GlBackend::osmesa) device = attempt(make_egl_context);
  if (!device) throw Error("renderer", "no OpenGL without a window: " + reasons);
  return device;
}

/// World to clip space of a light, map rows running along -v.
Mat4f clip_from_world(const LightBox& box) {
  Mat4f m = Mat4f::Identity();
  const auto row = [&](int i, const Vec3f& axis) {
    m.block<1, 3>(i, 0) = axis.transpose();
    m(i, 3) = -axis.dot(box.center);
  };
  row(0, box.u / box.half);
  row(1, box.v / box.half);
  row(2, -box.direction / box.depth);
  return m;
}

}  // namespace

struct Raster::State {
  explicit State(GlBackend backend) : device(open_device(backend)), gl(device->gl) {
    mesh_program = device->program(kMeshVertexShader, kMeshFragmentShader);
    mesh_depth_program = device->program(kMeshDepthVertexShader, kDepthFragmentShader);
    point_program = device->program(kPointVertexShader, kPointFragmentShader);
    point_depth_program = device->program(kPointDepthVertexShader, kPointDepthFragmentShader);
    gl.GenVertexArrays(1, &mesh.array);
    gl.GenBuffers(1, &mesh.vertices);
    gl.GenBuffers(1, &mesh.indices);
    gl.BindVertexArray(mesh.array);
    gl.BindBuffer(GL_ARRAY_BUFFER, mesh.vertices);
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices);
    const auto attribute = [&](GLuint index, GLint size, GLenum type, GLsizei stride,
                               std::size_t offset) {
      gl.EnableVertexAttribArray(index);
      gl.VertexAttribPointer(index, size, type, type == GL_FLOAT ? GL_FALSE : GL_TRUE, stride,
                             reinterpret_cast<const void*>(offset));
    };
    attribute(0, 3, GL_FLOAT, sizeof(MeshVertex), offsetof(MeshVertex, x));
    attribute(1, 4, GL_UNSIGNED_INT_2_10_10_10_REV, sizeof(MeshVertex),
              offsetof(MeshVertex, normal_kind));
    attribute(2, 1, GL_FLOAT, sizeof(MeshVertex), offsetof(MeshVertex, value));
    gl.GenVertexArrays(1, &points.array);
    gl.GenBuffers(1, &points.vertices);
    gl.BindVertexArray(points.array);
    gl.BindBuffer(GL_ARRAY_BUFFER, points.vertices);
    attribute(0, 3, GL_FLOAT, sizeof(PointVertex), offsetof(PointVertex, x));
    attribute(2, 1, GL_FLOAT, sizeof(PointVertex), offsetof(PointVertex, value));
    device->check("setting up");
  }

  std::unique_ptr<Device> device;
  const GlFunctions& gl;
  GLuint mesh_program = 0, mesh_depth_program = 0, point_program = 0, point_depth_program = 0;
  Shapes mesh, points;
  float point_radius = 0;
  Target picture, depth_map;
};

Raster::Raster(GlBackend backend) : state_(std::make_unique<State>(backend)) {}
Raster::~Raster() {
  // GL objects die with the context, which frees them all.
}

std::string Raster::describe() const { return state_->device->describe(); }

void Raster::upload(const CornerMesh& mesh, const std::vector<PointVertex>& points,
                    float point_radius) {
  const GlFunctions& gl = state_->gl;
  state_->device->make_current();
  const auto send = [&](GLenum target, GLuint buffer, const auto& data) {
    gl.BindBuffer(target, buffer);
    gl.BufferData(target, static_cast<GLsizeiptr>(data.size() * sizeof(data[0])), data.data(),
                  GL_STREAM_DRAW);
  };
  gl.BindVertexArray(state_->mesh.array);
  send(GL_ARRAY_BUFFER, state_->mesh.vertices, mesh.vertices);
  send(GL_ELEMENT_ARRAY_BUFFER, state_->mesh.indices, mesh.indices);
  state_->mesh.count = static_cast<GLsizei>(mesh.indices.size());
  gl.BindVertexArray(state_->points.array);
  send(GL_ARRAY_BUFFER, state_->points.vertices, points);
  state_->points.count = static_cast<GLsizei>(points.size());
  state_->point_radius = point_radius;
  state_->device->check("sending the shapes");
}

void Raster::draw(const PerspectiveView& view, GBuffer& out) {
  State& s = *state_;
  const GlFunctions& gl = s.gl;
  s.device->make_current();
  s.device->bind(s.picture, view.width, view.height, true);
  gl.Enable(GL_DEPTH_TEST);
  gl.Disable(GL_DEPTH_CLAMP);
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_BACK);
  gl.FrontFace(GL_CW);  // y points down
  const Mat4f clip = clip_from_world(view);
  if (s.mesh.count > 0) {
    gl.UseProgram(s.mesh_program);
    s.device->set(s.mesh_program, "clip_from_world", clip);
    gl.BindVertexArray(s.mesh.array);
    gl.DrawElements(GL_TRIANGLES, s.mesh.count, GL_UNSIGNED_INT, nullptr);
  }
  if (s.points.count > 0) {
    const GLuint p = s.point_program;
    gl.UseProgram(p);
    s.device->set(p, "clip_from_world", clip);
    s.device->set(p, "right", view.right);
    s.device->set(p, "up", view.up);
    s.device->set(p, "forward", view.forward);
    s.device->set(p, "radius", s.point_radius);
    s.device->set(p, "pixels", s.point_radius / view.tan_y * static_cast<float>(view.height));
    s.device->set(p, "near", view.near);
    s.device->set(p, "far", view.far);
    gl.Enable(GL_PROGRAM_POINT_SIZE);
    gl.BindVertexArray(s.points.array);
    gl.DrawArrays(GL_POINTS, 0, s.points.count);
  }
  out.resize(view.width, view.height);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, out.stride);
  gl.ReadPixels(0, 0, view.width, view.height, GL_RED_INTEGER, GL_UNSIGNED_INT, out.surface.data());
  gl.ReadPixels(0, 0, view.width, view.height, GL_DEPTH_COMPONENT, GL_FLOAT, out.depth.data());
  s.device->check("drawing the picture");
}

void Raster::draw_depth(const LightBox& light, DepthMap& out) {
  State& s = *state_;
  const GlFunctions& gl = s.gl;
  s.device->make_current();
  s.device->bind(s.depth_map, out.size, out.size, false);
  gl.Enable(GL_DEPTH_TEST);
  gl.Enable(GL_DEPTH_CLAMP);  // casters in front of the box still cast
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_BACK);
  gl.FrontFace(GL_CCW);
  const Mat4f clip = clip_from_world(light);
  if (s.mesh.count > 0) {
    gl.UseProgram(s.mesh_depth_program);
    s.device->set(s.mesh_depth_program, "clip_from_world", clip);
    gl.BindVertexArray(s.mesh.array);
    gl.DrawElements(GL_TRIANGLES, s.mesh.count, GL_UNSIGNED_INT, nullptr);
  }
  if (s.points.count > 0) {
    gl.UseProgram(s.point_depth_program);
    s.device->set(s.point_depth_program, "clip_from_world", clip);
    s.device->set(s.point_depth_program, "pixels",
                  s.point_radius / light.half * static_cast<float>(out.size));
    s.device->set(s.point_depth_program, "radius", s.point_radius / light.depth * 0.5f);
    gl.Enable(GL_PROGRAM_POINT_SIZE);
    gl.BindVertexArray(s.points.array);
    gl.DrawArrays(GL_POINTS, 0, s.points.count);
  }
  out.box = light;
  out.depth.resize(static_cast<std::size_t>(out.size) * static_cast<std::size_t>(out.size) +
                   kLanePad);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, out.size);
  gl.ReadPixels(0, 0, out.size, out.size, GL_DEPTH_COMPONENT, GL_FLOAT, out.depth.data());
  s.device->check("drawing a depth map");
}

}  // namespace rend

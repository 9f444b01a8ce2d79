// Shader sources (GLSL 3.30) of the raster passes.
#pragma once

#include <string>

namespace rend {

inline const std::string kGlsl = "#version 330 core\n";

/// Packs a surface word as described at GBuffer.
inline const std::string kPackSurface = R"(
uint pack_surface(vec3 n, uint kind, float value) {
  vec3 p = n / (abs(n.x) + abs(n.y) + abs(n.z) + 1e-20);
  vec2 fold = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  vec2 q = (p.z < 0.0 ? fold : p.xy) * 1023.5 + 1024.0;
  return min(uint(q.x), 2047u) | (min(uint(q.y), 2047u) << 11) | (kind << 22) |
         (uint(clamp(value, 0.0, 1.0) * 255.0 + 0.5) << 24);
}
)";

inline const std::string kTestVertexShader = kGlsl + R"(
void main() { gl_Position = vec4(float(gl_VertexID == 1) * 2.0 - 1.0, float(gl_VertexID == 2) * 2.0 - 1.0, 0.0, 1.0); }
)";
inline const std::string kTestFragmentShader = kGlsl + R"(
out uint word;
void main() { word = 0xc0ffee11u; }
)";

inline const std::string kMeshVertexShader = kGlsl + R"(
uniform mat4 clip_from_world;
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal_kind;
layout(location = 2) in float value;
out vec4 normal_value;
flat out uint kind;
void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  normal_value = vec4(normal_kind.xyz * 2.0 - 1.0, value);
  kind = uint(normal_kind.w * 3.0 + 0.5);
}
)";
inline const std::string kMeshFragmentShader = kGlsl + kPackSurface + R"(
in vec4 normal_value;
flat in uint kind;
out uint word;
void main() { word = pack_surface(normal_value.xyz, kind, normal_value.w); }
)";

inline const std::string kMeshDepthVertexShader = kGlsl + R"(
uniform mat4 clip_from_world;
layout(location = 0) in vec3 position;
void main() { gl_Position = clip_from_world * vec4(position, 1.0); }
)";
inline const std::string kDepthFragmentShader = kGlsl + R"(
void main() {}
)";

/// A particle is a square that shows a sphere; `pixels` is its width at view depth 1.
inline const std::string kPointVertexShader = kGlsl + R"(
uniform mat4 clip_from_world;
uniform float pixels;
layout(location = 0) in vec3 position;
layout(location = 2) in float value;
out float point_value;
out float view_depth;
void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  gl_PointSize = max(pixels / gl_Position.w, 1.0);
  point_value = value;
  view_depth = gl_Position.w;
}
)";
inline const std::string kPointFragmentShader = kGlsl + kPackSurface + R"(
uniform vec3 right, up, forward;
uniform float radius, near, far;
in float point_value;
in float view_depth;
out uint word;
void main() {
  vec2 c = gl_PointCoord * 2.0 - 1.0;
  float r2 = dot(c, c);
  if (r2 > 1.0) discard;
  float h = sqrt(1.0 - r2);
  float z = max(view_depth - radius * h, near);
  gl_FragDepth = far / (far - near) - far * near / ((far - near) * z);
  word = pack_surface(right * c.x + up * c.y - forward * h, 3u, point_value);
}
)";

inline const std::string kPointDepthVertexShader = kGlsl + R"(
uniform mat4 clip_from_world;
uniform float pixels;
layout(location = 0) in vec3 position;
void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  gl_PointSize = max(pixels, 1.0);
}
)";
inline const std::string kPointDepthFragmentShader = kGlsl + R"(
uniform float radius;
void main() {
  vec2 c = gl_PointCoord * 2.0 - 1.0;
  float r2 = dot(c, c);
  if (r2 > 1.0) discard;
  gl_FragDepth = gl_FragCoord.z - radius * sqrt(1.0 - r2);
}
)";

}  // namespace rend

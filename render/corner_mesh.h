// Surfaces as the rasteriser wants them: corners with normals of their own along creases and crack
// rims.
#pragma once

#include "engine/fracture/surface_mesh.h"
#include "render/gbuffer.h"
#include "render/renderer.h"
#include "render/view.h"

#include <cstdint>
#include <vector>

namespace rend {

/// 20 bytes: position [m], normal and Kind as unsigned 10-10-10-2, value in [0, 1].
struct MeshVertex {
  float x[3];
  std::uint32_t normal_kind;
  float value;
};

struct PointVertex {
  float x[3];
  float value;
};

struct CornerMesh {
  std::vector<MeshVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< 3 per triangle
};

/// Angle between faces beyond which an edge stays sharp [deg].
constexpr float kCreaseAngle = 35;

std::uint32_t pack_normal(const Vec3f& normal, Kind kind);

/// Appends a surface. `value` (#V, in [0, 1]) colours the skin; crack faces carry the damage.
/// Triangles with a corner that is not finite are left out. @throws Error when array lengths or
/// indices do not fit.
void append_surface(const SurfaceMesh& surface, const std::vector<float>& value, CornerMesh& out);

/// A surface whose vertices are split where corners need normals of their own.
struct SplitSurface {
  std::vector<Index> vertex;          ///< of the surface that each split vertex comes from
  std::vector<Vec3f> normal;          ///< of each split vertex
  std::vector<std::uint32_t> corner;  ///< 3 split vertices per triangle, triangles in their order
};

/// The split that pictures use, for files that carry one normal a vertex. A split vertex never
/// joins skin and crack faces. @throws Error when array lengths or indices do not fit.
SplitSurface split_surface(const SurfaceMesh& surface);

/// Appends a prop with sharp edges at the crease angle.
void append_prop(const Prop& prop, CornerMesh& out);

}  // namespace rend

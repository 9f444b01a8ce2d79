// A frame as named arrays: what every mesh file says about its points and triangles.
#pragma once

#include "engine/fracture/surface_mesh.h"
#include "engine/mpm/snapshot.h"
#include "engine/scene/model.h"

#include <string>
#include <variant>
#include <vector>

namespace rend {

/// One array of a file, `components` numbers a point or triangle.
struct NamedArray {
  std::string name;
  int components = 1;
  std::variant<std::vector<float>, std::vector<Index>, std::vector<std::uint8_t>> values;
};

/// Points with their fields, and triangles with theirs; without triangles it is a cloud of points.
struct FrameArrays {
  std::vector<float> position;  ///< 3 #P [m]
  std::vector<NamedArray> point;
  std::vector<Triangle> triangles;
  std::vector<NamedArray> triangle;  ///< interior (1: crack face), piece

  std::size_t point_count() const { return position.size() / 3; }
};

/// normal, rest [m], damage, stress [Pa], speed [m/s] of vertices; interior and piece of triangles.
FrameArrays surface_arrays(const SurfaceMesh& mesh);

/// id, rest [m], velocity [m/s], damage, stress [Pa], yielded, body of particles.
FrameArrays particle_arrays(const Snapshot& snapshot, const Model& model);

/// The piece of every vertex; each vertex belongs to one piece only.
std::vector<Index> vertex_pieces(const SurfaceMesh& mesh);

}  // namespace rend

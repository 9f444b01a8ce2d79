// Frames to named arrays.
#include "app/frame_arrays.h"

#include <numeric>

namespace rend {

namespace {

template <class V>
std::vector<float> flat(const std::vector<V>& vectors) {
  std::vector<float> out;
  out.reserve(3 * vectors.size());
  for (const V& v : vectors)
    for (int axis = 0; axis < 3; ++axis) out.push_back(static_cast<float>(v[axis]));
  return out;
}

}  // namespace

FrameArrays surface_arrays(const SurfaceMesh& mesh) {
  FrameArrays out;
  out.position = flat(mesh.x);
  out.point = {{"normal", 3, flat(mesh.normal)},
               {"rest", 3, flat(mesh.rest)},
               {"damage", 1, mesh.damage},
               {"stress", 1, mesh.stress},
               {"speed", 1, mesh.speed}};
  out.triangles = mesh.triangles;
  out.triangle = {{"interior", 1, mesh.interior}, {"piece", 1, mesh.piece}};
  return out;
}

FrameArrays particle_arrays(const Snapshot& snapshot, const Model& model) {
  std::vector<Index> id(snapshot.x.size());
  std::iota(id.begin(), id.end(), 0);
  FrameArrays out;
  out.position = flat(snapshot.x);
  out.point = {{"id", 1, std::move(id)},
               {"rest", 3, flat(model.X)},
               {"velocity", 3, flat(snapshot.v)},
               {"damage", 1, snapshot.damage},
               {"stress", 1, snapshot.stress},
               {"yielded", 1, snapshot.yielded},
               {"body", 1, std::vector<Index>(model.body.begin(), model.body.end())}};
  return out;
}

std::vector<Index> vertex_pieces(const SurfaceMesh& mesh) {
  std::vector<Index> piece(mesh.x.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (Index v : mesh.triangles[t]) piece[static_cast<std::size_t>(v)] = mesh.piece[t];
  return piece;
}

}  // namespace rend

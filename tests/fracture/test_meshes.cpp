// Small tet meshes and motions that the fracture tests are run on.
#include "tests/fracture/test_meshes.h"

#include "engine/core/random.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

namespace rend {

namespace {

Real tet_volume(const Model& m, const Tet& t) {
  return (m.X[t[1]] - m.X[t[0]]).cross(m.X[t[2]] - m.X[t[0]]).dot(m.X[t[3]] - m.X[t[0]]) / 6;
}

void add_tet(Model& m, Tet t) {
  if (tet_volume(m, t) < 0) std::swap(t[2], t[3]);
  m.tets.push_back(t);
}

void finish(Model& m, Real spacing) {
  m.skin = boundary_of(m);
  m.volume.assign(m.X.size(), rest_volume(m) / static_cast<Real>(m.X.size()));
  m.velocity.assign(m.X.size(), Vec3::Zero());
  m.body.assign(m.X.size(), 0);
  m.material.assign(m.X.size(), 0);
  m.crease.assign(m.X.size(), 0);
  m.velocity_gradient = {Mat3::Zero()};
  m.spacing = {spacing};
}

}  // namespace

Model kuhn_box(const Vec3i& cells, const Vec3& size, Real jitter, std::uint64_t seed) {
  Model m;
  Random random(seed, 0);
  const Vec3 h = size.cwiseQuotient(cells.cast<Real>());
  const auto id = [&](int i, int j, int k) {
    return (i * (cells.y() + 1) + j) * (cells.z() + 1) + k;
  };
  for (int i = 0; i <= cells.x(); ++i)
    for (int j = 0; j <= cells.y(); ++j)
      for (int k = 0; k <= cells.z(); ++k) {
        const Vec3i at(i, j, k);
        Vec3 x = at.cast<Real>().cwiseProduct(h);
        for (int axis = 0; axis < 3; ++axis)
          if (at[axis] > 0 && at[axis] < cells[axis])
            x[axis] += jitter * random.next(-1, 1) * h[axis];
        m.X.push_back(x);
      }
  constexpr int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int i = 0; i < cells.x(); ++i)
    for (int j = 0; j < cells.y(); ++j)
      for (int k = 0; k < cells.z(); ++k)
        for (const auto& axes : order) {
          Vec3i at(i, j, k);
          Tet t{id(i, j, k), 0, 0, 0};
          for (int step = 0; step < 3; ++step) {
            ++at[axes[step]];
            t[step + 1] = id(at.x(), at.y(), at.z());
          }
          add_tet(m, t);
        }
  finish(m, h.minCoeff());
  return m;
}

Model bcc_cube(int n) {
  Model m;
  const Real s = 1. / n;
  const auto corner = [&](int i, int j, int k) { return (i * (n + 1) + j) * (n + 1) + k; };
  const Index first_centre = (n + 1) * (n + 1) * (n + 1);
  const auto centre = [&](const Vec3i& c) {
    return first_centre + (c.x() * n + c.y()) * n + c.z();
  };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k <= n; ++k) m.X.push_back(s * Vec3(i, j, k));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) m.X.push_back(s * Vec3(i + .5, j + .5, k + .5));
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int layer = 0; layer <= n; ++layer)
      for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
          Vec3i cell;
          cell[axis] = layer, cell[u] = a, cell[v] = b;
          Index square[4];
          constexpr int step[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
          for (int c = 0; c < 4; ++c) {
            Vec3i at = cell;
            at[u] += step[c][0], at[v] += step[c][1];
            square[c] = corner(at.x(), at.y(), at.z());
          }
          Vec3i below = cell;
          --below[axis];
          if (layer > 0 && layer < n) {
            for (int c = 0; c < 4; ++c)
              add_tet(m, {centre(below), centre(cell), square[c], square[(c + 1) % 4]});
          } else {
            const Index apex = centre(layer == 0 ? cell : below);
            add_tet(m, {apex, square[0], square[1], square[2]});
            add_tet(m, {apex, square[0], square[2], square[3]});
          }
        }
  }
  finish(m, s * std::cbrt(0.5));
  return m;
}

std::vector<Triangle> boundary_of(const Model& model) {
  std::map<Triangle, std::pair<int, Triangle>> faces;
  constexpr int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (const Tet& t : model.tets)
    for (const auto& f : face) {
      const Triangle outward{t[f[0]], t[f[1]], t[f[2]]};
      Triangle key = outward;
      std::sort(key.begin(), key.end());
      auto& entry = faces[key];
      ++entry.first;
      entry.second = outward;
    }
  std::vector<Triangle> skin;
  for (const auto& [key, entry] : faces)
    if (entry.first == 1) skin.push_back(entry.second);
  return skin;
}

Real rest_volume(const Model& model) {
  Real sum = 0;
  for (const Tet& t : model.tets) sum += tet_volume(model, t);
  return sum;
}

SceneDesc plain_scene() {
  SceneDesc scene;
  scene.materials.emplace_back();
  scene.bodies.emplace_back();
  return scene;
}

Snapshot moved(const Model& model, const std::function<Vec3(const Vec3&)>& place, Index frame,
               float damage) {
  Snapshot s;
  s.frame = frame;
  s.time = frame / 24.;
  for (const Vec3& X : model.X) s.x.push_back(place(X));
  s.v.assign(model.X.size(), Vec3f::Zero());
  s.damage.assign(model.X.size(), damage);
  s.stress.assign(model.X.size(), 0);
  s.yielded.assign(model.X.size(), damage > 0);
  return s;
}

BreakTable table_of(const std::vector<Edge>& edges) {
  BreakTable table;
  table.edge = edges;
  table.frame.assign(edges.size(), 0);
  return table;
}

std::vector<Edge> edges_of(const Model& model) {
  std::vector<Edge> edges;
  for (const Tet& t : model.tets)
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) edges.push_back({std::min(t[i], t[j]), std::max(t[i], t[j])});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<Edge> edges_between(const Model& model, const std::function<int(const Vec3&)>& label) {
  std::vector<Edge> cut;
  for (const Edge& e : edges_of(model))
    if (label(model.X[e[0]]) != label(model.X[e[1]])) cut.push_back(e);
  return cut;
}

}  // namespace rend

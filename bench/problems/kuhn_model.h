// A body for mesh forces: a box of cubes cut into six tets each (Kuhn), with vertices as
// particles that own a quarter of the tets around them.
#pragma once

#include "engine/scene/model.h"

#include <utility>

namespace rend {

/// Low corner [m], cubes along each axis, their edge [m].
inline Model kuhn_box(const Vec3& low, const Vec3i& cells, Real spacing) {
  Model model;
  const Vec3i n = cells + Vec3i::Ones();
  const auto at = [&](const Vec3i& c) { return (c[0] * n[1] + c[1]) * n[2] + c[2]; };
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k) model.X.push_back(low + spacing * Vec3(i, j, k));
  const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  model.volume.assign(model.X.size(), 0);
  for (int i = 0; i < cells[0]; ++i)
    for (int j = 0; j < cells[1]; ++j)
      for (int k = 0; k < cells[2]; ++k)
        for (int o = 0; o < 6; ++o) {
          Vec3i c(i, j, k);
          Tet t;
          t[0] = at(c);
          for (int s = 0; s < 3; ++s) {
            c[orders[o][s]] += 1;
            t[static_cast<std::size_t>(s + 1)] = at(c);
          }
          if (o >= 3) std::swap(t[2], t[3]);
          model.tets.push_back(t);
          for (Index v : t)
            model.volume[static_cast<std::size_t>(v)] += spacing * spacing * spacing / 24;
        }
  const std::size_t count = model.X.size();
  model.velocity.assign(count, Vec3::Zero());
  model.velocity_gradient.assign(1, Mat3::Zero());
  model.body.assign(count, 0);
  model.material.assign(count, 0);
  model.crease.assign(count, 0);
  model.spacing.assign(1, spacing);
  return model;
}

}  // namespace rend

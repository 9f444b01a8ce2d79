// Bodies of studies: boxes of particles on a lattice, without tets.
#pragma once

#include "engine/core/random.h"
#include "engine/mpm/reference_solver.h"
#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

#include <Eigen/Geometry>

#include <functional>

namespace rend {

/// An elastic scene in weightlessness with dx = 1, density 1 and E = 100.
inline SceneDesc plain_scene() {
  SceneDesc scene;
  scene.grid.dx = 1;
  scene.gravity.setZero();
  scene.solver.precision = Precision::float64;
  MaterialDesc material;
  material.name = "jelly";
  material.density = 1;
  material.youngs_modulus = 100;
  material.poisson_ratio = 0.3;
  scene.materials.push_back(material);
  return scene;
}

inline MaterialDesc with_surface(MaterialDesc material, const char* name, Real tau_c,
                                 Real softening) {
  material.yield_surface.type = find_yield_surface(name).value();
  material.yield_surface.value[0] = tau_c;
  material.yield_surface.value[1] = softening;
  return material;
}

/// A model that grows body by body; call fill() last.
struct LatticeModel {
  Model model;

  /// Adds a box [low, low + spacing * count] of particles that passes `inside`; jitter is a share
  /// of the spacing.
  LatticeModel& add_box(const Vec3& low, const Vec3i& count, Real spacing,
                        const Vec3& velocity = Vec3::Zero(), Real jitter = 0,
                        std::uint16_t material = 0,
                        const std::function<bool(const Vec3&)>& inside = {}) {
    const auto body = static_cast<std::uint16_t>(model.velocity_gradient.size());
    Random random(5, body);
    for (int i = 0; i < count[0]; ++i)
      for (int j = 0; j < count[1]; ++j)
        for (int k = 0; k < count[2]; ++k) {
          Vec3 x = low + spacing * Vec3(i + 0.5, j + 0.5, k + 0.5);
          if (jitter > 0)
            x +=
                spacing * jitter * Vec3(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
          if (inside && !inside(x)) continue;
          model.X.push_back(x);
          model.volume.push_back(spacing * spacing * spacing);
          model.velocity.push_back(velocity);
          model.body.push_back(body);
          model.material.push_back(material);
          model.crease.push_back(0);
        }
    model.velocity_gradient.push_back(Mat3::Zero());
    model.spacing.push_back(spacing);
    return *this;
  }

  /// Lets body `b` spin about `centre` with angular velocity w.
  LatticeModel& spin(std::size_t b, const Vec3& centre, const Vec3& w) {
    Mat3 W;
    W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
    model.velocity_gradient[b] = W;
    for (std::size_t p = 0; p < model.X.size(); ++p)
      if (model.body[p] == b) model.velocity[p] += W * (model.X[p] - centre);
    return *this;
  }
};

inline Real total_energy(const FrameReport& r) {
  return r.kinetic_energy + r.elastic_energy + r.gravity_energy;
}

}  // namespace rend

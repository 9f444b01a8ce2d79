// The methods under test: transfer, kernel, force form and solver, and particle states read back
// from either solver.
#pragma once

#include "engine/core/small_matrix.h"
#include "engine/mpm/kernel.h"
#include "engine/mpm/reference_solver.h"
#include "engine/mpm/tile_solver.h"
#include "tests/mpm/lattice_model.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>

namespace rend {

inline constexpr Real kPi = 3.14159265358979323846;

/// Whether the long versions of the studies are asked for.
inline bool full_study() { return std::getenv("REND_FULL") != nullptr; }

/// A solver description; FLIP takes no PIC share unless told.
inline SolverDesc method(Transfer transfer, Kernel kernel = Kernel::quadratic,
                         ForceForm form = ForceForm::mls,
                         Precision precision = Precision::float64) {
  SolverDesc solver;
  solver.transfer = transfer;
  solver.kernel = kernel;
  solver.force_form = form;
  solver.precision = precision;
  solver.flip_ratio = 1;
  return solver;
}

inline std::string method_name(const SolverDesc& s) {
  const char* transfers[] = {"PIC", "FLIP", "APIC", "RPIC", "PolyPIC", "XPIC"};
  std::string name = transfers[static_cast<int>(s.transfer)];
  if (s.transfer == Transfer::flip) name += fmt::format(" {:.2f}", s.flip_ratio);
  if (s.transfer == Transfer::polypic) name += fmt::format(" {}", s.polypic_modes);
  if (s.transfer == Transfer::xpic) name += fmt::format("({})", s.xpic_order);
  return fmt::format("{} {} {} {}", name, s.kernel == Kernel::cubic ? "cubic" : "quadratic",
                     s.force_form == ForceForm::mls ? "mls" : "gradient",
                     s.precision == Precision::float32 ? "float" : "double");
}

/// Positions, velocities, Kirchhoff stresses and affine velocities (empty when the scheme has none)
/// by particle id.
struct Matter {
  std::vector<Vec3> x, v;
  std::vector<Mat3> tau, C;
};

/// One run of a scene by the solver of its precision.
class Trial {
 public:
  Trial(const SceneDesc& scene, const Model& model) : scene_(scene) {
    if (scene.solver.precision == Precision::float32)
      solver_ = std::make_unique<TileSolver>(scene, model);
    else
      solver_ = std::make_unique<ReferenceSolver>(scene, model);
  }

  Solver& operator*() { return *solver_; }
  Solver* operator->() { return solver_.get(); }

  Matter matter() const {
    if (const auto* reference = dynamic_cast<const ReferenceSolver*>(solver_.get()))
      return {reference->particles().x, reference->particles().v, reference->particles().tau,
              reference->particles().C};
    Matter out;
    for (const TileSolver::Point& p : static_cast<const TileSolver&>(*solver_).points()) {
      const MaterialDesc& m = scene_.materials[0];
      const Lame lame = lame_parameters(m.youngs_modulus, m.poisson_ratio);
      const SymmetricEigen b = symmetric_eigen(p.strain);
      const Vec3 hencky = 0.5 * b.value.array().log1p();
      const Vec3 tau = 2 * lame.mu * hencky + Vec3::Constant(lame.lambda * hencky.sum());
      out.x.push_back(p.x);
      out.v.push_back(p.v);
      out.C.push_back(p.C);
      out.tau.push_back(b.U * tau.asDiagonal() * b.U.transpose());
    }
    return out;
  }

 private:
  SceneDesc scene_;
  std::unique_ptr<Solver> solver_;
};

/// A rule that keeps matter in the directions of `free`: 1 lets the component be, 0 stops it. A
/// single layer of particles then moves exactly as in one or two dimensions (plane strain), since
/// weights are products.
inline NodeRule only_along(const Vec3& free) {
  return [free](const Vec3&, Real, Real, const Vec3& v) { return Vec3(v.cwiseProduct(free)); };
}

}  // namespace rend

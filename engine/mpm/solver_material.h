// One material as the reference solver uses it.
#pragma once

#include "engine/material/material_desc.h"
#include "engine/material/material_point.h"

namespace rend {

struct SolverMaterial {
  explicit SolverMaterial(const MaterialDesc& material)
      : desc(material),
        lame(lame_parameters(material.youngs_modulus, material.poisson_ratio)),
        constants(law_constants(material)),
        respond(stress_update(material)),
        tau_c0(initial_threshold(material.yield_surface)) {}

  MaterialDesc desc;
  Lame lame;
  LawConstants<Real> constants;
  StressUpdate respond;
  Real tau_c0;  ///< of a particle with strength 1 [Pa]
};

}  // namespace rend

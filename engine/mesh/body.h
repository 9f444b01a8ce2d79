// One body: samples, tets and rest volumes of a solid, in the solid's own frame.
#pragma once

#include "engine/mesh/sampling.h"

namespace rend {

struct Body {
  std::vector<Vec3> X;       ///< [m], sorted along a space-filling curve
  std::vector<Real> volume;  ///< a quarter of the tets around, scaled to the solid's volume [m3]
  std::vector<std::uint8_t> crease;  ///< 1 on sharp edges and corners
  std::vector<Tet> tets;
  std::vector<Triangle> skin;
  std::vector<std::string> notes;
};

/// Samples, triangulates and clips. @throws Error when nothing is left.
Body build_body(const Solid& solid, const SamplingOptions& options);

}  // namespace rend

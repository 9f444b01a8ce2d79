// The crack band: the softening with which a crack takes the fracture energy of its material.
#pragma once

#include "engine/scene/scene_desc.h"

namespace rend {

/// Width of the band of matter that a crack in this body softens [m]: softened rest volume over the
/// area of the crack, measured with bars that were torn (docs/decisions/0004-crack-band.md). The
/// kernel sets it, not the tets or particles. `opening` is that of a crack that carries nothing any
/// more, 2 G_f / tau_c [m]. Particles part numerically before they have opened that far, so their
/// band counts for less the larger it is.
Real crack_band_width(Kernel kernel, ForceKind force, Real dx, Real opening);

/// Most that a crack between particles takes, over tau_c dx: numerical separation ends it [-].
inline constexpr Real kMostCrackEnergy = 0.8;

/// Fills softening, alpha = w tau_c^2 / (2 G_f) (Bazant and Oh 1983), of a material that has a
/// fracture_energy. `where` is its pointer.
/// @throws Error when the stress would snap back, or when bodies with cracks of different width
/// share the material.
void derive_softening(SceneDesc& scene, std::size_t material, const std::string& where);

}  // namespace rend

// Strength that varies from place to place, so that equal bodies do not break in equal planes.
#pragma once

#include "engine/scene/model.h"
#include "engine/scene/scene_desc.h"

namespace rend {

/// Factors on tau_c [-] with mean 1, one a particle; empty when no material asks for them. A
/// Gaussian field with covariance exp(-r^2 / (2 l^2)) of the rest position (sum of random cosines,
/// Shinozuka and Deodatis 1996) is mapped to Weibull's distribution, f = (-ln(1 - Phi(z)))^(1/m) /
/// Gamma(1 + 1/m); length 0 draws each particle on its own.
std::vector<float> strength_factors(const SceneDesc& scene, const Model& model);

}  // namespace rend

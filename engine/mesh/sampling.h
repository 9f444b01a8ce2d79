// Particles of a solid: corners, sharp edges, surface, interior, at a spacing that gives the wanted
// number.
#pragma once

#include "engine/mesh/solid.h"

#include <cstdint>

namespace rend {

/// Where a sample lies; crease samples are also surface samples.
enum class SampleKind : std::uint8_t { interior, surface, crease };

struct Samples {
  void add(const Vec3& x, SampleKind k, const Vec3& n = Vec3::Zero()) {
    X.push_back(x);
    kind.push_back(k);
    normal.push_back(n);
  }

  std::vector<Vec3> X;  ///< [m]
  std::vector<SampleKind> kind;
  std::vector<Vec3> normal;  ///< outward; zero on creases and inside
  Real spacing = 0;          ///< 1 / cube root of the interior number density [m]
};

struct SamplingOptions {
  Sampling pattern = Sampling::poisson;
  Real count = 1000;  ///< wanted number of samples
  std::uint64_t seed = 1;
  std::uint64_t stream = 0;  ///< one per body
};

/// Samples within 5 % of the wanted number (small bodies of few samples may be further off):
/// interior ones at least half a spacing below the surface, all others on it. The same seed gives
/// the same bits.
/// @throws Error when the solid cannot take a single interior or surface sample.
Samples sample_solid(const Solid& solid, const SamplingOptions& options);

/// Samples on corners, along creases and on the surface, no two nearer than `radius` (closer only
/// where two sheets face away from each other).
Samples sample_surface(const Solid& solid, Real radius, std::uint64_t seed, std::uint64_t stream);

/// Adds a maximal set of interior points to `samples`, at least `radius` from all and `depth` below
/// the surface.
void add_poisson_disk(const Solid& solid, Real radius, Real depth, std::uint64_t seed,
                      std::uint64_t stream, Samples& samples);

}  // namespace rend

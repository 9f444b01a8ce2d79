// Chooses the spacing that gives the wanted number of samples, and the pattern inside.
#include "engine/mesh/sampling.h"

#include "engine/core/error.h"
#include "engine/core/random.h"
#include "engine/mesh/solid_cells.h"

#include <fmt/format.h>

#include <cmath>

namespace rend {

namespace {

// Of the lattices that find neighbours; 1 + 4 bytes each.
constexpr Real most_cells = 2e9;
// Random sequential packing in 3D saturates at 0.73 points per cubed radius: radius over spacing.
constexpr Real disk_share = 0.9;
// A little denser on the surface, where the distance of facets to a curved shape grows with its
// square.
constexpr Real surface_share = 0.85;

void add_lattice(const Solid& solid, Real spacing, Real jitter, std::uint64_t seed,
                 std::uint64_t stream, Samples& samples) {
  const SolidCells cells(solid, spacing, 0.5 * spacing);
  const Vec3 extent = solid.bounds().size();
  // Centred, and symmetric in each axis.
  Vec3 first;
  Vec3i count;
  for (int k = 0; k < 3; ++k) {
    count[k] = std::max(1, int(std::floor(extent[k] / spacing)));
    first[k] = -0.5 * spacing * (count[k] - 1);
  }
  Random random(seed, 4 * stream + 3);
  for (int z = 0; z < count.z(); ++z)
    for (int y = 0; y < count.y(); ++y)
      for (int x = 0; x < count.x(); ++x) {
        Vec3 p = first + spacing * Vec3(x, y, z);
        if (jitter > 0)
          for (int k = 0; k < 3; ++k) p[k] += spacing * random.next(-jitter, jitter);
        if (!cells.is_deep(p)) continue;
        samples.add(p, SampleKind::interior);
      }
}

Samples sample_at(const Solid& solid, Real spacing, const SamplingOptions& o) {
  Samples samples = sample_surface(solid, surface_share * spacing, o.seed, o.stream);
  samples.spacing = spacing;
  if (o.pattern == Sampling::poisson)
    add_poisson_disk(solid, disk_share * spacing, 0.5 * spacing, o.seed, o.stream, samples);
  else
    add_lattice(solid, spacing, o.pattern == Sampling::jittered ? 0.3 : 0, o.seed, o.stream,
                samples);
  return samples;
}

// Solves count = V / h^3 + s A / h^2, where s is the measured surplus of samples of the surface
// layer.
Real first_spacing(const Solid& solid, const SamplingOptions& o) {
  const Real surplus = o.pattern == Sampling::poisson ? 0.42 : 0.48;
  const Real area = surface_area(solid.surface());
  Real h = std::cbrt(solid.volume() / o.count);
  for (int i = 0; i < 20; ++i) h = std::cbrt((solid.volume() + surplus * area * h) / o.count);
  return h;
}

}  // namespace

Samples sample_solid(const Solid& solid, const SamplingOptions& o) {
  Real spacing = first_spacing(solid, o);
  Samples best;
  Real best_miss = 1e300, last_spacing = 0, last_count = 0;
  for (int attempt = 0; attempt < 6; ++attempt) {
    const Real cells = (solid.bounds().size() / (0.45 * spacing) + Vec3::Constant(2)).prod();
    if (!(cells < most_cells))
      throw Error("", "fills too little of its bounding box for so many particles");
    Samples s = sample_at(solid, spacing, o);
    const Real count = Real(s.X.size());
    const Real miss = std::abs(count / o.count - 1);
    if (miss < best_miss) {
      best_miss = miss;
      best = std::move(s);
    }
    if (best_miss < 0.03) break;
    // count ~ spacing^-p; p between 2 (all surface) and 3 (all interior), measured once two counts
    // are known.
    Real power = 2.7;
    if (last_count > 0 && count != last_count && spacing != last_spacing)
      power =
          std::clamp(-std::log(count / last_count) / std::log(spacing / last_spacing), 1.5, 4.0);
    last_spacing = spacing;
    last_count = count;
    spacing *= std::pow(std::max(count, 1.0) / o.count, 1 / power);
  }
  if (best.X.size() < 4) throw Error("", "no room for particles");
  return best;
}

}  // namespace rend

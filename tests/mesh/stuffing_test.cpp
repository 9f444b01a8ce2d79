// Lattice tets for mesh forces: closed, on the surface, without flat tets.
#include "engine/mesh/stuffing.h"
#include "engine/mesh/clip.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

using namespace rend;

namespace {

struct Figures {
  Real dihedral = 180, altitude = 10, volume = 0, off_surface = 0;
};

Figures measure(const Body& body, const Solid& solid, Real count) {
  const Real spacing = std::cbrt(solid.volume() / count);
  Figures f;
  for (const Tet& t : body.tets) {
    const TetQuality q = tet_quality(t, body.X);
    f.dihedral = std::min(f.dihedral, q.dihedral * 180 / std::numbers::pi);
    f.altitude = std::min(f.altitude, q.altitude / spacing);
    const Vec3& o = body.X[std::size_t(t[0])];
    f.volume += (body.X[std::size_t(t[1])] - o)
                    .dot((body.X[std::size_t(t[2])] - o).cross(body.X[std::size_t(t[3])] - o)) /
                6;
  }
  for (const Triangle& t : body.skin)
    for (Index v : t)
      f.off_surface =
          std::max(f.off_surface, std::abs(solid.distance(body.X[std::size_t(v)])) / spacing);
  return f;
}

}  // namespace

TEST_CASE("stuffed solids are closed, conform to the surface and have no flat tets") {
  const std::pair<const char*, std::unique_ptr<Solid>> solids[] = {
      {"box", make_box({Vec3(1, 0.6, 0.4)})},
      {"sphere", make_sphere({0.5})},
      {"cylinder", make_cylinder({0.4, 1.2})},
      {"torus", make_torus({0.6, 0.25})},
      {"prism", make_prism({{{0, 0}, {1, 0}, {1, 0.5}, {0.5, 0.5}, {0.5, 1}, {0, 1}}, 0.4})}};
  for (const auto& [name, solid] : solids)
    for (Real count : {400.0, 3000.0}) {
      CAPTURE(std::string(name));
      CAPTURE(count);
      const Body body = stuff_body(*solid, count);
      const Figures f = measure(body, *solid, count);
      MESSAGE(
          fmt::format("{} {}: {} vertices {} tets, least dihedral {:.1f} deg, altitude {:.2f} "
                      "spacings, volume {:.3f}, off surface {:.1e}",
                      name, count, body.X.size(), body.tets.size(), f.dihedral, f.altitude,
                      f.volume / solid->volume(), f.off_surface));
      CHECK(body.notes.empty());
      CHECK(std::abs(Real(body.X.size()) / count - 1) < (count > 1000 ? 0.1 : 0.35));
      CHECK(f.dihedral > 15);
      CHECK(f.altitude > 0.2);
      CHECK(std::abs(f.volume / solid->volume() - 1) < (count > 1000 ? 0.03 : 0.1));
      CHECK(f.off_surface < 1e-6);
    }
}

TEST_CASE("a stuffed box is the box") {
  const auto box = make_box({Vec3(1, 0.6, 0.4)});
  const Body body = stuff_body(*box, 500);
  const Figures f = measure(body, *box, 500);
  CHECK(f.volume == doctest::Approx(0.24).epsilon(1e-8));
  Vec3 low = Vec3::Constant(9);
  for (const Vec3& x : body.X) low = low.cwiseMin(x);
  CHECK((low - Vec3(-0.5, -0.3, -0.2)).norm() < 1e-9);
}

// Torn bodies made by formula.
#include "bench/torn_shapes.h"

#include "engine/core/random.h"

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <numbers>

namespace rend {

namespace {

constexpr Real kPi = std::numbers::pi;

/// Smooth noise of two coordinates in about [-1, 1] (value noise, quintic blend).
Real noise(Real x, Real y, int seed) {
  const Random random(static_cast<std::uint64_t>(seed), 17);
  const Real i = std::floor(x), j = std::floor(y);
  const auto corner = [&](int a, int b) {
    const auto key =
        static_cast<std::int64_t>(i + a) * 73856093 + static_cast<std::int64_t>(j + b) * 19349663;
    return 2 * random.uniform(static_cast<std::uint64_t>(key)) - 1;
  };
  const auto blend = [](Real t) { return t * t * t * (t * (6 * t - 15) + 10); };
  const Real u = blend(x - i), v = blend(y - j);
  const Real low = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * u;
  const Real high = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * u;
  return low + (high - low) * v;
}

/// Ridges of several sizes, as on a torn face.
Real ridges(Real x, Real y, int seed) {
  Real sum = 0, size = 0.5;
  for (int octave = 0; octave < 5; ++octave, size *= 0.5) {
    sum += size * (1 - 2 * std::abs(noise(x, y, seed + octave)));
    const Real turned = 1.6 * x + 1.2 * y;
    y = -1.2 * x + 1.6 * y + 1.7;
    x = turned + 3.1;
  }
  return sum;
}

/// One point of a solid tube: `along` in [0, 1], `angle` around, `reach` in [0, 1] from the axis to
/// the skin.
using TubeMap = std::function<Vec3(Real along, Real angle, Real reach)>;
using TubeField = std::function<float(Real along, Real reach)>;

/// Appends a closed tube: skin of `rings` x `sides` quads, two end faces that share the skin's rim.
/// `torn` marks ends that are crack faces.
void append_tube(int rings, int sides, const TubeMap& map, const TubeField& damage,
                 const std::array<bool, 2>& torn, Index piece, SurfaceMesh& out) {
  const auto add = [&](Real along, Real angle, Real reach) {
    out.x.push_back(map(along, angle, reach));
    out.damage.push_back(damage(along, reach));
    out.crease.push_back(0);
    return static_cast<Index>(out.x.size() - 1);
  };
  const auto triangle = [&](Index a, Index b, Index c, bool crack) {
    out.triangles.push_back({a, b, c});
    out.interior.push_back(crack);
    out.piece.push_back(piece);
  };
  const Index base = static_cast<Index>(out.x.size());
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < sides; ++j) add(Real(i) / rings, 2 * kPi * j / sides, 1);
  const auto skin = [&](int i, int j) { return base + i * sides + (j + sides) % sides; };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sides; ++j) {
      triangle(skin(i, j), skin(i, j + 1), skin(i + 1, j), false);
      triangle(skin(i, j + 1), skin(i + 1, j + 1), skin(i + 1, j), false);
    }
  // A square grid bent to a disc: its border has exactly `sides` vertices, those of the rim.
  const int k = sides / 8, n = 2 * k + 1;
  for (int end = 0; end < 2; ++end) {
    std::vector<Index> grid(static_cast<std::size_t>(n * n));
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) {
        const Real p = Real(a - k) / k, q = Real(b - k) / k;
        const Real reach = std::max(std::abs(p), std::abs(q));
        Real angle = 0;
        if (reach > 0)
          angle = std::abs(p) >= std::abs(q) ? (p > 0 ? 0 : kPi) + kPi / 4 * q / p
                                             : (q > 0 ? kPi / 2 : 3 * kPi / 2) - kPi / 4 * p / q;
        const int side = static_cast<int>(std::lround(angle / (2 * kPi) * sides));
        const bool rim = a == 0 || b == 0 || a == n - 1 || b == n - 1;
        grid[static_cast<std::size_t>(a * n + b)] =
            rim ? skin(end ? rings : 0, side) : add(end, angle, reach);
        if (rim) out.crease[static_cast<std::size_t>(skin(end ? rings : 0, side))] = 1;
      }
    for (int a = 0; a + 1 < n; ++a)
      for (int b = 0; b + 1 < n; ++b) {
        const Index v00 = grid[static_cast<std::size_t>(a * n + b)],
                    v01 = grid[static_cast<std::size_t>(a * n + b + 1)];
        const Index v10 = grid[static_cast<std::size_t>((a + 1) * n + b)];
        const Index v11 = grid[static_cast<std::size_t>((a + 1) * n + b + 1)];
        const bool crack = torn[static_cast<std::size_t>(end)];
        if (!end) {
          triangle(v00, v01, v10, crack);
          triangle(v01, v11, v10, crack);
        } else {
          triangle(v00, v10, v01, crack);
          triangle(v01, v10, v11, crack);
        }
      }
  }
}

/// Turns the triangles so that the surface encloses a positive volume, and fills what follows from
/// the positions.
void finish(SurfaceMesh& mesh) {
  Real volume = 0;
  for (const Triangle& t : mesh.triangles)
    volume += mesh.x[static_cast<std::size_t>(t[0])].dot(
        mesh.x[static_cast<std::size_t>(t[1])].cross(mesh.x[static_cast<std::size_t>(t[2])]));
  if (volume < 0)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  mesh.rest = mesh.x;
  mesh.stress.assign(mesh.x.size(), 0.0f);
  mesh.speed.assign(mesh.x.size(), 0.0f);
  mesh.normal.assign(mesh.x.size(), Vec3f::Zero());
  for (const Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.x[static_cast<std::size_t>(t[0])];
    const Vec3 area = (mesh.x[static_cast<std::size_t>(t[1])] - a)
                          .cross(mesh.x[static_cast<std::size_t>(t[2])] - a);
    for (const Index v : t) mesh.normal[static_cast<std::size_t>(v)] += area.cast<float>();
  }
  for (Vec3f& n : mesh.normal) n.normalize();
}

/// Rings and sides of a tube so that `tubes` of them have about `triangles` triangles; sides is a
/// multiple of 8.
std::array<int, 2> tube_size(int triangles, int tubes, Real shape) {
  const Real each = Real(triangles) / tubes;
  // Skin 2 rings sides, both ends sides^2 / 4.
  const Real sides = std::sqrt(each / (2 * shape + 0.25));
  const int whole = std::max(8, static_cast<int>(sides / 8) * 8);
  return {std::max(4, static_cast<int>((each - 0.25 * whole * whole) / (2 * whole))), whole};
}

}  // namespace

SurfaceMesh torn_torus(int triangles) {
  SurfaceMesh mesh;
  const auto [rings, sides] = tube_size(triangles, 2, 1.4);
  for (int half = 0; half < 2; ++half) {
    const Real start = half * kPi;
    const Real turn = (half == 0 ? 1 : -1) * 0.52, c = std::cos(turn), s = std::sin(turn);
    const TubeMap map = [=](Real along, Real angle, Real reach) {
      // Rings gather where the neck is thin.
      const Real even = along - 0.055 * std::sin(4 * kPi * along) / 2;
      const Real to_start = even * kPi, to_end = kPi - to_start;
      const Real neck =
          1 - 0.26 * (std::exp(-22 * to_start * to_start) + std::exp(-22 * to_end * to_end));
      const Real r = 0.4 * neck * reach, y = std::cos(angle) * reach, z = std::sin(angle) * reach;
      const auto rough = [&](int seam) {
        return 0.22 * ridges(1.6 * y + 5, 1.6 * z + 9, 20 + 11 * seam) +
               (seam ? 0.18 : -0.18) * (0.5 - reach * reach);
      };
      const Real u = start + to_start + 0.5 * std::exp(-9 * to_start) * rough(half) +
                     0.5 * std::exp(-9 * to_end) * rough(1 - half);
      const Real ring = 1 + r * std::cos(angle);
      const Vec3 p(ring * std::cos(u), r * std::sin(angle) + 0.394, ring * std::sin(u));
      return Vec3((p.x() + 1) * c - p.z() * s - 0.92, p.y(),
                  (p.x() + 1) * s + p.z() * c + (half ? -0.1 : 0.1));
    };
    const TubeField damage = [](Real along, Real reach) {
      const Real d = std::min(along, 1 - along) * kPi;
      return static_cast<float>(reach < 1 ? 0.6 + 0.4 * reach : std::exp(-9 * d * d));
    };
    append_tube(rings, sides, map, damage, {true, true}, half, mesh);
  }
  finish(mesh);
  return mesh;
}

SurfaceMesh torn_bar(int triangles) {
  SurfaceMesh mesh;
  const auto [rings, sides] = tube_size(triangles, 2, 1.0);
  for (int half = 0; half < 2; ++half) {
    const Real sign = half ? 1 : -1;
    const TubeMap map = [=](Real along, Real angle, Real reach) {
      const Real from_crack = half ? along : 1 - along;  // 0 at the crack
      const Real c = std::cos(angle), s = std::sin(angle);
      const Real square = reach * std::pow(std::max(std::abs(c), std::abs(s)), -0.86);
      const Real neck = 1 - 0.42 * std::exp(-14 * from_crack * from_crack);
      const Real y = c * square, z = s * square;
      const Real rough =
          0.16 * ridges(1.1 * y + 3, 1.1 * z + 1, 40) + 0.1 * noise(2.1 * y, 2.1 * z, 5);
      const Real fade = std::exp(-7 * from_crack);
      const Real x =
          sign * (0.10 + 0.9 * from_crack) + fade * (rough + sign * 0.06 * (0.5 - reach * reach));
      const Real sag = 0.05 * std::exp(-5 * from_crack);
      return Vec3(x, 0.55 + 0.2 * neck * y - sag, 0.2 * neck * z);
    };
    const TubeField damage = [half](Real along, Real) {
      const Real d = half ? along : 1 - along;
      return static_cast<float>(std::exp(-10 * d * d));
    };
    append_tube(rings, sides, map, damage, {half == 1, half == 0}, half, mesh);
  }
  finish(mesh);
  return mesh;
}

std::vector<Prop> bar_grips() {
  std::vector<Prop> props;
  for (const float sign : {-1.0f, 1.0f}) {
    Prop prop;
    for (int i = 0; i < 8; ++i)
      prop.x.push_back(Vec3f(sign * 1.02f, 0.55f, 0) +
                       Vec3f(i & 1 ? 0.09f : -0.09f, i & 2 ? 0.3f : -0.3f, i & 4 ? 0.3f : -0.3f));
    prop.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    props.push_back(prop);
  }
  return props;
}

SurfaceMesh sphere_surface(const Vec3& center, Real radius, int rings) {
  SurfaceMesh mesh;
  const int sides = 2 * rings;
  const auto add = [&](Real polar, Real angle) {
    mesh.x.push_back(center + radius * Vec3(std::sin(polar) * std::cos(angle), std::cos(polar),
                                            std::sin(polar) * std::sin(angle)));
    mesh.damage.push_back(0);
    mesh.crease.push_back(0);
  };
  add(0, 0);
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < sides; ++j) add(kPi * i / rings, 2 * kPi * j / sides);
  add(kPi, 0);
  const auto at = [&](int i, int j) { return 1 + (i - 1) * sides + j % sides; };
  for (int j = 0; j < sides; ++j) {
    mesh.triangles.push_back({0, at(1, j + 1), at(1, j)});
    for (int i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      mesh.triangles.push_back({at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
    }
    mesh.triangles.push_back(
        {at(rings - 1, j), at(rings - 1, j + 1), static_cast<Index>(mesh.x.size() - 1)});
  }
  mesh.interior.assign(mesh.triangles.size(), 0);
  mesh.piece.assign(mesh.triangles.size(), 0);
  finish(mesh);
  return mesh;
}

}  // namespace rend

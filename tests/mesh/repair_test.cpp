// Surface repair: what it mends, what it refuses, and what it says.
#include "engine/mesh/repair.h"

#include "engine/core/error.h"
#include "engine/mesh/edge_uses.h"
#include "tests/mesh/sample_files.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace rend;

namespace {

struct Repaired {
  TriangleSurface surface;
  std::string notes;
};

Repaired repair(const TriangleSurface& s) {
  std::vector<std::string> notes;
  Repaired r{repair_surface(s, notes), ""};
  for (const std::string& n : notes) r.notes += n + "\n";
  bool closed = true;
  for_each_edge(edge_uses(r.surface.triangles),
                [&](std::span<const EdgeUse> uses) { closed = closed && imbalance(uses) == 0; });
  CHECK(closed);
  return r;
}

std::string refusal(const TriangleSurface& s) {
  std::vector<std::string> notes;
  try {
    repair_surface(s, notes);
  } catch (const Error& e) {
    CHECK(e.where() == "file");
    return e.why();
  }
  return "";
}

bool says(const Repaired& r, const char* words) { return r.notes.find(words) != std::string::npos; }

// Every triangle with corners of its own, moved by less than the welding distance.
TriangleSurface shattered(const TriangleSurface& s) {
  TriangleSurface out;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k)
      out.positions.push_back(s.corner(t, k) + Vec3::Constant(1e-7 * Real(t % 3)));
    const Index i = Index(3 * t);
    out.triangles.push_back({i, i + 1, i + 2});
  }
  return out;
}

void turn_all(TriangleSurface& s) {
  for (Triangle& t : s.triangles) std::swap(t[1], t[2]);
}

// A tube of n sides, open at both ends.
TriangleSurface tube(int n) {
  TriangleSurface s;
  for (int i = 0; i < n; ++i)
    for (int end = 0; end < 2; ++end)
      s.positions.emplace_back(std::cos(2 * M_PI * i / n), end * 2.0, -std::sin(2 * M_PI * i / n));
  for (Index i = 0; i < n; ++i) {
    const Index a = 2 * i, b = 2 * ((i + 1) % n);
    s.triangles.push_back({a, b, b + 1});
    s.triangles.push_back({a, b + 1, a + 1});
  }
  return s;
}

}  // namespace

TEST_CASE("a sound cube stays as it is") {
  const Repaired r = repair(cube_surface());
  CHECK(r.notes.empty());
  CHECK(r.surface.triangles.size() == 12);
  CHECK(enclosed_volume(r.surface) == doctest::Approx(1));
}

TEST_CASE("split vertices are welded") {
  const Repaired r = repair(shattered(cube_surface()));
  CHECK(r.surface.positions.size() == 8);
  CHECK(enclosed_volume(r.surface) == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("an inverted cube and single turned faces are turned outward") {
  TriangleSurface s = cube_surface();
  turn_all(s);
  Repaired r = repair(s);
  CHECK(enclosed_volume(r.surface) == doctest::Approx(1));
  CHECK(says(r, "turned 1 shells inside out"));
  s = cube_surface();
  for (std::size_t t : {1, 5, 8}) std::swap(s.triangles[t][0], s.triangles[t][1]);
  r = repair(s);
  CHECK(enclosed_volume(r.surface) == doctest::Approx(1));
  CHECK(says(r, "turned 3 faces round"));
}

TEST_CASE("degenerate, double and loose faces are dropped") {
  TriangleSurface s = cube_surface();
  s.triangles.push_back({3, 3, 5});
  s.triangles.push_back(s.triangles[4]);
  Repaired r = repair(s);
  CHECK(r.surface.triangles.size() == 12);
  CHECK(says(r, "dropped 1 faces without area"));
  CHECK(says(r, "dropped 1 faces that were there twice"));
  // A fin at an edge, and a wall between two opposite edges.
  s = cube_surface();
  s.positions.emplace_back(-1, -1, 0.5);
  s.triangles.push_back({0, 4, 8});
  r = repair(s);
  CHECK(r.surface.triangles.size() == 12);
  CHECK(says(r, "inner walls or loose flaps"));
  CHECK(enclosed_volume(r.surface) == doctest::Approx(1));
}

TEST_CASE("small holes are closed, and the note says where") {
  TriangleSurface s = cube_surface();
  s.triangles.erase(s.triangles.begin() + 6, s.triangles.begin() + 8);
  Repaired r = repair(s);
  CHECK(enclosed_volume(r.surface) == doctest::Approx(1));
  CHECK(says(r, "closed 1 hole with 4 edges"));
  CHECK(says(r, "near ("));
  r = repair(tube(90));
  CHECK(enclosed_volume(r.surface) == doctest::Approx(2 * M_PI).epsilon(0.01));
  CHECK(says(r, "closed 2 holes with 180 edges"));
}

TEST_CASE("large holes, open sheets and one-sided surfaces are refused with their place") {
  CHECK(refusal(tube(300)).find(
            "is not a solid: 2 holes with 600 open edges, the largest with 300 edges near (") == 0);
  TriangleSurface sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  CHECK(refusal(sheet).find("encloses no volume") != std::string::npos);
  TriangleSurface strip;
  const int n = 12;
  for (int i = 0; i < n; ++i)
    for (int side : {-1, 1}) {
      const Real u = 2 * M_PI * i / n, w = 0.3 * side;
      strip.positions.emplace_back((1 + w * std::cos(u / 2)) * std::cos(u),
                                   (1 + w * std::cos(u / 2)) * std::sin(u), w * std::sin(u / 2));
    }
  for (Index i = 0; i < n; ++i) {
    const Index a = 2 * i, b = 2 * i + 1;
    const Index c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? b + 2 : 0;
    strip.triangles.push_back({a, c, d});
    strip.triangles.push_back({a, d, b});
  }
  CHECK(refusal(strip).find("one-sided near (") != std::string::npos);
}

TEST_CASE("vertices that are no numbers and empty surfaces are refused") {
  TriangleSurface s = cube_surface();
  s.positions[2].y() = std::numeric_limits<Real>::quiet_NaN();
  CHECK(refusal(s).find("not a number") != std::string::npos);
  CHECK(refusal({}).find("no triangles") != std::string::npos);
  TriangleSurface needles;
  needles.positions = {{0, 0, 0}, {1, 1, 1}};
  needles.triangles = {{0, 1, 1}, {0, 0, 1}};
  CHECK(refusal(needles).find("no face has area") != std::string::npos);
}

TEST_CASE("shells: apart they add, a reversed inner one is a cavity, a crumb goes") {
  Repaired r = repair(merged(cube_surface(), cube_surface(Vec3(2, 0, 0))));
  CHECK(r.notes.empty());
  CHECK(enclosed_volume(r.surface) == doctest::Approx(2));
  TriangleSurface inner = cube_surface(Vec3::Constant(0.25), 0.5);
  r = repair(merged(cube_surface(), inner));
  CHECK(enclosed_volume(r.surface) == doctest::Approx(1));
  CHECK(says(r, "dropped 1 shells inside others"));
  turn_all(inner);
  r = repair(merged(cube_surface(), inner));
  CHECK(enclosed_volume(r.surface) == doctest::Approx(0.875));
  CHECK(says(r, "kept 1 cavities"));
  TriangleSurface inside_out = merged(cube_surface(), inner);
  turn_all(inside_out);
  CHECK(enclosed_volume(repair(inside_out).surface) == doctest::Approx(0.875));
  r = repair(merged(cube_surface(), cube_surface(Vec3(3, 3, 3), 1e-3)));
  CHECK(says(r, "dropped 1 tiny or flat shells"));
  CHECK(r.surface.triangles.size() == 12);
}

TEST_CASE("two cubes that share an edge stay a solid") {
  TriangleSurface s = merged(cube_surface(), cube_surface(Vec3(1, 1, 0)));
  CHECK(enclosed_volume(repair(s).surface) == doctest::Approx(2));
  turn_all(s);
  CHECK(enclosed_volume(repair(s).surface) == doctest::Approx(2));
}

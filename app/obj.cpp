// OBJ text.
#include "app/obj.h"

#include "render/color_map.h"
#include "render/corner_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>

namespace rend {

namespace {

using Text = std::back_insert_iterator<fmt::memory_buffer>;

/// Comment lines that say what the numbers mean, then the texture coordinates.
void put_fields(Text out, Real time, const std::vector<float>& damage,
                const std::vector<float>& stress) {
  float largest = 0;
  for (float s : stress) largest = std::max(largest, s);
  fmt::format_to(out,
                 "# rend " REND_VERSION
                 "; metres, y is up; time {} s\n"
                 "# vt: damage, largest principal Kirchhoff stress / {} Pa\n",
                 time, largest);
  const float scale = largest > 0 ? 1 / largest : 0;
  for (std::size_t v = 0; v < damage.size(); ++v)
    fmt::format_to(out, "vt {:.4g} {:.4g}\n", damage[v], scale * stress[v]);
}

void put_vectors(Text out, const char* key, const auto& vectors) {
  for (const auto& v : vectors)
    fmt::format_to(out, "{} {} {} {}\n", key, static_cast<float>(v[0]), static_cast<float>(v[1]),
                   static_cast<float>(v[2]));
}

}  // namespace

std::string surface_obj(const SurfaceMesh& mesh, Real time) {
  fmt::memory_buffer text;
  const Text out(text);
  const SplitSurface split = split_surface(mesh);
  put_fields(out, time, mesh.damage, mesh.stress);
  fmt::format_to(out, "mtllib {}\n", kMaterialFile);
  put_vectors(out, "v", mesh.x);
  for (const Vec3f& n : split.normal)
    fmt::format_to(out, "vn {:.4f} {:.4f} {:.4f}\n", n.x(), n.y(), n.z());
  std::vector<std::size_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  const auto group = [&](std::size_t t) { return std::pair(mesh.piece[t], mesh.interior[t]); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return group(a) < group(b); });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t t = order[k];
    if (k == 0 || group(t) != group(order[k - 1])) {
      const char* kind = mesh.interior[t] ? "crack" : "skin";
      fmt::format_to(out, "g piece_{}_{}\nusemtl {}\n", mesh.piece[t], kind, kind);
    }
    fmt::format_to(out, "f");
    for (std::size_t c = 0; c < 3; ++c) {
      const Index v = mesh.triangles[t][c] + 1;
      fmt::format_to(out, " {}/{}/{}", v, v, split.corner[3 * t + c] + 1);
    }
    fmt::format_to(out, "\n");
  }
  return fmt::to_string(text);
}

std::string particles_obj(const Snapshot& snapshot) {
  fmt::memory_buffer text;
  const Text out(text);
  put_fields(out, snapshot.time, snapshot.damage, snapshot.stress);
  put_vectors(out, "v", snapshot.x);
  for (std::size_t p = 1; p <= snapshot.x.size(); ++p) fmt::format_to(out, "p {}\n", p);
  return fmt::to_string(text);
}

std::string obj_materials() {
  std::string text;
  for (const auto& [name, color] : {std::pair("skin", kClay), std::pair("crack", kCrack)}) {
    const Rgb c = hex_color(color);
    text += fmt::format("newmtl {}\nKd {:.3f} {:.3f} {:.3f}\nKs 0 0 0\n", name, c[0], c[1], c[2]);
  }
  return text;
}

}  // namespace rend

// Draws one frame: rasterises a thin G-buffer without a window and lights it per pixel.
#pragma once

#include "engine/core/types.h"
#include "engine/fracture/surface_mesh.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rend {

/// 8-bit RGB picture, rows from top to bottom.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height
};

struct Camera {
  Vec3 eye, target;
  Vec3 up = Vec3::UnitY();
  Real fov = 30;  ///< vertical [deg]
};

/// A rigid thing that is not torn: grips, plates, balls.
struct Prop {
  std::vector<Vec3f> x;
  std::vector<Triangle> triangles;
};

/// Particles drawn as lit spheres.
struct PointCloud {
  std::vector<Vec3f> x;
  float radius = 0;  ///< [m]
};

enum class ColorMap { plain, damage, cividis, pieces };
enum class Theme { light, dark };

/// How the surface or the particles are coloured, and what the legend says.
struct Coloring {
  ColorMap map = ColorMap::plain;
  std::vector<float> value;     ///< one per vertex, triangle-piece or particle; see `map`
  float low = 0, high = 1;      ///< ends of the legend
  std::string caption;          ///< "Damage", "Stress [kPa]"; empty: no legend
};

/// What to draw. Pointers are borrowed for the call.
struct DrawList {
  const SurfaceMesh* surface = nullptr;
  const PointCloud* points = nullptr;
  std::vector<Prop> props;
  Coloring coloring;
  float floor = 0;              ///< height of the studio floor [m]
  Theme theme = Theme::light;
};

enum class GlBackend { automatic, osmesa, egl };

struct DrawOptions {
  int width = 1280, height = 720;
  int accumulate = 1;           ///< passes of jittered pixel, light and sky; 1 is live quality, 64 a fine still
  /// Asked between passes; at "no" the picture is given up and comes back empty.
  std::function<bool()> keep_on = {};
};

/// Owns one GL context; use from one thread.
class Renderer {
 public:
  explicit Renderer(GlBackend backend = GlBackend::automatic);  ///< @throws Error when no context can be made
  ~Renderer();

  Image draw(const DrawList& list, const Camera& camera, const DrawOptions& options);
  std::string describe() const;  ///< backend, GL renderer string and lanes in use

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rend

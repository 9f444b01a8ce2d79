// A closed solid in its own frame: inside test, distance, surface, sharp edges and corners.
#pragma once

#include "engine/mesh/creases.h"
#include "engine/mesh/triangle_surface.h"
#include "engine/scene/scene_desc.h"

#include <memory>
#include <string>
#include <vector>

namespace rend {

/// A solid whose bounding box is centred at the origin.
class Solid {
 public:
  virtual ~Solid() = default;

  /// Signed distance to the surface [m], negative inside.
  virtual Real distance(const Vec3& x) const = 0;
  /// Distance without sign [m]; any value >= limit will do beyond it, which is cheaper for meshes.
  virtual Real clearance(const Vec3& x, Real limit) const;
  virtual bool inside(const Vec3& x) const { return distance(x) < 0; }
  /// Moves a point of a facet of surface() onto the shape itself.
  virtual Vec3 onto_surface(const Vec3& x) const = 0;
  /// Moves a point of a crease's chord onto the crease itself.
  virtual Vec3 onto_crease(const Vec3& x) const { return x; }

  const TriangleSurface& surface() const { return surface_; }
  const std::vector<CreaseCurve>& creases() const { return creases_; }
  Bounds bounds() const { return bounds_; }
  Real volume() const { return volume_; }  ///< [m3]

 protected:
  TriangleSurface surface_;  ///< outward; curved shapes are fine facets with corners on the shape
  std::vector<CreaseCurve> creases_;
  Bounds bounds_;
  Real volume_ = 0;
};

std::unique_ptr<Solid> make_box(const BoxDesc& box);
std::unique_ptr<Solid> make_sphere(const SphereDesc& sphere);
std::unique_ptr<Solid> make_cylinder(const CylinderDesc& cylinder);
std::unique_ptr<Solid> make_torus(const TorusDesc& torus);
/// @throws Error when the outline is not a simple polygon with area.
std::unique_ptr<Solid> make_prism(const PrismDesc& prism);
/// The inside of a closed outward surface, scaled to `height` along y. @throws Error when it is
/// flat in y.
std::unique_ptr<Solid> make_mesh_solid(TriangleSurface surface, Real height);

}  // namespace rend

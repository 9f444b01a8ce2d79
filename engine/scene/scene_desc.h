// A scene as validated numbers in SI units: what the JSON file says, with every default filled in.
#pragma once

#include "engine/core/types.h"
#include "engine/material/material_desc.h"

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace rend {

enum class Precision { float32, float64 };  ///< "float": tile solver, "double": reference solver
enum class Transfer { pic, flip, apic, rpic, polypic, xpic };
enum class Kernel { quadratic, cubic };
enum class ForceForm { mls, gradient };                  ///< w D^-1 (x_i - x_p), or the exact gradient of w
enum class DeformationUpdate { exponential, linear };    ///< exp(dt C) F, or (I + dt grad v) F
enum class ForceKind { particle, mesh };                 ///< particle energy, or Lagrangian energy on the tets
enum class Sampling { lattice, jittered, poisson };
enum class Contact { stick, slip, separate };
enum class BreakTest { gap, stretch };

struct SolverDesc {
  Precision precision = Precision::float32;
  Transfer transfer = Transfer::apic;
  Kernel kernel = Kernel::quadratic;
  ForceForm force_form = ForceForm::mls;
  DeformationUpdate deformation_update = DeformationUpdate::exponential;
  Real flip_ratio = 0.95;   ///< FLIP share of the flip transfer [-]; 0 is PIC
  Real rpic_blend = 0;      ///< 1: all of C (APIC), 0: only its skew part (RPIC) [-]
  int polypic_modes = 8;    ///< 1 (PIC), 4 (APIC) or 8
  int xpic_order = 2;       ///< m of XPIC(m); 1 is PIC
  Real cfl = 0.6;           ///< share of the stable step and of a cell a particle may cross [-]
  Real time_step = 0;       ///< fixed step [s]; 0 chooses it
  bool operator==(const SolverDesc&) const = default;
};

struct GridDesc {
  Real dx = 0;  ///< node spacing [m]; nodes lie at integer multiples from the world origin
  bool operator==(const GridDesc&) const = default;
};

struct BoxDesc {  ///< edge lengths [m]
  Vec3 size = Vec3::Ones();
  bool operator==(const BoxDesc&) const = default;
};
struct SphereDesc {  ///< [m]
  Real radius = 1;
  bool operator==(const SphereDesc&) const = default;
};
struct CylinderDesc {  ///< axis along y [m]
  Real radius = 1, height = 1;
  bool operator==(const CylinderDesc&) const = default;
};
struct TorusDesc {  ///< axis along y [m]
  Real major_radius = 1, minor_radius = 0.5;
  bool operator==(const TorusDesc&) const = default;
};
struct PrismDesc {  ///< simple polygon in x-y, extruded along z [m]
  std::vector<Eigen::Vector2d> outline;                 ///< counter-clockwise
  Real depth = 1;
  bool operator==(const PrismDesc&) const = default;
};
struct MeshDesc {
  std::string file;   ///< as written in the scene
  std::string path;   ///< where it was found
  Real height = 1;    ///< scaled to this extent along y [m]
  bool operator==(const MeshDesc&) const = default;
};
using ShapeDesc = std::variant<BoxDesc, SphereDesc, CylinderDesc, TorusDesc, PrismDesc, MeshDesc>;

struct BodyDesc {
  ShapeDesc shape;
  std::size_t material = 0;  ///< index into SceneDesc::materials
  ForceKind force = ForceKind::particle;
  Real particles_per_cell = 8;
  Sampling sampling = Sampling::poisson;
  Vec3 position = Vec3::Zero();           ///< centre of the shape's bounding box [m]
  Vec3 rotation = Vec3::Zero();           ///< rotation vector, axis times angle [deg]
  Vec3 velocity = Vec3::Zero();           ///< [m/s]
  Mat3 velocity_gradient = Mat3::Zero();  ///< [1/s], about the body's centre
  bool operator==(const BodyDesc&) const = default;
};

struct PlaneDesc {  ///< half space; the normal points out of the collider and may have any length
  Vec3 normal = Vec3::UnitY();
  bool operator==(const PlaneDesc&) const = default;
};
using ColliderShape = std::variant<PlaneDesc, BoxDesc, SphereDesc, CylinderDesc>;

/// Position and rotation at a time; linear in between, constant before the first and after the last.
struct Keyframe {
  Real time = 0;                  ///< [s]
  Vec3 position = Vec3::Zero();   ///< [m]
  Vec3 rotation = Vec3::Zero();   ///< rotation vector, axis times angle [deg]
  bool operator==(const Keyframe&) const = default;
};

struct ColliderDesc {
  ColliderShape shape;
  Contact contact = Contact::stick;
  Real friction = 0;              ///< Coulomb coefficient for slip and separate [-]
  std::vector<Keyframe> motion;   ///< at least one keyframe
  Real release_time = -1;         ///< the collider vanishes at this time [s]; negative: never
  bool visible = true;
  bool operator==(const ColliderDesc&) const = default;
};

struct FractureDesc {
  BreakTest break_test = BreakTest::gap;
  std::optional<Real> stretch;   ///< edge stretch that breaks an edge [-]; empty is "auto"
  Real gap = 0.5;                ///< rigid gap that breaks an edge, in mean edge lengths [-]
  int smoothing_iterations = 5;
  int smallest_fragment = 1;     ///< fragments of fewer particles are left out of the surface
  bool operator==(const FractureDesc&) const = default;
};

struct CameraDesc {
  Vec3 eye = Vec3(2, 1, 2);
  Vec3 target = Vec3::Zero();
  Real fov = 30;  ///< vertical [deg]
  bool operator==(const CameraDesc&) const = default;
};

struct RenderDesc {
  std::string color_by = "damage";  ///< "none", "damage", "stress", "speed", "piece" or "yielded"
  bool particles = false;           ///< show particles instead of the surface
  std::optional<Real> floor;        ///< height of the studio floor [m]; empty: below everything
  bool operator==(const RenderDesc&) const = default;
};

struct SceneDesc {
  std::string name;
  std::string description;
  Real frame_rate = 24;    ///< [1/s]
  int frames = 120;
  std::uint64_t seed = 1;
  Vec3 gravity = Vec3(0, -9.81, 0);  ///< [m/s2]
  GridDesc grid;
  SolverDesc solver;
  std::vector<MaterialDesc> materials;
  std::vector<BodyDesc> bodies;
  std::vector<ColliderDesc> colliders;
  FractureDesc fracture;
  CameraDesc camera;
  RenderDesc render;
  bool operator==(const SceneDesc&) const = default;
};

}  // namespace rend

// Fields of the scene itself: time, grid, solver, fracture mesh, camera and picture.
#include "engine/scene/scene_fields.h"

#include <algorithm>

namespace rend {

namespace {

constexpr const char* kPrecisions[] = {"float", "double"};
constexpr const char* kTransfers[] = {"pic", "flip", "apic", "rpic", "polypic", "xpic"};
constexpr const char* kKernels[] = {"quadratic", "cubic"};
constexpr const char* kForceForms[] = {"mls", "gradient"};
constexpr const char* kUpdates[] = {"exponential", "linear"};
constexpr const char* kBreakTests[] = {"gap", "stretch"};
constexpr const char* kColors[] = {"none", "damage", "stress", "speed", "threshold", "piece", "yielded"};
constexpr std::int64_t kPolypicModes[] = {1, 4, 8};
constexpr std::int64_t kLargestExact = (std::int64_t{1} << 53) - 1;

constexpr Range kPosition{"m", -1e4, 1e4};
constexpr Range kShare{"-", 0, 1};

template <class Int>
void whole(FieldVisitor& visitor, const Field& field, Int& value, std::int64_t min,
           std::int64_t max, std::span<const std::int64_t> allowed = {}) {
  auto wide = static_cast<std::int64_t>(value);
  visitor.integer(field, wide, min, max, allowed);
  value = static_cast<Int>(wide);
}

void describe_solver(FieldVisitor& v, SolverDesc& s) {
  choose(v, {"precision", "float: fast tile solver; double: reference solver"}, s.precision,
         kPrecisions);
  choose(v, {"transfer", "how velocity goes between particles and grid"}, s.transfer, kTransfers);
  choose(v, {"kernel", "B-spline of the transfer"}, s.kernel, kKernels);
  choose(v,
         {"force_form", "nodal force from the moving-least-squares weights or the exact gradient"},
         s.force_form, kForceForms);
  choose(v, {"deformation_update", "F from exp(dt C) or from I + dt grad v"}, s.deformation_update,
         kUpdates);
  v.number({"flip_ratio", "FLIP share of the flip transfer, 0 is PIC"}, s.flip_ratio, kShare);
  v.number({"rpic_blend", "1 keeps all of the affine velocity (APIC), 0 its rotation only (RPIC)"},
           s.rpic_blend, kShare);
  whole(v, {"polypic_modes", "velocity modes of the polypic transfer: 1 is PIC, 4 is APIC"},
        s.polypic_modes, 1, 8, kPolypicModes);
  whole(v, {"xpic_order", "order of the xpic transfer, 1 is PIC"}, s.xpic_order, 1, 20);
  v.number({"cfl", "share of the stable time step, and of a cell that a particle may cross"}, s.cfl,
           {"-", 0.01, 2});
  v.number({"time_step", "fixed time step, 0 chooses it"}, s.time_step, {"s", 0, 1});
}

void describe_fracture(FieldVisitor& v, FractureDesc& f) {
  choose(v, {"break_test", "what breaks an edge: a rigid gap between its ends, or its stretch"},
         f.break_test, kBreakTests);
  v.number_or_word({"stretch", "edge stretch that breaks an edge"}, f.stretch, "auto",
                   {"-", 1.001, 1000});
  v.number({"gap", "rigid gap that breaks an edge, in mean edge lengths"}, f.gap,
           {"-", 0.001, 1000});
  whole(v, {"smoothing_iterations", "Gauss-Seidel passes over the crack surface at rest"},
        f.smoothing_iterations, 0, 1000);
  whole(v, {"smallest_fragment", "fragments of fewer particles are left out of the surface"},
        f.smallest_fragment, 1, 1000000);
}

void describe_camera(FieldVisitor& v, CameraDesc& c) {
  v.vector({"eye", "where the camera is"}, c.eye, kPosition);
  v.vector({"target", "what it looks at"}, c.target, kPosition);
  v.number({"fov", "vertical field of view"}, c.fov, {"deg", 1, 120});
}

void describe_render(FieldVisitor& v, RenderDesc& r) {
  const auto* found = std::find(std::begin(kColors), std::end(kColors), r.color_by);
  int color = found == std::end(kColors) ? 0 : static_cast<int>(found - std::begin(kColors));
  v.choice({"color_by", "what the colour shows"}, color, kColors);
  r.color_by = kColors[color];
  v.flag({"particles", "show particles instead of the surface"}, r.particles);
  v.number_or_word({"floor", "height of the studio floor, auto puts it below everything"}, r.floor,
                   "auto", kPosition);
}

}  // namespace

void describe_scene(FieldVisitor& v, SceneDesc& s) {
  std::string schema;
  v.text({"$schema", "path of schema.json for editors; not used here", false, true}, schema, 1000);
  v.text({"name", "short name"}, s.name, 100);
  v.text({"description", "what happens"}, s.description, 2000);
  v.number({"frame_rate", "frames per second of simulated time"}, s.frame_rate,
           {"1/s", 0.001, 1e6});
  whole(v, {"frames", "number of frames"}, s.frames, 1, 1000000);
  whole(v, {"seed", "seed of sampling and of the strength field"}, s.seed, 0, kLargestExact);
  v.vector({"gravity", "acceleration of everything"}, s.gravity, {"m/s2", -1e5, 1e5});
  v.object({"grid", "background grid, nodes at integer multiples of dx from the origin", true},
           [&](FieldVisitor& o) {
             o.number({"dx", "node spacing", true}, s.grid.dx, {"m", 1e-6, 1000});
           });
  v.object({"solver", "numerical scheme"}, [&](FieldVisitor& o) { describe_solver(o, s.solver); });

  Sequence materials = sequence_of(s.materials, 1, 100, describe_material);
  materials.name = [&](std::size_t i) -> std::string& { return s.materials[i].name; };
  v.sequence({"materials", "materials by name", true}, materials);
  std::vector<std::string> names;
  for (const MaterialDesc& material : s.materials) names.push_back(material.name);
  v.sequence({"bodies", "what is torn", true},
             sequence_of(s.bodies, 1, 1000, [&names](FieldVisitor& o, BodyDesc& body) {
               describe_body(o, body, names);
             }));
  v.sequence({"colliders", "rigid things that hold, push and stop"},
             sequence_of(s.colliders, 0, 1000, describe_collider));

  v.object({"fracture", "fracture mesh, made once a frame"},
           [&](FieldVisitor& o) { describe_fracture(o, s.fracture); });
  v.object({"camera", "first view"}, [&](FieldVisitor& o) { describe_camera(o, s.camera); });
  v.object({"render", "first style of the picture"},
           [&](FieldVisitor& o) { describe_render(o, s.render); });
}

}  // namespace rend

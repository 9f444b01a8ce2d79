// Fields of bodies and colliders: shapes, placement, contact and motion.
#include "engine/scene/scene_fields.h"

namespace rend {

namespace {

constexpr const char* kBodyShapes[] = {"box", "sphere", "cylinder", "torus", "prism", "mesh"};
constexpr const char* kColliderShapes[] = {"plane", "box", "sphere", "cylinder"};
constexpr const char* kForceKinds[] = {"particle", "mesh"};
constexpr const char* kSamplings[] = {"lattice", "jittered", "poisson"};
constexpr const char* kContacts[] = {"stick", "slip", "separate"};

constexpr Range kLength{"m", 1e-6, 1e4};
constexpr Range kPosition{"m", -1e4, 1e4};
constexpr Range kAngle{"deg", -36000, 36000};

void describe_shape(FieldVisitor& v, BoxDesc& box) {
  v.vector({"size", "edge lengths", true}, box.size, kLength);
}
void describe_shape(FieldVisitor& v, SphereDesc& sphere) {
  v.number({"radius", "radius", true}, sphere.radius, kLength);
}
void describe_shape(FieldVisitor& v, CylinderDesc& cylinder) {
  v.number({"radius", "radius", true}, cylinder.radius, kLength);
  v.number({"height", "length along its axis y", true}, cylinder.height, kLength);
}
void describe_shape(FieldVisitor& v, TorusDesc& torus) {
  v.number({"major_radius", "from the axis y to the middle of the tube", true}, torus.major_radius,
           kLength);
  v.number({"minor_radius", "of the tube, smaller than major_radius", true}, torus.minor_radius,
           kLength);
}
void describe_shape(FieldVisitor& v, PrismDesc& prism) {
  v.points({"outline", "corners of a simple polygon in x and y", true}, prism.outline, 3, 1000,
           kPosition);
  v.number({"depth", "length along z", true}, prism.depth, kLength);
}
void describe_shape(FieldVisitor& v, MeshDesc& mesh) {
  v.mesh_file({"file",
               "closed surface as .obj, .off, .ply, .stl, .gltf or .glb; looked for next to the scene, "
               "then in the mesh folders",
               true},
              mesh.file, mesh.path);
  v.number({"height", "scaled to this extent along y", true}, mesh.height, kLength);
}
void describe_shape(FieldVisitor& v, PlaneDesc& plane) {
  v.vector({"normal", "points out of the solid half space, any length", true}, plane.normal,
           {"-", -1e6, 1e6});
}

template <class Variant, std::size_t I = 0>
Variant make_alternative(int index) {
  if constexpr (I + 1 < std::variant_size_v<Variant>)
    if (index != static_cast<int>(I)) return make_alternative<Variant, I + 1>(index);
  return std::variant_alternative_t<I, Variant>{};
}

template <class Variant>
void describe_variant(FieldVisitor& v, Variant& shape, Names names) {
  int type = static_cast<int>(shape.index());
  v.variant({"type", "which shape", true}, type, names, [&](FieldVisitor& o, int chosen) {
    if (o.fills()) shape = make_alternative<Variant>(chosen);
    std::visit([&](auto& alternative) { describe_shape(o, alternative); }, shape);
  });
}

void describe_keyframe(FieldVisitor& v, Keyframe& k) {
  v.number({"time", "larger than that of the keyframe before", true}, k.time, {"s", 0, 1e6});
  v.vector({"position", "of the collider's own origin"}, k.position, kPosition);
  v.vector({"rotation", "rotation vector, axis times angle"}, k.rotation, kAngle);
}

void describe_motion(FieldVisitor& v, ColliderDesc& c) {
  Keyframe rest;
  v.vector({"position", "where it rests, instead of motion", false, true}, rest.position,
           kPosition);
  v.vector({"rotation", "rotation vector, axis times angle, instead of motion", false, true},
           rest.rotation, kAngle);
  v.sequence({"motion", "keyframes, linear in between and constant outside"},
             sequence_of(c.motion, 1, 10000, describe_keyframe));
  v.exclusive("motion", "position");
  v.exclusive("motion", "rotation");
  if (v.fills() && !v.given("motion")) c.motion = {rest};
}

}  // namespace

void describe_body(FieldVisitor& v, BodyDesc& b, std::span<const std::string> materials) {
  v.object({"shape", "what it looks like at rest", true},
           [&](FieldVisitor& o) { describe_variant(o, b.shape, kBodyShapes); });
  v.reference({"material", "name of an entry of materials", true}, b.material, materials);
  choose(v, {"force", "stress from each particle's F, or from the tets of a mesh"}, b.force,
         kForceKinds);
  v.number({"particles_per_cell", "particles in a grid cell at rest"}, b.particles_per_cell,
           {"-", 0.1, 1000});
  choose(v, {"sampling", "how particles are spread"}, b.sampling, kSamplings);
  v.vector({"position", "centre of the shape's bounding box"}, b.position, kPosition);
  v.vector({"rotation", "rotation vector about that centre, axis times angle"}, b.rotation, kAngle);
  v.vector({"velocity", "first velocity"}, b.velocity, {"m/s", -1e4, 1e4});
  v.matrix({"velocity_gradient", "first velocity gradient about the centre, rows of dv/dx"},
           b.velocity_gradient, {"1/s", -1e6, 1e6});
}

void describe_collider(FieldVisitor& v, ColliderDesc& c) {
  v.object({"shape", "solid part", true},
           [&](FieldVisitor& o) { describe_variant(o, c.shape, kColliderShapes); });
  choose(v, {"contact", "stick holds, slip lets slide, separate lets slide and leave"}, c.contact,
         kContacts);
  v.number({"friction", "Coulomb coefficient of slip and separate"}, c.friction, {"-", 0, 100});
  describe_motion(v, c);
  std::optional<Real> release;
  if (c.release_time >= 0) release = c.release_time;
  v.number_or_word({"release_time", "when it vanishes"}, release, "never", {"s", 0, 1e6});
  c.release_time = release.value_or(-1);
  v.flag({"visible", "drawn in the picture"}, c.visible);
}

}  // namespace rend

// All bodies of a scene as one model.
#include "engine/mesh/build_model.h"

#include "engine/core/error.h"
#include "engine/material/law_constants.h"
#include "engine/mesh/body.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/strength_field.h"
#include "engine/mesh/stuffing.h"
#include "engine/scene/crack_band.h"
#include "engine/scene/motion.h"

#include <fmt/format.h>

namespace rend {

namespace {

// Particle state of the solver, tets, Delaunay while building and fracture tables; measured 530 B +
// 600 B + rest.
constexpr Real bytes_per_particle = 2000;
// Grid node and its share of the block tables.
constexpr Real bytes_per_cell = 64;
// Lattices of the sampling, for each particle that would fit into the bounding box.
constexpr Real bytes_per_site = 25;

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};

std::string pointer(std::size_t body) { return fmt::format("/bodies/{}/shape", body); }

struct SolidAndNotes {
  std::unique_ptr<Solid> solid;
  std::vector<std::string> notes;
};

SolidAndNotes make_solid(const ShapeDesc& shape, const MeshLoading& loading) {
  std::vector<std::string> notes;
  const auto from_mesh = [&](const MeshDesc& mesh) {
    TriangleSurface raw = import_mesh(mesh.path.empty() ? mesh.file : mesh.path, loading);
    try {
      return make_mesh_solid(repair_surface(std::move(raw), notes), mesh.height);
    } catch (const Error& e) {
      throw Error(e.where(), mesh.file + " " + e.why());
    }
  };
  auto solid = std::visit(Overloaded{[](const BoxDesc& s) { return make_box(s); },
                                     [](const SphereDesc& s) { return make_sphere(s); },
                                     [](const CylinderDesc& s) { return make_cylinder(s); },
                                     [](const TorusDesc& s) { return make_torus(s); },
                                     [](const PrismDesc& s) { return make_prism(s); }, from_mesh},
                          shape);
  return {std::move(solid), std::move(notes)};
}

// What `make` throws, told as trouble of this body.
template <class F>
auto at_body(std::size_t body, F&& make) {
  try {
    return make();
  } catch (const Error& e) {
    throw Error(pointer(body) + (e.where().empty() ? "" : "/" + e.where()), e.why());
  }
}

std::vector<SolidAndNotes> make_solids(const SceneDesc& scene, const MeshLoading& loading) {
  std::vector<SolidAndNotes> solids;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    solids.push_back(at_body(b, [&] { return make_solid(scene.bodies[b].shape, loading); }));
  return solids;
}

Real particle_count(const SceneDesc& scene, std::size_t b, const Solid& solid) {
  return solid.volume() * scene.bodies[b].particles_per_cell / std::pow(scene.grid.dx, 3);
}

ModelEstimate estimate(const SceneDesc& scene, const std::vector<SolidAndNotes>& solids) {
  ModelEstimate e;
  for (std::size_t b = 0; b < solids.size(); ++b) {
    const Real particles = particle_count(scene, b, *solids[b].solid);
    const Real cells =
        (solids[b].solid->bounds().size() / scene.grid.dx + Vec3::Constant(4)).prod();
    e.particles += particles;
    e.bytes += bytes_per_particle * particles +
               (bytes_per_cell + bytes_per_site * scene.bodies[b].particles_per_cell) * cells;
  }
  return e;
}

void append(const SceneDesc& scene, std::size_t b, const Body& body, Model& model) {
  const BodyDesc& desc = scene.bodies[b];
  const Mat3 rotation = rotation_from_degrees(desc.rotation);
  const Index first = model.particle_count();
  for (std::size_t i = 0; i < body.X.size(); ++i) {
    const Vec3 x = rotation * body.X[i];
    model.X.push_back(desc.position + x);
    model.velocity.push_back(desc.velocity + desc.velocity_gradient * x);
  }
  model.volume.insert(model.volume.end(), body.volume.begin(), body.volume.end());
  model.crease.insert(model.crease.end(), body.crease.begin(), body.crease.end());
  model.body.resize(model.X.size(), std::uint16_t(b));
  model.material.resize(model.X.size(), std::uint16_t(desc.material));
  model.tets.reserve(model.tets.size() + body.tets.size());
  for (const Tet& t : body.tets)
    model.tets.push_back({t[0] + first, t[1] + first, t[2] + first, t[3] + first});
  for (const Triangle& t : body.skin)
    model.skin.push_back({t[0] + first, t[1] + first, t[2] + first});
  for (const std::string& note : body.notes) model.notes.push_back(pointer(b) + ": " + note);
  model.velocity_gradient.push_back(desc.velocity_gradient);
  model.spacing.push_back(scene.grid.dx / std::cbrt(desc.particles_per_cell));
}

// A fracture energy that particles cannot hold.
void note_tough_matter(const SceneDesc& scene, std::size_t b, Model& model) {
  const MaterialDesc& m = scene.materials[scene.bodies[b].material];
  if (!m.fracture_energy || scene.bodies[b].force == ForceKind::mesh) return;
  const Real most = kMostCrackEnergy * initial_threshold(m.yield_surface) * scene.grid.dx;
  if (*m.fracture_energy > most)
    model.notes.push_back(fmt::format(
        "/bodies/{}: particles part numerically at about {:.3g} J/m2 of crack at this dx, before "
        "the fracture_energy {:.3g} J/m2 of \"{}\" is used up; force \"mesh\" holds it",
        b, most, *m.fracture_energy, m.name));
}

}  // namespace

ModelEstimate estimate_model(const SceneDesc& scene, const MeshLoading& loading) {
  return estimate(scene, make_solids(scene, loading));
}

Model build_model(const SceneDesc& scene, double memory_limit, const Progress& progress,
                  const MeshLoading& loading) {
  const auto report = [&](const char* stage, Real share) {
    if (progress) progress(stage, share);
  };
  report("shapes", 0);
  const auto solids = make_solids(scene, loading);
  const ModelEstimate size = estimate(scene, solids);
  if (!(size.bytes <= memory_limit))
    throw Error("/grid/dx",
                fmt::format("gives {:.3g} particles, about {:.3g} GB; the limit is {:.3g} GB. "
                            "Use a larger dx or fewer particles_per_cell",
                            size.particles, size.bytes / 1e9, memory_limit / 1e9));
  Model model;
  for (std::size_t b = 0; b < solids.size(); ++b) {
    report("particles", Real(b) / Real(solids.size()));
    const BodyDesc& desc = scene.bodies[b];
    const SamplingOptions options{desc.sampling, particle_count(scene, b, *solids[b].solid),
                                  scene.seed, b};
    for (const std::string& note : solids[b].notes) model.notes.push_back(pointer(b) + ": " + note);
    append(scene, b,
           at_body(b,
                   [&] {
                     return desc.force == ForceKind::mesh
                                ? stuff_body(*solids[b].solid, options.count)
                                : build_body(*solids[b].solid, options);
                   }),
           model);
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) note_tough_matter(scene, b, model);
  model.strength = strength_factors(scene, model);
  report("done", 1);
  return model;
}

}  // namespace rend

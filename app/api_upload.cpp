// Mesh files that viewers send.
#include "app/api_upload.h"

#include "app/write_file.h"
#include "engine/core/error.h"
#include "engine/mesh/repair.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace rend {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr Real kParticles = 25000;
constexpr Real kParticlesPerCell = 8;
constexpr Real kGripShare = 0.14;  // of the longest axis, at each end
constexpr Real kTravel = 0.4;      // of each grip [m]
constexpr Real kGroundGap = 0.08;  // below the body [m]

json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// A box around what lies within the grip's share of one end.
json grip(const std::vector<Vec3>& positions, const Bounds& box, int axis, int side) {
  const Real length = box.size()[axis];
  const Real end = side < 0 ? box.low[axis] : box.high[axis],
             inner = end - side * kGripShare * length;
  Bounds held;
  for (const Vec3& x : positions)
    if (side * (x[axis] - inner) >= 0) held.add(x);
  held.add(Vec3(held.centre()));
  Vec3 size = held.size() + Vec3::Constant(0.06), centre = held.centre();
  size[axis] = kGripShare * length + 0.05;
  centre[axis] = 0.5 * (inner + end) + side * 0.025;
  Vec3 slow = centre, far = centre;
  slow[axis] += side * 0.02;
  far[axis] += side * kTravel;
  return {{"shape", {{"type", "box"}, {"size", list(size)}}},
          {"contact", "stick"},
          {"motion",
           {{{"time", 0}, {"position", list(centre)}},
            {{"time", 0.5}, {"position", list(slow)}},
            {{"time", 4.5}, {"position", list(far)}}}}};
}

}  // namespace

std::string tearing_scene(const TriangleSurface& surface, const std::string& name,
                          const std::string& mesh_file) {
  const Bounds raw = bounds_of(surface.positions);
  const Real scale = 1 / raw.size().maxCoeff();
  std::vector<Vec3> positions;
  for (const Vec3& x : surface.positions) positions.push_back(scale * (x - raw.centre()));
  const Bounds box = bounds_of(positions);
  int axis = 0;
  box.size().maxCoeff(&axis);
  const Real volume = std::abs(enclosed_volume(surface)) * scale * scale * scale;
  const Real dx = std::clamp(std::cbrt(volume * kParticlesPerCell / kParticles), 0.008, 0.05);
  const Real ground = box.low.y() - (axis == 1 ? kTravel : 0) - kGroundGap;

  // Seen across the axis along which it is pulled.
  const Vec3 eye = axis == 2 ? Vec3(2.5, 0.9, 1.3) : Vec3(1.3, 0.9, 2.5);
  const json scene = {
      {"name", name},
      {"description",
       "Your mesh, held at both ends of its longest axis and pulled apart (Rankine)."},
      {"frame_rate", 24},
      {"frames", 120},
      {"gravity", {0, -1, 0}},
      {"grid", {{"dx", dx}}},
      {"materials",
       {{"clay",
         {{"density", 1000},
          {"youngs_modulus", 1e5},
          {"poisson_ratio", 0.3},
          {"yield_surface", {{"type", "rankine"}, {"tau_c", 1e4}, {"softening", 3e4}}},
          {"damage", {{"type", "granular"}, {"threshold", 0.1}}}}}}},
      {"bodies",
       {{{"shape", {{"type", "mesh"}, {"file", mesh_file}, {"height", box.size().y()}}},
         {"material", "clay"},
         {"particles_per_cell", kParticlesPerCell},
         {"sampling", "poisson"}}}},
      {"colliders",
       {grip(positions, box, axis, -1),
        grip(positions, box, axis, 1),
        {{"shape", {{"type", "plane"}, {"normal", {0, 1, 0}}}},
         {"contact", "separate"},
         {"friction", 0.5},
         {"position", {0, ground, 0}}}}},
      {"fracture", {{"break_test", "gap"}}},
      {"camera", {{"eye", list(eye)}, {"target", {0, 0, 0}}, {"fov", 32}}},
      {"render", {{"color_by", "damage"}}}};
  return scene.dump(1);
}

MeshUploads::MeshUploads(SceneLibrary& library, MeshLoading loading)
    : library_(library), loading_(std::move(loading)) {}

std::string MeshUploads::free_name(const std::string& stem) const {
  const std::vector<std::string> taken = library_.names();
  std::string name = stem;
  for (int n = 2; std::find(taken.begin(), taken.end(), name) != taken.end(); ++n)
    name = fmt::format("{}-{}", stem, n);
  return name;
}

UploadedMesh MeshUploads::add(const std::string& file_name, std::string_view bytes) {
  UploadedMesh uploaded;
  TriangleSurface surface = import_mesh_bytes(bytes, file_name, loading_);
  try {
    surface = repair_surface(std::move(surface), uploaded.notes);
  } catch (const Error& error) {
    throw Error(error.where(), file_name + " " + error.why());
  }
  const Vec3 size = bounds_of(surface.positions).size();
  if (!(size.minCoeff() > 0)) throw Error("file", file_name + " is flat: it encloses no volume");

  const std::lock_guard lock(mutex_);
  uploaded.name = free_name(plain_name(fs::path(file_name).stem().string(), "mesh"));
  // A folder for each, so that names in it are free.
  const fs::path place = folder_.path() / std::to_string(count_++);
  std::string ending = fs::path(file_name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const std::string mesh_file = "mesh" + ending;
  fs::create_directory(place);
  write_file(place / mesh_file, std::string(bytes));
  write_file(place / (uploaded.name + ".json"), tearing_scene(surface, uploaded.name, mesh_file));
  library_.add(place / (uploaded.name + ".json"));
  names_.push_back(uploaded.name);
  if (names_.size() > kMostUploads) {
    library_.remove(names_.front());
    names_.pop_front();
  }
  return uploaded;
}

}  // namespace rend

// The table of formats, and the files of a run.
#include "app/frame_formats.h"

#include "app/glb.h"
#include "app/obj.h"
#include "app/ply.h"
#include "app/vtp.h"
#include "app/write_file.h"
#include "engine/core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace rend {

namespace {

std::vector<RunFile> vtp_series(const std::vector<NamedFrame>& frames) {
  std::vector<RunFile> files;
  for (const std::string kind : {"mesh", "particles"}) {
    std::vector<SeriesEntry> entries;
    for (const NamedFrame& f : frames)
      entries.push_back({f.time, fmt::format("{}/{}.vtp", kind, f.name)});
    files.push_back({kind + ".pvd", pvd(entries)});
  }
  return files;
}

}  // namespace

const std::vector<FrameFormat>& frame_formats() {
  static const std::vector<FrameFormat> all = {
      {"ply", "application/octet-stream",
       [](const SurfaceMesh& mesh, Real) { return surface_ply(mesh); }, particles_ply, nullptr},
      {"vtp", "application/octet-stream",
       [](const SurfaceMesh& mesh, Real time) { return vtp(surface_arrays(mesh), time); },
       [](const Snapshot& s, const Model& m) { return vtp(particle_arrays(s, m), s.time); },
       vtp_series},
      {"obj", "model/obj", surface_obj,
       [](const Snapshot& s, const Model&) { return particles_obj(s); },
       [](const std::vector<NamedFrame>&) {
         return std::vector<RunFile>{{std::string("mesh/") + kMaterialFile, obj_materials()}};
       }},
      {"glb", "model/gltf-binary", surface_glb, particles_glb, nullptr}};
  return all;
}

std::vector<std::string> frame_format_names() {
  std::vector<std::string> names;
  for (const FrameFormat& f : frame_formats()) names.push_back(f.name);
  return names;
}

const FrameFormat& find_frame_format(const std::string& where, const std::string& name) {
  for (const FrameFormat& f : frame_formats())
    if (f.name == name) return f;
  throw Error(where, fmt::format("\"{}\" is not one of {}", name.substr(0, 40),
                                 fmt::join(frame_format_names(), ", ")));
}

FrameFiles::FrameFiles(std::filesystem::path folder, const std::vector<std::string>& formats)
    : folder_(std::move(folder)) {
  for (const std::string& name : formats) {
    const FrameFormat* format = &find_frame_format("--formats", name);
    if (std::find(formats_.begin(), formats_.end(), format) == formats_.end())
      formats_.push_back(format);
  }
  if (formats_.empty()) return;
  make_folder(folder_ / "mesh");
  make_folder(folder_ / "particles");
}

void FrameFiles::write(const std::string& name, const SurfaceMesh& surface,
                       const Snapshot& snapshot, const Model& model) {
  frames_.push_back({snapshot.time, name});
  for (const FrameFormat* format : formats_) {
    const std::string file = name + "." + format->name;
    write_file(folder_ / "mesh" / file, format->surface(surface, snapshot.time));
    write_file(folder_ / "particles" / file, format->particles(snapshot, model));
    if (!format->beside) continue;
    for (const RunFile& f : format->beside(frames_)) write_file(folder_ / f.path, f.bytes);
  }
}

}  // namespace rend

// The file formats in which frames are handed to other programs.
#pragma once

#include "engine/fracture/surface_mesh.h"
#include "engine/mpm/snapshot.h"
#include "engine/scene/model.h"

#include <filesystem>
#include <string>
#include <vector>

namespace rend {

/// The frames of a run: time [s], and the name under which their files are.
struct NamedFrame {
  Real time = 0;
  std::string name;
};

/// Path below the folder of a run, and content.
struct RunFile {
  std::string path, bytes;
};

/// Every format carries the surface and the particles of one frame.
struct FrameFormat {
  std::string name;  ///< also the ending of its files
  std::string media_type;
  std::string (*surface)(const SurfaceMesh&, Real time);
  std::string (*particles)(const Snapshot&, const Model&);
  /// What belongs to the frames so far as a whole, like mesh.pvd and mesh/materials.mtl; or null.
  std::vector<RunFile> (*beside)(const std::vector<NamedFrame>&);
};

/// ply, vtp, obj, glb.
const std::vector<FrameFormat>& frame_formats();
std::vector<std::string> frame_format_names();

/// @throws Error at `where` for a name that is none.
const FrameFormat& find_frame_format(const std::string& where, const std::string& name);

/// Writes mesh/NAME.* and particles/NAME.* of each frame below a folder, and what a format needs
/// beside them: mesh.pvd and particles.pvd (vtp), mesh/materials.mtl (obj).
class FrameFiles {
 public:
  /// Makes the folders. @throws Error for an unknown format and when the disk refuses.
  FrameFiles(std::filesystem::path folder, const std::vector<std::string>& formats);

  void write(const std::string& name, const SurfaceMesh& surface, const Snapshot& snapshot,
             const Model& model);

 private:
  std::filesystem::path folder_;
  std::vector<const FrameFormat*> formats_;
  std::vector<NamedFrame> frames_;  ///< so far
};

}  // namespace rend

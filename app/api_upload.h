// Mesh files that viewers send: each becomes a scene in which it is pulled apart.
#pragma once

#include "app/scene_library.h"
#include "app/temporary_folder.h"
#include "engine/mesh/mesh_import.h"

#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace rend {

/// A scene made from a mesh.
struct UploadedMesh {
  std::string name;                ///< of the scene
  std::vector<std::string> notes;  ///< what was repaired
};

/// Keeps the files in a folder of its own that goes when it does. Any thread.
class MeshUploads {
 public:
  explicit MeshUploads(SceneLibrary& library, MeshLoading loading = {});
  MeshUploads(const MeshUploads&) = delete;
  MeshUploads& operator=(const MeshUploads&) = delete;

  /// Reads the mesh in the loader's process, repairs it and offers a scene with it, the largest
  /// extent one metre, held by grips at both ends of its longest axis. The oldest of kMostUploads
  /// goes when there are more.
  /// @throws Error with what is wrong with the file and where.
  UploadedMesh add(const std::string& file_name, std::string_view bytes);

  static constexpr std::size_t kMostUploads = 12;
  static constexpr std::size_t kMostBytes = std::size_t(64) << 20;

 private:
  std::string free_name(const std::string& stem) const;

  SceneLibrary& library_;
  MeshLoading loading_;
  TemporaryFolder folder_{"rend-meshes"};
  std::mutex mutex_;
  std::deque<std::string> names_;  ///< oldest first
  int count_ = 0;
};

/// The scene in which `surface`, a closed mesh that is stored as `mesh_file`, is pulled apart, as
/// JSON text.
std::string tearing_scene(const TriangleSurface& surface, const std::string& name,
                          const std::string& mesh_file);

}  // namespace rend

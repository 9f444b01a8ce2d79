// Mesh files to triangles, read by a separate process that may crash or hang without harm.
#pragma once

#include "engine/mesh/triangle_surface.h"

#include <filesystem>
#include <string_view>

namespace rend {

/// How mesh files are read.
struct MeshLoading {
  std::filesystem::path
      loader;                 ///< rend-meshload; empty: beside the running program or one folder up
  Real wall_seconds = 20;     ///< the loader is killed after this time [s]
  unsigned cpu_seconds = 10;  ///< processor time of the loader [s]
  std::size_t memory_bytes = std::size_t(2) << 30;
  std::size_t file_bytes = std::size_t(256) << 20;  ///< larger files are refused unread
};

/// Raw triangles of an obj, stl, ply, off, gltf or glb file. @throws Error with where = "file" and
/// the file's name, what is wrong and what is allowed.
TriangleSurface import_mesh(const std::filesystem::path& file, const MeshLoading& loading = {});

/// The same for a file's content; `name` stands for the file in messages and its ending gives the
/// format.
TriangleSurface import_mesh_bytes(std::string_view bytes, const std::string& name,
                                  const MeshLoading& loading = {});

}  // namespace rend

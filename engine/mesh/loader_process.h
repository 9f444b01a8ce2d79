// Runs the mesh loader on bytes and returns what it wrote.
#pragma once

#include "engine/mesh/mesh_import.h"

#include <string>

namespace rend {

/// Output of a finished loader; `ending` chooses the importer. @throws Error with where = "file"
/// when the loader cannot start, crashes, or runs out of time; `why` does not name the file.
std::string run_mesh_loader(std::string_view bytes, const std::string& ending,
                            const MeshLoading& loading);

}  // namespace rend

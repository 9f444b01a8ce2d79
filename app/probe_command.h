// `rend probe`: one material point driven along a path of deformation gradients.
#pragma once

#include "engine/scene/scene_desc.h"

#include <filesystem>
#include <iosfwd>
#include <string>

namespace rend {

/// Reads F11,F12,...,F33 rows from a CSV file and prints step, F, tau [Pa], tau_c [Pa], yielded, dissipation [J/m3].
/// @throws Error naming file and line.
void probe_material(const SceneDesc& scene, const std::string& material, const std::filesystem::path& path,
                    std::ostream& out);

}  // namespace rend

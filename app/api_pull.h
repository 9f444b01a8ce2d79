// The pull tool of a viewer: what a request asks for, and a grip that suits a scene.
#pragma once

#include "app/session.h"

#include <nlohmann/json_fwd.hpp>

namespace rend {

/// A grip that can tear the scene's matter and is small against its bodies.
struct Grip {
  Real radius = 0;    ///< [m]
  Real strength = 0;  ///< [N], one and a half times what the grip's cross-section bears
};
Grip suitable_grip(const Stage& stage);

/// {"at", "target", "radius", "strength"} begins a spring from `at` to `target`, {"target",
/// "radius", "strength"} moves the one that acts, {"at", "force", "radius"} is a constant force,
/// and radius 0 lets go. A spring reaches its strength [N] when it is as long as the grip is wide.
/// `body` is the JSON text. @throws Error with a JSON pointer.
SetPull read_pull(const std::string& body);

/// The pull as viewers are told; null when there is none.
nlohmann::json pull_json(const PullForce& pull);

}  // namespace rend

// `rend serve`: the session behind a web server until a signal ends it.
#pragma once

#include "app/scene_library.h"
#include "render/renderer.h"
#include "web/server.h"

#include <string>

namespace rend {

struct ServeOptions {
  web::ServerOptions server;
  std::string scene;  ///< name of an offered scene
  GlBackend gl = GlBackend::automatic;
};

/// Prints the URL and serves until SIGINT or SIGTERM. Returns the exit code.
/// @throws Error when the port is taken, the scene is unknown or no GL context can be made.
int serve(SceneLibrary library, const ServeOptions& options);

}  // namespace rend

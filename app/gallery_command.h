// `rend gallery`: runs the scenes and leaves pictures, measured figures and a page about them.
#pragma once

#include "app/scene_library.h"
#include "render/renderer.h"

#include <filesystem>
#include <string>
#include <vector>

namespace rend {

struct GalleryOptions {
  std::filesystem::path out;  ///< folder of the page
  std::filesystem::path
      thumbs;  ///< folder of the thumbnails that the program embeds; empty writes none
  std::vector<std::string> only;  ///< scenes to run; empty runs all
  int accumulate = 16;            ///< render passes per picture
  GlBackend gl = GlBackend::automatic;
};

/// Runs each scene to its end: NAME.jpg at two thirds of the run, NAME_strip.jpg with five frames,
/// figures.csv and README.md. Scenes that are not run keep the figures of the last time. A scene
/// whose mesh file is missing is left out with a note. Returns the exit code: 0, or 4 when a run
/// stopped early. @throws Error when the disk refuses.
int make_gallery(const SceneLibrary& library, const GalleryOptions& options);

}  // namespace rend

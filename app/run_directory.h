// A run directory: scene.json, frames.csv, png/, mesh/, particles/, record/; written file by file, each renamed when whole.
#pragma once

#include "app/frame_formats.h"
#include "app/frame_table.h"
#include "app/pipeline.h"
#include "app/view.h"
#include "render/renderer.h"

#include <filesystem>
#include <optional>
#include <string>

namespace rend {

struct OutputOptions {
  std::filesystem::path out;
  bool png = true, record = true;
  std::vector<std::string> formats = {"ply"};  ///< of mesh/ and particles/, see frame_formats.h
  int width = 1280, height = 720;
  int accumulate = 8;  ///< render passes per picture
  int png_level = 1;
  GlBackend gl = GlBackend::automatic;
};

class RunDirectory {
 public:
  /// Makes the folders and writes scene.json. @throws Error when the disk refuses or no GL context can be made.
  RunDirectory(OutputOptions options, const Stage& stage, const Model& model);

  /// Writes what one frame leaves behind and its row of the table.
  void write(const Frame& frame);

 private:
  double write_picture(const Frame& frame, const std::string& name);

  OutputOptions options_;
  const Stage& stage_;
  const Model& model_;
  std::uint64_t fingerprint_;
  std::optional<FrameFiles> files_;
  std::optional<Renderer> renderer_;
  std::string table_;
};

}  // namespace rend

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
  /// Makes the folders and writes scene.json. With `keep` > 0 a run goes on after that frame: the table keeps its rows
  /// up to there. @throws Error when the disk refuses, no GL context can be made or a row is missing.
  RunDirectory(OutputOptions options, const Stage& stage, const Model& model, Index keep = 0);

  /// Writes what one frame leaves behind and its row of the table.
  void write(const Frame& frame);

  /// The frame that record/ keeps. @throws Error when it is missing or damaged.
  Snapshot recorded(Index frame) const;

 private:
  std::filesystem::path record_file(Index frame) const;
  double write_picture(const Frame& frame, const std::string& name);

  OutputOptions options_;
  const Stage& stage_;
  const Model& model_;
  std::uint64_t fingerprint_;
  std::optional<FrameFiles> files_;
  std::optional<Renderer> renderer_;
  std::string table_;
};

/// Removes checkpoints, frames and series of an earlier run, so that no frame of it is taken for one of the next.
void drop_earlier_run(const std::filesystem::path& run_directory);

}  // namespace rend

// A run directory.
#include "app/run_directory.h"

#include "app/checkpoint.h"
#include "app/record.h"
#include "app/write_file.h"
#include "engine/core/error.h"
#include "engine/scene/scene_reader.h"
#include "render/image_file.h"

#include <fmt/format.h>

#include <chrono>
#include <fstream>

namespace rend {

namespace {

/// Mesh files are named by where they were found, so that the copy reads from any folder.
SceneDesc with_found_meshes(SceneDesc scene) {
  for (BodyDesc& body : scene.bodies)
    if (auto* mesh = std::get_if<MeshDesc>(&body.shape)) mesh->file = std::filesystem::absolute(mesh->path);
  return scene;
}

/// Header and rows 1..count of a table that an earlier run wrote.
std::string first_rows(const std::filesystem::path& file, Index count) {
  std::ifstream in(file);
  std::string line, table;
  for (Index n = 0; n <= count; ++n) {
    if (!std::getline(in, line)) throw Error(file.string(), fmt::format("has no row for frame {}", n));
    const bool right = n == 0 ? line + "\n" == frame_table_header() : line.starts_with(fmt::format("{},", n));
    if (!right) throw Error(file.string(), fmt::format("line {} is not what this version of rend writes", n + 1));
    table += line + "\n";
  }
  return table;
}

}  // namespace

void drop_earlier_run(const std::filesystem::path& run_directory) {
  namespace fs = std::filesystem;
  drop_checkpoints(run_directory);
  std::error_code ignored;
  for (const char* series : {"mesh.pvd", "particles.pvd"}) fs::remove(run_directory / series, ignored);
  for (const char* folder : {"png", "mesh", "particles", "record"}) {
    std::vector<fs::path> frames;
    for (const auto& entry : fs::directory_iterator(run_directory / folder, ignored)) {
      const std::string stem = entry.path().stem().string();
      if (stem.size() == 6 && stem.find_first_not_of("0123456789") == std::string::npos)
        frames.push_back(entry.path());
    }
    for (const fs::path& frame : frames) fs::remove(frame, ignored);
  }
}

RunDirectory::RunDirectory(OutputOptions options, const Stage& stage, const Model& model, Index keep)
    : options_(std::move(options)), stage_(stage), model_(model), fingerprint_(fingerprint(model)) {
  if (options_.png) renderer_.emplace(options_.gl);
  make_folder(options_.out);
  files_.emplace(options_.out, options_.formats);
  if (options_.png) make_folder(options_.out / "png");
  if (options_.record) make_folder(options_.out / "record");
  if (keep > 0) {
    table_ = first_rows(options_.out / "frames.csv", keep);
    return;
  }
  write_file(options_.out / "scene.json", write_scene(with_found_meshes(stage.scene)));
  table_ = frame_table_header();
}

std::filesystem::path RunDirectory::record_file(Index frame) const {
  return options_.out / "record" / fmt::format("{:06}.bin", frame);
}

Snapshot RunDirectory::recorded(Index frame) const { return read_snapshot(record_file(frame), fingerprint_); }

double RunDirectory::write_picture(const Frame& frame, const std::string& name) {
  const auto start = std::chrono::steady_clock::now();
  const View view = default_view(stage_.scene);
  const Drawing drawing = make_drawing(stage_, frame, view);
  const Image image = renderer_->draw(drawing.list, view.camera, {options_.width, options_.height, options_.accumulate});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_png(options_.out / "png" / (name + ".png"), image, options_.png_level);
  return seconds;
}

void RunDirectory::write(const Frame& frame) {
  const std::string name = fmt::format("{:06}", frame.snapshot->frame);
  FrameCost cost{frame.fracture.seconds, 0};
  if (renderer_) cost.render_seconds = write_picture(frame, name);
  files_->write(name, *frame.surface, *frame.snapshot, model_);
  if (options_.record) write_file(record_file(frame.snapshot->frame), encode_snapshot(*frame.snapshot, fingerprint_));
  table_ += frame_table_row(frame, cost);
  write_file(options_.out / "frames.csv", table_);
}

}  // namespace rend

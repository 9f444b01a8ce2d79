// A run directory.
#include "app/run_directory.h"

#include "app/record.h"
#include "app/write_file.h"
#include "engine/core/error.h"
#include "engine/scene/scene_reader.h"
#include "render/image_file.h"

#include <fmt/format.h>

#include <chrono>

namespace rend {

namespace {

/// Mesh files are named by where they were found, so that the copy reads from any folder.
SceneDesc with_found_meshes(SceneDesc scene) {
  for (BodyDesc& body : scene.bodies)
    if (auto* mesh = std::get_if<MeshDesc>(&body.shape)) mesh->file = std::filesystem::absolute(mesh->path);
  return scene;
}

}  // namespace

RunDirectory::RunDirectory(OutputOptions options, const Stage& stage, const Model& model)
    : options_(std::move(options)), stage_(stage), model_(model), fingerprint_(fingerprint(model)) {
  if (options_.png) renderer_.emplace(options_.gl);
  make_folder(options_.out);
  files_.emplace(options_.out, options_.formats);
  if (options_.png) make_folder(options_.out / "png");
  if (options_.record) make_folder(options_.out / "record");
  write_file(options_.out / "scene.json", write_scene(with_found_meshes(stage.scene)));
  table_ = frame_table_header();
}

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
  if (options_.record) write_file(options_.out / "record" / (name + ".bin"), encode_snapshot(*frame.snapshot, fingerprint_));
  table_ += frame_table_row(frame, cost);
  write_file(options_.out / "frames.csv", table_);
}

}  // namespace rend

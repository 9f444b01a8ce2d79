// `rend run`.
#include "app/run_command.h"

#include "app/frame_table.h"
#include "app/ply.h"
#include "app/progress.h"
#include "app/view.h"
#include "engine/core/error.h"
#include "engine/scene/scene_reader.h"
#include "render/image_file.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>

namespace rend {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kMemoryLimit = 16e9;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) throw Error(folder.string(), "cannot create the folder: " + code.message());
}

/// Writes what one frame leaves behind in a run directory.
class RunDirectory {
 public:
  RunDirectory(const RunOptions& options, const SceneDesc& scene) : options_(options) {
    make_folder(options.out);
    if (options.png) make_folder(options.out / "png");
    if (options.ply) {
      make_folder(options.out / "mesh");
      make_folder(options.out / "particles");
    }
    write_file(options.out / "scene.json", write_scene(scene));
    if (options.png) renderer_.emplace(options.gl);
    table_ = frame_table_header();
  }

  void write(const Pipeline& pipeline, const Stage& stage, const Frame& frame) {
    FrameCost cost{frame.fracture.seconds, 0};
    const std::string name = fmt::format("{:06}", frame.snapshot->frame);
    if (renderer_) {
      const Clock::time_point start = Clock::now();
      const View view = default_view(stage.scene);
      const Drawing drawing = make_drawing(stage, frame, view);
      const Image image =
          renderer_->draw(drawing.list, view.camera, {options_.width, options_.height, options_.accumulate});
      cost.render_seconds = seconds_since(start);
      write_png(options_.out / "png" / (name + ".png"), image, options_.png_level);
    }
    if (options_.ply) {
      write_file(options_.out / "mesh" / (name + ".ply"), surface_ply(*frame.surface));
      write_file(options_.out / "particles" / (name + ".ply"), particles_ply(*frame.snapshot, pipeline.model()));
    }
    table_ += frame_table_row(frame, cost);
    write_file(options_.out / "frames.csv", table_);
  }

 private:
  const RunOptions& options_;
  std::optional<Renderer> renderer_;
  std::string table_;
};

}  // namespace

int run_scene(const SceneDesc& scene, const RunOptions& options) {
  const int frames = options.frames > 0 ? options.frames : scene.frames;
  const Clock::time_point start = Clock::now();
  ProgressLine preparing("preparing");
  const auto show = [&](const char* stage, double share) { preparing.show(share, stage); };
  Pipeline pipeline(scene, std::make_shared<Model>(build_model(scene, kMemoryLimit, show)));
  for (const std::string& note : pipeline.model().notes) fmt::print(stderr, "note: {}\n", note);
  preparing.finish(fmt::format("{} particles, {} tets in {}; {}", pipeline.model().particle_count(),
                               pipeline.model().tets.size(), duration_text(seconds_since(start)),
                               pipeline.solver_choice()));
  const Stage stage = make_stage(scene, pipeline.model());
  RunDirectory directory(options, scene);
  ProgressLine running("running");
  for (int n = 1; n <= frames; ++n) {
    const Frame frame = pipeline.advance();
    directory.write(pipeline, stage, frame);
    const FrameReport& report = frame.snapshot->report;
    if (report.status != Status::ok) {
      running.finish(fmt::format("stopped in frame {}: {}", n, report.reason));
      return 4;
    }
    running.show(static_cast<double>(n) / frames,
                 fmt::format("frame {} of {}, {} steps, {} pieces", n, frames, report.substeps, frame.fracture.pieces));
  }
  running.finish(fmt::format("{} frames in {}, written to {}", frames, duration_text(seconds_since(start)),
                             options.out.string()));
  return 0;
}

}  // namespace rend

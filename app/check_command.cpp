// `rend check`.
#include "app/check_command.h"

#include "app/pipeline.h"
#include "app/progress.h"

#include <fmt/format.h>

#include <chrono>

namespace rend {

namespace {

constexpr double kMemoryLimit = 16e9;  // bytes
constexpr double kTrialSeconds = 1.0;

/// Substeps of the first frame that fit into a second, to tell what a whole frame will take.
struct Trial {
  Index substeps = 0;
  double seconds = 0, share_of_frame = 0;
};

Trial time_first_frame(Pipeline& pipeline) {
  using Clock = std::chrono::steady_clock;
  Trial trial;
  const Clock::time_point start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  pipeline.advance([&] {
    ++trial.substeps;
    return elapsed() < kTrialSeconds;
  });
  trial.seconds = elapsed();
  trial.share_of_frame = pipeline.solver().time() * pipeline.scene().frame_rate;
  return trial;
}

}  // namespace

void check_scene(const SceneDesc& scene) {
  const ModelEstimate estimate = estimate_model(scene);
  fmt::print("scene        {}: {}\n", scene.name, scene.description);
  fmt::print("estimate     {:.0f} particles, {:.1f} MB\n", estimate.particles, estimate.bytes / 1e6);
  Pipeline pipeline(scene, std::make_shared<Model>(build_model(scene, kMemoryLimit)));
  const Model& model = pipeline.model();
  for (const std::string& note : model.notes) fmt::print("note         {}\n", note);
  fmt::print("particles    {}\ntets         {}\n", model.particle_count(), model.tets.size());
  fmt::print("solver       {}\n             {}\n", pipeline.solver().describe(), pipeline.solver_choice());
  fmt::print("memory       {:.0f} bytes per particle in the solver\n", pipeline.solver().bytes_per_particle());
  const Trial trial = time_first_frame(pipeline);
  if (trial.share_of_frame > 0)
    fmt::print("frame        {:.0f} steps of about {:.3g} s, {}\n", trial.substeps / trial.share_of_frame,
               pipeline.solver().time() / trial.substeps, duration_text(trial.seconds / trial.share_of_frame));
}

}  // namespace rend

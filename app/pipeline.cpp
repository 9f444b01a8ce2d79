// Scene to frames.
#include "app/pipeline.h"

#include <utility>

namespace rend {

Frame mesh_frame(FractureMesh& fracture, std::shared_ptr<const Snapshot> snapshot) {
  fracture.update(*snapshot);
  Frame frame;
  frame.surface = std::make_shared<SurfaceMesh>(fracture.surface(*snapshot));
  frame.nearness = std::make_shared<std::vector<float>>(fracture.nearness());
  frame.fracture = fracture.report();
  frame.snapshot = std::move(snapshot);
  return frame;
}

Pipeline::Pipeline(SceneDesc scene, std::shared_ptr<const Model> model)
    : scene_(std::move(scene)),
      model_(std::move(model)),
      solver_(make_solver(scene_, *model_, &solver_choice_)),
      fracture_(scene_, *model_) {}

Frame Pipeline::make_frame(FrameReport report) {
  auto snapshot = std::make_shared<Snapshot>(solver_->snapshot());
  report.frame = frame_;
  snapshot->frame = frame_;
  snapshot->report = std::move(report);
  return mesh_frame(fracture_, std::move(snapshot));
}

Frame Pipeline::current() { return make_frame(solver_->advance(0)); }

Frame Pipeline::advance(const BetweenSteps& between) {
  if (frame_end_ <= solver_->time()) frame_end_ = (frame_ + 1) / scene_.frame_rate;
  bool ended_early = false;
  const BetweenSteps watch = [&] {
    if (!between || between()) return true;
    ended_early = true;
    return false;
  };
  FrameReport report = solver_->advance(frame_end_ - solver_->time(), watch);
  if (ended_early) return {};
  if (report.status == Status::ok) ++frame_;
  return make_frame(std::move(report));
}

void Pipeline::resume(Index frame, std::istream& state, const std::function<Snapshot(Index)>& recorded) {
  solver_->load(state);
  fracture_ = fracture_.fresh(scene_.fracture);
  for (Index n = 1; n <= frame; ++n) fracture_.update(recorded(n));
  frame_ = frame;
  frame_end_ = solver_->time();
}

void Pipeline::apply(const SceneDesc& changed) {
  for (std::size_t i = 0; i < scene_.materials.size(); ++i)
    if (!(changed.materials[i] == scene_.materials[i])) solver_->set_material(i, changed.materials[i]);
  if (changed.gravity != scene_.gravity) solver_->set_gravity(changed.gravity);
  if (!(scene_.materials == changed.materials)) fracture_.set_materials(changed.materials);
  scene_.materials = changed.materials;
  scene_.gravity = changed.gravity;
}

void Pipeline::remesh(const FractureDesc& settings, std::vector<Frame>& recorded) {
  scene_.fracture = settings;
  fracture_ = fracture_.fresh(settings);
  for (Frame& frame : recorded) frame = mesh_frame(fracture_, frame.snapshot);
}

}  // namespace rend

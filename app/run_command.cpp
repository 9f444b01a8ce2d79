// `rend run` and `rend remesh`.
#include "app/run_command.h"

#include "app/checkpoint.h"
#include "app/progress.h"
#include "app/record.h"
#include "app/say.h"
#include "app/write_file.h"
#include "engine/core/error.h"
#include "engine/mpm/energy_balance.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <sstream>

namespace rend {

namespace {

constexpr double kMemoryLimit = 16e9;  // bytes

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::shared_ptr<Model> prepare_model(const SceneDesc& scene) {
  const Clock::time_point start = Clock::now();
  ProgressLine line("preparing");
  auto model = std::make_shared<Model>(
      build_model(scene, kMemoryLimit, [&](const char* stage, double share) { line.show(share, stage); }));
  line.finish(fmt::format("{} particles, {} tets in {}", model->particle_count(), model->tets.size(),
                          duration_text(seconds_since(start))));
  for (const std::string& note : model->notes) say("note: {}\n", note);
  return model;
}

std::vector<std::filesystem::path> recorded_files(const std::filesystem::path& run_directory) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(run_directory / "record", ignored))
    if (entry.path().extension() == ".bin") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw Error((run_directory / "record").string(), "holds no recorded frames; run without --no-record");
  return files;
}

Index frame_of(const std::filesystem::path& record) { return std::atoi(record.stem().c_str()); }

/// @throws Error when a frame between the first and the last is missing, and for a wanted one that is not there.
void check_frames(const std::vector<std::filesystem::path>& records, const std::vector<int>& wanted) {
  const Index first = frame_of(records.front()), last = frame_of(records.back());
  for (std::size_t n = 0; n < records.size(); ++n)
    if (const Index frame = first + static_cast<Index>(n); frame_of(records[n]) != frame)
      throw Error(records[n].parent_path().string(), fmt::format("has no frame {}, but later ones", frame));
  for (const int frame : wanted)
    if (frame < first || frame > last)
      throw Error("--only", fmt::format("{} is not recorded; {} to {} are", frame, first, last));
}

/// What became of the energy, and when the balance first left its bounds.
class EnergyWatch {
 public:
  void see(const FrameReport& report) {
    if (first_warned_ < 0 && !energy_warning(report).empty()) first_warned_ = report.frame;
    last_ = report;
  }
  void tell() const {
    const FrameReport& r = last_;
    say("energy: kinetic {:.4g} J, elastic {:.4g} J, gravity {:.4g} J, dissipated {:.4g} J, friction {:.4g} J, "
               "external work {:.4g} J, transfer loss {:.4g} J ({:.1f} % of the turnover)\n",
               r.kinetic_energy + r.affine_energy, r.elastic_energy, r.gravity_energy, r.dissipated_energy,
               r.friction_energy, r.external_work, r.transfer_loss, 100 * energy_drift(r));
    const std::string warning = energy_warning(r);
    if (!warning.empty()) say("warning: {}\n", warning);
    else if (first_warned_ >= 0)
      say("warning: the energy balance was out of bounds from frame {} on for a while; see energy_drift in frames.csv\n", first_warned_);
  }

 private:
  Index first_warned_ = -1;
  FrameReport last_;
};

/// The newest checkpoint that is whole; says which ones are not.
Checkpoint newest_checkpoint(const std::filesystem::path& run_directory, std::uint64_t scene_hash) {
  std::optional<Error> first;
  for (const auto& file : checkpoint_files(run_directory)) {
    try {
      return read_checkpoint(file, scene_hash);
    } catch (const Error& error) {
      if (first) throw *first;
      first = error;
      if (checkpoint_files(run_directory).size() > 1)
        say("note: {}; trying the one before\n", error.what());
    }
  }
  throw *first;
}

/// Puts the pipeline after the frame of a checkpoint.
void go_on(Pipeline& pipeline, const Checkpoint& from, const RunDirectory& directory) {
  std::istringstream state(from.state);
  pipeline.resume(from.frame, state, [&](Index frame) { return directory.recorded(frame); });
  say("going on after frame {}\n", from.frame);
}

}  // namespace

int run_scene(const SceneDesc& scene, const RunOptions& options) {
  const int frames = options.frames > 0 ? options.frames : scene.frames;
  const std::uint64_t hash = motion_hash(scene);
  check_folder(options.output.out);  // before minutes of preparation
  Checkpoint from;
  if (options.resume) from = newest_checkpoint(options.output.out, hash);
  if (from.frame >= frames) {
    say("nothing to do: {} frames are there\n", from.frame);
    return 0;
  }
  const auto model = prepare_model(scene);
  Pipeline pipeline(scene, model);
  say("{}\n", pipeline.solver_choice());
  const Stage stage = make_stage(scene, *model);
  if (!options.resume) drop_earlier_run(options.output.out);
  RunDirectory directory(options.output, stage, *model, from.frame);
  if (options.resume) go_on(pipeline, from, directory);
  // Solver and fracture mesh have tables of their own.
  model->tets = std::vector<Tet>();
  model->velocity = std::vector<Vec3>();
  const Clock::time_point start = Clock::now();
  EnergyWatch energy;
  ProgressLine line("running");
  for (int n = static_cast<int>(from.frame) + 1; n <= frames; ++n) {
    const Frame frame = pipeline.advance();
    const FrameReport& report = frame.snapshot->report;
    energy.see(report);
    if (report.status != Status::ok) {
      line.finish(fmt::format("stopped in frame {}: {}", n, report.reason));
      energy.tell();
      return 4;  // the last good frame is there already
    }
    directory.write(frame);
    if (options.checkpoint_every > 0 && n % options.checkpoint_every == 0) {
      std::ostringstream state;
      pipeline.save(state);
      write_checkpoint(options.output.out, {n, std::move(state).str()}, hash);
    }
    line.show(static_cast<double>(n) / frames,
              fmt::format("frame {} of {}, {} steps, {} pieces", n, frames, report.substeps, frame.fracture.pieces));
  }
  line.finish(fmt::format("{} frames in {}, written to {}", frames, duration_text(seconds_since(start)),
                          options.output.out.string()));
  energy.tell();
  return 0;
}

int remesh_run(const SceneDesc& scene, const std::filesystem::path& run_directory, const OutputOptions& options,
               const std::vector<int>& only) {
  const auto files = recorded_files(run_directory);
  check_frames(files, only);
  std::error_code ignored;
  if (std::filesystem::equivalent(run_directory, options.out, ignored))
    throw Error("--out", "is the run itself; choose another folder");
  check_folder(options.out);
  const auto model = prepare_model(scene);
  const std::uint64_t wanted = fingerprint(*model);
  const Stage stage = make_stage(scene, *model);
  const Clock::time_point start = Clock::now();
  ProgressLine line("remeshing");
  // First what breaks when, then the surfaces: crack faces are smoothed knowing how the run ends.
  FractureMesh live(scene, *model);
  std::vector<std::vector<float>> nearness;
  for (const auto& file : files) {
    live.update(read_snapshot(file, wanted));
    if (scene.render.color_by == "threshold") nearness.push_back(live.nearness());
  }
  RunDirectory directory(options, stage, *model);  // only now: every record has been read
  FractureMesh fracture = live.playback(live.break_table());
  for (std::size_t n = 0; n < files.size(); ++n) {
    auto snapshot = std::make_shared<const Snapshot>(read_snapshot(files[n], wanted));
    if (!nearness.empty()) fracture.set_nearness(std::move(nearness[n]));
    if (!only.empty() && std::find(only.begin(), only.end(), snapshot->frame) == only.end()) continue;
    directory.write(mesh_frame(fracture, std::move(snapshot)));
    line.show(static_cast<double>(n + 1) / static_cast<double>(files.size()),
              fmt::format("frame {} of {}, {} pieces", n + 1, files.size(), fracture.report().pieces));
  }
  line.finish(fmt::format("{} frames in {}, written to {}", files.size(), duration_text(seconds_since(start)),
                          options.out.string()));
  return 0;
}

}  // namespace rend

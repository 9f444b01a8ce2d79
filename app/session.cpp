// The running scene.
#include "app/session.h"

#include "engine/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

namespace rend {

namespace {

constexpr double kModelLimit = 8e9;      // bytes; leaves room for recorded frames on a 16 GB machine
constexpr std::chrono::seconds kLongestSilence{5};
constexpr double kRecordingLimit = 4e9;  // bytes; beyond it the oldest frames are dropped

/// Thrown through a progress callback when another scene was asked for; never leaves this file.
struct Abandoned {};

double bytes_of(const RecordedFrame& r) {
  const double particles = static_cast<double>(r.frame.snapshot->x.size());
  return particles * (sizeof(Vec3) + sizeof(Vec3f) + 13) + r.frame.surface->vertex_count() * 80.0 +
         r.frame.surface->triangle_count() * 17.0;
}

std::vector<Event> new_events(const RecordedFrame* before, const Frame& now) {
  std::vector<Event> events;
  const Index frame = now.snapshot->frame;
  const FrameReport& report = now.snapshot->report;
  const bool yielded_before = before && before->frame.snapshot->report.yielded > 0;
  if (report.yielded > 0 && !yielded_before) events.push_back({frame, "first yield"});
  const Index pieces_before = before ? before->frame.fracture.pieces : now.fracture.pieces;
  if (now.fracture.pieces > pieces_before && pieces_before == 1)
    events.push_back({frame, fmt::format("{} pieces", now.fracture.pieces)});
  return events;
}

}  // namespace

const char* run_state_name(RunState state) {
  switch (state) {
    case RunState::preparing: return "preparing";
    case RunState::paused: return "paused";
    case RunState::playing: return "playing";
    case RunState::finished: return "finished";
    case RunState::stopped: return "stopped";
  }
  return "";
}

template <class Change>
void Session::update(Change&& change) {
  {
    const std::lock_guard lock(mutex_);
    change(state_);
    ++state_.revision;
  }
  wake_.notify_all();
}

Session::Session(SceneLibrary library, std::string first_scene)
    : library_(std::move(library)), scene_to_load_(std::move(first_scene)) {
  state_.revision = 1;
  state_.scene_name = *scene_to_load_;
  thread_ = std::thread([this] { run(); });
}

Session::~Session() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Session::send(Command command) {
  if (const auto* load = std::get_if<LoadScene>(&command)) {
    const std::vector<std::string> names = library_.names();
    if (std::find(names.begin(), names.end(), load->name) == names.end())
      throw Error("/name", "there is no scene \"" + load->name + "\"");
  }
  {
    const std::lock_guard lock(mutex_);
    if (const auto* set = std::get_if<SetValues>(&command)) {
      SceneDesc trial = queued_scene_ ? *queued_scene_ : state_.stage ? state_.stage->scene : SceneDesc{};
      set_values(trial, state_.controls, set->values);
      queued_scene_ = std::move(trial);
    }
    queue_.push_back(std::move(command));
  }
  wake_.notify_all();
}

SessionState Session::state(std::uint64_t after, double wait_seconds, const std::atomic<bool>* stopping) const {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(wait_seconds);
  std::unique_lock lock(mutex_);
  while (state_.revision <= after && std::chrono::steady_clock::now() < deadline && !(stopping && *stopping))
    wake_.wait_for(lock, std::chrono::milliseconds(50));
  return state_;
}

std::shared_ptr<const RecordedFrame> Session::frame(Index number) const {
  const std::lock_guard lock(mutex_);
  if (recorded_.empty()) return nullptr;
  if (number < 0) return recorded_.back();
  const Index slot = number - state_.first_frame;
  return slot >= 0 && slot < static_cast<Index>(recorded_.size()) ? recorded_[static_cast<std::size_t>(slot)] : nullptr;
}

std::vector<std::shared_ptr<const RecordedFrame>> Session::frames_from(Index from) const {
  const std::lock_guard lock(mutex_);
  const Index slot = std::clamp<Index>(from - state_.first_frame, 0, static_cast<Index>(recorded_.size()));
  return {recorded_.begin() + slot, recorded_.end()};
}

std::pair<SessionState, std::vector<std::shared_ptr<const RecordedFrame>>> Session::recording(Index first,
                                                                                              Index last) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<const RecordedFrame>> frames;
  for (const auto& recorded : recorded_) {
    const Index number = recorded->frame.snapshot->frame;
    if (number >= first && number <= last) frames.push_back(recorded);
  }
  return {state_, frames};
}

std::vector<std::string> Session::command_log() const {
  const std::lock_guard lock(mutex_);
  return log_;
}

void Session::log(const std::string& json) {
  const double time = pipeline_ ? pipeline_->solver().time() : 0;
  const std::lock_guard lock(mutex_);
  log_.push_back(fmt::format("{{\"time\":{},{}}}", time, json));
}

void Session::run() {
  while (true) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return quit_ || !queue_.empty() || scene_to_load_ || restart_needed_ || wants_step(); });
      if (quit_) return;
    }
    try {
      work();
    } catch (const Error& error) {
      stop(error.what());
    } catch (const std::bad_alloc&) {
      stop("not enough memory for this scene; choose a larger grid.dx or fewer particles_per_cell");
    }
  }
}

void Session::work() {
  apply_queue();
  if (scene_to_load_) {
    const std::string name = *std::exchange(scene_to_load_, std::nullopt);
    prepare(name);
  } else if (restart_needed_) {
    start_pipeline();
  }
  if (remesh_needed_) remesh();
  if (pipeline_ && wants_step()) step_frame();
}

void Session::stop(const std::string& message) {
  restart_needed_ = remesh_needed_ = false;
  frames_to_step_ = 0;
  update([&](SessionState& s) {
    s.run = RunState::stopped;
    s.message = message;
  });
}

void Session::apply_queue() {
  std::deque<Command> commands;
  {
    const std::lock_guard lock(mutex_);
    commands.swap(queue_);
  }
  for (const Command& command : commands) apply(command);
  const std::lock_guard lock(mutex_);
  if (queue_.empty()) queued_scene_.reset();
}

void Session::apply(const Command& command) {
  const auto set_run = [&](RunState run) { update([&](SessionState& s) { s.run = run; }); };
  const bool ready = pipeline_ != nullptr && state_.run != RunState::stopped;
  if (const auto* load = std::get_if<LoadScene>(&command)) {
    scene_to_load_ = load->name;
    log(fmt::format("\"load\":\"{}\"", load->name));
  } else if (std::holds_alternative<Play>(command) && ready) {
    if (state_.run == RunState::finished) restart_needed_ = true;
    set_run(RunState::playing);
  } else if (std::holds_alternative<Pause>(command) && state_.run == RunState::playing) {
    frames_to_step_ = 0;
    set_run(RunState::paused);
  } else if (const auto* step = std::get_if<Step>(&command); step && ready && state_.run != RunState::finished) {
    frames_to_step_ = step->frames;
    set_run(RunState::paused);
  } else if (std::holds_alternative<Reset>(command) && pipeline_) {
    restart_needed_ = true;
    frames_to_step_ = 0;
    log("\"reset\":true");
    if (state_.run != RunState::playing) set_run(RunState::paused);
  } else if (const auto* set = std::get_if<SetValues>(&command); set && pipeline_) {
    apply_values(set->values);
  } else if (const auto* pull = std::get_if<SetPull>(&command); pull && pipeline_) {
    set_pull(*pull);
    if (pull->pull.radius > 0 && state_.run == RunState::paused) set_run(RunState::playing);
  }
}

void Session::apply_values(const ControlValues& values) {
  try {
    set_values(scene_, state_.controls, values);
  } catch (const Error&) {
    return;  // it was meant for a scene that another has replaced
  }
  bool live = false;
  for (const Control& control : state_.controls) {
    const auto value = values.find(control.id);
    if (value == values.end()) continue;
    (control.applies == Applies::live ? live : remesh_needed_) = true;
    log(fmt::format("\"set\":\"{}\",\"value\":{}", control.id, value->second));
  }
  if (live) pipeline_->apply(scene_);
  auto stage = std::make_shared<Stage>(*state_.stage);
  stage->scene = scene_;
  update([&](SessionState& s) { s.stage = std::move(stage); });
}

void Session::set_pull(const SetPull& set) {
  PullForce pull = set.pull;
  if (set.keeps_grip) {
    if (!pipeline_->pull().is_spring()) return;
    pull = pipeline_->pull();
    pull.target = set.pull.target;
    pull.radius = set.pull.radius;
    pull.stiffness = set.pull.stiffness;
    pull.strongest = set.pull.strongest;
  }
  pipeline_->set_pull(pull);
  pull_heard_ = std::chrono::steady_clock::now();
  const auto numbers = [](const Vec3& v) { return fmt::format("[{},{},{}]", v.x(), v.y(), v.z()); };
  log(fmt::format("\"pull\":{{\"at\":{},\"force\":{},\"radius\":{},\"target\":{},\"stiffness\":{},\"strongest\":{}}}",
                  numbers(pull.at), numbers(pull.force), pull.radius, numbers(pull.target), pull.stiffness,
                  pull.strongest));
  update([&](SessionState& s) { s.pull = pull; });
}

void Session::release_forgotten_pull() {
  // A viewer that holds a spring speaks at least once a second; one that left must not pull for ever.
  if (pipeline_->pull().is_spring() && std::chrono::steady_clock::now() - pull_heard_ > kLongestSilence) set_pull({});
}

bool Session::keep_stepping() {
  // A pull only adds force to the steps to come. All else waits for a complete state: the advance ends early and the
  // frame goes on after it.
  const auto is_pull = [](const Command& c) { return std::holds_alternative<SetPull>(c); };
  {
    const std::lock_guard lock(mutex_);
    if (!std::all_of(queue_.begin(), queue_.end(), is_pull)) return false;
  }
  apply_queue();
  release_forgotten_pull();
  const std::lock_guard lock(mutex_);
  return !quit_ && !scene_to_load_ && !restart_needed_ && wants_step();
}

void Session::prepare(const std::string& name) {
  // Nothing of the scene before stays: its title, views and frames would be taken for those of the new one.
  pipeline_.reset();
  model_.reset();
  recorded_bytes_ = 0;
  update([&](SessionState& s) {
    s.run = RunState::preparing;
    s.scene_name = name;
    s.stage.reset();
    s.model.reset();
    s.loaded.reset();
    s.controls.clear();
    s.notes.clear();
    s.events.clear();
    s.pull = {};
    recorded_.clear();
    s.first_frame = 0;
    s.last_frame = -1;
    ++s.data;
    s.message.clear();
    s.progress_stage = "reading";
    s.progress_share = 0;
  });
  try {
    const SceneDesc scene = library_.read(name);
    auto model = std::make_shared<Model>(build_model(scene, kModelLimit, [&](const char* stage, double share) {
      {
        const std::lock_guard lock(mutex_);
        const bool other = std::any_of(queue_.begin(), queue_.end(),
                                       [](const Command& c) { return std::holds_alternative<LoadScene>(c); });
        if (quit_ || other) throw Abandoned{};
      }
      update([&](SessionState& s) {
        s.progress_stage = stage;
        s.progress_share = share;
      });
    }));
    scene_ = scene;
    model_ = std::move(model);
    const auto stage = std::make_shared<Stage>(make_stage(scene_, *model_));
    update([&](SessionState& s) {
      s.stage = stage;
      s.model = model_;
      s.loaded = std::make_shared<SceneDesc>(scene_);
      s.controls = make_controls(scene_);
      queued_scene_.reset();
      s.notes = model_->notes;
    });
    start_pipeline();
  } catch (const Abandoned&) {
  }
}

void Session::start_pipeline() {
  restart_needed_ = remesh_needed_ = false;
  pipeline_.reset();
  pipeline_ = std::make_unique<Pipeline>(scene_, model_);
  recorded_bytes_ = 0;
  frames_to_step_ = 0;
  record(pipeline_->current(), Recording::anew);
}

void Session::step_frame() {
  const auto start = std::chrono::steady_clock::now();
  Frame frame = pipeline_->advance([&] { return keep_stepping(); });
  if (!frame.snapshot) return;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const FrameReport report = frame.snapshot->report;
  record(std::move(frame));
  frames_to_step_ = std::max(0, frames_to_step_ - 1);
  update([&](SessionState& s) {
    s.frames_per_second = seconds > 0 ? 1 / seconds : 0;
    s.pull = pipeline_->pull();
    if (report.status != Status::ok) {
      s.run = RunState::stopped;
      s.message = report.reason;
      frames_to_step_ = 0;
    } else if (report.frame >= scene_.frames) {
      s.run = RunState::finished;
      frames_to_step_ = 0;
    }
  });
}

void Session::record(Frame frame, Recording how) {
  auto recorded = std::make_shared<RecordedFrame>();
  recorded->cost.post_seconds = frame.fracture.seconds;
  recorded->frame = std::move(frame);
  const bool anew = how == Recording::anew;
  const RecordedFrame* before = anew || recorded_.empty() ? nullptr : recorded_.back().get();
  const std::vector<Event> events = new_events(before, recorded->frame);
  recorded_bytes_ += bytes_of(*recorded);
  update([&](SessionState& s) {
    if (anew) {
      recorded_.clear();
      s.first_frame = 0;
      s.pull = {};
      ++s.data;
      s.events.clear();
      s.message.clear();
      if (s.run != RunState::playing) s.run = RunState::paused;
    }
    const Index number = recorded->frame.snapshot->frame;
    if (!recorded_.empty() && s.last_frame == number) recorded_.pop_back();
    recorded_.push_back(recorded);
    s.last_frame = number;
    s.events.insert(s.events.end(), events.begin(), events.end());
    while (recorded_bytes_ > kRecordingLimit && recorded_.size() > 2) {
      recorded_bytes_ -= bytes_of(*recorded_.front());
      recorded_.pop_front();
      ++s.first_frame;
    }
  });
}

void Session::remesh() {
  remesh_needed_ = false;
  std::vector<Frame> frames;
  for (const auto& r : recorded_) frames.push_back(r->frame);
  pipeline_->remesh(scene_.fracture, frames);
  update([&](SessionState& s) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
      auto renewed = std::make_shared<RecordedFrame>(*recorded_[k]);
      renewed->frame = frames[k];
      recorded_[k] = std::move(renewed);
    }
    ++s.data;
  });
}

}  // namespace rend

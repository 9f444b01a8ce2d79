// A running scene that people watch and steer: one thread simulates, commands wait in one queue and are applied
// between steps, every finished frame is recorded.
#pragma once

#include "app/controls.h"
#include "app/frame_table.h"
#include "app/pipeline.h"
#include "app/scene_library.h"
#include "app/view.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace rend {

enum class RunState { preparing, paused, playing, finished, stopped };
const char* run_state_name(RunState state);

struct LoadScene { std::string name; };
struct Play {};
struct Pause {};
struct Step { int frames; };
struct Reset {};
struct SetValues { ControlValues values; };  ///< checked before it is queued
struct SetPull {
  PullForce pull;
  bool keeps_grip = false;  ///< the spring that acts goes on from its grip; without one nothing happens
};
using Command = std::variant<LoadScene, Play, Pause, Step, Reset, SetValues, SetPull>;

/// A moment that the timeline marks.
struct Event {
  Index frame;
  std::string name;
};

/// What viewers are told about the run; a copy, taken under the lock.
struct SessionState {
  std::uint64_t revision = 0;  ///< grows with every change
  std::uint64_t data = 0;      ///< grows when recorded frames are replaced (reset, other fracture settings)
  std::string scene_name;
  std::shared_ptr<const Stage> stage;  ///< null while the first scene is being prepared
  std::shared_ptr<const SceneDesc> loaded;  ///< the scene as its file says, for default values
  std::vector<Control> controls;
  RunState run = RunState::preparing;
  std::string message;                 ///< why the run stopped or a scene did not load
  std::string progress_stage;
  double progress_share = 0;
  Index first_frame = 0, last_frame = -1;  ///< recorded range
  double frames_per_second = 0;
  std::vector<Event> events;
  std::vector<std::string> notes;
  std::shared_ptr<const Model> model;  ///< of the stage's scene
  PullForce pull;                      ///< as it was at the newest frame
};

/// One recorded frame with what it cost.
struct RecordedFrame {
  Frame frame;
  FrameCost cost;
};

class Session {
 public:
  /// Starts the simulation thread and loads the first scene, paused at frame 0.
  Session(SceneLibrary library, std::string first_scene);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Queues a command. @throws Error for an unknown scene or control and for a value out of range.
  void send(Command command);

  /// The state as soon as its revision is above `after`, or the present one after `wait_seconds`.
  SessionState state(std::uint64_t after = 0, double wait_seconds = 0, const std::atomic<bool>* stopping = nullptr) const;

  /// A recorded frame, or the newest for -1; null when it is not recorded.
  std::shared_ptr<const RecordedFrame> frame(Index number) const;

  /// All recorded frames from number `from` on.
  std::vector<std::shared_ptr<const RecordedFrame>> frames_from(Index from) const;

  /// The state together with the recorded frames from `first` to `last`, all of the same moment.
  std::pair<SessionState, std::vector<std::shared_ptr<const RecordedFrame>>> recording(Index first, Index last) const;

  const SceneLibrary& library() const { return library_; }
  SceneLibrary& library() { return library_; }

  /// Every applied command as one JSON line with the simulated time; replays the run together with the scene.
  std::vector<std::string> command_log() const;

 private:
  void run();
  void work();
  void stop(const std::string& message);
  bool wants_step() const { return state_.run == RunState::playing || frames_to_step_ > 0; }
  void apply_queue();
  void apply(const Command& command);
  bool keep_stepping();
  void prepare(const std::string& name);
  void start_pipeline();
  void apply_values(const ControlValues& values);
  void set_pull(const SetPull& set);
  void release_forgotten_pull();
  void step_frame();
  /// With `anew` the frames so far go in the same moment: there is never a run without a frame.
  enum class Recording { on, anew };
  void record(Frame frame, Recording how = Recording::on);
  void remesh();
  void log(const std::string& json);

  /// Changes the shared state under the lock and wakes those who wait for it.
  template <class Change>
  void update(Change&& change);

  SceneLibrary library_;
  mutable std::mutex mutex_;
  mutable std::condition_variable wake_;
  std::deque<Command> queue_;
  std::optional<SceneDesc> queued_scene_;  ///< what queued values make of the scene; none when the queue is empty
  SessionState state_;  ///< written by the simulation thread only
  std::deque<std::shared_ptr<const RecordedFrame>> recorded_;
  std::vector<std::string> log_;
  bool quit_ = false;

  // Simulation thread only, from here on.
  SceneDesc scene_;                          ///< as loaded, with the viewers' changes
  std::shared_ptr<const Model> model_;
  std::unique_ptr<Pipeline> pipeline_;
  std::optional<std::string> scene_to_load_;
  bool restart_needed_ = false;
  bool remesh_needed_ = false;
  int frames_to_step_ = 0;                   ///< single steps that are still owed
  std::chrono::steady_clock::time_point pull_heard_;  ///< when a viewer last spoke of the pull
  double recorded_bytes_ = 0;

  std::thread thread_;                       ///< last: starts when everything else stands
};

}  // namespace rend

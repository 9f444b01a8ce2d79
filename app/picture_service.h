// Pictures on demand: one thread owns the GL context, equal requests share one picture.
#pragma once

#include "app/session.h"
#include "app/view.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace rend {

enum class PictureFormat { jpeg, jpeg_still, png };

/// Encoded bytes of one view of one frame.
struct Picture {
  std::string bytes;
  std::string caption;      ///< of the colour scale, with its unit; empty without one
  float low = 0, high = 1;  ///< ends of the colour scale, in that unit
  double render_seconds = 0, encode_seconds = 0;
};

/// Draws and encodes; between passes it asks whether to `keep_on`, and gives an empty picture when not. @throws Error
/// when drawing fails.
Picture draw_picture(Renderer& renderer, const Stage& stage, const Frame& frame, const View& view, PictureFormat format,
                     const std::function<bool()>& keep_on = {});

class PictureService {
 public:
  /// Starts the thread and makes the GL context in it. @throws Error when no context can be made.
  explicit PictureService(GlBackend backend);
  ~PictureService();
  PictureService(const PictureService&) = delete;
  PictureService& operator=(const PictureService&) = delete;

  /// Draws and encodes, or hands out the picture that equal requests got before. `frame_key` names the frame's
  /// contents. Null when the service is stopping. @throws Error when drawing fails.
  std::shared_ptr<const Picture> picture(const std::string& frame_key, std::shared_ptr<const Stage> stage,
                                         const Frame& frame, const View& view, PictureFormat format);

  GlBackend backend() const { return backend_; }
  const std::string& describe() const { return describe_; }
  double last_render_seconds() const { return last_render_seconds_; }
  double last_encode_seconds() const { return last_encode_seconds_; }

 private:
  struct Job;
  void run();
  std::shared_ptr<const Picture> remembered(const std::string& key);

  const GlBackend backend_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::shared_ptr<Job>> jobs_;
  std::list<std::pair<std::string, std::shared_ptr<const Picture>>> cache_;  ///< newest first
  std::string describe_, failure_;
  bool ready_ = false;
  std::atomic<bool> quit_ = false;
  std::atomic<double> last_render_seconds_ = 0, last_encode_seconds_ = 0;
  std::thread thread_;
};

}  // namespace rend

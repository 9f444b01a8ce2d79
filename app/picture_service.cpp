// Pictures on demand.
#include "app/picture_service.h"

#include "engine/core/error.h"
#include "render/image_file.h"

#include <algorithm>
#include <chrono>
#include <new>

namespace rend {

namespace {

constexpr std::size_t kRememberedPictures = 48;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string encode(const Image& image, PictureFormat format) {
  std::vector<std::uint8_t> bytes;
  switch (format) {
    case PictureFormat::jpeg: bytes = encode_jpeg(image, 85, false); break;
    case PictureFormat::jpeg_still: bytes = encode_jpeg(image, 92, true); break;
    case PictureFormat::png: bytes = encode_png(image, 3); break;
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Picture draw_picture(Renderer& renderer, const Stage& stage, const Frame& frame, const View& view, PictureFormat format,
                     const std::function<bool()>& keep_on) {
  Picture picture;
  const double start = now();
  Drawing drawing = make_drawing(stage, frame, view);
  picture.caption = drawing.list.coloring.caption;
  picture.low = drawing.list.coloring.low;
  picture.high = drawing.list.coloring.high;
  if (!view.legend) drawing.list.coloring.caption.clear();
  const Image image =
      renderer.draw(drawing.list, view.camera, {view.width, view.height, view.accumulate, keep_on});
  if (image.rgb.empty()) return picture;
  const double drawn = now();
  picture.bytes = encode(image, format);
  picture.render_seconds = drawn - start;
  picture.encode_seconds = now() - drawn;
  return picture;
}

struct PictureService::Job {
  std::string key;
  std::shared_ptr<const Stage> stage;
  Frame frame;
  View view;
  PictureFormat format;
  std::shared_ptr<const Picture> picture;
  std::string failure;
  bool done = false;
};

PictureService::PictureService(GlBackend backend) : backend_(backend), thread_([this] { run(); }) {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [&] { return ready_ || !failure_.empty(); });
  if (failure_.empty()) return;
  lock.unlock();
  thread_.join();
  throw Error("renderer", failure_);
}

PictureService::~PictureService() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

std::shared_ptr<const Picture> PictureService::remembered(const std::string& key) {
  const auto hit = std::find_if(cache_.begin(), cache_.end(), [&](const auto& entry) { return entry.first == key; });
  if (hit == cache_.end()) return nullptr;
  cache_.splice(cache_.begin(), cache_, hit);
  return hit->second;
}

std::shared_ptr<const Picture> PictureService::picture(const std::string& frame_key, std::shared_ptr<const Stage> stage,
                                                       const Frame& frame, const View& view, PictureFormat format) {
  const std::string key = frame_key + " " + view.key() + " " + std::to_string(static_cast<int>(format));
  std::unique_lock lock(mutex_);
  if (auto known = remembered(key)) return known;
  const auto waiting = std::find_if(jobs_.begin(), jobs_.end(), [&](const auto& job) { return job->key == key; });
  std::shared_ptr<Job> job;
  if (waiting != jobs_.end()) {
    job = *waiting;
  } else {
    job = std::make_shared<Job>(Job{key, std::move(stage), frame, view, format, nullptr, {}, false});
    jobs_.push_back(job);
    wake_.notify_all();
  }
  wake_.wait(lock, [&] { return job->done || quit_; });
  if (!job->failure.empty()) throw Error("picture", job->failure);
  return job->picture;
}

void PictureService::run() {
  std::unique_ptr<Renderer> renderer;
  try {
    renderer = std::make_unique<Renderer>(backend_);
  } catch (const Error& error) {
    const std::lock_guard lock(mutex_);
    failure_ = error.what();
  }
  {
    const std::lock_guard lock(mutex_);
    if (renderer) describe_ = renderer->describe();
    ready_ = renderer != nullptr;
  }
  wake_.notify_all();
  while (renderer) {
    std::shared_ptr<Job> job;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return quit_ || !jobs_.empty(); });
      if (quit_) return;
      job = jobs_.front();
    }
    std::shared_ptr<const Picture> picture;
    std::string failure;
    try {
      picture = std::make_shared<const Picture>(draw_picture(*renderer, *job->stage, job->frame, job->view, job->format,
                                                             [&] { return !quit_; }));
      if (picture->bytes.empty()) return;  // the service is stopping
      last_render_seconds_ = picture->render_seconds;
      last_encode_seconds_ = picture->encode_seconds;
    } catch (const Error& error) {
      failure = error.what();
    } catch (const std::bad_alloc&) {
      failure = "not enough memory for this picture; ask for a smaller one";
    }
    {
      const std::lock_guard lock(mutex_);
      jobs_.pop_front();
      job->failure = failure;
      job->done = true;
      if (failure.empty()) {
        job->picture = picture;
        cache_.emplace_front(job->key, std::move(picture));
        if (cache_.size() > kRememberedPictures) cache_.pop_back();
      }
    }
    wake_.notify_all();
  }
}

}  // namespace rend

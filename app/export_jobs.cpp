// Exports of many frames.
#include "app/export_jobs.h"

#include "app/write_file.h"
#include "app/zip_file.h"
#include "engine/core/error.h"

#include <chrono>
#include <new>

namespace rend {

namespace fs = std::filesystem;

const char* export_state_name(ExportState state) {
  switch (state) {
    case ExportState::running:
      return "running";
    case ExportState::done:
      return "done";
    case ExportState::cancelled:
      return "cancelled";
    case ExportState::failed:
      return "failed";
  }
  return "";
}

ExportJobs::~ExportJobs() {
  cancel_ = true;
  if (thread_.joinable()) thread_.join();
}

fs::path ExportJobs::file(int id) const { return folder_.path() / (std::to_string(id) + ".zip"); }

const ExportStatus* ExportJobs::find(int id) const {
  if (id <= 0) return nullptr;
  return id == id_ ? &status_ : id == kept_id_ ? &kept_ : nullptr;
}

void ExportJobs::forget_kept() {
  std::error_code ignored;
  if (kept_id_ > 0) fs::remove(file(kept_id_), ignored);
  kept_id_ = 0;
}

std::optional<int> ExportJobs::start(ExportOrder order) {
  if (order.frames.empty()) throw Error("/first", "no frame of this range is recorded");
  const std::lock_guard lock(mutex_);
  if (id_ > 0 && status_.state == ExportState::running) return std::nullopt;
  if (thread_.joinable()) thread_.join();  // it has nothing left to do
  make_folder(folder_.path());             // somebody may have tidied up
  const ExportStatus fresh{ExportState::running, order.name, 0, order.frames.size(), 0, 0, {}};
  cancel_ = false;
  thread_ = std::thread(
      [this, id = id_ + 1, order = std::move(order)]() mutable { run(std::move(order), id); });
  if (id_ > 0 && status_.state == ExportState::done) {
    forget_kept();
    kept_id_ = id_;
    kept_ = status_;
  }
  status_ = fresh;
  return ++id_;
}

std::optional<int> ExportJobs::running() const {
  const std::lock_guard lock(mutex_);
  if (id_ == 0 || status_.state != ExportState::running) return std::nullopt;
  return id_;
}

std::optional<ExportStatus> ExportJobs::status(int id) const {
  const std::lock_guard lock(mutex_);
  const ExportStatus* found = find(id);
  return found ? std::optional(*found) : std::nullopt;
}

bool ExportJobs::cancel(int id) {
  const std::lock_guard lock(mutex_);
  if (!find(id)) return false;
  if (id == kept_id_) {
    forget_kept();
  } else if (status_.state == ExportState::running) {
    cancel_ = true;
  } else if (status_.state == ExportState::done) {
    status_.state = ExportState::cancelled;
    std::error_code ignored;
    fs::remove(file(id), ignored);
  }
  return true;
}

std::shared_ptr<const web::FileBody> ExportJobs::archive(int id) const {
  const std::lock_guard lock(mutex_);
  const ExportStatus* found = find(id);
  std::error_code ignored;
  if (!found || found->state != ExportState::done || !fs::exists(file(id), ignored)) return nullptr;
  return std::make_shared<const web::FileBody>(file(id));
}

void ExportJobs::run(ExportOrder order, int id) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto end = [&](ExportState state, const std::string& reason) {
    std::error_code ignored;
    const std::lock_guard lock(mutex_);
    status_.state = cancel_ ? ExportState::cancelled : state;
    status_.reason = status_.state == ExportState::failed ? reason : "";
    status_.seconds_left = 0;
    if (status_.state == ExportState::done) {
      status_.bytes = fs::file_size(file(id), ignored);
      forget_kept();
    } else {
      fs::remove(file(id), ignored);
    }
  };
  try {
    ZipFile zip(file(id));
    const auto add = [&](const std::vector<ExportedFile>& files) {
      for (const ExportedFile& f : files)
        if (!cancel_) zip.add(order.name + "/" + f.name, f.bytes, f.packed);
    };
    const KeepOn keep_on = [this] { return !cancel_; };
    for (auto& frame : order.frames) {
      add(order.files_of(*frame, keep_on));
      frame.reset();  // recorded frames need memory, and the run may have let go of them
      const std::chrono::duration<double> spent = Clock::now() - start;
      const std::lock_guard lock(mutex_);
      if (cancel_) break;
      ++status_.done;
      status_.seconds_left = spent.count() / static_cast<double>(status_.done) *
                             static_cast<double>(status_.of - status_.done);
    }
    add(order.beside());
    zip.close();
  } catch (const Error& error) {
    return end(ExportState::failed, error.why());
  } catch (const std::bad_alloc&) {
    return end(ExportState::failed, "not enough memory for these frames");
  } catch (...) {
    return end(ExportState::failed, "the export failed inside");
  }
  end(ExportState::done, {});
}

}  // namespace rend

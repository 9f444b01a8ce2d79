// Exports of many frames.
#include "app/export_jobs.h"

#include "app/zip_file.h"
#include "engine/core/error.h"

#include <chrono>
#include <cstdlib>
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

ExportJobs::ExportJobs() {
  std::string pattern = (fs::temp_directory_path() / "rend-exports-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw Error(pattern, "cannot make a folder for exports");
  folder_ = pattern;
}

ExportJobs::~ExportJobs() {
  {
    const std::lock_guard lock(mutex_);
    cancel_ = true;
  }
  if (thread_.joinable()) thread_.join();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

fs::path ExportJobs::file() const { return folder_ / "export.zip"; }

std::optional<int> ExportJobs::start(ExportOrder order) {
  if (order.frames.empty()) throw Error("/first", "no frame of this range is recorded");
  const std::lock_guard lock(mutex_);
  if (id_ > 0 && status_.state == ExportState::running) return std::nullopt;
  if (thread_.joinable()) thread_.join();  // it has nothing left to do
  std::error_code ignored;
  fs::remove(file(), ignored);
  cancel_ = false;
  status_ = {ExportState::running, order.name, 0, order.frames.size(), 0, 0, {}};
  thread_ = std::thread([this, order = std::move(order)] { run(order); });
  return ++id_;
}

std::optional<ExportStatus> ExportJobs::status(int id) const {
  const std::lock_guard lock(mutex_);
  if (id <= 0 || id != id_) return std::nullopt;
  return status_;
}

bool ExportJobs::cancel(int id) {
  const std::lock_guard lock(mutex_);
  if (id <= 0 || id != id_) return false;
  cancel_ = true;
  if (status_.state != ExportState::done) return true;
  status_.state = ExportState::cancelled;
  std::error_code ignored;
  fs::remove(file(), ignored);
  return true;
}

fs::path ExportJobs::archive(int id) const {
  const std::lock_guard lock(mutex_);
  return id > 0 && id == id_ && status_.state == ExportState::done ? file() : fs::path();
}

void ExportJobs::run(const ExportOrder& order) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto end = [&](ExportState state, const std::string& reason) {
    std::error_code ignored;
    const std::lock_guard lock(mutex_);
    status_.state = state == ExportState::done && cancel_ ? ExportState::cancelled : state;
    status_.reason = reason;
    status_.seconds_left = 0;
    if (status_.state == ExportState::done)
      status_.bytes = fs::file_size(file(), ignored);
    else
      fs::remove(file(), ignored);
  };
  try {
    ZipFile zip(file());
    const auto add = [&](const ExportedFile& f) {
      zip.add(order.name + "/" + f.name, f.bytes, f.packed);
    };
    for (const auto& frame : order.frames) {
      for (const ExportedFile& f : order.files_of(*frame)) add(f);
      const std::chrono::duration<double> spent = Clock::now() - start;
      const std::lock_guard lock(mutex_);
      if (cancel_) break;
      ++status_.done;
      status_.seconds_left = spent.count() / static_cast<double>(status_.done) *
                             static_cast<double>(status_.of - status_.done);
    }
    for (const ExportedFile& f : order.beside) add(f);
    zip.close();
  } catch (const Error& error) {
    return end(ExportState::failed, error.why());
  } catch (const std::bad_alloc&) {
    return end(ExportState::failed, "not enough memory; ask for smaller pictures");
  }
  end(ExportState::done, {});
}

}  // namespace rend

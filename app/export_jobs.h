// Exports of many frames: one job at a time fills an archive in a thread of its own.
#pragma once

#include "app/session.h"
#include "app/temporary_folder.h"
#include "web/file_body.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace rend {

/// A file of an archive.
struct ExportedFile {
  std::string name;  ///< path below the archive's folder
  std::string bytes;
  bool packed = false;  ///< does not become smaller
};

/// False when the job is to end.
using KeepOn = std::function<bool()>;

struct ExportOrder {
  std::string name;  ///< of the archive and of the one folder in it
  std::vector<std::shared_ptr<const RecordedFrame>> frames;
  /// The files of one frame; any, when it is told not to keep on. @throws Error to end the job.
  std::function<std::vector<ExportedFile>(const RecordedFrame&, const KeepOn&)> files_of;
  /// What belongs to the frames as a whole; called last.
  std::function<std::vector<ExportedFile>()> beside;
};

enum class ExportState { running, done, cancelled, failed };
const char* export_state_name(ExportState state);

struct ExportStatus {
  ExportState state = ExportState::running;
  std::string name;
  std::size_t done = 0, of = 0;  ///< frames
  double seconds_left = 0;       ///< at the pace so far; 0 before the first frame
  std::uintmax_t bytes = 0;      ///< of the finished archive
  std::string reason;            ///< why it failed
};

/// Any thread may call. Archives lie in a folder of its own that goes when this does; the last one
/// that is finished stays until another is.
class ExportJobs {
 public:
  ExportJobs() = default;
  ~ExportJobs();
  ExportJobs(const ExportJobs&) = delete;
  ExportJobs& operator=(const ExportJobs&) = delete;

  /// The number of the job; none while another runs. @throws Error for an order without frames.
  std::optional<int> start(ExportOrder order);
  /// The number of the job that runs.
  std::optional<int> running() const;
  /// Of the newest job and of the one whose archive is kept; none for other numbers.
  std::optional<ExportStatus> status(int id) const;
  /// Ends a job that runs, and removes the archive of one that is done. False as above.
  bool cancel(int id);
  /// The finished archive, null when there is none.
  std::shared_ptr<const web::FileBody> archive(int id) const;

 private:
  void run(ExportOrder order, int id);
  std::filesystem::path file(int id) const;
  const ExportStatus* find(int id) const;
  void forget_kept();

  TemporaryFolder folder_{"rend-exports"};
  mutable std::mutex mutex_;
  int id_ = 0, kept_id_ = 0;  ///< the newest job, and an older one whose archive is still there
  ExportStatus status_, kept_;
  std::atomic<bool> cancel_ = false;
  std::thread thread_;
};

}  // namespace rend

// Exports of many frames: one job at a time fills an archive in a thread of its own.
#pragma once

#include "app/session.h"

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

struct ExportOrder {
  std::string name;  ///< of the archive and of the one folder in it
  std::vector<std::shared_ptr<const RecordedFrame>> frames;
  /// The files of one frame; throws Error when there is no more to come.
  std::function<std::vector<ExportedFile>(const RecordedFrame&)> files_of;
  std::vector<ExportedFile> beside;  ///< what belongs to the run as a whole
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

/// Any thread may call. The archive lies in a folder of its own that goes when this does; a new job
/// takes the place of the last one.
class ExportJobs {
 public:
  ExportJobs();
  ~ExportJobs();
  ExportJobs(const ExportJobs&) = delete;
  ExportJobs& operator=(const ExportJobs&) = delete;

  /// The number of the job; none while another runs. @throws Error for an order without frames.
  std::optional<int> start(ExportOrder order);
  /// None for a number that is not the last one given.
  std::optional<ExportStatus> status(int id) const;
  /// Ends a job that runs, and removes the archive of one that is done. False as above.
  bool cancel(int id);
  /// The finished archive; empty when there is none.
  std::filesystem::path archive(int id) const;

 private:
  void run(const ExportOrder& order);
  std::filesystem::path file() const;

  std::filesystem::path folder_;
  mutable std::mutex mutex_;
  int id_ = 0;
  bool cancel_ = false;
  ExportStatus status_;
  std::thread thread_;
};

}  // namespace rend

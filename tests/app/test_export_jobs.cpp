// Exports of many frames: what is in the archive, one at a time, cancelling, failing, cleaning up.
#include "app/export_jobs.h"
#include "app/zip_file.h"
#include "engine/core/error.h"
#include "tests/app/program.h"

#include <archive.h>
#include <archive_entry.h>
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace rend;
namespace fs = std::filesystem;

namespace {

std::map<std::string, std::string> contents(const fs::path& zip) {
  std::map<std::string, std::string> files;
  archive* in = archive_read_new();
  archive_read_support_format_zip(in);
  CHECK(archive_read_open_filename(in, zip.c_str(), 65536) == ARCHIVE_OK);
  archive_entry* entry = nullptr;
  while (archive_read_next_header(in, &entry) == ARCHIVE_OK) {
    std::string bytes(static_cast<std::size_t>(archive_entry_size(entry)), '\0');
    CHECK(archive_read_data(in, bytes.data(), bytes.size()) ==
          static_cast<la_ssize_t>(bytes.size()));
    files[archive_entry_pathname(entry)] = bytes;
  }
  archive_read_free(in);
  return files;
}

/// A gate that a job waits at, so that nothing depends on how fast it is.
class Gate {
 public:
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    opened_.notify_all();
  }
  void pass() {
    std::unique_lock lock(mutex_);
    opened_.wait(lock, [&] { return open_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  bool open_ = false;
};

/// `count` frames, each of one file with its number; waits at `gate` before the second.
ExportOrder numbered(int count, Gate& gate) {
  ExportOrder order;
  order.name = "run";
  order.frames.resize(static_cast<std::size_t>(count), std::make_shared<const RecordedFrame>());
  order.beside = [] { return std::vector<ExportedFile>{{"frames.csv", "frame,time\n"}}; };
  order.files_of = [&gate, number = 0](const RecordedFrame&, const KeepOn&) mutable {
    if (++number == 2) gate.pass();
    return std::vector<ExportedFile>{
        {fmt::format("png/{:06}.png", number), std::string(1000, static_cast<char>(number)), true}};
  };
  return order;
}

ExportStatus finished(const ExportJobs& jobs, int id) {
  for (;;) {
    const auto status = jobs.status(id);
    REQUIRE(status);
    if (status->state != ExportState::running) return *status;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

}  // namespace

TEST_CASE("an archive gives back its files, stored or deflated") {
  test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.zip";
  const std::string zeros(300000, '0');
  ZipFile zip(file);
  zip.add("a/stored.bin", zeros, true);
  zip.add("a/deflated.txt", zeros, false);
  zip.add("a/empty", "", false);
  zip.close();
  CHECK(contents(file) == std::map<std::string, std::string>{
                              {"a/stored.bin", zeros}, {"a/deflated.txt", zeros}, {"a/empty", ""}});
  CHECK(fs::file_size(file) > 300000);
  CHECK(fs::file_size(file) < 310000);
}

TEST_CASE("a disk that is full, or no folder, is an error with the name of the archive") {
  CHECK_THROWS_WITH_AS(ZipFile("/nowhere/a.zip"), doctest::Contains("/nowhere/a.zip"), Error);
  const auto fill = [] {
    ZipFile zip("/dev/full");
    for (int i = 0; i < 20; ++i) zip.add(std::to_string(i), std::string(1 << 16, 'x'), true);
    zip.close();
  };
  CHECK_THROWS_WITH_AS(fill(), doctest::Contains("/dev/full"), Error);
}

namespace {

/// Jobs whose folder of temporary files is one of the test's own.
struct Place {
  Place() {
    setenv("TMPDIR", folder.path().c_str(), 1);
    jobs = std::make_unique<ExportJobs>();
    unsetenv("TMPDIR");
  }
  ~Place() {
    gate.open();
    jobs.reset();
  }

  /// Names of all files there are.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
      if (entry.is_regular_file()) names.push_back(entry.path().filename());
    return names;
  }

  test::TemporaryFolder folder;
  Gate gate;
  std::unique_ptr<ExportJobs> jobs;
};

fs::path path_of(const std::shared_ptr<const web::FileBody>& file) {
  return "/proc/self/fd/" + std::to_string(file->descriptor());
}

}  // namespace

TEST_CASE("a job says how far it is, another waits its turn, the archive is whole") {
  Place place;
  ExportJobs& jobs = *place.jobs;
  const auto id = jobs.start(numbered(3, place.gate));
  REQUIRE(id);
  while (jobs.status(*id)->done < 1) std::this_thread::yield();
  CHECK(jobs.status(*id)->of == 3);
  CHECK(jobs.running() == *id);
  CHECK_FALSE(jobs.archive(*id));
  CHECK_FALSE(jobs.start(numbered(1, place.gate)));
  place.gate.open();
  const ExportStatus status = finished(jobs, *id);
  CHECK(status.state == ExportState::done);
  CHECK(status.done == 3);
  CHECK_FALSE(jobs.running());
  const auto archive = jobs.archive(*id);
  REQUIRE(archive);
  CHECK(status.bytes == archive->size());
  const auto files = contents(path_of(archive));
  CHECK(files.size() == 4);
  CHECK(files.at("run/frames.csv") == "frame,time\n");
  CHECK(files.at("run/png/000003.png") == std::string(1000, '\3'));
}

TEST_CASE("a finished archive stays until the next is finished") {
  Place place;
  ExportJobs& jobs = *place.jobs;
  const auto first = jobs.start(numbered(1, place.gate));
  CHECK(finished(jobs, *first).state == ExportState::done);
  const auto second = jobs.start(numbered(2, place.gate));
  CHECK(jobs.archive(*first));
  CHECK(jobs.status(*first)->state == ExportState::done);
  place.gate.open();
  CHECK(finished(jobs, *second).state == ExportState::done);
  CHECK_FALSE(jobs.status(*first));
  CHECK_FALSE(jobs.cancel(*first));
  CHECK(place.files() == std::vector<std::string>{"2.zip"});
  CHECK(jobs.cancel(*second));
  CHECK(jobs.status(*second)->state == ExportState::cancelled);
  CHECK(place.files().empty());
}

TEST_CASE("cancelled, failed, abandoned and empty jobs leave nothing behind") {
  Place place;
  ExportJobs& jobs = *place.jobs;
  const auto cancelled = jobs.start(numbered(100, place.gate));
  REQUIRE(cancelled);
  CHECK(jobs.cancel(*cancelled));
  place.gate.open();
  CHECK(finished(jobs, *cancelled).state == ExportState::cancelled);
  CHECK(jobs.status(*cancelled)->done < 3);
  CHECK(place.files().empty());

  const auto fails = [&](auto&& how) {
    ExportOrder order = numbered(2, place.gate);
    order.files_of = how;
    const auto id = jobs.start(order);
    const ExportStatus status = finished(jobs, *id);
    CHECK(status.state == ExportState::failed);
    CHECK_FALSE(jobs.archive(*id));
    CHECK(place.files().empty());
    return status.reason;
  };
  using Files = std::vector<ExportedFile>;
  CHECK(fails([](const RecordedFrame&, const KeepOn&) -> Files {
          throw Error("picture", "no context");
        }) == "no context");
  CHECK(fails([](const RecordedFrame&, const KeepOn&) -> Files {
          throw std::length_error("inner");
        }) == "the export failed inside");

  CHECK_THROWS_WITH_AS(jobs.start(ExportOrder{}), doctest::Contains("/first"), Error);
  CHECK_FALSE(jobs.status(0));
  CHECK_FALSE(jobs.status(99));

  // One that only ends when it is told to.
  ExportOrder endless = numbered(2, place.gate);
  endless.files_of = [](const RecordedFrame&, const KeepOn& keep_on) -> Files {
    while (keep_on()) std::this_thread::yield();
    return {};
  };
  CHECK(jobs.start(endless));
  place.jobs.reset();
  CHECK(fs::is_empty(place.folder.path()));
}

TEST_CASE("a folder that somebody has removed is made again") {
  Place place;
  for (const auto& entry : fs::directory_iterator(place.folder.path())) fs::remove_all(entry);
  const auto id = place.jobs->start(numbered(1, place.gate));
  CHECK(finished(*place.jobs, *id).state == ExportState::done);
}

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
#include <map>
#include <mutex>
#include <thread>

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
  order.beside = {{"frames.csv", "frame,time\n"}};
  order.files_of = [&gate, number = 0](const RecordedFrame&) mutable {
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

TEST_CASE("a job says how far it is, another waits its turn, the archive is whole") {
  fs::path archive;
  {
    Gate gate;
    ExportJobs jobs;
    const auto id = jobs.start(numbered(3, gate));
    REQUIRE(id);
    while (jobs.status(*id)->done < 1) std::this_thread::yield();
    CHECK(jobs.status(*id)->of == 3);
    CHECK(jobs.archive(*id).empty());
    CHECK_FALSE(jobs.start(numbered(1, gate)));
    gate.open();
    const ExportStatus status = finished(jobs, *id);
    CHECK(status.state == ExportState::done);
    CHECK(status.done == 3);
    archive = jobs.archive(*id);
    CHECK(status.bytes == fs::file_size(archive));
    const auto files = contents(archive);
    CHECK(files.size() == 4);
    CHECK(files.at("run/frames.csv") == "frame,time\n");
    CHECK(files.at("run/png/000003.png") == std::string(1000, '\3'));
    // A new job takes the place of the last.
    const auto next = jobs.start(numbered(1, gate));
    REQUIRE(next);
    CHECK_FALSE(jobs.status(*id));
    CHECK_FALSE(jobs.cancel(*id));
    CHECK(finished(jobs, *next).done == 1);
    CHECK(jobs.cancel(*next));
    CHECK(jobs.status(*next)->state == ExportState::cancelled);
    CHECK_FALSE(fs::exists(archive));
  }
  CHECK_FALSE(fs::exists(archive.parent_path()));
}

TEST_CASE("cancelled, failed and empty jobs leave nothing behind") {
  Gate gate;
  ExportJobs jobs;
  const auto cancelled = jobs.start(numbered(100, gate));
  REQUIRE(cancelled);
  CHECK(jobs.cancel(*cancelled));
  gate.open();
  CHECK(finished(jobs, *cancelled).state == ExportState::cancelled);
  CHECK(jobs.status(*cancelled)->done < 3);
  CHECK(jobs.archive(*cancelled).empty());

  ExportOrder bad = numbered(2, gate);
  bad.files_of = [](const RecordedFrame&) -> std::vector<ExportedFile> {
    throw Error("picture", "no context");
  };
  const auto failed = jobs.start(bad);
  REQUIRE(failed);
  CHECK(finished(jobs, *failed).state == ExportState::failed);
  CHECK(jobs.status(*failed)->reason == "no context");
  CHECK(jobs.archive(*failed).empty());

  CHECK_THROWS_WITH_AS(jobs.start(ExportOrder{}), doctest::Contains("/first"), Error);
  CHECK_FALSE(jobs.status(0));
  CHECK_FALSE(jobs.status(99));
}

// ZIP archives through libarchive.
#include "app/zip_file.h"

#include "engine/core/error.h"

#include <archive.h>
#include <archive_entry.h>

#include <cstring>
#include <ctime>

namespace rend {

struct ZipFile::State {
  explicit State(const std::filesystem::path& path)
      : file(path.string()), out(archive_write_new()) {}
  ~State() { archive_write_free(out); }

  void check(int code) const {
    if (code != ARCHIVE_OK) fail();
  }
  [[noreturn]] void fail() const {
    // The library's own words name the whole path.
    throw Error(file, std::string("cannot be written: ") + std::strerror(archive_errno(out)));
  }

  std::string file;
  archive* out;
};

ZipFile::ZipFile(const std::filesystem::path& file) : state_(std::make_unique<State>(file)) {
  state_->check(archive_write_set_format_zip(state_->out));
  state_->check(archive_write_open_filename(state_->out, state_->file.c_str()));
}

ZipFile::~ZipFile() = default;

void ZipFile::add(const std::string& name, const std::string& bytes, bool packed) {
  State& s = *state_;
  s.check(packed ? archive_write_zip_set_compression_store(s.out)
                 : archive_write_zip_set_compression_deflate(s.out));
  const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(),
                                                                       archive_entry_free);
  archive_entry_set_pathname(entry.get(), name.c_str());
  archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), 0644);
  archive_entry_set_mtime(entry.get(), std::time(nullptr), 0);
  s.check(archive_write_header(s.out, entry.get()));
  if (archive_write_data(s.out, bytes.data(), bytes.size()) !=
      static_cast<la_ssize_t>(bytes.size()))
    s.fail();
}

void ZipFile::close() { state_->check(archive_write_close(state_->out)); }

}  // namespace rend

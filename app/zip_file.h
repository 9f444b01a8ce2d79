// A ZIP archive that is written file by file.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace rend {

class ZipFile {
 public:
  /// @throws Error naming the file when it cannot be made; so do add() and close() when the disk is
  /// full.
  explicit ZipFile(const std::filesystem::path& file);
  /// Without close() before, the archive is not complete.
  ~ZipFile();
  ZipFile(const ZipFile&) = delete;
  ZipFile& operator=(const ZipFile&) = delete;

  /// `packed` bytes, like PNG, are stored as they are, others deflated.
  void add(const std::string& name, const std::string& bytes, bool packed);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rend

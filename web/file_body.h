// A file on disk as the body of a reply: large ones never pass through memory.
#pragma once

#include <cstdint>
#include <filesystem>

namespace rend::web {

/// Holds the file open: its bytes stay readable when its name goes. The file must not shrink.
class FileBody {
 public:
  /// @throws Error naming the file when it cannot be read.
  explicit FileBody(const std::filesystem::path& file);
  ~FileBody();
  FileBody(const FileBody&) = delete;
  FileBody& operator=(const FileBody&) = delete;

  int descriptor() const { return fd_; }
  std::uint64_t size() const { return size_; }  ///< [bytes]

 private:
  int fd_;
  std::uint64_t size_ = 0;
};

}  // namespace rend::web

// A file on disk as the body of a reply.
#include "web/file_body.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/core/error.h"

namespace rend::web {

FileBody::FileBody(const std::filesystem::path& file)
    : fd_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (fd_ < 0) throw Error(file.string(), std::string("cannot be read: ") + std::strerror(errno));
  struct stat status {};
  if (::fstat(fd_, &status) == 0) size_ = static_cast<std::uint64_t>(status.st_size);
}

FileBody::~FileBody() { ::close(fd_); }

}  // namespace rend::web

// The listening socket: address rules, options, and the Host values that name it.
#pragma once

#include <string>
#include <vector>

namespace rend::web {

/// An owned file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() { reset(); }
  Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;

  int get() const { return fd_; }
  int release();
  void reset(int fd = -1);

 private:
  int fd_;
};

struct Listener {
  Descriptor socket;  ///< non-blocking, listening
  int port = 0;
  std::string display_host;        ///< for the printed address, IPv6 in brackets
  std::vector<std::string> hosts;  ///< Host values that name this server, lower case
};

/// True for 127.0.0.0/8, ::1 and "localhost". @throws Error when it is not a numeric address.
bool is_loopback(const std::string& address);

/// Binds and listens. @throws Error (port taken, address not of this machine).
Listener open_listener(const std::string& address, int port);

}  // namespace rend::web

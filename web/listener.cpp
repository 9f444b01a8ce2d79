// The listening socket: address rules, options, and the Host values that name it.
#include "web/listener.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "engine/core/error.h"

namespace rend::web {
namespace {

struct Address {
  sockaddr_storage storage{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

Address resolve(const std::string& text, int port) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  const std::string numeric = text == "localhost" ? "127.0.0.1" : text;
  addrinfo* found = nullptr;
  if (getaddrinfo(numeric.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
    throw Error("listen address", "'" + text + "' is not an IPv4 or IPv6 address");
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, freeaddrinfo);
  Address address;
  std::memcpy(&address.storage, found->ai_addr, found->ai_addrlen);
  address.size = found->ai_addrlen;
  return address;
}

std::string host_text(const sockaddr* address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (address->sa_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text, sizeof text);
    return text;
  }
  inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, text,
            sizeof text);
  return std::string("[").append(text).append("]");
}

bool is_wildcard(const std::string& host) { return host == "0.0.0.0" || host == "[::]"; }

// "Every address" is no name a browser can use, so the machine's own addresses stand in for it.
std::vector<std::string> machine_addresses() {
  std::vector<std::string> hosts;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return hosts;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  for (const ifaddrs* item = list; item; item = item->ifa_next) {
    if (!item->ifa_addr) continue;
    const int family = item->ifa_addr->sa_family;
    if (family == AF_INET || family == AF_INET6) hosts.push_back(host_text(item->ifa_addr));
  }
  return hosts;
}

void set_option(int fd, int level, int name, int value) {
  setsockopt(fd, level, name, &value, sizeof value);
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) reset(other.release());
  return *this;
}

int Descriptor::release() { return std::exchange(fd_, -1); }

void Descriptor::reset(int fd) {
  if (fd_ >= 0) ::close(fd_);
  fd_ = fd;
}

bool is_loopback(const std::string& address) {
  const Address resolved = resolve(address, 0);
  if (resolved.storage.ss_family == AF_INET) {
    const auto* v4 = reinterpret_cast<const sockaddr_in*>(resolved.get());
    return (ntohl(v4->sin_addr.s_addr) >> 24) == 127;
  }
  return host_text(resolved.get()) == "[::1]";
}

Listener open_listener(const std::string& address, int port) {
  if (port < 0 || port > 65535) {
    throw Error("port", std::to_string(port) + " is not in 0..65535 (0 picks a free one)");
  }
  const Address wanted = resolve(address, port);
  Listener listener;
  listener.socket.reset(
      ::socket(wanted.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int fd = listener.socket.get();
  // Not SO_REUSEPORT: with it a second server would share the port and split the clients.
  set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1);
  // A connection that sends nothing is the kernel's until it speaks, and inherits no delay after.
  set_option(fd, IPPROTO_TCP, TCP_DEFER_ACCEPT, 5);
  set_option(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  const std::string place = address + ":" + std::to_string(port);
  if (::bind(fd, wanted.get(), wanted.size) != 0 || ::listen(fd, 1024) != 0) {
    if (errno == EADDRINUSE) {
      throw Error(place, "port " + std::to_string(port) +
                             " is taken by another program; choose another, or 0 for a free one");
    }
    throw Error(place, std::string("cannot listen: ") + std::strerror(errno));
  }
  Address bound;
  bound.size = sizeof bound.storage;
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&bound.storage), &bound.size);
  listener.port = ntohs(bound.storage.ss_family == AF_INET
                            ? reinterpret_cast<const sockaddr_in*>(bound.get())->sin_port
                            : reinterpret_cast<const sockaddr_in6*>(bound.get())->sin6_port);

  listener.display_host = host_text(bound.get());
  std::vector<std::string> names = {"localhost", "127.0.0.1", "[::1]"};
  if (is_wildcard(listener.display_host)) {
    listener.display_host = "127.0.0.1";
    for (const std::string& host : machine_addresses()) {
      names.push_back(host);
      const bool outside = host != "127.0.0.1" && host != "[::1]" && !host.starts_with("[fe80");
      if (outside && listener.display_host == "127.0.0.1") listener.display_host = host;
    }
  } else {
    names.push_back(listener.display_host);
  }
  for (const std::string& name : names) {
    listener.hosts.push_back(name + ":" + std::to_string(listener.port));
    if (listener.port == 80) listener.hosts.push_back(name);
  }
  return listener;
}

}  // namespace rend::web

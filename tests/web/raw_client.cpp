// A client that sends exactly the bytes it is told to, and reads what comes back.
#include "tests/web/raw_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <strings.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace rend::test {
namespace {

using Clock = std::chrono::steady_clock;

int milliseconds_left(Clock::time_point deadline) {
  const auto left = std::chrono::duration_cast<Milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::max<std::int64_t>(left, 0));
}

}  // namespace

RawClient::RawClient(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  if (fd_ < 0) return;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int on = 1;
  ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    ::close(fd_);
    fd_ = -1;
  }
}

RawClient::~RawClient() {
  if (fd_ >= 0) ::close(fd_);
}

bool RawClient::send(const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

bool RawClient::receive(Clock::time_point deadline) {
  pollfd waiting{fd_, POLLIN, 0};
  if (ended_ || ::poll(&waiting, 1, milliseconds_left(deadline)) <= 0) return false;
  char buffer[65536];
  const ssize_t count = ::recv(fd_, buffer, sizeof buffer, 0);
  if (count <= 0) {
    ended_ = true;
    return false;
  }
  in_.append(buffer, static_cast<std::size_t>(count));
  return true;
}

std::string RawClient::read_to_end(Milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (receive(deadline)) {
  }
  return std::move(in_);
}

std::string RawClient::read_reply(Milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  for (;;) {
    const auto end = in_.find("\r\n\r\n");
    if (end != std::string::npos) {
      const auto length = header_of(in_.substr(0, end + 4), "Content-Length");
      const std::size_t total = end + 4 + static_cast<std::size_t>(std::atoll(length.c_str()));
      if (in_.size() >= total) {
        std::string reply = in_.substr(0, total);
        in_.erase(0, total);
        return reply;
      }
    }
    if (!receive(deadline)) return "";
  }
}

bool RawClient::reply_begins(Milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (in_.empty() && receive(deadline)) {
  }
  return !in_.empty();
}

bool RawClient::closed_by_server(Milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (receive(deadline)) {
  }
  return ended_;
}

int status_of(const std::string& reply) {
  return reply.starts_with("HTTP/1.1 ") ? std::atoi(reply.c_str() + 9) : 0;
}

int count_replies(const std::string& bytes) {
  int count = 0;
  for (auto at = bytes.find("HTTP/1.1 "); at != std::string::npos;
       at = bytes.find("HTTP/1.1 ", at + 1)) {
    ++count;
  }
  return count;
}

std::string body_of(const std::string& reply) {
  const auto end = reply.find("\r\n\r\n");
  return end == std::string::npos ? "" : reply.substr(end + 4);
}

std::string header_of(const std::string& reply, const std::string& name) {
  const auto head_end = reply.find("\r\n\r\n");
  for (auto at = reply.find("\r\n"); at < head_end; at = reply.find("\r\n", at + 2)) {
    const auto colon = reply.find(':', at);
    const auto end = reply.find("\r\n", at + 2);
    if (colon == std::string::npos || colon > end) continue;
    const std::string key = reply.substr(at + 2, colon - at - 2);
    if (key.size() == name.size() && strcasecmp(key.c_str(), name.c_str()) == 0) {
      return reply.substr(colon + 2, end - colon - 2);
    }
  }
  return "";
}

std::string get_request(int port, const std::string& path, const std::string& extra) {
  return "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + extra +
         "\r\n";
}

std::string body_request(int port, const std::string& method, const std::string& path,
                         const std::string& body, const std::string& type,
                         const std::string& extra) {
  return method + " " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
         "\r\nContent-Type: " + type + "\r\nContent-Length: " + std::to_string(body.size()) +
         "\r\n" + extra + "\r\n" + body;
}

std::string ask(int port, const std::string& bytes, Milliseconds limit) {
  RawClient client(port);
  client.send(bytes);
  return client.read_reply(limit);
}

}  // namespace rend::test

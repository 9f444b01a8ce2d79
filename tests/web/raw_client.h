// A client that sends exactly the bytes it is told to, and reads what comes back.
#pragma once

#include <chrono>
#include <string>

namespace rend::test {

using Milliseconds = std::chrono::milliseconds;

class RawClient {
 public:
  explicit RawClient(int port);  ///< connects to 127.0.0.1
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool connected() const { return fd_ >= 0; }
  bool send(const std::string& bytes);  ///< false when the server has closed
  /// Everything until the server closes or `limit` is over.
  std::string read_to_end(Milliseconds limit = Milliseconds(2000));
  /// One reply by its Content-Length; empty when none comes in time.
  std::string read_reply(Milliseconds limit = Milliseconds(2000));
  bool reply_begins(Milliseconds limit);  ///< true when the first bytes come in time
  bool closed_by_server(Milliseconds limit);  ///< true when end of stream comes in time

 private:
  bool receive(std::chrono::steady_clock::time_point deadline);
  int fd_ = -1;
  bool ended_ = false;
  std::string in_;
};

int status_of(const std::string& reply);  ///< 0 when it is no reply
int count_replies(const std::string& bytes);
std::string body_of(const std::string& reply);
std::string header_of(const std::string& reply, const std::string& name);  ///< "" when absent

/// "GET path HTTP/1.1" with the Host of `port` and `extra` header lines (each with CRLF).
std::string get_request(int port, const std::string& path, const std::string& extra = "");
/// A request with a body and its Content-Length.
std::string body_request(int port, const std::string& method, const std::string& path,
                         const std::string& body, const std::string& type = "application/json",
                         const std::string& extra = "");
/// One request on a connection of its own.
std::string ask(int port, const std::string& bytes, Milliseconds limit = Milliseconds(2000));

}  // namespace rend::test

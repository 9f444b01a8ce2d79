// An HTTP server that is safe to leave open: cpp-httplib behind our own guard, routes given by the
// caller.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "web/file_body.h"

namespace rend::web {

struct Request {
  std::string method, path;
  std::map<std::string, std::string> query;
  std::vector<std::string> parts;  ///< values of the {placeholders} of the route, decoded
  std::map<std::string, std::string> headers;  ///< accept, content-type, if-match, if-none-match
  std::string body;
  /// Long waits must watch it: the server stops or the client has left.
  const std::atomic<bool>* stopping = nullptr;
};

struct Response {
  int status = 200;
  std::string type = "application/json";
  std::string body;
  std::map<std::string, std::string> headers;
  std::shared_ptr<const FileBody> file = nullptr;  ///< sent in place of `body`
};

/// An RFC 9457 problem; `pointer` is a JSON pointer into the request body, empty when none applies.
Response problem(int status, const std::string& code, const std::string& detail,
                 const std::string& pointer = "");

/// `text` as the inside of a JSON string; bytes that are not UTF-8 become U+FFFD.
std::string json_escaped(const std::string& text);

/// 128 bits from the kernel as 32 hexadecimal digits, for ServerOptions::token.
std::string random_token();

/// May throw Error (sent as 422, `where` as pointer); anything else thrown is sent as a bare 500.
using Handler = std::function<Response(const Request&)>;

struct Route {
  std::string method;   ///< "GET" (HEAD comes with it), "POST", "PUT", "PATCH" or "DELETE"
  std::string pattern;  ///< "/api/frames/{n}.png": at most one placeholder between two slashes
  Handler handler;
  std::size_t body_limit = 64 * 1024;
  bool long_wait = false;  ///< long poll: runs in the pool of viewers, not in the pool of controls
  /// A body of another type is refused with 415; JSON takes "application/...+json" too.
  std::string body_type = "application/json";
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 8080;    ///< 0 picks a free one
  std::string token;  ///< needed for any address that is not loopback; 16 or more of [A-Za-z0-9_-]
  int max_connections = 64;
  int max_viewers = 16;
  std::chrono::milliseconds head_time{5000};    ///< for a whole request head, from its first byte
  std::chrono::milliseconds body_time{10000};   ///< span in which a body must bring 32 kB/s
  std::chrono::milliseconds write_time{10000};  ///< span in which a client must take 32 kB/s
  std::chrono::milliseconds idle_time{30000};   ///< between two requests of one connection
};

class Server {
 public:
  /// Binds and listens; the page's files are added to `routes`.
  /// @throws Error when the port is taken, the address is not of this machine, or a token is
  /// missing.
  Server(ServerOptions options, std::vector<Route> routes);
  ~Server();

  int port() const;
  std::string url() const;  ///< to open in a browser; holds the token when there is one
  void run();               ///< blocks until stop(); finishes requests in hand within 2 s
  void stop();              ///< asks run() to return; does not wait; from any thread or handler

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rend::web

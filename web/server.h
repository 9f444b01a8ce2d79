// An HTTP server that is safe to leave open: cpp-httplib behind our own guard, routes given by the caller.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rend::web {

struct Request {
  std::string method, path;
  std::map<std::string, std::string> query;
  std::vector<std::string> parts;  ///< values of the {placeholders} of the route, decoded
  std::string body;
  const std::atomic<bool>* stopping = nullptr;  ///< long waits must watch it
};

struct Response {
  int status = 200;
  std::string type = "application/json";
  std::string body;
  std::map<std::string, std::string> headers;
};

/// An RFC 9457 problem; `pointer` is a JSON pointer into the request body, empty when none applies.
Response problem(int status, const std::string& code, const std::string& detail, const std::string& pointer = "");

using Handler = std::function<Response(const Request&)>;

struct Route {
  std::string method;    ///< "GET", "POST", "PUT", "PATCH" or "DELETE"
  std::string pattern;   ///< "/api/frames/{n}.png"
  Handler handler;
  std::size_t body_limit = 64 * 1024;
  bool long_wait = false;  ///< long poll: runs in the pool of viewers, not in the pool of controls
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 8080;         ///< 0 picks a free one
  std::string token;       ///< needed for any address that is not loopback
  int max_connections = 64;
  int max_viewers = 16;
};

class Server {
 public:
  Server(ServerOptions options, std::vector<Route> routes);  ///< @throws Error when the port is taken
  ~Server();

  int port() const;
  std::string url() const;
  void run();   ///< blocks until stop(); finishes requests in hand within 2 s
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rend::web

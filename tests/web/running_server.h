// A server on a free loopback port with a few small routes, run by a thread of its own.
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "web/server.h"

namespace rend::test {

class RunningServer {
 public:
  explicit RunningServer(web::ServerOptions options = quick_options());
  ~RunningServer();

  int port() const { return server_->port(); }
  std::string url() const { return server_->url(); }
  bool alive() const;    ///< GET /api/ping answers 200 within a second
  void stop_and_join();  ///< asks the server to stop and waits for run() to return
  int handled() const { return handled_; }  ///< calls of POST /api/echo
  int waiting() const { return waiting_; }  ///< long polls in their handler now

  /// Port 0, no token, deadlines short enough for a test.
  static web::ServerOptions quick_options();

 private:
  std::vector<web::Route> routes();

  std::atomic<int> handled_{0}, waiting_{0};
  std::unique_ptr<web::Server> server_;
  std::thread thread_;
};

/// What GET /api/large-file answers: 24 MiB from a file, more than any socket takes at once.
const std::string& large_file_text();

}  // namespace rend::test

// A server on a free loopback port with a few small routes, run by a thread of its own.
#include "tests/web/running_server.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "engine/core/error.h"
#include "tests/web/raw_client.h"

namespace rend::test {

using namespace std::chrono_literals;
using web::Request;
using web::Response;
using web::Route;

const std::string& large_file_text() {
  static const std::string text = [] {
    std::string numbers;
    for (int i = 0; numbers.size() < (24u << 20); ++i) numbers += std::to_string(i) + ' ';
    return numbers;
  }();
  return text;
}

namespace {

// Loses its name at once: what is open stays readable.
std::shared_ptr<const web::FileBody> large_file() {
  std::string name = (std::filesystem::temp_directory_path() / "rend-web-XXXXXX").string();
  if (const int fd = mkstemp(name.data()); fd >= 0) ::close(fd);
  std::ofstream(name) << large_file_text();
  auto file = std::make_shared<const web::FileBody>(name);
  std::filesystem::remove(name);
  return file;
}

}  // namespace

web::ServerOptions RunningServer::quick_options() {
  web::ServerOptions options;
  options.port = 0;
  options.head_time = 600ms;
  options.body_time = 600ms;
  options.write_time = 600ms;
  options.idle_time = 5000ms;
  return options;
}

std::vector<Route> RunningServer::routes() {
  const auto text = [](std::string body) {
    return Response{200, "text/plain", std::move(body), {}};
  };
  std::vector<Route> routes;
  routes.push_back({"GET", "/", [=](const Request&) { return text("page"); }});
  routes.push_back({"GET", "/api/ping", [=](const Request&) { return text("pong"); }});
  routes.push_back({"POST", "/api/echo",
                    [this](const Request& request) {
                      ++handled_;
                      return Response{200, "application/json", request.body, {}};
                    },
                    1024});
  routes.push_back({"PATCH", "/api/echo", [](const Request& request) {
                      return Response{200, "application/json", "patched " + request.body, {}};
                    }});
  routes.push_back({"DELETE", "/api/things/{id}",
                    [=](const Request& request) { return text("deleted " + request.parts[0]); }});
  routes.push_back({"GET", "/api/frames/{n}.png", [=](const Request& request) {
                      const auto width = request.query.find("width");
                      return text("frame " + request.parts[0] + " " +
                                  (width == request.query.end() ? "" : width->second));
                    }});
  Route upload{"PUT", "/api/mesh",
               [=](const Request& request) { return text(std::to_string(request.body.size())); },
               8u << 20};
  upload.body_type = "application/octet-stream";
  routes.push_back(upload);
  routes.push_back(
      {"GET", "/api/big", [=](const Request&) { return text(std::string(16u << 20, 'x')); }});
  routes.push_back({"GET", "/api/large-file", [file = large_file()](const Request&) {
                      return Response{200, "application/zip", "", {}, file};
                    }});
  routes.push_back({"GET", "/api/error", [](const Request&) -> Response {
                      throw Error("scene.json#/bodies/0/density", "is -1, must be > 0");
                    }});
  routes.push_back({"GET", "/api/file-error", [](const Request&) -> Response {
                      throw Error("/home/someone/scene.json:12", "unknown key");
                    }});
  routes.push_back({"GET", "/api/bug",
                    [](const Request&) -> Response { throw std::runtime_error("secret detail"); }});
  routes.push_back({"GET", "/api/split", [](const Request&) {
                      return Response{200, "text/plain", "x", {{"X-Name", "a\r\nSet-Cookie: b=c"}}};
                    }});
  Route wait{"GET", "/api/wait", [=, this](const Request& request) {
               ++waiting_;
               const auto end = std::chrono::steady_clock::now() + 20s;
               while (!*request.stopping && std::chrono::steady_clock::now() < end) {
                 std::this_thread::sleep_for(5ms);
               }
               --waiting_;
               return text("waited");
             }};
  wait.long_wait = true;
  routes.push_back(wait);
  return routes;
}

RunningServer::RunningServer(web::ServerOptions options)
    : server_(std::make_unique<web::Server>(options, routes())),
      thread_([this] { server_->run(); }) {}

RunningServer::~RunningServer() { stop_and_join(); }

void RunningServer::stop_and_join() {
  server_->stop();
  if (thread_.joinable()) thread_.join();
}

bool RunningServer::alive() const {
  const std::string reply = ask(port(), get_request(port(), "/api/ping"), 1000ms);
  return status_of(reply) == 200 && body_of(reply) == "pong";
}

}  // namespace rend::test

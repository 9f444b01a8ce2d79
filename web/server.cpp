// Puts the listener, the page's files and the event loop together.
#include "web/server.h"

#include <csignal>
#include <set>

#include "engine/core/error.h"
#include "web/assets.h"
#include "web/event_loop.h"

namespace rend::web {
namespace {

Route asset_route(const Asset& asset, std::string pattern) {
  Route route;
  route.method = "GET";
  route.pattern = std::move(pattern);
  route.handler = [asset](const Request& request) {
    Response response;
    response.headers = {{"ETag", std::string(asset.etag)}, {"Cache-Control", "no-cache"}};
    const auto known = request.headers.find("if-none-match");
    if (known != request.headers.end() && known->second == asset.etag) {
      response.status = 304;
      return response;
    }
    response.type = std::string(asset.type);
    response.body = std::string(asset.bytes);
    return response;
  };
  return route;
}

std::vector<Route> with_page(std::vector<Route> routes) {
  std::set<std::string> taken;
  for (const Route& route : routes) {
    if (route.method == "GET") taken.insert(route.pattern);
  }
  const auto add = [&](const Asset& asset, std::string_view pattern) {
    const std::string path(pattern);
    if (taken.insert(path).second) routes.push_back(asset_route(asset, path));
  };
  for (const Asset& asset : page_assets()) {
    add(asset, asset.path);
    if (asset.path == "/index.html") add(asset, "/");
  }
  return routes;
}

Listener open_allowed(const ServerOptions& options) {
  if (!is_loopback(options.address) && options.token.empty()) {
    throw Error("listen address",
                options.address +
                    " can be reached from other machines, which needs a token: give "
                    "one, or listen on 127.0.0.1");
  }
  return open_listener(options.address, options.port);
}

std::string address_text(const Listener& listener, const std::string& token) {
  std::string text = "http://" + listener.display_host + ":" + std::to_string(listener.port) + "/";
  if (!token.empty()) text.append("?token=").append(token);
  return text;
}

}  // namespace

struct Server::State {
  State(const ServerOptions& options, std::vector<Route> routes, Listener listener)
      : port(listener.port),
        url(address_text(listener, options.token)),
        loop(options, std::move(listener), with_page(std::move(routes))) {}

  int port;
  std::string url;
  EventLoop loop;
};

Server::Server(ServerOptions options, std::vector<Route> routes) {
  // A client that leaves in the middle of a reply must not end the program.
  std::signal(SIGPIPE, SIG_IGN);
  state_ = std::make_unique<State>(options, std::move(routes), open_allowed(options));
}

Server::~Server() = default;

int Server::port() const { return state_->port; }
std::string Server::url() const { return state_->url; }
void Server::run() { state_->loop.run(); }
void Server::stop() { state_->loop.stop(); }

}  // namespace rend::web

// One thread that owns every socket; handlers run in two pools and never touch one.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "web/access_gate.h"
#include "web/http_codec.h"
#include "web/http_guard.h"
#include "web/listener.h"
#include "web/router.h"
#include "web/server.h"
#include "web/worker_pool.h"

namespace rend::web {

class EventLoop {
 public:
  EventLoop(const ServerOptions& options, Listener listener, std::vector<Route> routes);
  ~EventLoop();

  void run();
  void stop() noexcept;

 private:
  using Clock = std::chrono::steady_clock;

  enum class Phase {
    idle,      ///< between two requests
    head,      ///< some bytes of a head are here
    body,      ///< the head passed, the body is on its way
    working,   ///< a handler has it
    delayed,   ///< the reply is ready but held back
    writing,   ///< the reply is on its way
    draining,  ///< half closed, so that the client reads the reply instead of a reset
  };

  struct Connection {
    Descriptor socket;
    std::uint64_t id = 0;
    Phase phase = Phase::idle;
    Clock::time_point since{}, deadline{};
    std::uint32_t interest = 0;  ///< epoll events asked for
    bool watched = false;        ///< epoll knows the socket
    std::string in;
    std::size_t head_length = 0;
    GuardedHead head;
    Router::Match match;
    Reply out;
    std::uint64_t sent = 0;
    bool keep_alive = false;
    std::size_t drained = 0;
    std::uint64_t marked = 0;  ///< bytes the peer had moved when the deadline was last put off
    std::size_t reserved = 0;  ///< its share of body_bytes_
    std::shared_ptr<std::atomic<bool>> stopping;  ///< while a handler has it
  };

  struct Completion {
    std::uint64_t id;
    Reply reply;
  };

  void accept_new();
  void admit(int fd);
  bool make_room();
  void on_event(Connection& connection, std::uint32_t events);
  void receive(Connection& connection);
  void advance(Connection& connection);
  bool accept_head(Connection& connection);
  void dispatch(Connection& connection);
  void refuse(Connection& connection, const Response& response, bool keep_alive);
  void start_reply(Connection& connection, Reply reply, bool keep_alive);
  void send_more(Connection& connection);
  void finish_reply(Connection& connection);
  void drain(Connection& connection);
  void expire(Connection& connection);
  void expire_due();
  void begin_stop();
  void take_completions();
  int milliseconds_to_next_deadline() const;
  void enter(Connection& connection, Phase phase, Clock::duration allowed);
  void watch(Connection& connection, std::uint32_t events);
  void close(Connection& connection);
  void sweep();
  Connection* find(std::uint64_t id);

  ServerOptions options_;
  Listener listener_;
  GuardPolicy policy_;
  Router router_;
  AccessGate gate_;
  Descriptor epoll_, wake_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Connection>> connections_;
  std::vector<std::uint64_t> closed_;  ///< erased between two rounds, so that references stay good
  std::uint64_t next_id_ = 2;
  std::size_t body_bytes_ = 0;  ///< declared by all bodies on their way or in a handler
  Clock::time_point now_{}, accept_again_{}, give_up_{};
  bool accepting_ = true;
  std::atomic<bool> stop_{false};
  std::mutex completions_mutex_;
  std::vector<Completion> completions_;
  WorkerPool controls_, viewers_;  ///< last: their threads end before the rest goes
};

}  // namespace rend::web

// One thread that owns every socket: accepting, waiting, deadlines, stopping.
#include "web/event_loop.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace rend::web {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t listener_id = 0, wake_id = 1;
constexpr int control_threads = 4;
constexpr int refused_at_once = 64;  // sockets above the limit that may still be told 503

int live_epoll(int epoll, int fd, std::uint64_t id, std::uint32_t events, int operation) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = id;
  return ::epoll_ctl(epoll, operation, fd, &event);
}

}  // namespace

EventLoop::EventLoop(const ServerOptions& options, Listener listener, std::vector<Route> routes)
    : options_(options),
      listener_(std::move(listener)),
      router_(std::move(routes)),
      gate_(options.token, listener_.port),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      controls_(control_threads, std::max(1, options.max_connections)),
      viewers_(std::max(1, options.max_viewers), 0) {
  policy_.hosts = listener_.hosts;
  const int epoll = epoll_.get();
  if (epoll < 0 || wake_.get() < 0 ||
      live_epoll(epoll, listener_.socket.get(), listener_id, EPOLLIN, EPOLL_CTL_ADD) != 0 ||
      live_epoll(epoll, wake_.get(), wake_id, EPOLLIN, EPOLL_CTL_ADD) != 0) {
    throw std::runtime_error(std::string("cannot wait for connections: ") + std::strerror(errno));
  }
}

EventLoop::~EventLoop() {
  for (auto& [id, connection] : connections_) {
    if (connection->stopping) *connection->stopping = true;
  }
}

void EventLoop::stop() noexcept {
  stop_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(wake_.get(), &one, sizeof one);
}

void EventLoop::run() {
  std::array<epoll_event, 64> events{};
  bool stopping = false;
  for (;;) {
    now_ = Clock::now();
    if (stop_ && !stopping) {
      stopping = true;
      begin_stop();
      sweep();
    }
    if (stopping && (connections_.empty() || now_ >= give_up_)) break;
    const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()),
                                   milliseconds_to_next_deadline());
    now_ = Clock::now();
    for (int i = 0; i < count; ++i) {
      const auto& event = events[static_cast<std::size_t>(i)];
      if (event.data.u64 == listener_id) {
        accept_new();
      } else if (event.data.u64 == wake_id) {
        std::uint64_t ignored = 0;
        [[maybe_unused]] const auto got = ::read(wake_.get(), &ignored, sizeof ignored);
      } else if (Connection* connection = find(event.data.u64)) {
        on_event(*connection, event.events);
      }
    }
    take_completions();
    expire_due();
    sweep();
  }
  for (auto& [id, connection] : connections_) close(*connection);
  sweep();
}

void EventLoop::accept_new() {
  for (int i = 0; i < 64 && !stop_; ++i) {
    const int fd =
        ::accept4(listener_.socket.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd >= 0) {
      admit(fd);
      continue;
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) return;
    if (errno == EINTR || errno == ECONNABORTED) continue;
    // Out of descriptors or memory: free what idles, let the backlog wait, never give up the port.
    std::fprintf(stderr, "rend: cannot accept a connection: %s\n", std::strerror(errno));
    make_room();
    accepting_ = false;
    accept_again_ = now_ + 200ms;
    live_epoll(epoll_.get(), listener_.socket.get(), listener_id, 0, EPOLL_CTL_MOD);
    return;
  }
}

void EventLoop::admit(int fd) {
  const int live = static_cast<int>(connections_.size() - closed_.size());
  const bool room = live < options_.max_connections || make_room();
  Descriptor socket(fd);
  if (!room && live >= options_.max_connections + refused_at_once) return;
  auto owner = std::make_unique<Connection>();
  Connection& connection = *owner;
  connection.socket = std::move(socket);
  connection.id = next_id_++;
  connections_.emplace(connection.id, std::move(owner));
  enter(connection, Phase::idle, options_.head_time);
  if (!room) {
    Response busy = problem(503, "too_many_connections", "All connections are in use.");
    busy.headers.emplace("Retry-After", "1");
    return refuse(connection, busy, false);
  }
  watch(connection, EPOLLIN | EPOLLRDHUP);
  receive(connection);
}

// Whoever keeps a slot without using it goes first, so slow clients cannot keep new ones out.
bool EventLoop::make_room() {
  const auto rank = [&](const Connection& connection) {
    switch (connection.phase) {
      case Phase::draining:
        return 0;
      case Phase::delayed:
        return 1;
      case Phase::idle:
        return 2;
      case Phase::head:
        return 3;
      case Phase::body:
        return 4;
      case Phase::writing:
        return now_ - connection.since > 1s ? 5 : 9;
      case Phase::working:
        return 9;
    }
    return 9;
  };
  Connection* victim = nullptr;
  for (auto& [id, connection] : connections_) {
    if (connection->socket.get() < 0 || rank(*connection) > 5) continue;
    const auto key = [&](const Connection& c) { return std::make_pair(rank(c), c.since); };
    if (!victim || key(*connection) < key(*victim)) victim = connection.get();
  }
  if (victim) close(*victim);
  return victim != nullptr;
}

void EventLoop::expire_due() {
  if (!accepting_ && now_ >= accept_again_ && !stop_) {
    accepting_ = true;
    live_epoll(epoll_.get(), listener_.socket.get(), listener_id, EPOLLIN, EPOLL_CTL_MOD);
  }
  for (auto& [id, connection] : connections_) {
    if (connection->socket.get() >= 0 && now_ >= connection->deadline) expire(*connection);
  }
}

int EventLoop::milliseconds_to_next_deadline() const {
  auto next = Clock::time_point::max();
  if (!accepting_) next = accept_again_;
  if (stop_) next = std::min(next, give_up_);
  for (const auto& [id, connection] : connections_) next = std::min(next, connection->deadline);
  if (next == Clock::time_point::max()) return -1;
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(next - now_).count();
  return static_cast<int>(std::clamp<std::int64_t>(left + 1, 0, 60'000));
}

void EventLoop::begin_stop() {
  give_up_ = now_ + 1800ms;
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, listener_.socket.get(), nullptr);
  listener_.socket.reset();
  accepting_ = true;
  for (auto& [id, connection] : connections_) {
    if (connection->phase == Phase::working) {
      *connection->stopping = true;
    } else if (connection->phase != Phase::writing) {
      close(*connection);
    }
  }
}

void EventLoop::take_completions() {
  std::vector<Completion> done;
  {
    const std::lock_guard lock(completions_mutex_);
    done.swap(completions_);
  }
  for (Completion& completion : done) {
    Connection* connection = find(completion.id);
    if (!connection) continue;
    connection->stopping.reset();
    start_reply(*connection, std::move(completion.reply), connection->keep_alive);
  }
}

void EventLoop::enter(Connection& connection, Phase phase, Clock::duration allowed) {
  connection.phase = phase;
  connection.since = now_;
  connection.marked = 0;
  connection.deadline =
      allowed == Clock::duration::max() ? Clock::time_point::max() : now_ + allowed;
}

void EventLoop::watch(Connection& connection, std::uint32_t events) {
  if (connection.watched && connection.interest == events) return;
  live_epoll(epoll_.get(), connection.socket.get(), connection.id, events,
             connection.watched ? EPOLL_CTL_MOD : EPOLL_CTL_ADD);
  connection.watched = true;
  connection.interest = events;
}

void EventLoop::close(Connection& connection) {
  if (connection.socket.get() < 0) return;
  if (connection.stopping) *connection.stopping = true;
  body_bytes_ -= std::exchange(connection.reserved, 0);
  connection.socket.reset();
  connection.deadline = Clock::time_point::max();
  closed_.push_back(connection.id);
}

void EventLoop::sweep() {
  for (const std::uint64_t id : closed_) connections_.erase(id);
  closed_.clear();
}

EventLoop::Connection* EventLoop::find(std::uint64_t id) {
  const auto it = connections_.find(id);
  return it == connections_.end() || it->second->socket.get() < 0 ? nullptr : it->second.get();
}

}  // namespace rend::web

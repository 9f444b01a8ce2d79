// One request after another on a connection: receive, check, dispatch, reply.
#include <linux/sockios.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/sendfile.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <utility>

#include "web/event_loop.h"
#include "web/http_codec.h"

namespace rend::web {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t all_bodies_limit = 256u << 20;
constexpr std::size_t drain_limit = 1u << 20;
constexpr std::size_t turn_limit = 4u << 20;  // of a file, before others have their turn

// A peer may be slow, but not slower than 32 kB/s over a whole span of waiting.
bool moved_enough(std::uint64_t bytes, std::chrono::milliseconds span) {
  return bytes >= static_cast<std::uint64_t>(span.count()) * 32;
}

// What the client has taken, not what the kernel holds for it: buffers swallow megabytes at once.
std::uint64_t acknowledged(int fd, std::uint64_t sent) {
  int queued = 0;
  if (::ioctl(fd, SIOCOUTQ, &queued) != 0) return sent;
  return sent - std::min(sent, static_cast<std::uint64_t>(queued));
}

// One call's worth of what follows the first `sent` bytes.
ssize_t send_some(int socket, const Reply& reply, std::uint64_t sent) {
  if (sent < reply.bytes.size())
    return ::send(socket, reply.bytes.data() + sent, reply.bytes.size() - sent,
                  MSG_NOSIGNAL | MSG_DONTWAIT);
  auto offset = static_cast<off_t>(sent - reply.bytes.size());
  return ::sendfile(socket, reply.file->descriptor(), &offset,
                    std::min<std::uint64_t>(reply.size() - sent, turn_limit));
}

Response problem_of(const Refusal& refusal) {
  return problem(refusal.status, refusal.code, refusal.detail);
}

Response try_later(const std::string& code, const std::string& detail) {
  Response response = problem(503, code, detail);
  response.headers.emplace("Retry-After", "1");
  return response;
}

bool body_type_fits(const std::string& wanted, const GuardedHead& head) {
  const auto it = head.headers.find("content-type");
  if (it == head.headers.end()) return false;
  std::string type = it->second.substr(0, it->second.find_first_of("; \t"));
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (type == wanted) return true;
  return wanted == "application/json" && type.starts_with("application/") &&
         type.ends_with("+json");
}

}  // namespace

void EventLoop::on_event(Connection& connection, std::uint32_t events) {
  if (events & (EPOLLERR | EPOLLHUP)) return close(connection);
  switch (connection.phase) {
    case Phase::idle:
    case Phase::head:
    case Phase::body:
      return receive(connection);
    case Phase::working:
      // A client that half-closes still gets its reply, only nobody waits for news on its behalf.
      if (connection.match.route->long_wait) *connection.stopping = true;
      return watch(connection, 0);
    case Phase::delayed:
      return;
    case Phase::writing:
      return send_more(connection);
    case Phase::draining:
      return drain(connection);
  }
}

void EventLoop::receive(Connection& connection) {
  std::array<char, 64 * 1024> buffer;
  const ssize_t count = ::recv(connection.socket.get(), buffer.data(), buffer.size(), 0);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count <= 0) return close(connection);
  connection.in.append(buffer.data(), static_cast<std::size_t>(count));
  advance(connection);
}

void EventLoop::advance(Connection& connection) {
  if (connection.phase == Phase::idle || connection.phase == Phase::head) {
    const HeadScan scan = scan_head(connection.in, policy_);
    if (scan.refusal) return refuse(connection, problem_of(scan.refusal), false);
    if (scan.state == HeadScan::State::more) {
      if (connection.phase == Phase::idle) enter(connection, Phase::head, options_.head_time);
      return;
    }
    connection.head_length = scan.length;
    if (!accept_head(connection)) return;
    enter(connection, Phase::body, options_.body_time);
  }
  const std::size_t got = connection.in.size() - connection.head_length;
  if (got >= connection.head.content_length) dispatch(connection);
}

// Everything that can be refused is refused here, before a byte of the body is waited for.
bool EventLoop::accept_head(Connection& connection) {
  GuardedHead& head = connection.head;
  head = check_head(std::string_view(connection.in).substr(0, connection.head_length), policy_);
  if (head.refusal) {
    refuse(connection, problem_of(head.refusal), false);
    return false;
  }
  const bool bare = head.content_length == 0 && connection.in.size() == connection.head_length;
  const bool keep = head.keep_alive && bare;
  const auto turn_away = [&](const Response& response) {
    refuse(connection, response, keep);
    return false;
  };
  using Verdict = AccessGate::Verdict;
  const Verdict verdict = gate_.judge(head, now_);
  if (verdict == Verdict::greet) {
    Response hello{303, "", "", {{"Location", "/"}, {"Set-Cookie", gate_.cookie()}}};
    return turn_away(hello);
  }
  if (verdict != Verdict::pass) {
    Response denied = problem(401, "token", "This server needs its token.");
    denied.headers.emplace("WWW-Authenticate", "Bearer");
    if (verdict == Verdict::missing || gate_.penalty() == 0ms) return turn_away(denied);
    connection.keep_alive = false;
    connection.out = encode_response(denied, false, head.method == "HEAD");
    enter(connection, Phase::delayed, gate_.penalty());
    watch(connection, 0);
    return false;
  }
  connection.match = router_.find(head.method, head.path);
  if (!connection.match.route) {
    if (connection.match.allow.empty()) {
      return turn_away(problem(404, "not_found", "Nothing is at this path."));
    }
    Response other = problem(405, "method_not_allowed", "Allowed: " + connection.match.allow + ".");
    other.headers.emplace("Allow", connection.match.allow);
    return turn_away(other);
  }
  const Route& route = *connection.match.route;
  if (head.content_length > route.body_limit) {
    return turn_away(problem(413, "body_too_large",
                             "The body may have " + std::to_string(route.body_limit) + " bytes."));
  }
  if (head.content_length > 0 && !body_type_fits(route.body_type, head)) {
    return turn_away(problem(415, "content_type", "The body must be " + route.body_type + "."));
  }
  if (body_bytes_ + head.content_length > all_bodies_limit) {
    return turn_away(try_later("too_many_uploads", "Other uploads fill the memory set aside."));
  }
  connection.reserved = head.content_length;
  body_bytes_ += connection.reserved;
  return true;
}

void EventLoop::dispatch(Connection& connection) {
  struct Job {
    GuardedHead head;
    Router::Match match;
    std::string body;
    bool keep_alive;
    std::shared_ptr<std::atomic<bool>> stopping;
  };
  const GuardedHead& head = connection.head;
  // Bytes behind the body were not asked for: answer this request and listen no further.
  const bool excess = connection.in.size() > connection.head_length + head.content_length;
  connection.keep_alive = head.keep_alive && !excess && !stop_;
  connection.in.erase(0, connection.head_length);
  connection.in.resize(head.content_length);
  connection.stopping = std::make_shared<std::atomic<bool>>(stop_.load());
  auto job = std::make_shared<Job>(Job{head, connection.match, std::move(connection.in),
                                       connection.keep_alive, connection.stopping});
  connection.in.clear();
  const auto work = [this, id = connection.id, job] {
    Reply reply = answer_request(job->head, job->keep_alive, [&](const Request& parsed) {
      Request request = parsed;
      request.parts = std::move(job->match.parts);
      request.body = std::move(job->body);
      request.stopping = job->stopping.get();
      return job->match.route->handler(request);
    });
    {
      const std::lock_guard lock(completions_mutex_);
      completions_.push_back({id, std::move(reply)});
    }
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(wake_.get(), &one, sizeof one);
  };
  enter(connection, Phase::working, Clock::duration::max());
  watch(connection, EPOLLRDHUP);
  const bool long_wait = job->match.route->long_wait;
  if ((long_wait ? viewers_ : controls_).try_submit(work)) return;
  connection.stopping.reset();
  refuse(connection,
         long_wait ? try_later("too_many_viewers", "All viewers' places are taken.")
                   : try_later("busy", "Too many requests wait."),
         connection.keep_alive);
}

void EventLoop::refuse(Connection& connection, const Response& response, bool keep_alive) {
  connection.in.clear();
  start_reply(connection, encode_response(response, keep_alive, connection.head.method == "HEAD"),
              keep_alive);
}

void EventLoop::start_reply(Connection& connection, Reply reply, bool keep_alive) {
  body_bytes_ -= std::exchange(connection.reserved, 0);
  connection.out = std::move(reply);
  connection.keep_alive = keep_alive;
  enter(connection, Phase::writing, options_.write_time);
  send_more(connection);
}

void EventLoop::send_more(Connection& connection) {
  const Reply& out = connection.out;
  const std::uint64_t turn_end = connection.sent + turn_limit;
  while (connection.sent < out.size()) {
    if (out.file && connection.sent >= turn_end) return watch(connection, EPOLLOUT);
    const ssize_t count = send_some(connection.socket.get(), out, connection.sent);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      return watch(connection, EPOLLOUT);
    }
    if (count <= 0) return close(connection);
    connection.sent += static_cast<std::uint64_t>(count);
  }
  finish_reply(connection);
}

void EventLoop::finish_reply(Connection& connection) {
  connection.out = {};
  connection.sent = 0;
  connection.head = {};
  connection.match = {};
  watch(connection, EPOLLIN | EPOLLRDHUP);
  if (connection.keep_alive && !stop_) {
    return enter(connection, Phase::idle, options_.idle_time);
  }
  ::shutdown(connection.socket.get(), SHUT_WR);
  enter(connection, Phase::draining, 300ms);
}

void EventLoop::drain(Connection& connection) {
  std::array<char, 64 * 1024> buffer;
  const ssize_t count = ::recv(connection.socket.get(), buffer.data(), buffer.size(), 0);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count > 0) connection.drained += static_cast<std::size_t>(count);
  if (count <= 0 || connection.drained > drain_limit) close(connection);
}

void EventLoop::expire(Connection& connection) {
  // Grants another span when the peer kept moving during the last one.
  const auto extend = [&](std::size_t moved, std::chrono::milliseconds span) {
    if (!moved_enough(moved - connection.marked, span)) return false;
    connection.marked = moved;
    connection.deadline = now_ + span;
    return true;
  };
  switch (connection.phase) {
    case Phase::body:
      if (extend(connection.in.size(), options_.body_time)) return;
      [[fallthrough]];
    case Phase::head:
      return refuse(connection, problem(408, "timeout", "The request took too long to arrive."),
                    false);
    case Phase::delayed:
      enter(connection, Phase::writing, options_.write_time);
      return send_more(connection);
    case Phase::writing:
      if (extend(acknowledged(connection.socket.get(), connection.sent), options_.write_time)) {
        return;
      }
      return close(connection);
    case Phase::idle:
    case Phase::draining:
    case Phase::working:
      return close(connection);
  }
}

}  // namespace rend::web

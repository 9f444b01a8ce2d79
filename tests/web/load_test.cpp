// Many clients, slow clients, silent clients: somebody new is always served, and nothing is left
// over.
#include <doctest/doctest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/web/raw_client.h"
#include "tests/web/running_server.h"

using namespace rend;
using namespace rend::test;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

std::vector<std::unique_ptr<RawClient>> connect_many(int port, int count,
                                                     const std::string& bytes) {
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < count; ++i) {
    clients.push_back(std::make_unique<RawClient>(port));
    if (!bytes.empty()) clients.back()->send(bytes);
  }
  return clients;
}

long open_descriptors() {
  const std::filesystem::directory_iterator entries("/proc/self/fd");
  return std::distance(begin(entries), end(entries));
}

// True when the condition holds within a second.
template <class Condition>
bool soon(Condition condition) {
  const auto end = Clock::now() + 1s;
  while (!condition()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(5ms);
  }
  return true;
}

}  // namespace

TEST_CASE("64 slow heads and 200 silent connections do not keep a new client out") {
  web::ServerOptions options = RunningServer::quick_options();
  options.head_time = 5000ms;
  RunningServer server(options);
  auto slow = connect_many(server.port(), 64, "GET /api/ping HTTP/1.1\r\n");
  auto silent = connect_many(server.port(), 200, "");
  for (int round = 0; round < 5; ++round) {
    for (auto& client : slow) client->send("X-A: b\r\n");
    const auto start = Clock::now();
    CHECK(server.alive());
    CHECK(Clock::now() - start < 1s);
  }
}

TEST_CASE("1000 connections at once, each with one request") {
  RunningServer server;
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  rlimit wide = before;
  wide.rlim_cur = std::min<rlim_t>(before.rlim_max, 4096);
  setrlimit(RLIMIT_NOFILE, &wide);
  {
    auto clients = connect_many(server.port(), 1000, get_request(server.port(), "/api/ping"));
    int served = 0, refused = 0;
    for (auto& client : clients) {
      const int status = client->connected() ? status_of(client->read_reply(1000ms)) : 0;
      served += status == 200;
      refused += status == 503;
    }
    MESSAGE("of 1000: served " << served << ", told 503 " << refused);
    CHECK(served + refused >= 900);
    CHECK(served >= 64);
    CHECK(server.alive());
  }
  setrlimit(RLIMIT_NOFILE, &before);
}

TEST_CASE("long polls fill their own places and leave the controls alone") {
  web::ServerOptions options = RunningServer::quick_options();
  options.max_viewers = 4;
  RunningServer server(options);
  const std::string wait = get_request(server.port(), "/api/wait");
  auto viewers = connect_many(server.port(), 4, wait);
  REQUIRE(soon([&] { return server.waiting() == 4; }));
  const std::string fifth = ask(server.port(), wait);
  CHECK(status_of(fifth) == 503);
  CHECK(header_of(fifth, "Retry-After") == "1");
  const auto start = Clock::now();
  for (int i = 0; i < 20; ++i) {
    CHECK(status_of(ask(server.port(), body_request(server.port(), "POST", "/api/echo", "1"))) ==
          200);
  }
  CHECK(Clock::now() - start < 1s);
  // A viewer that leaves gives its place back without waiting out its poll.
  viewers.pop_back();
  CHECK(soon([&] { return server.waiting() == 3; }));
  viewers.push_back(std::make_unique<RawClient>(server.port()));
  viewers.back()->send(wait);
  CHECK(soon([&] { return server.waiting() == 4; }));
}

TEST_CASE("readers that stall or crawl are dropped, others are not held up") {
  RunningServer server;
  for (const char* path : {"/api/big", "/api/large-file"}) {
    CAPTURE(path);
    RawClient stalled(server.port());
    stalled.send(get_request(server.port(), path));
    RawClient good(server.port());
    good.send(get_request(server.port(), path));
    CHECK(body_of(good.read_reply(5000ms)).size() >= 16u << 20);
    CHECK(server.alive());
    std::this_thread::sleep_for(1200ms);
    CHECK(body_of(stalled.read_to_end(2000ms)).size() < 16u << 20);
  }
}

TEST_CASE("an upload may be slow but not stall, a download too") {
  RunningServer server;
  const std::string body(200'000, 'm');
  const std::string put =
      body_request(server.port(), "PUT", "/api/mesh", body, "application/octet-stream");
  RawClient steady(server.port());
  // 200 kB in 1.5 s: more than twice body_time, at four times the least rate.
  for (std::size_t at = 0; at < put.size(); at += 20'000) {
    REQUIRE(steady.send(put.substr(at, 20'000)));
    std::this_thread::sleep_for(150ms);
  }
  CHECK(body_of(steady.read_reply()) == "200000");
  RawClient crawling(server.port());
  crawling.send(put.substr(0, 1000));
  const auto start = Clock::now();
  std::string reply;
  while (reply.empty() && Clock::now() - start < 3s) {
    crawling.send("m");
    reply = crawling.read_reply(50ms);
  }
  CHECK(status_of(reply) == 408);
  CHECK(Clock::now() - start < 2s);
}

TEST_CASE("10 000 control posts over a few connections are all handled") {
  RunningServer server;
  std::vector<std::thread> threads;
  const auto start = Clock::now();
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      RawClient client(server.port());
      const std::string post = body_request(server.port(), "POST", "/api/echo", "[1]");
      for (int i = 0; i < 2500; ++i) {
        if (!client.send(post) || status_of(client.read_reply()) != 200) return;
      }
    });
  }
  for (auto& thread : threads) thread.join();
  CHECK(server.handled() == 10'000);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  MESSAGE("10000 posts in " << seconds << " s");
}

TEST_CASE("request rate and latency of a kept connection") {
  RunningServer server;
  RawClient client(server.port());
  const std::string get = get_request(server.port(), "/api/ping");
  std::vector<double> micros;
  const auto start = Clock::now();
  for (int i = 0; i < 3000; ++i) {
    const auto sent = Clock::now();
    client.send(get);
    REQUIRE(status_of(client.read_reply()) == 200);
    micros.push_back(std::chrono::duration<double, std::micro>(Clock::now() - sent).count());
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  std::sort(micros.begin(), micros.end());
  MESSAGE("one connection: " << static_cast<int>(3000 / seconds) << " requests/s, p50 "
                             << micros[1500] << " us, p99 " << micros[2970] << " us");
  // Nagle with delayed acknowledgements would cost 40 ms a request.
  CHECK(micros[1500] < 20'000);
}

TEST_CASE("descriptors return to the base after many comings and goings") {
  RunningServer server;
  REQUIRE(server.alive());
  const long base = open_descriptors();
  const std::string ping = get_request(server.port(), "/api/ping");
  for (int i = 0; i < 200; ++i) {
    RawClient client(server.port());
    switch (i % 4) {
      case 0:
        client.send(ping);
        break;  // leaves before the reply
      case 1:
        client.send(ping.substr(0, 20));
        break;
      case 2:
        client.send(get_request(server.port(), "/api/big"));
        break;
      default:
        client.send(ping), client.read_reply();
    }
  }
  CHECK(soon([&] { return open_descriptors() <= base; }));
  CHECK(server.alive());
}

TEST_CASE("running out of descriptors pauses accepting and ends nothing") {
  RunningServer server;
  const long base = open_descriptors();
  REQUIRE(server.alive());
  REQUIRE(soon([&] { return open_descriptors() == base; }));
  RawClient client(server.port());
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  rlimit tight = before;
  const int next = ::dup(0);  // the number the accepted socket would get
  ::close(next);
  tight.rlim_cur = static_cast<rlim_t>(next);
  setrlimit(RLIMIT_NOFILE, &tight);
  client.send(get_request(server.port(), "/api/ping"));
  const std::string starved = client.read_reply(300ms);
  setrlimit(RLIMIT_NOFILE, &before);
  CHECK(starved.empty());
  CHECK(status_of(client.read_reply(1000ms)) == 200);
}

TEST_CASE("stop under load returns within two seconds, 20 times") {
  std::mt19937 random(7);
  const long base = open_descriptors();
  for (int round = 0; round < 20; ++round) {
    auto server = std::make_unique<RunningServer>();
    const int port = server->port();
    std::atomic<bool> done{false};
    std::vector<std::thread> load;
    for (int t = 0; t < 3; ++t) {
      load.emplace_back([&, t] {
        while (!done) {
          RawClient client(port);
          if (!client.connected()) break;
          client.send(get_request(port, t == 0 ? "/api/big" : "/api/ping"));
          client.read_reply(200ms);
        }
      });
    }
    auto viewers = connect_many(port, 5, get_request(port, "/api/wait"));
    auto slow = connect_many(port, 5, "GET /api/pi");
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
    const auto start = Clock::now();
    server->stop_and_join();
    server.reset();
    CHECK(Clock::now() - start < 2s);
    done = true;
    for (auto& thread : load) thread.join();
    for (auto& viewer : viewers) CHECK(viewer->closed_by_server(500ms));
  }
  CHECK(soon([&] { return open_descriptors() <= base; }));
}

TEST_CASE("a long poll in hand gets its reply when the server stops") {
  RunningServer server;
  RawClient viewer(server.port());
  viewer.send(get_request(server.port(), "/api/wait"));
  REQUIRE(soon([&] { return server.waiting() == 1; }));
  server.stop_and_join();
  CHECK(body_of(viewer.read_reply(500ms)) == "waited");
}

// The token: who gets in, what a guesser meets, what the cookie looks like.
#include <doctest/doctest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "tests/web/raw_client.h"
#include "tests/web/running_server.h"
#include "web/access_gate.h"

using namespace rend;
using namespace rend::test;
using namespace std::chrono_literals;

namespace {

const std::string token = "0123456789abcdef0123456789abcdef";

web::ServerOptions with_token() {
  web::ServerOptions options = RunningServer::quick_options();
  options.token = token;
  return options;
}

std::string cookie_of(const std::string& set_cookie) {
  return set_cookie.substr(0, set_cookie.find(';'));
}

}  // namespace

TEST_CASE("the printed address sets a cookie and leaves the token out of the page's address") {
  RunningServer server(with_token());
  const int port = server.port();
  CHECK(server.url() == "http://127.0.0.1:" + std::to_string(port) + "/?token=" + token);
  CHECK(status_of(ask(port, get_request(port, "/"))) == 401);
  CHECK(status_of(ask(port, get_request(port, "/api/ping"))) == 401);
  CHECK(status_of(ask(port, get_request(port, "/api/nothing"))) == 401);

  const std::string greeting = ask(port, get_request(port, "/?token=" + token));
  CHECK(status_of(greeting) == 303);
  CHECK(header_of(greeting, "Location") == "/");
  const std::string set = header_of(greeting, "Set-Cookie");
  CHECK(set ==
        "rend_" + std::to_string(port) + "=" + token + "; Path=/; HttpOnly; SameSite=Strict");
  CHECK(body_of(ask(port, get_request(port, "/", "Cookie: other=1; " + cookie_of(set) + "\r\n"))) ==
        "page");
  CHECK(status_of(ask(
            port, get_request(port, "/api/ping", "Cookie: " + cookie_of(set) + "\r\n"))) == 200);
  CHECK(status_of(ask(port, get_request(port, "/api/ping",
                                        "Authorization: Bearer " + token + "\r\n"))) == 200);
  CHECK(status_of(ask(port, get_request(port, "/api/ping?token=" + token))) == 401);
}

TEST_CASE("a token does not open the door to foreign pages") {
  RunningServer server(with_token());
  const std::string reply =
      ask(server.port(),
          body_request(server.port(), "POST", "/api/echo", "1", "application/json",
                       "Authorization: Bearer " + token + "\r\nOrigin: http://evil\r\n"));
  CHECK(status_of(reply) == 403);
}

TEST_CASE("1000 wrong tokens are all refused, after the tenth slowly, and the right one is not") {
  RunningServer server(with_token());
  const int port = server.port();
  const auto wrong = [&](int n) {
    return get_request(port, "/api/ping",
                       "Authorization: Bearer wrong" + std::to_string(n) + "\r\n");
  };
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 10; ++i) CHECK(status_of(ask(port, wrong(i))) == 401);
  CHECK(std::chrono::steady_clock::now() - start < 1s);
  const auto eleventh = std::chrono::steady_clock::now();
  CHECK(status_of(ask(port, wrong(11))) == 401);
  CHECK(std::chrono::steady_clock::now() - eleventh >= 240ms);

  std::atomic<int> refused{0};
  std::vector<std::thread> guessers;
  for (int t = 0; t < 55; ++t) {
    guessers.emplace_back([&, t] {
      for (int i = 0; i < 18; ++i) {
        refused += status_of(ask(port, wrong(100 + 18 * t + i))) == 401 ? 1 : 0;
      }
    });
  }
  const auto honest = std::chrono::steady_clock::now();
  CHECK(status_of(ask(port, get_request(port, "/api/ping",
                                        "Authorization: Bearer " + token + "\r\n"))) == 200);
  CHECK(std::chrono::steady_clock::now() - honest < 240ms);
  for (auto& guesser : guessers) guesser.join();
  CHECK(refused == 990);
}

TEST_CASE("tokens are 32 random hexadecimal digits, compared in full") {
  const std::string a = web::random_token(), b = web::random_token();
  CHECK(a.size() == 32);
  CHECK(a.find_first_not_of("0123456789abcdef") == std::string::npos);
  CHECK(a != b);
  CHECK(web::equal_in_constant_time(a, a));
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::string other = a;
    other[i] ^= 1;
    CHECK(!web::equal_in_constant_time(a, other));
  }
  CHECK(!web::equal_in_constant_time(a, a.substr(0, 31)));
  CHECK(!web::equal_in_constant_time(a, a + a));
  CHECK(!web::equal_in_constant_time(a, ""));
  CHECK(!web::equal_in_constant_time("", a));
}

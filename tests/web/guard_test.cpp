// The guard as a pure function: what random heads may never get past it.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/web/head_properties.h"
#include "web/http_guard.h"

using namespace rend;

namespace {

web::GuardPolicy policy() {
  web::GuardPolicy policy;
  policy.hosts = {"127.0.0.1:8080", "localhost:8080"};
  return policy;
}

std::string mutated(std::string text, std::mt19937& random) {
  const auto pick = [&](std::size_t n) {
    return static_cast<std::size_t>(random() % std::max<std::size_t>(n, 1));
  };
  static const std::vector<std::string> pieces = {"\r\n",
                                                  "\n",
                                                  "\r",
                                                  ":",
                                                  " ",
                                                  "%0d%0a",
                                                  "%",
                                                  "..",
                                                  "\t",
                                                  std::string(1, '\0'),
                                                  "Host: evil\r\n",
                                                  "Transfer-Encoding: chunked\r\n",
                                                  "Content-Length: 3\r\n",
                                                  "Content-Length: 03\r\n",
                                                  "?",
                                                  "#",
                                                  "transfer-encoding : x\r\n",
                                                  "Origin: http://evil\r\n",
                                                  "Origin: http://localhost:8080\r\n",
                                                  "Sec-Fetch-Site: cross-site\r\n",
                                                  "Connection: close\r\n",
                                                  "Accept: a%0ab\r\n",
                                                  "\r\n\r\n",
                                                  "POST /"};
  const int edits = static_cast<int>(pick(4));
  for (int i = 0; i < edits; ++i) {
    const std::size_t at = pick(text.size() + 1);
    switch (pick(5)) {
      case 0:
        text.insert(at, pieces[pick(pieces.size())]);
        break;
      case 1:
        text.insert(at, 1, static_cast<char>(pick(256)));
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(pick(256));
        break;
      case 3:
        text.erase(std::min(at, text.size()), pick(6));
        break;
      default: {
        // Whole header lines matter most, so place them where lines begin.
        const auto line = text.find("\r\n");
        if (line != std::string::npos) text.insert(line + 2, pieces[10 + pick(10)]);
      }
    }
  }
  return text;
}

}  // namespace

TEST_CASE("100 000 mutated and random heads: nothing unsafe passes") {
  std::mt19937 random(20240917);
  const std::vector<std::string> seeds = {
      "GET /api/frames/3.png?w=1&h=2 HTTP/1.1\r\nHost: localhost:8080\r\nAccept: image/png\r\n\r\n",
      "POST /api/x HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nContent-Length: 12\r\nContent-Type: "
      "application/json\r\n\r\n",
      "DELETE /a%20b HTTP/1.0\r\nHost: LOCALHOST:8080\r\nCookie: rend=1\r\nAuthorization: Bearer "
      "x\r\n\r\n",
      "PATCH /p HTTP/1.1\r\nHost: localhost:8080\r\nOrigin: "
      "http://localhost:8080\r\nContent-Length: 0\r\n\r\n"};
  int passed = 0;
  for (int i = 0; i < 100'000; ++i) {
    std::string bytes;
    if (i % 10 == 0) {
      for (std::size_t n = random() % 80; n > 0; --n) bytes += static_cast<char>(random() % 256);
    } else {
      bytes = mutated(seeds[random() % seeds.size()], random);
    }
    const std::string broken = test::broken_property(bytes, policy());
    if (!broken.empty()) {
      CAPTURE(bytes);
      FAIL(broken);
    }
    passed += !web::check_head(bytes, policy()).refusal ? 1 : 0;
  }
  // The properties say nothing if hardly anything passes.
  CHECK(passed > 5'000);
  MESSAGE(passed << " of 100000 heads passed the guard");
}

TEST_CASE("only allowed headers are handed on, and none the library would decode") {
  const auto head =
      web::check_head("GET /a?b=%0 HTTP/1.1\r\nHost: localhost:8080\r\n\r\n", policy());
  CHECK(head.refusal.status == 400);
  const auto fine = web::check_head(
      "GET /a%20b?c=%2F HTTP/1.1\r\nHost: Localhost:8080\r\nX-Forwarded-For: 1\r\nRange: "
      "bytes=0-\r\n"
      "Cookie: k=v\r\nAccept: a%0d%0ab\r\nIf-None-Match: \"x\"\r\n\r\n",
      policy());
  REQUIRE(!fine.refusal);
  CHECK(fine.path == "/a b");
  CHECK(fine.query == "c=%2F");
  CHECK(fine.cookie == "k=v");
  CHECK(fine.block == "GET /a%20b?c=%2F HTTP/1.1\r\nif-none-match: \"x\"\r\n\r\n");
}

TEST_CASE("percent escapes") {
  std::string out;
  CHECK(web::percent_decode("a%41%7a%20", out));
  CHECK(out == "aAz ");
  for (const char* bad : {"%", "%4", "%g0", "%0g", "%u0041", "a%"}) {
    CAPTURE(bad);
    CHECK(!web::percent_decode(bad, out));
  }
}

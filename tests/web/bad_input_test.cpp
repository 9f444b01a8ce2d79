// Hostile requests, byte by byte: each gets its one status, quickly, and the server lives on.
#include <doctest/doctest.h>

#include <chrono>
#include <fstream>
#include <string>
#include <vector>

#include "tests/web/raw_client.h"
#include "tests/web/running_server.h"

using namespace rend;
using namespace rend::test;
using namespace std::chrono_literals;

namespace {

struct BadInput {
  std::string name;
  std::string bytes;
  int status;
  std::string later = "";  ///< sent in a second packet
};

std::string repeated(const std::string& text, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += text;
  return out;
}

// `text` with the right Host value for each `%P`.
std::string with_host(std::string text, int port) {
  const std::string host = "127.0.0.1:" + std::to_string(port);
  for (auto at = text.find("%P"); at != std::string::npos; at = text.find("%P")) {
    text.replace(at, 2, host);
  }
  return text;
}

// A head of the request line "METHOD target HTTP/1.1" and the given header lines.
std::string raw(const std::string& line, const std::string& headers, int port) {
  return with_host(line + " HTTP/1.1\r\n" + headers + "\r\n", port);
}

const std::string good_host = "Host: %P\r\n";
const std::string marker =
    "POST /api/echo HTTP/1.1\r\nHost: %P\r\nContent-Type: application/json\r\n"
    "Content-Length: 8\r\n\r\n\"marker\"";

std::vector<BadInput> foreign_sites(int p) {
  const std::string json = "Content-Type: application/json\r\nContent-Length: 2\r\n";
  const std::string port = std::to_string(p);
  return {
      {"rebinding", raw("GET /api/ping", "Host: evil.example\r\n", p), 421},
      {"rebinding with port", raw("GET /api/ping", "Host: evil.example:" + port + "\r\n", p), 421},
      {"rebinding by other interface", raw("GET /api/ping", "Host: 10.0.0.5:" + port + "\r\n", p),
       421},
      {"right name, wrong port", raw("GET /api/ping", "Host: 127.0.0.1:1\r\n", p), 421},
      {"right name as prefix", raw("GET /api/ping", "Host: %P.evil.example\r\n", p), 421},
      {"no Host", raw("GET /", "", p), 400},
      {"empty Host", raw("GET /", "Host:\r\n", p), 421},
      {"two Hosts", raw("GET /", "Host: %P\r\nHost: %P\r\n", p), 400},
      {"form post from elsewhere",
       raw("POST /api/echo",
           good_host + "Origin: http://evil\r\nContent-Type: text/plain\r\nContent-Length: 2\r\n",
           p) +
           "{}",
       403},
      {"foreign origin, JSON",
       raw("POST /api/echo", good_host + "Origin: http://evil\r\n" + json, p) + "{}", 403},
      {"other port of this machine",
       raw("POST /api/echo", good_host + "Origin: http://127.0.0.1:1\r\n" + json, p) + "{}", 403},
      {"https origin", raw("POST /api/echo", good_host + "Origin: https://%P\r\n" + json, p) + "{}",
       403},
      {"null origin", raw("POST /api/echo", good_host + "Origin: null\r\n" + json, p) + "{}", 403},
      {"cross-site without Origin",
       raw("POST /api/echo", good_host + "Sec-Fetch-Site: cross-site\r\n" + json, p) + "{}", 403},
      {"same-site is not same-origin",
       raw("POST /api/echo", good_host + "Sec-Fetch-Site: same-site\r\n" + json, p) + "{}", 403},
      {"preflight",
       raw("OPTIONS /api/echo",
           good_host + "Origin: http://evil\r\nAccess-Control-Request-Method: POST\r\n", p),
       501},
      {"image from a foreign page",
       raw("GET /api/frames/1.png",
           good_host +
               "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: no-cors\r\nSec-Fetch-Dest: image\r\n",
           p),
       403},
      {"page in a foreign frame",
       raw("GET /",
           good_host + "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: "
                       "iframe\r\n",
           p),
       403},
      {"navigation to the interface",
       raw("GET /api/ping",
           good_host + "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: "
                       "document\r\n",
           p),
       403},
      {"event stream from elsewhere",
       raw("GET /api/wait", good_host + "Origin: http://evil\r\n", p), 403},
      {"navigation to the page from elsewhere is fine",
       raw("GET /",
           good_host + "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: "
                       "document\r\n",
           p),
       200},
      {"own page",
       raw("POST /api/echo",
           good_host + "Origin: http://%P\r\nSec-Fetch-Site: same-origin\r\n" + json, p) +
           "{}",
       200},
  };
}

std::vector<BadInput> paths(int p) {
  std::vector<BadInput> list;
  for (const char* path : {"/../etc/passwd",
                           "/..",
                           "/a/../../etc/passwd",
                           "/./index.html",
                           "/a/.",
                           "/%2e%2e/etc/passwd",
                           "/%2E%2E/etc/passwd",
                           "/..%2fetc/passwd",
                           "/%2e%2e%2fetc%2fpasswd",
                           "/..%5cetc%5cpasswd",
                           "/%252e%252e/etc/passwd",
                           "/%c0%ae%c0%ae/etc/passwd",
                           "/..\\etc\\passwd",
                           "/....//etc/passwd",
                           "/index.html%00.png",
                           "/%0d%0aSet-Cookie:x",
                           "/a%zz",
                           "/a%",
                           "/a%u002e",
                           "/api/ping?a=%0a",
                           "/api/ping?a=1?b",
                           "/a#b",
                           "/\x80",
                           "http://127.0.0.1/api/ping",
                           "*",
                           "api/ping"}) {
    list.push_back(
        {std::string("path ") + path, raw(std::string("GET ") + path, good_host, p), 400});
  }
  for (const char* path : {"//etc/passwd", "/etc/passwd", "/link", "/api/ping/", "/api//ping"}) {
    list.push_back(
        {std::string("path ") + path, raw(std::string("GET ") + path, good_host, p), 404});
  }
  list.push_back(
      {"target of 1025 bytes", raw("GET /" + std::string(1024, 'a'), good_host, p), 414});
  list.push_back(
      {"target of 1024 bytes", raw("GET /" + std::string(1023, 'a'), good_host, p), 404});
  return list;
}

std::vector<BadInput> framing(int p) {
  const std::string json = good_host + "Content-Type: application/json\r\n";
  const std::string smuggled = with_host(marker, p);
  std::vector<BadInput> list = {
      {"length and chunked",
       raw("POST /api/echo", json + "Content-Length: 4\r\nTransfer-Encoding: chunked\r\n", p) +
           "0\r\n\r\n" + smuggled,
       501},
      {"two lengths",
       raw("POST /api/echo", json + "Content-Length: 4\r\nContent-Length: 5\r\n", p) + "[12]" +
           smuggled,
       400},
      {"same length twice",
       raw("POST /api/echo", json + "Content-Length: 4\r\nContent-Length: 4\r\n", p) + "[12]", 400},
      {"body on GET, second packet", raw("GET /api/ping", good_host + "Content-Length: 60\r\n", p),
       400, smuggled},
      {"no length on POST", raw("POST /api/echo", json, p), 411},
      {"length too long",
       raw("POST /api/echo", json + "Content-Length: " + std::string(40, '9') + "\r\n", p), 413},
      {"over the route's limit", raw("POST /api/echo", json + "Content-Length: 1025\r\n", p), 413},
      {"far over the limit", raw("POST /api/echo", json + "Content-Length: 2147483648\r\n", p),
       413},
      {"body to an unknown path", raw("POST /api/nothing", json + "Content-Length: 100\r\n", p),
       404, smuggled},
      {"body to a known path of another method",
       raw("PUT /api/echo", json + "Content-Length: 100\r\n", p), 405, smuggled},
      {"expect", raw("POST /api/echo", json + "Content-Length: 4\r\nExpect: 100-continue\r\n", p),
       417},
      {"gzip body",
       raw("POST /api/echo", json + "Content-Length: 4\r\nContent-Encoding: gzip\r\n", p) + "abcd",
       415},
      {"text body",
       raw("POST /api/echo", good_host + "Content-Type: text/plain\r\nContent-Length: 2\r\n", p) +
           "{}",
       415},
      {"form body",
       raw("POST /api/echo",
           good_host + "Content-Type: multipart/form-data; boundary=x\r\nContent-Length: 2\r\n",
           p) +
           "{}",
       415},
      {"body without type", raw("POST /api/echo", good_host + "Content-Length: 2\r\n", p) + "{}",
       415},
      {"upgrade",
       raw("GET /api/ping", good_host + "Connection: Upgrade\r\nUpgrade: websocket\r\n", p), 501},
  };
  for (const char* coding :
       {"chunked", "gzip, chunked", "xchunked", "identity", "chunked, chunked", ""}) {
    list.push_back({std::string("transfer coding '") + coding + "'",
                    raw("POST /api/echo", json + "Transfer-Encoding: " + coding + "\r\n", p) +
                        "0\r\n\r\n" + smuggled,
                    501});
  }
  for (const char* length : {"-1", "+5", "0x10", "5,5", "", "1e3", "5 5", "4;", "\xd9\xa5"}) {
    list.push_back({std::string("length '") + length + "'",
                    raw("POST /api/echo", json + "Content-Length: " + length + "\r\n", p) + "[12]",
                    400});
  }
  return list;
}

std::vector<BadInput> heads(int p) {
  using namespace std::string_literals;
  std::vector<BadInput> list = {
      {"NUL in a value", raw("GET /api/ping", good_host + "Accept: a\0b\r\n"s, p), 400},
      {"CR in a value", raw("GET /api/ping", good_host + "Accept: a\rb\r\n", p), 400},
      {"escaped line break in a value stays outside",
       raw("GET /api/ping", good_host + "Accept: a%0d%0aX-Evil: 1\r\nIf-None-Match: %0d%0a\r\n", p),
       200},
      {"folded line", raw("GET /api/ping", good_host + "Accept: a\r\n b\r\n", p), 400},
      {"blank before colon", raw("GET /api/ping", good_host + "Accept : a\r\n", p), 400},
      {"no colon", raw("GET /api/ping", good_host + "Accept\r\n", p), 400},
      {"empty name", raw("GET /api/ping", good_host + ": a\r\n", p), 400},
      {"underscore", raw("GET /api/ping", good_host + "REMOTE_ADDR: 6.6.6.6\r\n", p), 400},
      {"head of 17 kB",
       raw("GET /api/ping", good_host + "Accept: " + std::string(17000, 'a') + "\r\n", p), 431},
      {"65 headers", raw("GET /api/ping", good_host + repeated("X-A: b\r\n", 64), p), 431},
      {"64 headers", raw("GET /api/ping", good_host + repeated("X-A: b\r\n", 63), p), 200},
      {"endless line", "GET /" + std::string(100000, 'a'), 431},
      {"endless headers",
       raw("GET /api/ping", good_host, p).substr(0, 40) + repeated("X-A: b\r\n", 20000), 431},
      {"bare line feeds", "GET /api/ping HTTP/1.1\nHost: 127.0.0.1:" + std::to_string(p) + "\n\n",
       400},
      {"one bare line feed",
       "GET /api/ping HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(p) + "\nAccept: a\r\n\r\n",
       400},
      {"HTTP/2 preface", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 505},
      {"HTTP/9.9", "GET /api/ping HTTP/9.9\r\n\r\n", 505},
      {"no version", "GET /api/ping\r\n\r\n", 400},
      {"lower-case version", "GET /api/ping http/1.1\r\n\r\n", 400},
      {"TLS hello", "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"s, 400},
      {"random bytes", "\x8f\x01\xd3 \xff\xfe\r\n\r\n"s, 400},
      {"empty line first", "\r\n" + raw("GET /api/ping", good_host, p), 400},
      {"two blanks", raw("GET  /api/ping", good_host, p), 400},
      {"lower-case method", raw("get /api/ping", good_host, p), 400},
      {"two cookies headers", raw("GET /api/ping", good_host + "Cookie: a=b\r\nCookie: c=d\r\n", p),
       400},
      {"ranges",
       raw("GET /api/ping", good_host + "Range: bytes=" + repeated("0-,", 2000) + "0-\r\n", p),
       200},
  };
  for (const char* method : {"TRACE", "CONNECT", "FOO", "OPTIONS", "PROPFIND"}) {
    list.push_back({std::string("method ") + method,
                    raw(std::string(method) + " /api/ping", good_host, p), 501});
  }
  return list;
}

double resident_mebibytes() {
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return resident * 4096.0 / (1 << 20);
}

void check_all(const std::vector<BadInput>& list, RunningServer& server) {
  const int port = server.port();
  REQUIRE(server.alive());
  const double before = resident_mebibytes();
  for (const BadInput& bad : list) {
    CAPTURE(bad.name);
    const int handled = server.handled();
    const auto start = std::chrono::steady_clock::now();
    RawClient client(port);
    client.send(bad.bytes);
    std::string reply = client.read_reply(1000ms);
    const auto took = std::chrono::steady_clock::now() - start;
    CHECK(status_of(reply) == bad.status);
    CHECK(took < 1s);
    CHECK(reply.find("marker") == std::string::npos);
    CHECK(reply.find("root:") == std::string::npos);
    CHECK(header_of(reply, "Access-Control-Allow-Origin") == "");
    CHECK(header_of(reply, "X-Evil") == "");
    if (bad.status >= 400) {
      CHECK(header_of(reply, "Content-Type") == "application/problem+json");
      CHECK(body_of(reply).find("\"status\":" + std::to_string(bad.status)) != std::string::npos);
      if (!bad.later.empty()) client.send(bad.later);
      // A refused request is the last one of its connection whenever bytes of it may still come.
      if (header_of(reply, "Connection") == "close") {
        CHECK(count_replies(client.read_to_end(1000ms)) == 0);
      }
      CHECK(server.handled() == handled);
    }
    REQUIRE(server.alive());
  }
  CHECK(resident_mebibytes() - before < 16);
}

}  // namespace

TEST_CASE("requests by way of foreign sites") {
  RunningServer server;
  check_all(foreign_sites(server.port()), server);
}

TEST_CASE("paths that try to leave the tree") {
  RunningServer server;
  check_all(paths(server.port()), server);
}

TEST_CASE("bodies of unclear length, and requests hidden in them") {
  RunningServer server;
  check_all(framing(server.port()), server);
}

TEST_CASE("malformed heads") {
  RunningServer server;
  check_all(heads(server.port()), server);
}

TEST_CASE("a body that stalls gets 408, a head that stalls gets 408") {
  RunningServer server;
  RawClient body(server.port()), head(server.port());
  body.send(body_request(server.port(), "POST", "/api/echo", std::string(100, 'x')).substr(0, 130));
  head.send("GET /api/ping HTTP/1.1\r\nHost: ");
  CHECK(status_of(body.read_reply(1500ms)) == 408);
  CHECK(status_of(head.read_reply(1500ms)) == 408);
  CHECK(server.handled() == 0);
  CHECK(server.alive());
}

TEST_CASE("a body on HEAD is refused, without a body in the refusal") {
  RunningServer server;
  RawClient client(server.port());
  client.send("HEAD /api/ping HTTP/1.1\r\nHost: localhost:" + std::to_string(server.port()) +
              "\r\nContent-Length: 4\r\n\r\nabcd");
  const std::string reply = client.read_to_end();
  CHECK(status_of(reply) == 400);
  CHECK(body_of(reply) == "");
}

TEST_CASE("bytes behind a request are dropped and end the connection") {
  RunningServer server;
  const std::string post = body_request(server.port(), "POST", "/api/echo", "[1]");
  RawClient client(server.port());
  client.send(post + post + post);
  CHECK(count_replies(client.read_to_end()) == 1);
  CHECK(server.handled() == 1);
}

TEST_CASE("a head in many small pieces is still one head") {
  RunningServer server;
  RawClient client(server.port());
  for (const char c : get_request(server.port(), "/api/ping")) client.send(std::string(1, c));
  CHECK(body_of(client.read_reply()) == "pong");
}

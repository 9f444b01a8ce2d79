// What a well-behaved client sees: routes, methods, errors, headers, keep-alive, page files.
#include <doctest/doctest.h>

#include "engine/core/error.h"
#include "tests/web/raw_client.h"
#include "tests/web/running_server.h"
#include "web/assets.h"

using namespace rend;
using namespace rend::test;
using namespace std::chrono_literals;

TEST_CASE("routes give their placeholders, query and body") {
  RunningServer server;
  const int port = server.port();
  CHECK(body_of(ask(port, get_request(port, "/api/frames/17.png?width=64%30"))) == "frame 17 640");
  CHECK(body_of(ask(port, body_request(port, "POST", "/api/echo", R"({"a":1})"))) == R"({"a":1})");
  CHECK(body_of(ask(port, body_request(port, "PATCH", "/api/echo", "{}",
                                       "application/merge-patch+json; charset=utf-8"))) ==
        "patched {}");
  CHECK(body_of(ask(port, "DELETE /api/things/a%20b HTTP/1.1\r\nHost: localhost:" +
                              std::to_string(port) + "\r\n\r\n")) == "deleted a b");
  const std::string mesh(3u << 20, 'm');
  CHECK(body_of(ask(port, body_request(port, "PUT", "/api/mesh", mesh, "application/octet-stream"),
                    5000ms)) == std::to_string(mesh.size()));
}

TEST_CASE("HEAD has the length and no body") {
  RunningServer server;
  RawClient client(server.port());
  client.send("HEAD /api/ping HTTP/1.1\r\nConnection: close\r\nHost: [::1]:" +
              std::to_string(server.port()) + "\r\n\r\n");
  const std::string reply = client.read_to_end();
  CHECK(status_of(reply) == 200);
  CHECK(header_of(reply, "Content-Length") == "4");
  CHECK(body_of(reply) == "");
}

TEST_CASE("a file as body arrives whole, others are served meanwhile, the connection goes on") {
  RunningServer server;
  const int port = server.port();
  RawClient client(port);
  client.send(get_request(port, "/api/large-file"));
  CHECK(client.reply_begins(2000ms));
  CHECK(server.alive());  // most of the file still waits
  const std::string reply = client.read_reply(10000ms);
  CHECK(header_of(reply, "Content-Type") == "application/zip");
  CHECK_UNARY(body_of(reply) == large_file_text());
  client.send(get_request(port, "/api/ping"));
  CHECK(body_of(client.read_reply()) == "pong");
  client.send("HEAD /api/large-file HTTP/1.1\r\nConnection: close\r\nHost: localhost:" +
              std::to_string(port) + "\r\n\r\n");
  const std::string head = client.read_to_end();
  CHECK(header_of(head, "Content-Length") == std::to_string(large_file_text().size()));
  CHECK(body_of(head) == "");
}

TEST_CASE("unknown paths and methods are told apart, with Allow") {
  RunningServer server;
  const int port = server.port();
  const std::string missing = ask(port, get_request(port, "/api/nothing"));
  CHECK(status_of(missing) == 404);
  CHECK(header_of(missing, "Content-Type") == "application/problem+json");
  CHECK(body_of(missing) ==
        "{\"type\":\"about:blank\",\"title\":\"Not Found\",\"status\":404,"
        "\"detail\":\"Nothing is at this path.\",\"code\":\"not_found\"}\n");
  const std::string wrong = ask(port, get_request(port, "/api/echo"));
  CHECK(status_of(wrong) == 405);
  CHECK(header_of(wrong, "Allow") == "PATCH, POST");
}

TEST_CASE("what handlers throw becomes a problem without inner text") {
  RunningServer server;
  const int port = server.port();
  const std::string error = ask(port, get_request(port, "/api/error"));
  CHECK(status_of(error) == 422);
  CHECK(body_of(error).find(R"("pointer":"/bodies/0/density")") != std::string::npos);
  CHECK(body_of(error).find("is -1, must be > 0") != std::string::npos);
  const std::string file = ask(port, get_request(port, "/api/file-error"));
  CHECK(status_of(file) == 422);
  CHECK(file.find("/home") == std::string::npos);
  const std::string bug = ask(port, get_request(port, "/api/bug"));
  CHECK(status_of(bug) == 500);
  CHECK(bug.find("secret") == std::string::npos);
  const std::string split = ask(port, get_request(port, "/api/split"));
  CHECK(status_of(split) == 500);
  CHECK(header_of(split, "Set-Cookie") == "");
}

TEST_CASE("every reply carries the security headers") {
  RunningServer server;
  const int port = server.port();
  for (const char* path : {"/", "/api/ping", "/api/nothing", "/%00"}) {
    CAPTURE(path);
    const std::string reply = ask(port, get_request(port, path));
    CHECK(header_of(reply, "Content-Security-Policy")
              .find("default-src 'self'; img-src 'self' blob: data:") == 0);
    CHECK(header_of(reply, "Content-Security-Policy").find("frame-ancestors 'none'") !=
          std::string::npos);
    CHECK(header_of(reply, "X-Content-Type-Options") == "nosniff");
    CHECK(header_of(reply, "Cross-Origin-Resource-Policy") == "same-origin");
    CHECK(header_of(reply, "Referrer-Policy") == "no-referrer");
    CHECK(header_of(reply, "Cache-Control") == "no-store");
    CHECK(header_of(reply, "Access-Control-Allow-Origin") == "");
  }
}

TEST_CASE("keep-alive serves many requests on one connection, errors included") {
  RunningServer server;
  const int port = server.port();
  RawClient client(port);
  for (int i = 0; i < 50; ++i) {
    REQUIRE(client.send(get_request(port, i % 5 == 4 ? "/api/nothing" : "/api/ping")));
    REQUIRE(status_of(client.read_reply()) == (i % 5 == 4 ? 404 : 200));
    REQUIRE(client.send(body_request(port, "POST", "/api/echo", "[1]")));
    REQUIRE(body_of(client.read_reply()) == "[1]");
  }
  client.send(get_request(port, "/api/ping", "Connection: close\r\n"));
  CHECK(status_of(client.read_reply()) == 200);
  CHECK(client.closed_by_server(1000ms));
}

TEST_CASE("files of the page come with a validator") {
  RunningServer server;
  bool has_index = false;
  for (const web::Asset& asset : web::page_assets()) {
    CAPTURE(asset.path);
    has_index = has_index || asset.path == "/index.html";
    const int port = server.port();
    const std::string path(asset.path), etag(asset.etag);
    const std::string reply = ask(port, get_request(port, path));
    CHECK(status_of(reply) == 200);
    CHECK(body_of(reply) == asset.bytes);
    CHECK(header_of(reply, "Content-Type") == asset.type);
    CHECK(header_of(reply, "ETag") == etag);
    CHECK(header_of(reply, "Cache-Control") == "no-cache");
    const std::string again = ask(port, get_request(port, path, "If-None-Match: " + etag + "\r\n"));
    CHECK(status_of(again) == 304);
    CHECK(body_of(again) == "");
  }
  CHECK(has_index);
}

TEST_CASE("start-up refuses what would be unsafe or cannot work") {
  const auto start = [](const std::string& address, int port, const std::string& token) {
    web::ServerOptions options;
    options.address = address;
    options.port = port;
    options.token = token;
    web::Server server(options, {});
    return server.port();
  };
  CHECK_THROWS_WITH_AS(start("0.0.0.0", 0, ""), doctest::Contains("needs a token"), Error);
  CHECK_THROWS_AS(start("not-an-address", 0, ""), Error);
  CHECK_THROWS_AS(start("192.0.2.1", 0, web::random_token()), Error);
  CHECK_THROWS_AS(start("127.0.0.1", 70000, ""), Error);
  CHECK_THROWS_AS(start("127.0.0.1", 0, "short"), Error);
  RunningServer first;
  CHECK_THROWS_WITH_AS(start("127.0.0.1", first.port(), ""),
                       doctest::Contains(std::to_string(first.port()).c_str()), Error);
  CHECK(start("127.0.0.1", 0, "") > 0);
  CHECK(start("::1", 0, "") > 0);
  CHECK(start("0.0.0.0", 0, web::random_token()) > 0);
}

TEST_CASE("stop before run returns at once") {
  web::ServerOptions options;
  options.port = 0;
  web::Server server(options, {});
  server.stop();
  server.run();
  CHECK(server.url() == "http://127.0.0.1:" + std::to_string(server.port()) + "/");
}

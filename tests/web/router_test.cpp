// Patterns, placeholders and the JSON of problems.
#include <doctest/doctest.h>

#include "engine/core/error.h"
#include "web/router.h"

using namespace rend;
using web::Router;

namespace {

web::Route route(const std::string& method, const std::string& pattern) {
  return {method, pattern, [](const web::Request&) { return web::Response{}; }};
}

}  // namespace

TEST_CASE("a pattern matches whole segments and takes the placeholder's text") {
  const Router router({route("GET", "/api/frames/{n}.png"), route("GET", "/api/frames/latest.png"),
                       route("POST", "/api/scenes/{name}/actions/{verb}"),
                       route("PUT", "/api/frames/{n}.png")});
  const auto frame = router.find("GET", "/api/frames/12.png");
  REQUIRE(frame.route);
  CHECK(frame.parts == std::vector<std::string>{"12"});
  CHECK(frame.allow == "GET, HEAD, PUT");
  CHECK(router.find("GET", "/api/frames/latest.png").parts.empty());
  CHECK(router.find("PUT", "/api/frames/latest.png").parts == std::vector<std::string>{"latest"});
  CHECK(router.find("HEAD", "/api/frames/1.png").route == frame.route);
  CHECK(router.find("POST", "/api/scenes/a b/actions/load").parts ==
        std::vector<std::string>{"a b", "load"});
  CHECK(!router.find("DELETE", "/api/frames/1.png").route);
  for (const char* path :
       {"/", "/api/frames/.png", "/api/frames/1.jpg", "/api/frames/1.png/", "/api/frames",
        "/api/scenes//actions/load", "/api/scenes/a/actions/", "x/api/frames/1.png"}) {
    CAPTURE(path);
    CHECK(!router.find("GET", path).route);
    CHECK(router.find("GET", path).allow.empty());
  }
}

TEST_CASE("malformed and double routes are refused") {
  CHECK_THROWS_AS(Router({route("GET", "/a"), route("GET", "/a")}), Error);
  CHECK_THROWS_AS(Router({route("FETCH", "/a")}), Error);
  CHECK_THROWS_AS(Router({route("GET", "a")}), Error);
  CHECK_THROWS_AS(Router({route("GET", "/{a")}), Error);
  CHECK_THROWS_AS(Router({route("GET", "/{a}{b}")}), Error);
  CHECK_THROWS_AS(Router({web::Route{"GET", "/a", nullptr}}), Error);
}

TEST_CASE("text becomes valid JSON whatever its bytes") {
  using web::json_escaped;
  CHECK(json_escaped("a\"b\\c\n\x01") == "a\\\"b\\\\c\\u000a\\u0001");
  CHECK(json_escaped("\xce\xb1 \xf0\x9f\x98\x80") == "\xce\xb1 \xf0\x9f\x98\x80");
  CHECK(json_escaped("\xff|\xc0\xaf|\xed\xa0\x80") ==
        "\\ufffd|\\ufffd\\ufffd|\\ufffd\\ufffd\\ufffd");
  CHECK(json_escaped("\xe2\x82") == "\\ufffd\\ufffd");
  const auto response = web::problem(422, "range", "dt is 0, must be > 0", "/time_step");
  CHECK(response.status == 422);
  CHECK(response.type == "application/problem+json");
  CHECK(response.body ==
        "{\"type\":\"about:blank\",\"title\":\"Unprocessable Content\",\"status\":422,"
        "\"detail\":\"dt is 0, must be > 0\",\"code\":\"range\",\"pointer\":\"/time_step\"}\n");
}

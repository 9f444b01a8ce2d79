// Error replies as RFC 9457 problem documents.
#include <cstdio>

#include "web/http_status.h"
#include "web/server.h"

namespace rend::web {
namespace {

// Length of the well-formed UTF-8 sequence at `at`, 0 when there is none (RFC 3629, table 3-7 of
// Unicode).
std::size_t utf8_length(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const unsigned first = byte(at), second = byte(at + 1);
  const auto tail = [](unsigned b) { return b >= 0x80 && b <= 0xBF; };
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return tail(second) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    const unsigned low = first == 0xE0 ? 0xA0 : 0x80, high = first == 0xED ? 0x9F : 0xBF;
    return second >= low && second <= high && tail(byte(at + 2)) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const unsigned low = first == 0xF0 ? 0x90 : 0x80, high = first == 0xF4 ? 0x8F : 0xBF;
    const bool rest = tail(byte(at + 2)) && tail(byte(at + 3));
    return second >= low && second <= high && rest ? 4 : 0;
  }
  return 0;
}

}  // namespace

std::string json_escaped(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const char c = text[at];
    if (length == 0) {
      out += "\\ufffd";
    } else if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 32 || c == 127) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
      out += escape;
    } else {
      out.append(text, at, length);
    }
    at += length == 0 ? 1 : length;
  }
  return out;
}

Response problem(int status, const std::string& code, const std::string& detail,
                 const std::string& pointer) {
  Response response;
  response.status = status;
  response.type = "application/problem+json";
  response.body = R"({"type":"about:blank","title":")" + std::string(status_title(status)) +
                  R"(","status":)" + std::to_string(status) + R"(,"detail":")" +
                  json_escaped(detail) + R"(","code":")" + json_escaped(code) + '"';
  if (!pointer.empty()) response.body += R"(,"pointer":")" + json_escaped(pointer) + '"';
  response.body += "}\n";
  return response;
}

}  // namespace rend::web

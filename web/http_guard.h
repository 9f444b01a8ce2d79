// The gate in front of the HTTP library: a pure check of one request head against a strict
// allow-list.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rend::web {

struct GuardPolicy {
  std::vector<std::string>
      hosts;  ///< allowed Host values, lower case, with the port where it shows
  std::size_t max_head = 16 * 1024;
  std::size_t max_headers = 64;
  std::size_t max_target = 1024;
};

/// Why a request was refused; status 0 means it was not.
struct Refusal {
  int status = 0;
  std::string code, detail;
  explicit operator bool() const { return status != 0; }
};

/// What a request head says, after every check; only meaningful while `refusal` is empty.
struct GuardedHead {
  Refusal refusal;
  std::string method;
  std::string path;   ///< decoded, printable ASCII, no dot segment, no encoded slash
  std::string query;  ///< as sent, without '?'
  std::map<std::string, std::string> headers;  ///< forwarded ones, lower-case names
  std::string cookie, authorization;           ///< for the gate alone, never forwarded
  std::uint64_t content_length = 0;
  bool keep_alive = false;
  std::string block;  ///< the head to hand to the library: request line and forwarded headers only
};

/// Where a head ends in the bytes received so far.
struct HeadScan {
  enum class State { more, complete, refused } state = State::more;
  std::size_t length = 0;  ///< bytes up to and with the empty line, when complete
  Refusal refusal;
};

/// Looks for the end of the first head in `bytes`; refuses at once what can never become one.
HeadScan scan_head(std::string_view bytes, const GuardPolicy& policy);

/// Checks one complete head (up to and with CRLFCRLF); a pure function, safe for any bytes.
GuardedHead check_head(std::string_view head, const GuardPolicy& policy);

/// Percent-decodes `text`; false when an escape is malformed.
bool percent_decode(std::string_view text, std::string& out);

}  // namespace rend::web

// What must hold for any bytes given to the guard; shared by the random test and the fuzz target.
#pragma once

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string>

#include "web/http_guard.h"

namespace rend::test {

/// Names the property that `bytes` break, empty when all hold. Written without the guard's own
/// parser.
inline std::string broken_property(const std::string& bytes, const web::GuardPolicy& policy) {
  const web::HeadScan scan = web::scan_head(bytes, policy);
  if (scan.state == web::HeadScan::State::complete &&
      (scan.length > bytes.size() || scan.length < 4 ||
       bytes.compare(scan.length - 4, 4, "\r\n\r\n") != 0)) {
    return "a complete head ends with an empty line";
  }
  const web::GuardedHead head = web::check_head(bytes, policy);
  if (head.refusal) {
    const int status = head.refusal.status;
    return status >= 400 && status < 600 && !head.refusal.code.empty() ? ""
                                                                       : "refusal has a status";
  }

  std::string lower = bytes;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  // Header lines called `name`, blanks around the name included.
  const auto lines_with = [&](const std::string& name) {
    int count = 0;
    for (auto at = lower.find(name); at != std::string::npos; at = lower.find(name, at + 1)) {
      const auto start = lower.find_last_not_of(" \t", at - 1);
      const auto after = lower.find_first_not_of(" \t", at + name.size());
      if (at == 0 || start == std::string::npos || after == std::string::npos) continue;
      count += lower[start] == '\n' && lower[after] == ':' ? 1 : 0;
    }
    return count;
  };
  if (lines_with("transfer-encoding") > 0) return "never accepts Transfer-Encoding";
  if (lines_with("content-length") > 1) return "never accepts two Content-Length";
  if (lines_with("host") != 1) return "accepts exactly one Host";
  const auto host = lower.find("\nhost:") + 6;
  auto name = lower.substr(host, lower.find('\r', host) - host);
  name.erase(0, name.find_first_not_of(" \t"));
  name.erase(name.find_last_not_of(" \t") + 1);
  if (std::find(policy.hosts.begin(), policy.hosts.end(), name) == policy.hosts.end()) {
    return "never accepts a foreign Host";
  }
  if (lower.find("\norigin:") != std::string::npos &&
      lower.find("http://" + name, lower.find("\norigin:")) == std::string::npos) {
    return "never accepts a foreign Origin";
  }
  if (bytes.find('\0') != std::string::npos) return "never accepts NUL";
  if (head.path.empty() || head.path[0] != '/' || head.path.find("..") != std::string::npos) {
    return "the path is absolute and has no dot segment";
  }
  for (const char c : head.path) {
    if (c < 32 || c == 127) return "the path is printable ASCII";
  }
  if ((head.method == "GET" || head.method == "HEAD") && head.content_length > 0) {
    return "GET and HEAD have no body";
  }

  // The block handed on: CRLF lines only, a request line, then forwarded headers without '%'.
  std::istringstream lines(head.block);
  std::string line;
  bool first = true, ended = false;
  while (std::getline(lines, line)) {
    if (ended || line.empty() || line.back() != '\r') return "the block is CRLF lines";
    line.pop_back();
    if (line.find('\r') != std::string::npos) return "no CR inside a line of the block";
    if (line.empty())
      ended = true;
    else if (!first &&
             (line.find('%') != std::string::npos || line.find(": ") == std::string::npos)) {
      return "forwarded headers are plain";
    }
    first = false;
  }
  return ended ? "" : "the block ends with an empty line";
}

}  // namespace rend::test

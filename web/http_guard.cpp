// The gate in front of the HTTP library: a pure check of one request head against a strict
// allow-list.
#include "web/http_guard.h"

#include <algorithm>
#include <array>

namespace rend::web {
namespace {

bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
char lower(char c) { return is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c; }
bool is_name_char(char c) {
  return (lower(c) >= 'a' && lower(c) <= 'z') || is_digit(c) || c == '-';
}

std::string lowered(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), lower);
  return out;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

int hex_value(char c) {
  if (is_digit(c)) return c - '0';
  const char l = lower(c);
  return l >= 'a' && l <= 'f' ? l - 'a' + 10 : -1;
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u < 32 || u == 127;
  });
}

Refusal bad_request(std::string code, std::string detail) {
  return {400, std::move(code), std::move(detail)};
}

constexpr std::array<std::string_view, 6> methods = {"GET", "HEAD",  "POST",
                                                     "PUT", "PATCH", "DELETE"};

// Headers that reach the library and the handlers; everything else stays at the gate.
constexpr std::array<std::string_view, 4> forwarded = {"accept", "content-type", "if-match",
                                                       "if-none-match"};

// Headers the gate decides by: a second copy could be read differently by somebody else.
constexpr std::array<std::string_view, 14> single = {
    "host",          "content-length", "content-type",   "origin",         "cookie",
    "authorization", "connection",     "sec-fetch-site", "sec-fetch-mode", "sec-fetch-dest",
    "if-none-match", "if-match",       "accept",         "expect"};

template <class List>
bool contains(const List& list, std::string_view value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

Refusal check_target(std::string_view target, GuardedHead& head) {
  if (target.empty() || target[0] != '/') {
    return bad_request("bad_target", "The request target must be a path that starts with '/'.");
  }
  for (const char c : target) {
    const auto u = static_cast<unsigned char>(c);
    if (u <= 32 || u >= 127 || c == '\\' || c == '#') {
      return bad_request("bad_target",
                         "The request target holds a character that must be escaped.");
    }
  }
  const auto mark = target.find('?');
  const auto path = target.substr(0, mark);
  const auto query = mark == std::string_view::npos ? std::string_view{} : target.substr(mark + 1);
  if (query.find('?') != std::string_view::npos) {
    return bad_request("bad_target", "The request target holds two question marks.");
  }
  std::string decoded_query;
  if (!percent_decode(path, head.path) || !percent_decode(query, decoded_query)) {
    return bad_request("bad_target", "The request target holds a malformed percent escape.");
  }
  // An escaped slash, dot or percent sign in a path only serves to be read twice.
  const std::string lower_path = lowered(path);
  for (const char* escape : {"%2f", "%5c", "%2e", "%25"}) {
    if (lower_path.find(escape) != std::string::npos) {
      return bad_request("bad_target", "The path holds an escape that is not allowed.");
    }
  }
  const bool plain =
      std::all_of(head.path.begin(), head.path.end(), [](char c) { return c >= 32 && c < 127; });
  if (!plain || has_control(decoded_query)) {
    return bad_request("bad_target", "The request target holds a control or non-ASCII character.");
  }
  if (head.path.find("..") != std::string::npos ||
      (head.path + "/").find("/./") != std::string::npos) {
    return bad_request("bad_target", "The path holds a dot segment.");
  }
  head.query = std::string(query);
  return {};
}

Refusal check_request_line(std::string_view line, const GuardPolicy& policy, GuardedHead& head,
                           std::string_view& version) {
  const auto first = line.find(' ');
  const auto last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) {
    return bad_request("bad_request_line", "The request line is not METHOD TARGET VERSION.");
  }
  const auto method = line.substr(0, first);
  const auto target = line.substr(first + 1, last - first - 1);
  version = line.substr(last + 1);
  if (method.empty() || !std::all_of(method.begin(), method.end(), is_upper)) {
    return bad_request("bad_method", "The method must be capital letters.");
  }
  if (version != "HTTP/1.1" && version != "HTTP/1.0") {
    if (version.substr(0, 5) == "HTTP/") return {505, "http_version", "Use HTTP/1.1."};
    return bad_request("bad_request_line", "The request line does not end with HTTP/1.1.");
  }
  if (!contains(methods, method)) {
    return {501, "method_unknown", "Known methods: GET, HEAD, POST, PUT, PATCH, DELETE."};
  }
  if (target.size() > policy.max_target) {
    return {414, "target_too_long",
            "The request target may have " + std::to_string(policy.max_target) + " bytes."};
  }
  head.method = std::string(method);
  return check_target(target, head);
}

Refusal parse_headers(std::string_view lines, const GuardPolicy& policy,
                      std::map<std::string, std::string>& all) {
  std::size_t count = 0;
  while (!lines.empty()) {
    const auto end = lines.find("\r\n");
    if (end == std::string_view::npos)
      return bad_request("bad_header", "A header has no line end.");
    const auto line = lines.substr(0, end);
    lines.remove_prefix(end + 2);
    if (line.empty()) {
      return lines.empty() ? Refusal{} : bad_request("bad_header", "Bytes after the empty line.");
    }
    if (++count > policy.max_headers) {
      return {431, "too_many_headers",
              "A request may have " + std::to_string(policy.max_headers) + " headers."};
    }
    const auto colon = line.find(':');
    const auto name = line.substr(0, colon);
    // Letters, digits and '-' alone: also refuses folded lines, blanks before ':' and REMOTE_ADDR.
    if (colon == std::string_view::npos || name.empty() ||
        !std::all_of(name.begin(), name.end(), is_name_char)) {
      return bad_request("bad_header", "A header name may hold letters, digits and '-' only.");
    }
    const auto value = line.substr(colon + 1);
    std::string without_tabs(value);
    std::replace(without_tabs.begin(), without_tabs.end(), '\t', ' ');
    if (has_control(without_tabs)) {
      return bad_request("bad_header", "A header value holds a control character.");
    }
    const std::string key = lowered(name);
    if (!all.emplace(key, trimmed(value)).second && contains(single, key)) {
      return bad_request(key == "host" ? "bad_host" : "duplicate_header",
                         "The header '" + key + "' may come only once.");
    }
  }
  return bad_request("bad_header", "The head has no empty line at its end.");
}

Refusal check_framing(const std::map<std::string, std::string>& all, GuardedHead& head) {
  const bool body_method = head.method != "GET" && head.method != "HEAD";
  if (all.contains("transfer-encoding")) {
    return {501, "transfer_encoding", "Send a Content-Length instead of a Transfer-Encoding."};
  }
  if (all.contains("upgrade")) return {501, "upgrade", "Protocol upgrades are not offered."};
  if (all.contains("expect")) return {417, "expect", "Send the body without Expect."};
  if (all.contains("content-encoding")) {
    return {415, "content_encoding", "Send the body without Content-Encoding."};
  }
  const auto length = all.find("content-length");
  if (length == all.end()) {
    if (body_method && head.method != "DELETE") {
      return {411, "length_required", "Send a Content-Length."};
    }
    return {};
  }
  const std::string& digits = length->second;
  if (digits.empty() || !std::all_of(digits.begin(), digits.end(), is_digit)) {
    return bad_request("bad_length", "Content-Length must be decimal digits.");
  }
  if (digits.size() > 15) return {413, "body_too_large", "The body is too large."};
  head.content_length = std::stoull(digits);
  if (!body_method && head.content_length > 0) {
    return bad_request("body_not_allowed", "GET and HEAD carry no body here.");
  }
  return {};
}

// Keeps foreign pages out: DNS rebinding by Host, forged requests by Origin and Sec-Fetch-Site.
Refusal check_site(const std::map<std::string, std::string>& all, const GuardPolicy& policy,
                   const GuardedHead& head) {
  const auto host = all.find("host");
  if (host == all.end()) return bad_request("bad_host", "Send exactly one Host header.");
  const std::string name = lowered(host->second);
  if (!contains(policy.hosts, name)) {
    return {421, "host_not_allowed", "This server does not answer for that Host."};
  }
  const auto value = [&](const char* key) {
    const auto it = all.find(key);
    return it == all.end() ? std::string() : lowered(it->second);
  };
  const auto origin = all.find("origin");
  if (origin != all.end() && lowered(origin->second) != "http://" + name) {
    return {403, "origin", "Requests from other origins are refused."};
  }
  const std::string site = value("sec-fetch-site");
  if (site.empty() || site == "same-origin" || site == "none") return {};
  const bool page_visit = head.method == "GET" && head.path == "/" &&
                          value("sec-fetch-mode") == "navigate" &&
                          value("sec-fetch-dest") == "document";
  if (page_visit) return {};
  return {403, "cross_site", "Requests from other sites are refused."};
}

// The library percent-decodes header values, so a value with '%' could turn into a line break
// there.
bool safe_to_forward(std::string_view value) {
  return std::all_of(value.begin(), value.end(),
                     [](char c) { return c >= 32 && c < 127 && c != '%'; });
}

}  // namespace

bool percent_decode(std::string_view text, std::string& out) {
  out.clear();
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return false;
    const int high = hex_value(text[i + 1]), low = hex_value(text[i + 2]);
    if (high < 0 || low < 0) return false;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return true;
}

HeadScan scan_head(std::string_view bytes, const GuardPolicy& policy) {
  using State = HeadScan::State;
  if (bytes.empty()) return {};
  if (!is_upper(bytes[0])) {
    return {State::refused, 0, bad_request("bad_request_line", "This is not an HTTP request.")};
  }
  const auto end = bytes.find("\r\n\r\n");
  const auto head = bytes.substr(0, end == std::string_view::npos ? end : end + 4);
  // Other programs take a bare line feed for a line end; two readings of one head are one too many.
  for (auto at = head.find('\n'); at != std::string_view::npos; at = head.find('\n', at + 1)) {
    if (at == 0 || head[at - 1] != '\r') {
      return {State::refused, 0, bad_request("bad_line_end", "Lines must end with CR LF.")};
    }
  }
  if (head.size() > policy.max_head) {
    return {State::refused,
            0,
            {431, "head_too_large",
             "A request head may have " + std::to_string(policy.max_head) + " bytes."}};
  }
  if (end == std::string_view::npos) return {};
  return {State::complete, end + 4, {}};
}

GuardedHead check_head(std::string_view bytes, const GuardPolicy& policy) {
  GuardedHead head;
  const auto line_end = bytes.find("\r\n");
  if (line_end == std::string_view::npos) {
    head.refusal = bad_request("bad_request_line", "The head has no request line.");
    return head;
  }
  std::string_view version;
  std::map<std::string, std::string> all;
  head.refusal = check_request_line(bytes.substr(0, line_end), policy, head, version);
  if (!head.refusal) head.refusal = parse_headers(bytes.substr(line_end + 2), policy, all);
  if (!head.refusal) head.refusal = check_framing(all, head);
  if (!head.refusal) head.refusal = check_site(all, policy, head);
  if (head.refusal) return head;

  const auto connection = all.find("connection");
  head.keep_alive =
      version == "HTTP/1.1" &&
      (connection == all.end() || lowered(connection->second).find("close") == std::string::npos);
  if (all.contains("cookie")) head.cookie = all["cookie"];
  if (all.contains("authorization")) head.authorization = all["authorization"];
  const auto request_line = bytes.substr(0, line_end);
  const auto target =
      request_line.substr(head.method.size() + 1, request_line.rfind(' ') - head.method.size() - 1);
  head.block = head.method + " " + std::string(target) + " HTTP/1.1\r\n";
  for (const auto name : forwarded) {
    const auto it = all.find(std::string(name));
    if (it == all.end() || it->second.empty() || !safe_to_forward(it->second)) continue;
    head.headers[it->first] = it->second;
    head.block += it->first + ": " + it->second + "\r\n";
  }
  head.block += "\r\n";
  return head;
}

}  // namespace rend::web

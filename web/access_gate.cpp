// Who may talk to a server that listens beyond this machine: one shared token.
#include "web/access_gate.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <stdexcept>

#include "engine/core/error.h"
#include "web/server.h"

namespace rend::web {
namespace {

// Value of `key` in a list "a=1; b=2" or "a=1&b=2"; false when it is not there.
bool find_value(std::string_view list, char separator, std::string_view key, std::string& value) {
  while (!list.empty()) {
    const auto end = list.find(separator);
    auto item = list.substr(0, end);
    list.remove_prefix(end == std::string_view::npos ? list.size() : end + 1);
    while (!item.empty() && item.front() == ' ') item.remove_prefix(1);
    const auto equals = item.find('=');
    if (equals == std::string_view::npos || item.substr(0, equals) != key) continue;
    value = std::string(item.substr(equals + 1));
    return true;
  }
  return false;
}

}  // namespace

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the kernel gave no random bytes");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    token += digits;
  }
  return token;
}

bool equal_in_constant_time(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0u : 1u;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char other = b.empty() ? '\0' : b[i % b.size()];
    difference |= static_cast<unsigned char>(a[i] ^ other);
  }
  return difference == 0;
}

AccessGate::AccessGate(std::string token, int port)
    : token_(std::move(token)), cookie_name_("rend_" + std::to_string(port)) {
  const bool safe = std::all_of(token_.begin(), token_.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
  if (!token_.empty() && (token_.size() < 16 || !safe)) {
    throw Error("token", "must be 16 or more of the characters A-Z a-z 0-9 _ -");
  }
}

AccessGate::Verdict AccessGate::judge(const GuardedHead& head, Clock::time_point now) {
  if (token_.empty()) return Verdict::pass;
  std::string given;
  bool in_address = false;
  constexpr std::string_view bearer = "Bearer ";
  if (head.method == "GET" && head.path == "/" && find_value(head.query, '&', "token", given)) {
    in_address = true;
  } else if (std::string_view(head.authorization).substr(0, bearer.size()) == bearer) {
    given = head.authorization.substr(bearer.size());
  } else if (!find_value(head.cookie, ';', cookie_name_, given)) {
    return Verdict::missing;
  }
  if (equal_in_constant_time(token_, given)) return in_address ? Verdict::greet : Verdict::pass;
  if (now - counted_since_ > std::chrono::minutes(1)) {
    wrong_ = 0;
    counted_since_ = now;
  }
  ++wrong_;
  return Verdict::wrong;
}

std::chrono::milliseconds AccessGate::penalty() const {
  return std::chrono::milliseconds(wrong_ <= 10 ? 0 : 250);
}

std::string AccessGate::cookie() const {
  return cookie_name_ + "=" + token_ + "; Path=/; HttpOnly; SameSite=Strict";
}

}  // namespace rend::web

// Who may talk to a server that listens beyond this machine: one shared token.
#pragma once

#include <chrono>
#include <string>

#include "web/http_guard.h"

namespace rend::web {

/// Compares without telling by its duration where the first difference is.
bool equal_in_constant_time(const std::string& a, const std::string& b);

class AccessGate {
 public:
  using Clock = std::chrono::steady_clock;

  /// An empty token lets everybody pass. @throws Error when the token is too short or not URL-safe.
  AccessGate(std::string token, int port);

  enum class Verdict { pass, greet, missing, wrong };

  /// `greet`: the token came in the address of the page; set the cookie and send it to "/".
  /// Counts wrong tokens.
  Verdict judge(const GuardedHead& head, Clock::time_point now);

  /// How long to hold back the answer to a wrong token: nothing for the first ten in a minute.
  std::chrono::milliseconds penalty() const;

  std::string cookie() const;  ///< value of Set-Cookie

 private:
  std::string token_, cookie_name_;
  int wrong_ = 0;
  Clock::time_point counted_since_{};
};

}  // namespace rend::web

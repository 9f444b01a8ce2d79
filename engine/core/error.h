// The one exception type: bad input, with the place it came from and what would be right.
#pragma once

#include <stdexcept>
#include <string>

namespace rend {

/// Thrown for bad input only; a bug asserts and numerical trouble is data in a report.
/// `where` is a JSON pointer, `file:line`, or `file#/json/pointer`; `why` says what is wrong, shows the
/// value and what is allowed. Caught in main, at the HTTP edge and in the session thread.
class Error : public std::runtime_error {
 public:
  Error(std::string where, std::string why)
      : std::runtime_error(where.empty() ? why : where + ": " + why),
        where_(std::move(where)),
        why_(std::move(why)) {}

  const std::string& where() const { return where_; }
  const std::string& why() const { return why_; }

 private:
  std::string where_;
  std::string why_;
};

}  // namespace rend

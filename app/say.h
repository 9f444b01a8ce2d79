// Words for people on standard error.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

namespace rend {

/// Prints as fmt::print does; a standard error that is closed or full is no reason to stop.
template <class... T>
void say(fmt::format_string<T...> text, T&&... values) {
  const std::string words = fmt::format(text, std::forward<T>(values)...);
  std::fputs(words.c_str(), stderr);
}

}  // namespace rend

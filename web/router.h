// Which route answers a path, and what the path's placeholders hold.
#pragma once

#include <string>
#include <vector>

#include "web/server.h"

namespace rend::web {

class Router {
 public:
  /// @throws Error when a pattern is malformed or two routes have the same method and pattern.
  explicit Router(std::vector<Route> routes);

  struct Match {
    const Route* route = nullptr;    ///< null: no route for this method
    std::vector<std::string> parts;  ///< values of the placeholders
    std::string allow;  ///< methods known for the path, "GET, HEAD, POST"; empty: unknown path
  };

  /// `path` is decoded; HEAD finds the GET route; a literal piece wins over a placeholder.
  Match find(const std::string& method, const std::string& path) const;

 private:
  struct Piece {
    std::string before,
        after;  ///< literal text around the placeholder; all in `before` without one
    bool placeholder = false;
  };
  struct Entry {
    Route route;
    std::vector<Piece> pieces;
    int placeholders = 0;
  };

  static Entry parse(Route route);
  static bool matches(const Entry& entry, const std::vector<std::string>& segments,
                      std::vector<std::string>& parts);

  std::vector<Entry> entries_;  ///< fewest placeholders first
};

}  // namespace rend::web

// Which route answers a path, and what the path's placeholders hold.
#include "web/router.h"

#include <algorithm>
#include <set>

#include "engine/core/error.h"

namespace rend::web {
namespace {

std::vector<std::string> split_segments(const std::string& path) {
  std::vector<std::string> segments;
  for (std::size_t start = 1; start <= path.size();) {
    const auto end = std::min(path.find('/', start), path.size());
    segments.push_back(path.substr(start, end - start));
    start = end + 1;
  }
  return segments;
}

}  // namespace

Router::Entry Router::parse(Route route) {
  const auto malformed = [&](const char* why) {
    return Error("route " + route.method + " " + route.pattern, why);
  };
  static const std::set<std::string> known = {"GET", "POST", "PUT", "PATCH", "DELETE"};
  if (!known.contains(route.method)) throw malformed("unknown method");
  if (route.pattern.empty() || route.pattern[0] != '/') throw malformed("must start with '/'");
  if (!route.handler) throw malformed("has no handler");
  Entry entry{std::move(route), {}, 0};
  for (const std::string& segment : split_segments(entry.route.pattern)) {
    const auto open = segment.find('{');
    if (open == std::string::npos) {
      entry.pieces.push_back({segment, "", false});
      continue;
    }
    const auto close = segment.find('}', open);
    if (close == std::string::npos || segment.find('{', close) != std::string::npos) {
      throw Error("route " + entry.route.pattern, "wants one {placeholder} between two slashes");
    }
    entry.pieces.push_back({segment.substr(0, open), segment.substr(close + 1), true});
    ++entry.placeholders;
  }
  return entry;
}

Router::Router(std::vector<Route> routes) {
  std::set<std::string> seen;
  for (Route& route : routes) {
    if (!seen.insert(route.method + " " + route.pattern).second) {
      throw Error("route " + route.method + " " + route.pattern, "is given twice");
    }
    entries_.push_back(parse(std::move(route)));
  }
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.placeholders < b.placeholders; });
}

bool Router::matches(const Entry& entry, const std::vector<std::string>& segments,
                     std::vector<std::string>& parts) {
  if (entry.pieces.size() != segments.size()) return false;
  parts.clear();
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Piece& piece = entry.pieces[i];
    const std::string& text = segments[i];
    if (!piece.placeholder) {
      if (text != piece.before) return false;
      continue;
    }
    const std::size_t literal = piece.before.size() + piece.after.size();
    if (text.size() <= literal || !text.starts_with(piece.before) || !text.ends_with(piece.after)) {
      return false;
    }
    parts.push_back(text.substr(piece.before.size(), text.size() - literal));
  }
  return true;
}

Router::Match Router::find(const std::string& method, const std::string& path) const {
  const std::string wanted = method == "HEAD" ? "GET" : method;
  const auto segments = split_segments(path);
  Match match;
  std::set<std::string> allowed;
  std::vector<std::string> parts;
  for (const Entry& entry : entries_) {
    if (!matches(entry, segments, parts)) continue;
    allowed.insert(entry.route.method);
    if (entry.route.method == "GET") allowed.insert("HEAD");
    if (entry.route.method == wanted && !match.route) {
      match.route = &entry.route;
      match.parts = parts;
    }
  }
  for (const auto& name : allowed) match.allow += (match.allow.empty() ? "" : ", ") + name;
  return match;
}

}  // namespace rend::web

// Requests to numbers.
#include "app/api_query.h"

#include "engine/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace rend {

namespace {

constexpr int kStillPasses = 12;

template <class T>
T parse(const std::string& key, const std::string& text, T min, T max) {
  T value{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size() || !(value >= min && value <= max))
    throw Error(key, fmt::format("\"{}\" is not a number from {} to {}", text.substr(0, 40), min, max));
  return value;
}

template <class T>
T parse_or(const Query& query, const char* key, T fallback, T min, T max) {
  const auto found = query.find(key);
  return found == query.end() ? fallback : parse<T>(key, found->second, min, max);
}

Vec3 parse_vector(const std::string& key, const std::string& text) {
  Vec3 v;
  std::size_t start = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = axis < 2 ? text.find(',', start) : text.size();
    if (comma == std::string::npos) throw Error(key, "must be three numbers with commas between");
    v[axis] = parse<double>(key, text.substr(start, comma - start), -1e6, 1e6);
    start = comma + 1;
  }
  return v;
}

std::string one_of(const Query& query, const char* key, const std::string& fallback,
                   const std::vector<std::string>& allowed) {
  const auto found = query.find(key);
  if (found == query.end()) return fallback;
  if (std::find(allowed.begin(), allowed.end(), found->second) == allowed.end())
    throw Error(key, fmt::format("\"{}\" is not one of {}", found->second.substr(0, 40), fmt::join(allowed, ", ")));
  return found->second;
}

}  // namespace

PictureQuery read_picture_query(const Query& query) {
  PictureQuery q;
  q.text = query;
  const auto after = query.find("after");
  if (after != query.end()) q.after = after->second;
  q.wait_ms = parse_or(query, "wait", 0, 0, 30000);
  const auto frame = query.find("frame");
  if (frame != query.end() && frame->second != "live") q.frame = read_frame_number(frame->second);
  q.width = parse_or(query, "w", 1280, 16, 3840);
  q.height = parse_or(query, "h", 720, 16, 2160);
  q.quality_still = one_of(query, "quality", "fast", {"fast", "still"}) == "still";
  if (q.quality_still) q.format = PictureFormat::jpeg_still;
  return q;
}

View PictureQuery::view(const Stage& stage) const {
  View v = default_view(stage.scene);
  v.width = width;
  v.height = height;
  v.accumulate = quality_still ? kStillPasses : 1;
  if (const auto eye = text.find("eye"); eye != text.end()) v.camera.eye = parse_vector("eye", eye->second);
  if (const auto target = text.find("target"); target != text.end())
    v.camera.target = parse_vector("target", target->second);
  v.camera.fov = parse_or<double>(text, "fov", v.camera.fov, 1, 120);
  if ((v.camera.eye - v.camera.target).norm() < 1e-9) throw Error("eye", "must differ from target");
  v.color_by = one_of(text, "color", v.color_by, color_names());
  v.particles = one_of(text, "mode", v.particles ? "particles" : "surface", {"surface", "particles"}) == "particles";
  v.legend = one_of(text, "legend", "1", {"0", "1"}) == "1";
  v.theme = one_of(text, "theme", "light", {"light", "dark"}) == "dark" ? Theme::dark : Theme::light;
  return v;
}

WaitQuery read_wait_query(const Query& query) {
  WaitQuery wait;
  wait.after = parse_or<std::uint64_t>(query, "after", 0, 0, ~std::uint64_t{0});
  wait.seconds = 1e-3 * parse_or(query, "wait", 0, 0, 30000);
  return wait;
}

PictureShare read_picture_share(const Query& query) {
  const auto share = [&](const char* key) {
    const auto found = query.find(key);
    if (found == query.end()) throw Error(key, "is needed: a share of the picture from 0 to 1");
    return parse<double>(key, found->second, 0, 1);
  };
  return {share("x"), share("y")};
}

Index read_frame_number(const std::string& text) { return parse<Index>("frame", text, 0, 1000000000); }

}  // namespace rend

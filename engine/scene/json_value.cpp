// Strict JSON text to a tree; the one place of the scene reader that includes nlohmann-json.
#include "engine/scene/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/core/error.h"

namespace rend {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxDepth = 32;
constexpr std::size_t kMaxValues = 100000;

/// Builds the tree from parser events, so that a document which is too deep or too big is never
/// built.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(std::string_view text, const std::string& source) : text_(text), source_(source) {}

  JsonValue take() { return std::move(root_); }

  bool null() override { return put({}); }
  bool boolean(bool value) override { return put(JsonValue::of(value)); }
  bool number_integer(number_integer_t value) override {
    return put(JsonValue::of(static_cast<double>(value)));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return put(JsonValue::of(static_cast<double>(value)));
  }
  bool number_float(number_float_t value, const string_t&) override {
    return put(JsonValue::of(value));
  }
  bool string(string_t& value) override {
    refuse_nul(value);
    return put(JsonValue::of(std::string_view(value)));
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(JsonValue::object()); }
  bool start_array(std::size_t) override { return open(JsonValue::list()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& value) override {
    refuse_nul(value);
    if (!open_.back().keys.insert(value).second)
      throw Error(place(value), "this key is given twice");
    open_.back().key = value;
    return true;
  }
  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::json::exception& exception) override {
    const std::size_t end = std::min(position, text_.size());
    const std::string_view read = text_.substr(0, end == 0 ? 0 : end - 1);
    const std::size_t line = 1 + std::count(read.begin(), read.end(), '\n');
    const std::size_t newline = read.rfind('\n');
    const std::size_t column = read.size() - (newline == read.npos ? 0 : newline + 1) + 1;
    throw Error(fmt::format("{}:{}:{}", source_, line, column), reason(exception.what()));
  }

 private:
  struct Open {
    JsonValue value;
    std::string key;
    std::set<std::string> keys;
  };

  std::string place(std::string_view key) const {
    std::string pointer;
    for (std::size_t i = 0; i + 1 < open_.size(); ++i)
      pointer = join_pointer(pointer, step(open_[i]));
    return source_ + "#" + join_pointer(pointer, key);
  }
  static std::string step(const Open& open) {
    return open.value.kind == JsonValue::Kind::list ? std::to_string(open.value.items.size())
                                                    : open.key;
  }
  std::string here() const { return open_.empty() ? source_ + "#" : place(step(open_.back())); }

  void refuse_nul(const std::string& value) const {
    if (value.find('\0') != value.npos)
      throw Error(here(), "a string must not hold a NUL character");
  }
  void count() {
    if (++values_ > kMaxValues)
      throw Error(here(), fmt::format("more than {} values in one file", kMaxValues));
  }
  bool put(JsonValue value) {
    count();
    attach(std::move(value));
    return true;
  }
  bool open(JsonValue value) {
    count();
    if (open_.size() == kMaxDepth)
      throw Error(here(), fmt::format("nested deeper than {} levels", kMaxDepth));
    open_.push_back({std::move(value), {}, {}});
    return true;
  }
  bool close() {
    JsonValue value = std::move(open_.back().value);
    open_.pop_back();
    attach(std::move(value));
    return true;
  }
  void attach(JsonValue value) {
    if (open_.empty())
      root_ = std::move(value);
    else if (open_.back().value.kind == JsonValue::Kind::list)
      open_.back().value.items.push_back(std::move(value));
    else
      open_.back().value.members.emplace_back(open_.back().key, std::move(value));
  }

  /// The parser's sentence without its own prefix, and in ASCII since it may quote broken UTF-8.
  static std::string reason(std::string what) {
    for (const char* start : {"syntax error", "number overflow"})
      if (const auto at = what.find(start); at != what.npos) what.erase(0, at);
    if (what.size() > 300) what = what.substr(0, 300) + "...";
    for (char& c : what)
      if (static_cast<unsigned char>(c) >= 0x80) c = '?';
    return "not valid JSON: " + what;
  }

  std::string_view text_;
  const std::string& source_;
  JsonValue root_;
  std::vector<Open> open_;
  std::size_t values_ = 0;
};

std::string quote(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string print_number(double value) {
  if (value == 0) return std::signbit(value) ? "-0.0" : "0";
  std::string text = fmt::format("{}", value);
  if (const auto e = text.find('e'); e != text.npos) {  // 1e+05 -> 1e5
    std::size_t digits = e + 1;
    const bool negative = text[digits] == '-';
    const std::size_t first = text.find_first_not_of("+-0", digits);
    text = text.substr(0, digits) + (negative ? "-" : "") + text.substr(first);
  }
  return text;
}

void append_line(const JsonValue& value, std::size_t limit, std::string& out) {
  const auto full = [&] { return limit != 0 && out.size() > limit; };
  switch (value.kind) {
    case JsonValue::Kind::null:
      out += "null";
      break;
    case JsonValue::Kind::boolean:
      out += value.boolean ? "true" : "false";
      break;
    case JsonValue::Kind::number:
      out += print_number(value.number);
      break;
    case JsonValue::Kind::text:
      out += limit != 0 && value.text.size() > limit ? quote(value.text.substr(0, limit) + "...")
                                                     : quote(value.text);
      break;
    case JsonValue::Kind::list: {
      const char* gap = "";
      out += '[';
      for (const JsonValue& item : value.items) {
        out += std::exchange(gap, ", ");
        if (full()) {
          out += fmt::format("... {} items", value.items.size());
          break;
        }
        append_line(item, limit, out);
      }
      out += ']';
      break;
    }
    case JsonValue::Kind::object: {
      const char* gap = "";
      out += '{';
      for (const auto& [key, member] : value.members) {
        out += std::exchange(gap, ", ");
        if (full()) {
          out += "...";
          break;
        }
        out += quote(key) + ": ";
        append_line(member, limit, out);
      }
      out += '}';
      break;
    }
  }
}

void append_block(const JsonValue& value, std::size_t indent, std::size_t used, std::string& out) {
  constexpr std::size_t columns = 99;  // leaves room for a comma
  const bool is_object = value.kind == JsonValue::Kind::object;
  const bool nested = is_object || value.kind == JsonValue::Kind::list;
  const std::string line = print_json_line(value, nested ? columns : 0);
  const std::size_t count = is_object ? value.members.size() : value.items.size();
  if (!nested || count == 0 || (indent > 0 && used + line.size() <= columns)) {
    out += line;
    return;
  }
  const std::string margin(indent + 2, ' ');
  out += is_object ? "{\n" : "[\n";
  for (std::size_t i = 0; i < count; ++i) {
    const std::string key = is_object ? quote(value.members[i].first) + ": " : "";
    out += margin + key;
    append_block(is_object ? value.members[i].second : value.items[i], indent + 2,
                 margin.size() + key.size(), out);
    out += i + 1 < count ? ",\n" : "\n";
  }
  out += std::string(indent, ' ') + (is_object ? "}" : "]");
}

}  // namespace

JsonValue::JsonValue() = default;
JsonValue::JsonValue(const JsonValue& other) = default;
JsonValue::JsonValue(JsonValue&& other) noexcept = default;
JsonValue& JsonValue::operator=(const JsonValue& other) = default;
JsonValue& JsonValue::operator=(JsonValue&& other) noexcept = default;
JsonValue::~JsonValue() = default;

JsonValue JsonValue::of(const char* value) { return of(std::string_view(value)); }

JsonValue JsonValue::of(bool value) {
  JsonValue json;
  json.kind = Kind::boolean;
  json.boolean = value;
  return json;
}

JsonValue JsonValue::of(double value) {
  JsonValue json;
  json.kind = Kind::number;
  json.number = value;
  return json;
}

JsonValue JsonValue::of(std::string_view value) {
  JsonValue json;
  json.kind = Kind::text;
  json.text = value;
  return json;
}

JsonValue JsonValue::list() {
  JsonValue json;
  json.kind = Kind::list;
  return json;
}

JsonValue JsonValue::object() {
  JsonValue json;
  json.kind = Kind::object;
  return json;
}

const JsonValue* JsonValue::find(std::string_view key) const {
  const auto at = std::find_if(members.begin(), members.end(),
                               [&](const auto& member) { return member.first == key; });
  return at == members.end() ? nullptr : &at->second;
}

JsonValue* JsonValue::find(std::string_view key) {
  return const_cast<JsonValue*>(std::as_const(*this).find(key));
}

JsonValue& JsonValue::add(std::string_view key, JsonValue value) {
  return members.emplace_back(std::string(key), std::move(value)).second;
}

JsonValue parse_json(std::string_view text, const std::string& source) {
  if (text.size() > kMaxBytes)
    throw Error(source, fmt::format("{} bytes; a scene has at most {}", text.size(), kMaxBytes));
  // The parser takes a raw NUL for the end of the text and would not see what follows it.
  if (text.find('\0') != text.npos) throw Error(source, "not valid JSON: holds a NUL byte");
  TreeBuilder builder(text, source);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

std::string print_json(const JsonValue& value) {
  std::string out;
  append_block(value, 0, 0, out);
  return out + "\n";
}

std::string print_json_line(const JsonValue& value, std::size_t limit) {
  std::string out;
  append_line(value, limit, out);
  return out;
}

}  // namespace rend

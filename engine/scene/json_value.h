// A JSON document as a small tree: strict parser, pretty printer, replacement by pointer.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rend {

/// One JSON value; members keep their order and their keys are distinct. Numbers are doubles, exact
/// for integers below 2^53.
struct JsonValue {
  enum class Kind { null, boolean, number, text, list, object };
  using Members = std::vector<std::pair<std::string, JsonValue>>;

  Kind kind = Kind::null;
  bool boolean = false;
  double number = 0;
  std::string text;
  std::vector<JsonValue> items;
  Members members;

  // A value holds pairs of its own kind, so these can only be made where the type is complete.
  JsonValue();
  JsonValue(const JsonValue& other);
  JsonValue(JsonValue&& other) noexcept;
  JsonValue& operator=(const JsonValue& other);
  JsonValue& operator=(JsonValue&& other) noexcept;
  ~JsonValue();

  static JsonValue of(bool value);
  static JsonValue of(double value);
  static JsonValue of(std::string_view value);
  static JsonValue of(const char* value);
  static JsonValue list();
  static JsonValue object();

  /// The member called `key`; nullptr when there is none.
  const JsonValue* find(std::string_view key) const;
  JsonValue* find(std::string_view key);
  /// Appends a member to an object and returns it; the key must be new.
  JsonValue& add(std::string_view key, JsonValue value);
};

/// Parses RFC 8259 JSON and nothing else: no comments, NaN, trailing text, NUL, bad UTF-8,
/// duplicate keys, depth above 32 or more than 100 000 values. @throws Error with
/// `source:line:column` or `source#/pointer`.
JsonValue parse_json(std::string_view text, const std::string& source);

/// JSON text indented by two spaces; what fits into 100 columns stays on one line. Numbers are the
/// shortest text that reads back to the same double.
std::string print_json(const JsonValue& value);

/// The same on one line; long lists, objects and strings are cut when `limit` characters are passed
/// (0: never).
std::string print_json_line(const JsonValue& value, std::size_t limit = 0);

/// `pointer` + "/" + `key` with ~ and / escaped as RFC 6901 wants.
std::string join_pointer(std::string_view pointer, std::string_view key);

/// Puts the JSON text `value` (or the string itself when it is not JSON) at `pointer`, making
/// missing objects on the way; null removes a key. @throws Error when the pointer leads nowhere.
void replace_at(JsonValue& root, const std::string& pointer, const std::string& value,
                const std::string& source);

}  // namespace rend

// JSON pointers (RFC 6901): building them and replacing a part of a document.
#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "engine/core/error.h"
#include "engine/scene/json_value.h"

namespace rend {

namespace {

std::vector<std::string> split_pointer(const std::string& pointer, const std::string& where) {
  if (pointer.size() < 2 || pointer[0] != '/')
    throw Error(where, "an override needs a JSON pointer such as /grid/dx");
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    const char c = pointer[i];
    if (c == '/') {
      keys.emplace_back();
    } else if (c == '~') {
      const char next = i + 1 < pointer.size() ? pointer[i + 1] : '\0';
      if (next != '0' && next != '1')
        throw Error(where, "a JSON pointer writes ~ as ~0 and / as ~1");
      keys.back() += next == '0' ? '~' : '/';
      ++i;
    } else {
      keys.back() += c;
    }
  }
  return keys;
}

std::optional<std::size_t> list_index(const std::string& key) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
  const bool whole = error == std::errc() && end == key.data() + key.size();
  if (!whole || (key.size() > 1 && key[0] == '0')) return std::nullopt;
  return index;
}

std::optional<JsonValue> try_parse(const std::string& text) {
  try {
    return parse_json(text, {});
  } catch (const Error&) {
    return std::nullopt;
  }
}

JsonValue parse_override(const std::string& text, const std::string& where) {
  if (const auto json = try_parse(text)) return *json;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  // Through the parser once more, which refuses control characters and broken UTF-8.
  if (const auto plain = try_parse(quoted + "\"")) return *plain;
  throw Error(where, "neither JSON nor plain UTF-8 text");
}

}  // namespace

std::string join_pointer(std::string_view pointer, std::string_view key) {
  std::string joined = std::string(pointer) + '/';
  for (const char c : key) {
    if (c == '~')
      joined += "~0";
    else if (c == '/')
      joined += "~1";
    else
      joined += c;
  }
  return joined;
}

void replace_at(JsonValue& root, const std::string& pointer, const std::string& value,
                const std::string& source) {
  const std::string where = source + "#" + pointer;
  const std::vector<std::string> keys = split_pointer(pointer, where);
  JsonValue replacement = parse_override(value, where);
  JsonValue* at = &root;
  std::string path;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const bool last = k + 1 == keys.size();
    if (at->kind == JsonValue::Kind::list) {
      const auto index = list_index(keys[k]);
      if (!index || *index >= at->items.size())
        throw Error(where, fmt::format("leads nowhere: {} is a list of {} items, counted from 0",
                                       path, at->items.size()));
      at = &at->items[*index];
    } else if (at->kind == JsonValue::Kind::object) {
      JsonValue* next = at->find(keys[k]);
      if (last && replacement.kind == JsonValue::Kind::null) {
        std::erase_if(at->members, [&](const auto& member) { return member.first == keys[k]; });
        return;
      }
      if (!next && !last && list_index(keys[k + 1]))
        throw Error(where,
                    fmt::format("leads nowhere: the scene has no {}", join_pointer(path, keys[k])));
      at = next ? next : &at->add(keys[k], JsonValue::object());
    } else {
      throw Error(where, fmt::format("leads nowhere: {} is {}", path, print_json_line(*at, 60)));
    }
    path = join_pointer(path, keys[k]);
  }
  *at = std::move(replacement);
}

}  // namespace rend

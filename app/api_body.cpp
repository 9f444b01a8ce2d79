// Bodies of requests.
#include "app/api_body.h"

#include "engine/core/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string_view>

namespace rend {

namespace {

using Kind = JsonValue::Kind;

const JsonValue* number_of(const JsonValue* value) {
  return value && value->kind == Kind::number ? value : nullptr;
}

Real within(Real value, Real min, Real max, const std::string& where) {
  if (!(value >= min && value <= max))
    throw Error(where, fmt::format("{} is out of range; {} to {} is allowed", value, min, max));
  return value;
}

}  // namespace

web::Response reply(const nlohmann::json& body) { return {200, "application/json", body.dump(), {}}; }

JsonValue parse_body(const std::string& body, std::initializer_list<const char*> known) {
  if (body.empty()) return JsonValue::object();
  JsonValue value = parse_json(body, "");
  if (value.kind != Kind::object) throw Error("", "the body must be a JSON object");
  const std::string names = known.size() == 0 ? "none" : fmt::format("{}", fmt::join(known, ", "));
  for (const auto& [key, member] : value.members)
    if (std::find(known.begin(), known.end(), std::string_view(key)) == known.end())
      throw Error(join_pointer("", key), "unknown key; known here: " + names);
  return value;
}

Real read_number(const JsonValue& body, const char* key, Real min, Real max) {
  const std::string where = join_pointer("", key);
  const JsonValue* value = number_of(body.find(key));
  if (!value) throw Error(where, "must be a number");
  return within(value->number, min, max, where);
}

Vec3 read_vector(const JsonValue& body, const char* key, Real limit) {
  const std::string where = join_pointer("", key);
  const JsonValue* list = body.find(key);
  if (!list || list->kind != Kind::list || list->items.size() != 3)
    throw Error(where, "must be three numbers");
  Vec3 vector;
  for (int k = 0; k < 3; ++k) {
    const JsonValue* value = number_of(&list->items[static_cast<std::size_t>(k)]);
    if (!value) throw Error(where, "must be three numbers");
    vector[k] = within(value->number, -limit, limit, where);
  }
  return vector;
}

}  // namespace rend

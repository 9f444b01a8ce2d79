// Field tables to JSON Schema (2020-12): what the reader accepts, for editors, the page and tests.
#include "engine/scene/field_schema.h"

#include <fmt/format.h>

#include <algorithm>

namespace rend {

namespace {

JsonValue typed(const char* type) {
  JsonValue schema = JsonValue::object();
  schema.add("type", JsonValue::of(type));
  return schema;
}

JsonValue number_schema(const Range& range) {
  JsonValue schema = typed("number");
  schema.add("minimum", JsonValue::of(range.min));
  schema.add("maximum", JsonValue::of(range.max));
  return schema;
}

JsonValue list_schema(JsonValue item, std::size_t min, std::size_t max) {
  JsonValue schema = typed("array");
  schema.add("minItems", JsonValue::of(static_cast<double>(min)));
  schema.add("maxItems", JsonValue::of(static_cast<double>(max)));
  schema.add("items", std::move(item));
  return schema;
}

JsonValue enum_schema(Names names) {
  JsonValue schema = typed("string");
  JsonValue list = JsonValue::list();
  for (const char* name : names) list.items.push_back(JsonValue::of(name));
  schema.add("enum", std::move(list));
  return schema;
}

template <class Values>
JsonValue numbers(const Values& values) {
  JsonValue list = JsonValue::list();
  for (const Real value : values) list.items.push_back(JsonValue::of(value));
  return list;
}

JsonValue names_list(const std::vector<std::string>& names) {
  JsonValue list = JsonValue::list();
  for (const std::string& name : names) list.items.push_back(JsonValue::of(std::string_view(name)));
  return list;
}

}  // namespace

void FieldSchema::put(const Field& field, JsonValue schema, const char* unit,
                      std::optional<JsonValue> fallback) {
  const std::string help =
      std::string(unit) == "-" ? field.help : fmt::format("{} [{}]", field.help, unit);
  schema.add("description", JsonValue::of(std::string_view(help)));
  if (field.required)
    required_.emplace_back(field.key);
  else if (fallback)
    schema.add("default", std::move(*fallback));
  properties_.add(field.key, std::move(schema));
}

JsonValue FieldSchema::schema() const {
  if (!variants_.empty()) {
    JsonValue choices = JsonValue::list();
    for (const FieldSchema& variant : variants_) choices.items.push_back(variant.schema());
    JsonValue schema = typed("object");
    schema.add("oneOf", std::move(choices));
    return schema;
  }
  JsonValue schema = typed("object");
  schema.add("properties", properties_);
  if (!required_.empty()) schema.add("required", names_list(required_));
  JsonValue dependent = JsonValue::object();
  for (const auto& [first, second] : exclusive_) {
    JsonValue* refused = dependent.find(first);
    if (!refused) {
      refused = &dependent.add(first, typed("object"));
      refused->add("properties", JsonValue::object());
    }
    refused->find("properties")->add(second, JsonValue::of(false));
  }
  if (!exclusive_.empty()) schema.add("dependentSchemas", std::move(dependent));
  schema.add("additionalProperties", JsonValue::of(false));
  return schema;
}

void FieldSchema::number(const Field& field, Real& value, const Range& range) {
  put(field, number_schema(range), range.unit, JsonValue::of(value));
}

void FieldSchema::optional_number(const Field& field, std::optional<Real>&, const Range& range) {
  put(field, number_schema(range), range.unit);
}

void FieldSchema::number_or_word(const Field& field, std::optional<Real>& value, const char* word,
                                 const Range& range) {
  JsonValue fixed = JsonValue::object();
  fixed.add("const", JsonValue::of(word));
  JsonValue either = JsonValue::list();
  either.items = {number_schema(range), std::move(fixed)};
  JsonValue schema = JsonValue::object();
  schema.add("oneOf", std::move(either));
  put(field, std::move(schema), range.unit, value ? JsonValue::of(*value) : JsonValue::of(word));
}

void FieldSchema::integer(const Field& field, std::int64_t& value, std::int64_t min,
                          std::int64_t max, std::span<const std::int64_t> allowed) {
  JsonValue schema = typed("integer");
  if (allowed.empty()) {
    schema.add("minimum", JsonValue::of(static_cast<double>(min)));
    schema.add("maximum", JsonValue::of(static_cast<double>(max)));
  } else {
    schema.add("enum", numbers(allowed));
  }
  put(field, std::move(schema), "-", JsonValue::of(static_cast<double>(value)));
}

void FieldSchema::flag(const Field& field, bool& value) {
  put(field, typed("boolean"), "-", JsonValue::of(value));
}

void FieldSchema::text(const Field& field, std::string& value, std::size_t max_length) {
  JsonValue schema = typed("string");
  schema.add("maxLength", JsonValue::of(static_cast<double>(max_length)));
  put(field, std::move(schema), "-", JsonValue::of(std::string_view(value)));
}

void FieldSchema::choice(const Field& field, int& value, Names names) {
  put(field, enum_schema(names), "-", JsonValue::of(names[value]));
}

void FieldSchema::vector(const Field& field, Vec3& value, const Range& range) {
  put(field, list_schema(number_schema(range), 3, 3), range.unit, numbers(value));
}

void FieldSchema::matrix(const Field& field, Mat3& value, const Range& range) {
  JsonValue rows = JsonValue::list();
  for (int i = 0; i < 3; ++i) rows.items.push_back(numbers(Vec3(value.row(i))));
  put(field, list_schema(list_schema(number_schema(range), 3, 3), 3, 3), range.unit,
      std::move(rows));
}

void FieldSchema::points(const Field& field, std::vector<Eigen::Vector2d>&, std::size_t min,
                         std::size_t max, const Range& range) {
  put(field, list_schema(list_schema(number_schema(range), 2, 2), min, max), range.unit);
}

void FieldSchema::reference(const Field& field, std::size_t&, std::span<const std::string>) {
  put(field, typed("string"));
}

void FieldSchema::mesh_file(const Field& field, std::string&, std::string&) {
  put(field, typed("string"));
}

void FieldSchema::object(const Field& field, const std::function<void(FieldVisitor&)>& fields) {
  FieldSchema inner;
  fields(inner);
  put(field, inner.schema());
}

void FieldSchema::sequence(const Field& field, const Sequence& sequence) {
  sequence.resize(1);
  FieldSchema inner;
  sequence.describe(inner, 0);
  sequence.resize(0);
  if (!sequence.name) return put(field, list_schema(inner.schema(), sequence.min, sequence.max));
  JsonValue schema = typed("object");
  schema.add("minProperties", JsonValue::of(static_cast<double>(sequence.min)));
  schema.add("maxProperties", JsonValue::of(static_cast<double>(sequence.max)));
  schema.add("additionalProperties", inner.schema());
  put(field, std::move(schema));
}

void FieldSchema::variant(const Field& field, int& value, Names names,
                          const std::function<void(FieldVisitor&, int)>& fields) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    FieldSchema alternative;
    JsonValue type = JsonValue::object();
    type.add("const", JsonValue::of(names[i]));
    alternative.put(field, std::move(type));
    value = static_cast<int>(i);
    fields(alternative, value);
    variants_.push_back(std::move(alternative));
  }
}

void FieldSchema::exclusive(const char* first, const char* second) {
  // Either one stands in for the other, so neither is required by itself.
  std::erase_if(required_, [&](const std::string& key) { return key == first || key == second; });
  exclusive_.emplace_back(first, second);
}

}  // namespace rend

// Scene to JSON, one member for each field that is not a shorthand.
#include "engine/scene/field_writer.h"

namespace rend {

namespace {

template <class Values>
JsonValue numbers(const Values& values) {
  JsonValue list = JsonValue::list();
  for (const Real value : values) list.items.push_back(JsonValue::of(value));
  return list;
}

}  // namespace

void FieldWriter::put(const Field& field, JsonValue value) {
  if (!field.input_only) json_.add(field.key, std::move(value));
}

void FieldWriter::number(const Field& field, Real& value, const Range&) {
  put(field, JsonValue::of(value));
}

void FieldWriter::optional_number(const Field& field, std::optional<Real>& value, const Range&) {
  if (value) put(field, JsonValue::of(*value));
}

void FieldWriter::number_or_word(const Field& field, std::optional<Real>& value, const char* word,
                                 const Range&) {
  put(field, value ? JsonValue::of(*value) : JsonValue::of(word));
}

void FieldWriter::integer(const Field& field, std::int64_t& value, std::int64_t, std::int64_t,
                          std::span<const std::int64_t>) {
  put(field, JsonValue::of(static_cast<double>(value)));
}

void FieldWriter::flag(const Field& field, bool& value) { put(field, JsonValue::of(value)); }

void FieldWriter::text(const Field& field, std::string& value, std::size_t) {
  put(field, JsonValue::of(std::string_view(value)));
}

void FieldWriter::choice(const Field& field, int& value, Names names) {
  put(field, JsonValue::of(names[value]));
}

void FieldWriter::vector(const Field& field, Vec3& value, const Range&) {
  put(field, numbers(value));
}

void FieldWriter::matrix(const Field& field, Mat3& value, const Range&) {
  JsonValue rows = JsonValue::list();
  for (int i = 0; i < 3; ++i) rows.items.push_back(numbers(Vec3(value.row(i))));
  put(field, std::move(rows));
}

void FieldWriter::points(const Field& field, std::vector<Eigen::Vector2d>& value, std::size_t,
                         std::size_t, const Range&) {
  JsonValue list = JsonValue::list();
  for (const Eigen::Vector2d& point : value) list.items.push_back(numbers(point));
  put(field, std::move(list));
}

void FieldWriter::reference(const Field& field, std::size_t& value,
                            std::span<const std::string> names) {
  put(field, JsonValue::of(std::string_view(names[value])));
}

void FieldWriter::mesh_file(const Field& field, std::string& file, std::string&) {
  put(field, JsonValue::of(std::string_view(file)));
}

void FieldWriter::object(const Field& field, const std::function<void(FieldVisitor&)>& fields) {
  JsonValue object = JsonValue::object();
  FieldWriter writer(object);
  fields(writer);
  put(field, std::move(object));
}

void FieldWriter::sequence(const Field& field, const Sequence& sequence) {
  JsonValue all = sequence.name ? JsonValue::object() : JsonValue::list();
  for (std::size_t i = 0; i < sequence.size; ++i) {
    JsonValue object = JsonValue::object();
    FieldWriter writer(object);
    sequence.describe(writer, i);
    if (sequence.name)
      all.add(sequence.name(i), std::move(object));
    else
      all.items.push_back(std::move(object));
  }
  put(field, std::move(all));
}

void FieldWriter::variant(const Field& field, int& value, Names names,
                          const std::function<void(FieldVisitor&, int)>& fields) {
  put(field, JsonValue::of(names[value]));
  fields(*this, value);
}

}  // namespace rend

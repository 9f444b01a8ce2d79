// JSON to scene: types, ranges, unknown and missing keys, each refusal with its pointer.
#include "engine/scene/field_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "engine/core/error.h"

namespace rend {

namespace {

constexpr const char* kKindNames[] = {"null",   "true or false", "a number",
                                      "a text", "a list",        "an object"};

std::string show(const JsonValue& value) { return print_json_line(value, 60); }

[[noreturn]] void wrong_type(const std::string& place, const JsonValue& value,
                             const std::string& wanted) {
  throw Error(place, fmt::format("is {} ({}); it must be {}", show(value),
                                 kKindNames[static_cast<int>(value.kind)], wanted));
}

std::string show_range(const Range& range) {
  const std::string unit = std::string(range.unit) == "-" ? "" : fmt::format(" {}", range.unit);
  if (std::isinf(range.max)) return fmt::format("at least {}{}", range.min, unit);
  return fmt::format("between {} and {}{}", range.min, range.max, unit);
}

std::vector<std::string> strings(Names names) { return {names.begin(), names.end()}; }

void refuse_control_characters(const std::string& text, const std::string& place) {
  const auto is_control = [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7f; };
  if (std::any_of(text.begin(), text.end(), is_control))
    throw Error(place, "must not hold control characters");
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(const std::string& name, const std::vector<std::string>& names) {
  constexpr std::size_t longest = 100;
  std::string nearest;
  if (name.size() > longest) return nearest;
  std::size_t best = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string& candidate : names) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

FieldReader::FieldReader(const JsonValue& json, std::string pointer, const SceneSource& source,
                         bool absent)
    : json_(json), pointer_(std::move(pointer)), source_(source), absent_(absent) {
  if (json.kind != JsonValue::Kind::object)
    wrong_type(source_.name + "#" + pointer_, json, "an object");
}

std::string FieldReader::place(std::string_view key) const {
  return source_.name + "#" + join_pointer(pointer_, key);
}

const JsonValue* FieldReader::take(const Field& field, const char* unit) {
  known_.emplace_back(field.key);
  const JsonValue* value = json_.find(field.key);
  if (!value && field.required && missing_.empty()) {
    const std::string shown = unit && std::string(unit) != "-" ? fmt::format(" [{}]", unit) : "";
    missing_ = fmt::format("the key \"{}\" is missing ({}{})", field.key, field.help, shown);
  }
  return value;
}

void FieldReader::finish() const {
  for (const auto& [key, value] : json_.members) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    const std::string near = nearest_name(key, known_);
    throw Error(place(key),
                fmt::format("unknown key{}; known here: {}",
                            near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near),
                            fmt::join(known_, ", ")));
  }
  if (!missing_.empty()) throw Error(source_.name + "#" + pointer_, missing_);
}

void FieldReader::exclusive(const char* first, const char* second) {
  if (given(first) && given(second))
    throw Error(place(second), fmt::format("give either {} or {}, not both", first, second));
}

Real FieldReader::read_number(const JsonValue& value, const std::string& place, const Range& range,
                              const char* word) const {
  const std::string allowed =
      word ? fmt::format("{}, or \"{}\"", show_range(range), word) : show_range(range);
  if (value.kind != JsonValue::Kind::number) wrong_type(place, value, "a number " + allowed);
  if (!(value.number >= range.min && value.number <= range.max))
    throw Error(place, fmt::format("is {}; it must be {}", show(value), allowed));
  return value.number;
}

const JsonValue& FieldReader::read_list(const JsonValue& value, const std::string& place,
                                        std::size_t min, std::size_t max,
                                        const std::string& what) const {
  const std::string count = min == max ? std::to_string(min) : fmt::format("{} to {}", min, max);
  const std::string wanted = fmt::format("a list of {} {}", count, what);
  if (value.kind != JsonValue::Kind::list) wrong_type(place, value, wanted);
  if (value.items.size() < min || value.items.size() > max)
    throw Error(place, fmt::format("has {} items; it must be {}", value.items.size(), wanted));
  return value;
}

std::size_t FieldReader::read_name(const JsonValue& value, const std::string& place,
                                   const char* what, const std::vector<std::string>& names) const {
  const std::string list = fmt::format("one of \"{}\"", fmt::join(names, "\", \""));
  if (value.kind != JsonValue::Kind::text) wrong_type(place, value, list);
  const auto found = std::find(names.begin(), names.end(), value.text);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const std::string near = nearest_name(value.text, names);
  throw Error(place,
              fmt::format("is {}, which is no {}{}; it must be {}", show(value), what,
                          near.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", near), list));
}

void FieldReader::number(const Field& field, Real& value, const Range& range) {
  if (const JsonValue* json = take(field, range.unit))
    value = read_number(*json, place(field.key), range);
}

void FieldReader::optional_number(const Field& field, std::optional<Real>& value,
                                  const Range& range) {
  value.reset();
  if (const JsonValue* json = take(field, range.unit))
    value = read_number(*json, place(field.key), range);
}

void FieldReader::number_or_word(const Field& field, std::optional<Real>& value, const char* word,
                                 const Range& range) {
  const JsonValue* json = take(field, range.unit);
  if (!json) return;
  value.reset();
  if (json->kind != JsonValue::Kind::text || json->text != word)
    value = read_number(*json, place(field.key), range, word);
}

void FieldReader::integer(const Field& field, std::int64_t& value, std::int64_t min,
                          std::int64_t max, std::span<const std::int64_t> allowed) {
  const JsonValue* json = take(field);
  if (!json) return;
  const std::string wanted = allowed.empty()
                                 ? fmt::format("a whole number between {} and {}", min, max)
                                 : fmt::format("one of {}", fmt::join(allowed, ", "));
  if (json->kind != JsonValue::Kind::number) wrong_type(place(field.key), *json, wanted);
  const double number = json->number;
  bool right = number == std::floor(number) && number >= static_cast<double>(min) &&
               number <= static_cast<double>(max);
  if (right && !allowed.empty())
    right = std::find(allowed.begin(), allowed.end(), static_cast<std::int64_t>(number)) !=
            allowed.end();
  if (!right)
    throw Error(place(field.key), fmt::format("is {}; it must be {}", show(*json), wanted));
  value = static_cast<std::int64_t>(number);
}

void FieldReader::flag(const Field& field, bool& value) {
  const JsonValue* json = take(field);
  if (!json) return;
  if (json->kind != JsonValue::Kind::boolean) wrong_type(place(field.key), *json, "true or false");
  value = json->boolean;
}

void FieldReader::text(const Field& field, std::string& value, std::size_t max_length) {
  const JsonValue* json = take(field);
  if (!json) return;
  if (json->kind != JsonValue::Kind::text) wrong_type(place(field.key), *json, "a text");
  if (json->text.size() > max_length)
    throw Error(place(field.key), fmt::format("has {} bytes; it must have at most {}",
                                              json->text.size(), max_length));
  refuse_control_characters(json->text, place(field.key));
  value = json->text;
}

void FieldReader::choice(const Field& field, int& value, Names names) {
  if (const JsonValue* json = take(field))
    value = static_cast<int>(read_name(*json, place(field.key), field.key, strings(names)));
}

void FieldReader::vector(const Field& field, Vec3& value, const Range& range) {
  const JsonValue* json = take(field, range.unit);
  if (!json) return;
  const std::string at = place(field.key);
  read_list(*json, at, 3, 3, "numbers");
  for (int i = 0; i < 3; ++i)
    value[i] = read_number(json->items[i], join_pointer(at, std::to_string(i)), range);
}

void FieldReader::matrix(const Field& field, Mat3& value, const Range& range) {
  const JsonValue* json = take(field, range.unit);
  if (!json) return;
  const std::string at = place(field.key);
  read_list(*json, at, 3, 3, "rows of 3 numbers");
  for (int i = 0; i < 3; ++i) {
    const std::string row = join_pointer(at, std::to_string(i));
    read_list(json->items[i], row, 3, 3, "numbers");
    for (int j = 0; j < 3; ++j)
      value(i, j) =
          read_number(json->items[i].items[j], join_pointer(row, std::to_string(j)), range);
  }
}

void FieldReader::points(const Field& field, std::vector<Eigen::Vector2d>& value, std::size_t min,
                         std::size_t max, const Range& range) {
  const JsonValue* json = take(field, range.unit);
  if (!json) return;
  const std::string at = place(field.key);
  read_list(*json, at, min, max, "points [x, y]");
  value.clear();
  for (std::size_t i = 0; i < json->items.size(); ++i) {
    const std::string point = join_pointer(at, std::to_string(i));
    const JsonValue& xy = read_list(json->items[i], point, 2, 2, "numbers");
    value.emplace_back(read_number(xy.items[0], join_pointer(point, "0"), range),
                       read_number(xy.items[1], join_pointer(point, "1"), range));
  }
}

void FieldReader::reference(const Field& field, std::size_t& value,
                            std::span<const std::string> names) {
  const JsonValue* json = take(field);
  if (!json || names.empty())
    return;  // without names their own list is missing, which is told later
  value = read_name(*json, place(field.key), field.key, {names.begin(), names.end()});
}

void FieldReader::mesh_file(const Field& field, std::string& file, std::string& path) {
  if (!take(field)) return;
  known_.pop_back();
  text(field, file, 1000);
  path = find_mesh_file(file, source_.folders, place(field.key));
}

void FieldReader::object(const Field& field, const std::function<void(FieldVisitor&)>& fields) {
  static const JsonValue empty = JsonValue::object();
  const JsonValue* json = take(field);
  if (!json && field.required) return;
  FieldReader reader(json ? *json : empty, join_pointer(pointer_, field.key), source_, !json);
  fields(reader);
  reader.finish();
}

void FieldReader::sequence(const Field& field, const Sequence& sequence) {
  const JsonValue* json = take(field);
  if (!json) return;
  const std::string at = join_pointer(pointer_, field.key);
  std::size_t count = 0;
  if (sequence.name) {
    if (json->kind != JsonValue::Kind::object)
      wrong_type(place(field.key), *json, "an object with a name for each entry");
    count = json->members.size();
    if (count < sequence.min || count > sequence.max)
      throw Error(place(field.key), fmt::format("has {} entries; it must have {} to {}", count,
                                                sequence.min, sequence.max));
  } else {
    count = read_list(*json, place(field.key), sequence.min, sequence.max, "objects").items.size();
  }
  sequence.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string key = sequence.name ? json->members[i].first : std::to_string(i);
    if (sequence.name) {
      if (key.empty() || key.size() > 64)
        throw Error(place(field.key), fmt::format("the name {} must have 1 to 64 bytes",
                                                  show(JsonValue::of(std::string_view(key)))));
      refuse_control_characters(key, source_.name + "#" + join_pointer(at, key));
      sequence.name(i) = key;
    }
    FieldReader reader(sequence.name ? json->members[i].second : json->items[i],
                       join_pointer(at, key), source_);
    sequence.describe(reader, i);
    reader.finish();
  }
}

void FieldReader::variant(const Field& field, int& value, Names names,
                          const std::function<void(FieldVisitor&, int)>& fields) {
  const JsonValue* json = take({field.key, field.help});
  if (json)
    value = static_cast<int>(read_name(*json, place(field.key), field.key, strings(names)));
  else if (!absent_)
    throw Error(source_.name + "#" + pointer_,
                fmt::format("the key \"{}\" is missing; it must be one of \"{}\"", field.key,
                            fmt::join(names, "\", \"")));
  fields(*this, value);
}

std::string find_mesh_file(const std::string& file,
                           const std::vector<std::filesystem::path>& folders,
                           const std::string& place) {
  namespace fs = std::filesystem;
  const fs::path name(file);
  std::string ending = name.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::string_view known[] = {".obj", ".off", ".ply", ".stl", ".gltf", ".glb"};
  if (std::find(std::begin(known), std::end(known), ending) == std::end(known))
    throw Error(place,
                fmt::format("is \"{}\"; a mesh file must end in {}", file, fmt::join(known, ", ")));
  std::vector<fs::path> tried;
  if (name.is_absolute())
    tried.push_back(name);
  else
    for (const fs::path& folder : folders) tried.push_back(folder / name);
  for (const fs::path& path : tried) {
    std::error_code error;
    if (fs::is_regular_file(path, error)) return path.string();
  }
  std::vector<std::string> shown;
  for (const fs::path& path : tried) shown.push_back(path.string());
  std::string why =
      fmt::format("cannot find the mesh \"{}\"; looked for {}", file, fmt::join(shown, ", "));
  if (file.starts_with("models/"))
    why +=
        "; the example meshes are those of Debian's libcgal-demo, which ./rend unpacks into "
        "build/models: run it once";
  throw Error(place, why);
}

}  // namespace rend

// The JSON Schema agrees with the reader, and docs/scene-format.md with the schema.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/core/error.h"
#include "engine/scene/scene_reader.h"

namespace rend {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const fs::path kRoot = REND_SOURCE_DIR;

std::string file_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  REQUIRE_MESSAGE(stream.good(), file.string());
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

bool has_type(const Json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "number") return value.is_number();
  if (type == "integer")
    return value.is_number() && value.get<double>() == std::floor(value.get<double>());
  FAIL("schema with the unknown type " << type);
  return false;
}

/// Whether `value` satisfies the part of JSON Schema that scene_schema() uses; any other keyword
/// fails the test.
bool satisfies(const Json& value, const Json& schema) {
  if (schema.is_boolean()) return schema;
  for (const auto& [keyword, rule] : schema.items()) {
    bool good = true;
    if (keyword == "type")
      good = has_type(value, rule);
    else if (keyword == "const")
      good = value == rule;
    else if (keyword == "enum")
      good = std::find(rule.begin(), rule.end(), value) != rule.end();
    else if (keyword == "minimum")
      good = !value.is_number() || value >= rule;
    else if (keyword == "maximum")
      good = !value.is_number() || value <= rule;
    else if (keyword == "maxLength")
      good = !value.is_string() || value.get<std::string>().size() <= rule;
    else if (keyword == "minItems")
      good = !value.is_array() || value.size() >= rule;
    else if (keyword == "maxItems")
      good = !value.is_array() || value.size() <= rule;
    else if (keyword == "minProperties")
      good = !value.is_object() || value.size() >= rule;
    else if (keyword == "maxProperties")
      good = !value.is_object() || value.size() <= rule;
    else if (keyword == "items") {
      if (value.is_array())
        for (const Json& item : value) good = good && satisfies(item, rule);
    } else if (keyword == "properties") {
      if (value.is_object())
        for (const auto& [key, member] : value.items())
          good = good && (!rule.contains(key) || satisfies(member, rule[key]));
    } else if (keyword == "required") {
      for (const Json& key : rule) good = good && (!value.is_object() || value.contains(key));
    } else if (keyword == "additionalProperties") {
      if (value.is_object())
        for (const auto& [key, member] : value.items()) {
          if (schema.contains("properties") && schema["properties"].contains(key)) continue;
          good = good && (rule.is_object() ? satisfies(member, rule) : rule.get<bool>());
        }
    } else if (keyword == "oneOf") {
      int count = 0;
      for (const Json& choice : rule) count += satisfies(value, choice);
      good = count == 1;
    } else if (keyword == "dependentSchemas") {
      for (const auto& [key, part] : rule.items())
        good = good && (!value.is_object() || !value.contains(key) || satisfies(value, part));
    } else if (keyword != "$schema" && keyword != "title" && keyword != "description" &&
               keyword != "default") {
      FAIL("schema with the unknown keyword " << keyword);
    }
    if (!good) return false;
  }
  return true;
}

bool reads(const Json& scene) {
  try {
    parse_scene(scene.dump(), "scene", kRoot / "scenes", {kRoot / "build"});
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// The text of a default, a bound or a value for a table cell.
std::string show(const Json& value) { return "`" + value.dump() + "`"; }

std::string type_and_range(const Json& schema) {
  if (schema.contains("const")) return show(schema["const"]);
  if (schema.contains("enum")) {
    std::string text;
    for (const Json& value : schema["enum"]) text += (text.empty() ? "" : ", ") + show(value);
    return text;
  }
  if (schema.contains("oneOf") && !schema.contains("type")) {
    std::string text;
    for (const Json& choice : schema["oneOf"])
      text += (text.empty() ? "" : ", or ") + type_and_range(choice);
    return text;
  }
  const std::string type = schema["type"];
  if (type == "array" && schema["items"]["type"] != "object") {
    const Json& most = schema["maxItems"];
    const std::string count =
        schema["minItems"] == most ? most.dump() : schema["minItems"].dump() + " to " + most.dump();
    return count + " x " + type_and_range(schema["items"]);
  }
  if (type == "array") return "list of objects";
  if (type == "object") return "object";
  if (type == "string") return "text";
  if (type == "boolean") return "`true`, `false`";
  return type + " " + schema["minimum"].dump() + " .. " + schema["maximum"].dump();
}

void append_table(const std::string& title, const Json& schema, std::string& out) {
  if (schema.contains("oneOf")) {
    for (const Json& choice : schema["oneOf"]) append_table(title, choice, out);
    return;
  }
  const Json& properties = schema["properties"];
  std::string kind;
  if (properties.contains("type") && properties["type"].contains("const"))
    kind = " of type " + show(properties["type"]["const"]);
  out += "### " + title + kind +
         "\n\n| key | type and range | unit | default | meaning |\n|---|---|---|---|---|\n";
  for (const auto& [key, property] : properties.items()) {
    std::string help = property["description"], unit;
    if (help.ends_with("]")) {
      const auto at = help.rfind(" [");
      unit = help.substr(at + 2, help.size() - at - 3);
      help.resize(at);
    }
    const Json required = schema.value("required", Json::array());
    const bool must = std::find(required.begin(), required.end(), Json(key)) != required.end();
    out += "| `" + key + "` | " + type_and_range(property) + " | " + unit + " | " +
           (must                           ? "required"
            : property.contains("default") ? show(property["default"])
                                           : "") +
           " | " + help + " |\n";
  }
  out += "\n";
  for (const auto& [key, property] : properties.items()) {
    const std::string inner = title == "scene" ? key : title + "." + key;
    if (property.value("type", "") == "array" && property["items"]["type"] == "object")
      append_table(inner + "[]", property["items"], out);
    else if (property.contains("additionalProperties") &&
             property["additionalProperties"].is_object())
      append_table(inner + ".NAME", property["additionalProperties"], out);
    else if (property.value("type", "") == "object")
      append_table(inner, property, out);
  }
}

}  // namespace

TEST_CASE("scenes/schema.json is what the tables say") {
  const fs::path file = kRoot / "scenes" / "schema.json";
  if (std::getenv("REND_UPDATE")) std::ofstream(file, std::ios::binary) << scene_schema();
  CHECK_MESSAGE(file_text(file) == scene_schema(), "REND_UPDATE=1 test_scene writes it again");
}

TEST_CASE("the tables of docs/scene-format.md are those of the schema") {
  const fs::path file = kRoot / "docs" / "scene-format.md";
  const std::string heading = "## Every key\n\n";
  std::string text = file_text(file);
  const auto at = text.find(heading);
  REQUIRE(at != std::string::npos);
  std::string tables;
  append_table("scene", Json::parse(scene_schema()), tables);
  tables.pop_back();
  if (std::getenv("REND_UPDATE")) {
    text = text.substr(0, at + heading.size()) + tables;
    std::ofstream(file, std::ios::binary) << text;
  }
  CHECK_MESSAGE(text.substr(at + heading.size()) == tables,
                "REND_UPDATE=1 test_scene writes them again");
}

TEST_CASE("the schema accepts the scenes of the repository, as written by hand and as resolved") {
  const Json schema = Json::parse(scene_schema());
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kRoot / "scenes")) {
    if (entry.path().extension() != ".json" || entry.path().filename() == "schema.json") continue;
    CAPTURE(entry.path());
    const Json scene = Json::parse(file_text(entry.path()));
    CHECK(satisfies(scene, schema));
    if (!reads(scene)) continue;
    CHECK(satisfies(Json::parse(write_scene(read_scene(entry.path(), {kRoot / "build"}))), schema));
    ++count;
  }
  CHECK(count >= 2);
}

TEST_CASE("the schema knows which keys exclude each other") {
  const Json schema = Json::parse(scene_schema());
  Json scene = Json::parse(file_text(kRoot / "scenes" / "tear.json"));
  Json& yield = scene["materials"]["clay"]["yield_surface"];
  yield["fracture_energy"] = 1e4;
  CHECK_FALSE(satisfies(scene, schema));
  yield.erase("softening");
  CHECK(satisfies(scene, schema));
  CHECK(reads(scene));
  Json& collider = scene["colliders"][0];
  collider["position"] = {0, 0, 0};
  CHECK_FALSE(satisfies(scene, schema));
  collider.erase("motion");
  CHECK(satisfies(scene, schema));
  CHECK(reads(scene));
}

TEST_CASE("schema and reader agree on single changes of a scene") {
  const Json schema = Json::parse(scene_schema());
  const Json good = Json::parse(file_text(kRoot / "scenes" / "tear.json"));
  REQUIRE(satisfies(good, schema));
  const Json values[] = {0,
                         -1,
                         1,
                         0.5,
                         2.5,
                         1e30,
                         true,
                         "text",
                         "auto",
                         "never",
                         "box",
                         nullptr,
                         Json::array(),
                         Json::object(),
                         {0, 1, 2},
                         {{"type", "sphere"}, {"radius", 1}}};
  const Json flat = good.flatten();
  int refused = 0, accepted = 0;
  const auto compare = [&](const Json& changed, const std::string& what) {
    CAPTURE(what);
    const bool by_schema = satisfies(changed, schema), by_reader = reads(changed);
    // The schema cannot know what must fit together, so it may accept more, never less.
    CHECK((by_schema || !by_reader));
    ++(by_schema ? accepted : refused);
  };
  for (const auto& [pointer, old] : flat.items()) {
    for (const Json& value : values) {
      Json changed = good;
      changed[Json::json_pointer(pointer)] = value;
      compare(changed, pointer + " = " + value.dump());
    }
    Json changed = good;
    const Json::json_pointer at(pointer);
    Json& parent = changed[at.parent_pointer()];
    if (!parent.is_object()) continue;
    parent[at.back() + "_"] = old;
    CHECK_FALSE(satisfies(changed, schema));
    CHECK_FALSE(reads(changed));
    parent.erase(at.back() + "_");
    parent.erase(at.back());
    compare(changed, pointer + " removed");
  }
  CHECK(refused > 500);
  CHECK(accepted > 100);
}

}  // namespace rend

// Text or file to scene and back: parser, overrides, tables and checks in order.
#include "engine/scene/scene_reader.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "engine/core/error.h"
#include "engine/scene/field_reader.h"
#include "engine/scene/field_schema.h"
#include "engine/scene/field_writer.h"
#include "engine/scene/scene_check.h"
#include "engine/scene/scene_fields.h"

namespace rend {

SceneDesc read_scene(const std::filesystem::path& file, const MeshFolders& folders,
                     const Overrides& overrides) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw Error(file.string(), "is no file that can be read");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream || !text) throw Error(file.string(), "cannot be read");
  return parse_scene(text.str(), file.string(), file.parent_path(), folders, overrides);
}

SceneDesc parse_scene(const std::string& text, const std::string& name,
                      const std::filesystem::path& folder, const MeshFolders& folders,
                      const Overrides& overrides) {
  JsonValue json = parse_json(text, name);
  for (const auto& [pointer, value] : overrides) replace_at(json, pointer, value, name);
  SceneSource source{name, {folder}};
  source.folders.insert(source.folders.end(), folders.begin(), folders.end());
  SceneDesc scene;
  FieldReader reader(json, "", source);
  describe_scene(reader, scene);
  reader.finish();
  complete_scene(scene, name);
  return scene;
}

std::string write_scene(const SceneDesc& scene) {
  SceneDesc copy = scene;  // the tables take what they describe by non-const reference
  JsonValue json = JsonValue::object();
  FieldWriter writer(json);
  describe_scene(writer, copy);
  return print_json(json);
}

std::string scene_schema() {
  SceneDesc sample;
  FieldSchema properties;
  describe_scene(properties, sample);
  JsonValue json = JsonValue::object();
  json.add("$schema", JsonValue::of("https://json-schema.org/draft/2020-12/schema"));
  json.add("title", JsonValue::of("Rend scene"));
  for (auto& [key, value] : properties.schema().members) json.add(key, std::move(value));
  return print_json(json);
}

}  // namespace rend

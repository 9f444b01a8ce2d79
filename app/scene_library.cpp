// Scenes by name.
#include "app/scene_library.h"

#include "engine/core/error.h"

#include <algorithm>

namespace rend {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDefaultScene = "tear";

}  // namespace

SceneLibrary::SceneLibrary(fs::path root)
    : folder_(root / "scenes"), mesh_folders_{root / "build", root / "scenes"} {}

std::vector<std::string> SceneLibrary::names() const {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored))
    if (entry.path().extension() == ".json" && entry.path().stem() != "schema") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  const auto first = std::find(names.begin(), names.end(), kDefaultScene);
  if (first != names.end()) std::rotate(names.begin(), first, first + 1);
  for (const auto& [name, file] : added_) names.insert(names.begin(), name);
  return names;
}

SceneDesc SceneLibrary::read(const std::string& name, const Overrides& overrides) const {
  for (const auto& [added, file] : added_)
    if (added == name) return read_scene(file, mesh_folders_, overrides);
  const std::vector<std::string> all = names();
  if (std::find(all.begin(), all.end(), name) == all.end()) {
    std::string known;
    for (const std::string& n : all) known += (known.empty() ? "" : ", ") + n;
    throw Error("scene", "there is no scene \"" + name + "\"; known scenes: " + known);
  }
  return read_scene(folder_ / (name + ".json"), mesh_folders_, overrides);
}

SceneDesc SceneLibrary::read_any(const std::string& file_or_name, const Overrides& overrides) const {
  const bool looks_like_file = file_or_name.find('/') != std::string::npos || file_or_name.ends_with(".json");
  return looks_like_file ? read_scene(file_or_name, mesh_folders_, overrides) : read(file_or_name, overrides);
}

std::string SceneLibrary::add(const fs::path& file) {
  const fs::path whole = fs::absolute(file);
  const std::string name = whole.stem();
  if (whole.parent_path() != folder_) added_.emplace_back(name, whole);
  return name;
}

}  // namespace rend

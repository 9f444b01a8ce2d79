// Scenes by name.
#include "app/scene_library.h"

#include "engine/core/error.h"

#include <algorithm>
#include <mutex>

namespace rend {

namespace fs = std::filesystem;

namespace {

// Offered before all others, the first of them by default.
constexpr const char* kFirstScenes[] = {"tear", "press", "armadillo"};

}  // namespace

struct SceneLibrary::Added {
  std::mutex mutex;
  std::vector<std::pair<std::string, fs::path>> scenes;
};

SceneLibrary::SceneLibrary(fs::path root)
    : folder_(root / "scenes"), mesh_folders_{root / "build", root / "scenes"}, added_(std::make_shared<Added>()) {}

std::vector<std::string> SceneLibrary::names() const {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored))
    if (entry.path().extension() == ".json" && entry.path().stem() != "schema") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  auto place = names.begin();
  for (const char* early : kFirstScenes) {
    const auto found = std::find(place, names.end(), early);
    if (found != names.end()) std::rotate(place++, found, found + 1);
  }
  const std::lock_guard lock(added_->mutex);
  for (const auto& [name, file] : added_->scenes) names.insert(names.begin(), name);
  return names;
}

SceneDesc SceneLibrary::read(const std::string& name, const Overrides& overrides) const {
  {
    std::unique_lock lock(added_->mutex);
    for (const auto& [added, path] : added_->scenes) {
      if (added != name) continue;
      const fs::path file = path;
      lock.unlock();
      return read_scene(file, mesh_folders_, overrides);
    }
  }
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
  if (whole.parent_path() == folder_) return name;
  const std::lock_guard lock(added_->mutex);
  added_->scenes.emplace_back(name, whole);
  return name;
}

void SceneLibrary::remove(const std::string& name) {
  const std::lock_guard lock(added_->mutex);
  std::erase_if(added_->scenes, [&](const auto& scene) { return scene.first == name; });
}

}  // namespace rend

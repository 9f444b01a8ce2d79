// The scenes a server offers: the files of a folder, by name.
#pragma once

#include "engine/scene/scene_reader.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rend {

/// Any thread; copies share what was added.
class SceneLibrary {
 public:
  /// `root` holds scenes/ and, when the set-up could fetch them, build/models/.
  explicit SceneLibrary(std::filesystem::path root);

  /// Names (file names without .json) in alphabetical order, the default scene first.
  std::vector<std::string> names() const;

  /// @throws Error for a name that is not offered or a file that does not read.
  SceneDesc read(const std::string& name, const Overrides& overrides = {}) const;

  /// A file path, or the name of an offered scene.
  SceneDesc read_any(const std::string& file_or_name, const Overrides& overrides = {}) const;

  /// Adds a scene file from elsewhere under its own name and returns that name.
  std::string add(const std::filesystem::path& file);

  /// Takes an added scene back; others stay.
  void remove(const std::string& name);

  const MeshFolders& mesh_folders() const { return mesh_folders_; }

 private:
  struct Added;

  std::filesystem::path folder_;
  MeshFolders mesh_folders_;
  std::shared_ptr<Added> added_;
};

}  // namespace rend

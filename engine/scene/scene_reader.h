// Scene files: JSON text to a validated SceneDesc and back.
#pragma once

#include "engine/scene/scene_desc.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace rend {

/// (JSON pointer, JSON value as text) pairs that replace parts of a scene before validation; a value that is not
/// JSON is taken as a string.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// Where mesh files named by a scene are looked for, in order, after the scene's own folder.
using MeshFolders = std::vector<std::filesystem::path>;

/// Reads and validates a scene file; nothing half-loads.
/// @throws Error with `file#/json/pointer`, the value and what is allowed.
SceneDesc read_scene(const std::filesystem::path& file, const MeshFolders& folders = {},
                     const Overrides& overrides = {});

/// The same from text; `name` stands for the file in messages and `folder` is where relative mesh paths start.
SceneDesc parse_scene(const std::string& text, const std::string& name, const std::filesystem::path& folder,
                      const MeshFolders& folders = {}, const Overrides& overrides = {});

/// The resolved scene as JSON text with every default written out; parse_scene(write_scene(s)) equals s.
std::string write_scene(const SceneDesc& scene);

/// The JSON Schema (2020-12) made from the same tables as the reader; scenes/schema.json is this text.
std::string scene_schema();

}  // namespace rend

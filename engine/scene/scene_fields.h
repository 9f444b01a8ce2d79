// The tables of the scene format: every key with unit, range, default and meaning, visited in the
// order of the file.
#pragma once

#include <span>
#include <string>

#include "engine/scene/field_visitor.h"
#include "engine/scene/scene_desc.h"

namespace rend {

void describe_scene(FieldVisitor& visitor, SceneDesc& scene);
void describe_material(FieldVisitor& visitor, MaterialDesc& material);
void describe_body(FieldVisitor& visitor, BodyDesc& body, std::span<const std::string> materials);
void describe_collider(FieldVisitor& visitor, ColliderDesc& collider);

}  // namespace rend

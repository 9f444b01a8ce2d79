// Bodies of requests: strict JSON objects whose members are all known; bodies of answers.
#pragma once

#include "engine/scene/json_value.h"

#include "engine/core/types.h"
#include "web/server.h"

#include <nlohmann/json_fwd.hpp>

#include <initializer_list>
#include <string>

namespace rend {

/// The JSON object of a body; an empty body is an empty object. @throws Error for anything else
/// than strict JSON (NaN, a key given twice, deep nesting, trailing text), and at /key for a member
/// that is not `known`.
JsonValue parse_body(const std::string& body, std::initializer_list<const char*> known);

/// A good answer.
web::Response reply(const nlohmann::json& body);

/// Each reads the member `key`, which must be there. @throws Error at /key.
Real read_number(const JsonValue& body, const char* key, Real min, Real max);
/// Within +-`limit` on each axis.
Vec3 read_vector(const JsonValue& body, const char* key, Real limit);

}  // namespace rend

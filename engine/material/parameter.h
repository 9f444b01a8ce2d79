// A number that a material law takes: drives the scene reader, the schema, the page's controls and
// the tests.
#pragma once

#include "engine/core/types.h"

namespace rend {

/// Name, unit and allowed range of one parameter. `fallback` is used when a scene leaves it out;
/// NaN means that it must be given.
struct Parameter {
  const char* name;   ///< JSON key, snake_case
  const char* label;  ///< what the page shows
  const char* unit;   ///< SI unit as in "Pa", "-", "deg"
  Real min;           ///< smallest allowed value
  Real max;           ///< largest allowed value
  Real fallback;      ///< value when absent, NaN when required
  const char* help;   ///< one short sentence
};

}  // namespace rend

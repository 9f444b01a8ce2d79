// The list of yield surfaces for readers that know no law, derived from yield_surface_list-inl.h.
#include "engine/material/yield_surface.h"

#include "engine/material/law_constants.h"
#include "engine/material/yield_surface_list-inl.h"

#include <stdexcept>

namespace rend {

namespace {

struct Row {
  std::string_view name;
  std::span<const Parameter> parameters;
};

template <class... Laws>
std::span<const Row> make_rows(LawList<Laws...>) {
  static_assert(((Laws::kParameters.size() <= kMaxYieldParameters) && ...));
  static const Row rows[] = {{Laws::kName, Laws::kParameters}...};
  return rows;
}

std::span<const Row> rows() { return make_rows(YieldSurfaceList{}); }

const Row& row(int type) {
  if (type < 0 || type >= yield_surface_count()) throw std::out_of_range("yield surface type");
  return rows()[static_cast<std::size_t>(type)];
}

}  // namespace

int yield_surface_count() { return YieldSurfaceList::kCount; }

std::string_view yield_surface_name(int type) { return row(type).name; }

std::span<const Parameter> yield_surface_parameters(int type) { return row(type).parameters; }

std::optional<int> find_yield_surface(std::string_view name) {
  for (int type = 0; type < yield_surface_count(); ++type)
    if (row(type).name == name) return type;
  return std::nullopt;
}

std::optional<std::size_t> find_parameter(int type, std::string_view name) {
  const std::span<const Parameter> parameters = yield_surface_parameters(type);
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (name == parameters[i].name) return i;
  return std::nullopt;
}

}  // namespace rend

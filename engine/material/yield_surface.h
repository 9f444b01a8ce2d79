// The closed list of yield surfaces as the scene reader, the page and the solvers see it. The laws
// themselves are one -inl.h file each and are listed in yield_surface_list-inl.h.
#pragma once

#include "engine/material/parameter.h"

#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace rend {

inline constexpr std::size_t kMaxYieldParameters = 6;

/// How the threshold shrinks within a step: the softened threshold holds after the return
/// (implicit, paths do not depend on the number of steps), or the slides' rule that projects first
/// and shrinks afterwards (explicit).
enum class SofteningRule { implicit_rule, explicit_rule };

/// One yield surface with its numbers.
struct YieldSurface {
  int type = 0;  ///< index into the list; 0 is "elastic" (never yields)
  std::array<Real, kMaxYieldParameters>
      value{};  ///< in the order of yield_surface_parameters(type), SI units
  bool operator==(const YieldSurface&) const = default;
};

int yield_surface_count();
std::string_view yield_surface_name(int type);
std::span<const Parameter> yield_surface_parameters(int type);
std::optional<int> find_yield_surface(std::string_view name);

/// Index of the parameter called `name` of a surface; nullopt when it has none.
std::optional<std::size_t> find_parameter(int type, std::string_view name);

}  // namespace rend

// Names of the ways in which a simulation can stop.
#include "engine/mpm/fault.h"

#include <fmt/format.h>

namespace rend {

const char* status_name(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::not_finite:
      return "not_finite";
    case Status::too_fast:
      return "too_fast";
    case Status::left_domain:
      return "left_domain";
    case Status::out_of_memory:
      return "out_of_memory";
  }
  return "unknown";
}

std::string describe(const Fault& fault, Real time, Index step) {
  const std::string when = fmt::format("at {:.6g} s, step {} of the frame", time, step);
  const std::string who =
      fault.particle < 0 ? std::string("A particle") : fmt::format("Particle {}", fault.particle);
  switch (fault.status) {
    case Status::ok:
      break;
    case Status::not_finite:
      return fmt::format("{} is not finite {}; lower cfl or the loads.", who, when);
    case Status::too_fast:
      if (fault.tiny_step)
        return fmt::format(
            "The step has fallen below 1e-7 of a frame {}, with speeds up to {:.3g} m/s; "
            "lower the loads or the stiffness.",
            when, fault.amount);
      return fmt::format(
          "{} crossed more than a cell in one step {}, at {:.3g} m/s; lower cfl or time_step.", who,
          when, fault.amount);
    case Status::left_domain:
      return fmt::format(
          "{} is {:.3g} m from the origin {}, beyond 2^20 cells; add a collider or use larger "
          "cells.",
          who, fault.amount, when);
    case Status::out_of_memory:
      return fmt::format("The grid does not fit in memory {}; use larger cells or fewer particles.",
                         when);
  }
  return "";
}

}  // namespace rend

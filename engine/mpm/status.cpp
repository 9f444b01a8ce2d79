// Names of the ways in which a simulation can stop.
#include "engine/mpm/snapshot.h"

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

}  // namespace rend

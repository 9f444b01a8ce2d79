// The methods that studies compare: transfer, kernel, force form and solver.
#pragma once

#include "engine/scene/scene_desc.h"

#include <string>

namespace rend {

/// A solver description; FLIP takes no PIC share unless told.
inline SolverDesc method(Transfer transfer, Kernel kernel = Kernel::quadratic,
                         ForceForm form = ForceForm::mls,
                         Precision precision = Precision::float64) {
  SolverDesc solver;
  solver.transfer = transfer;
  solver.kernel = kernel;
  solver.force_form = form;
  solver.precision = precision;
  solver.flip_ratio = 1;
  return solver;
}

/// "FLIP 0.95", "XPIC(2)"
std::string transfer_name(const SolverDesc& solver);

/// "APIC quadratic mls double"
std::string method_name(const SolverDesc& solver);

}  // namespace rend

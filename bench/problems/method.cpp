// Names of methods.
#include "bench/problems/method.h"

#include <fmt/format.h>

namespace rend {

std::string transfer_name(const SolverDesc& s) {
  const char* transfers[] = {"PIC", "FLIP", "APIC", "RPIC", "PolyPIC", "XPIC"};
  std::string name = transfers[static_cast<int>(s.transfer)];
  if (s.transfer == Transfer::flip) name += fmt::format(" {:.2f}", s.flip_ratio);
  if (s.transfer == Transfer::polypic) name += fmt::format(" {}", s.polypic_modes);
  if (s.transfer == Transfer::xpic) name += fmt::format("({})", s.xpic_order);
  return name;
}

std::string method_name(const SolverDesc& s) {
  return fmt::format("{} {} {} {}", transfer_name(s),
                     s.kernel == Kernel::cubic ? "cubic" : "quadratic",
                     s.force_form == ForceForm::mls ? "mls" : "gradient",
                     s.precision == Precision::float32 ? "float" : "double");
}

}  // namespace rend

// What a careful developer writes first: APIC with quadratic weights in double, F, an SVD per
// particle and a dense grid. The fixed baseline of `rend bench solver`; it is not part of the
// program's physics.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace rend {

/// One body of von Mises matter in weightlessness; lengths in cells, all arrays by particle.
struct TextbookProblem {
  std::vector<double> x, v;  ///< three each
  std::vector<double> C;     ///< nine each, row by row
  std::vector<double> volume;
  double mu = 0, lambda = 0, density = 1, tau_c = 0, dt = 0;
};

class __attribute__((visibility("default"))) TextbookSolver {
 public:
  explicit TextbookSolver(const TextbookProblem& problem);
  ~TextbookSolver();

  void step();
  /// v (three) and b^e - I (xx yy zz xy yz zx) of a particle.
  void read(std::size_t particle, double* v, double* strain) const;
  double bytes_per_particle() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Flops per second of single-precision fused multiply-adds on one core of this CPU, over `seconds`
/// of CPU time.
__attribute__((visibility("default"))) double fma_flops_per_second(double seconds);

/// Whether the CPU has the instructions that this file was compiled for.
__attribute__((visibility("default"))) bool textbook_runs_here();

}  // namespace rend

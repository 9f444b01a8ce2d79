// Compiled with -O3 -march=native. Eigen lives under another name here, so that none of its
// functions compiled for this CPU can stand in for those of the portable rest of the program.
#define Eigen rend_textbook_eigen
#include "bench/textbook_solver.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <ctime>

namespace rend {

namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

struct TextbookParticle {
  Vector x, v;
  Matrix C, F, tau;
  double volume;
};

struct TextbookNode {
  Vector momentum;
  double mass;
};

struct Stencil {
  Eigen::Vector3i base;
  Vector f;
  Vector w[3];

  explicit Stencil(const Vector& x) {
    for (int a = 0; a < 3; ++a) base[a] = static_cast<int>(std::floor(x[a] - 0.5));
    f = x - base.cast<double>();
    w[0] = 0.5 * (Vector::Constant(1.5) - f).array().square();
    w[1] = 0.75 - (f - Vector::Constant(1)).array().square();
    w[2] = 0.5 * (f - Vector::Constant(0.5)).array().square();
  }
};

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

struct TextbookSolver::State {
  std::vector<TextbookParticle> particles;
  std::vector<TextbookNode> grid;
  Eigen::Vector3i low, size;
  double mu, lambda, density, tau_c, dt;

  TextbookNode& node(int i, int j, int k) {
    const std::size_t n = (static_cast<std::size_t>(i - low[0]) * size[1] + (j - low[1])) * size[2];
    return grid[n + static_cast<std::size_t>(k - low[2])];
  }
};

TextbookSolver::TextbookSolver(const TextbookProblem& problem) : state_(new State) {
  State& s = *state_;
  s.mu = problem.mu;
  s.lambda = problem.lambda;
  s.density = problem.density;
  s.tau_c = problem.tau_c;
  s.dt = problem.dt;
  const std::size_t count = problem.volume.size();
  s.particles.resize(count);
  Vector low = Vector::Constant(1e300), high = -low;
  for (std::size_t p = 0; p < count; ++p) {
    TextbookParticle& q = s.particles[p];
    for (int a = 0; a < 3; ++a) {
      q.x[a] = problem.x[3 * p + a];
      q.v[a] = problem.v[3 * p + a];
    }
    for (int a = 0; a < 9; ++a) q.C(a / 3, a % 3) = problem.C[9 * p + a];
    q.F.setIdentity();
    q.tau.setZero();
    q.volume = problem.volume[p];
    low = low.cwiseMin(q.x);
    high = high.cwiseMax(q.x);
  }
  const Vector room = 0.35 * (high - low) + Vector::Constant(4);  // the body grows and drifts
  s.low = (low - room).array().floor().cast<int>();
  s.size = (high + room).array().ceil().cast<int>().matrix() - s.low;
  s.grid.resize(static_cast<std::size_t>(s.size[0]) * s.size[1] * s.size[2]);
}

TextbookSolver::~TextbookSolver() = default;

void TextbookSolver::step() {
  State& s = *state_;
  const double dt = s.dt;
  for (TextbookNode& n : s.grid) n = {Vector::Zero(), 0};
  for (const TextbookParticle& p : s.particles) {
    const Stencil w(p.x);
    const double m = s.density * p.volume;
    const Matrix A = m * p.C - 4 * dt * p.volume * p.tau;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) {
          const double weight = w.w[i][0] * w.w[j][1] * w.w[k][2];
          TextbookNode& n = s.node(w.base[0] + i, w.base[1] + j, w.base[2] + k);
          n.momentum += weight * (m * p.v + A * (Vector(i, j, k) - w.f));
          n.mass += weight * m;
        }
  }
  for (TextbookNode& n : s.grid)
    if (n.mass > 0) n.momentum /= n.mass;
  for (TextbookParticle& p : s.particles) {
    const Stencil w(p.x);
    p.v.setZero();
    p.C.setZero();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) {
          const double weight = w.w[i][0] * w.w[j][1] * w.w[k][2];
          const Vector& v = s.node(w.base[0] + i, w.base[1] + j, w.base[2] + k).momentum;
          p.v += weight * v;
          p.C += 4 * weight * v * (Vector(i, j, k) - w.f).transpose();
        }
    p.x += dt * p.v;
    Matrix H = dt * p.C;
    const Matrix W = 0.5 * (H - H.transpose());
    H -= 0.5 * W * W;  // see step_exponent()
    const Matrix H2 = H * H;
    p.F = (Matrix::Identity() + H + 0.5 * H2 + (1.0 / 6) * H2 * H) * p.F;
    const Eigen::JacobiSVD<Matrix> svd(p.F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vector eps = svd.singularValues().array().log();
    const double mean = eps.sum() / 3;
    const Vector dev = eps - Vector::Constant(mean);
    const double length = dev.norm();
    if (2 * s.mu * length > s.tau_c) {
      eps = Vector::Constant(mean) + dev * (s.tau_c / (2 * s.mu * length));
      p.F = svd.matrixU() * Vector(eps.array().exp()).asDiagonal() * svd.matrixV().transpose();
    }
    const Vector tau = 2 * s.mu * eps + Vector::Constant(s.lambda * eps.sum());
    p.tau = svd.matrixU() * tau.asDiagonal() * svd.matrixU().transpose();
  }
}

void TextbookSolver::read(std::size_t particle, double* v, double* strain) const {
  const TextbookParticle& p = state_->particles[particle];
  for (int a = 0; a < 3; ++a) v[a] = p.v[a];
  const Matrix b = p.F * p.F.transpose() - Matrix::Identity();
  const double values[6] = {b(0, 0), b(1, 1), b(2, 2), b(0, 1), b(1, 2), b(2, 0)};
  std::copy(values, values + 6, strain);
}

double TextbookSolver::bytes_per_particle() const {
  return static_cast<double>(sizeof(TextbookParticle)) +
         static_cast<double>(state_->grid.size() * sizeof(TextbookNode)) /
             static_cast<double>(state_->particles.size());
}

double fma_flops_per_second(double seconds) {
  typedef float Wide __attribute__((vector_size(64)));
  constexpr int kChains = 12;
  constexpr long kTurns = 1000000;
  Wide sum[kChains];
  for (int c = 0; c < kChains; ++c) sum[c] = Wide{} + static_cast<float>(c);
  const Wide factor = Wide{} + 0.999f, term = Wide{} + 1e-3f;
  const double begin = cpu_seconds();
  double turns = 0, spent = 0;
  do {
    for (long n = 0; n < kTurns; ++n)
      for (int c = 0; c < kChains; ++c) sum[c] = sum[c] * factor + term;
    turns += static_cast<double>(kTurns);
    spent = cpu_seconds() - begin;
  } while (spent < seconds);
  volatile float keep = 0;
  for (const Wide& s : sum) keep = keep + s[0];
  return turns * kChains * 16 * 2 / spent;
}

bool textbook_runs_here() {
#ifdef __AVX512F__
  if (!__builtin_cpu_supports("avx512f")) return false;
#endif
#ifdef __AVX2__
  if (!__builtin_cpu_supports("avx2")) return false;
#endif
#ifdef __FMA__
  if (!__builtin_cpu_supports("fma")) return false;
#endif
  return true;
}

}  // namespace rend

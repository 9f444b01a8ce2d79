// The functions a branch-free law calls, for double and float; lane types bring their own of the
// same names.
#pragma once

#include <cmath>

namespace rend {

inline double max(double a, double b) { return a < b ? b : a; }
inline float max(float a, float b) { return a < b ? b : a; }
inline double min(double a, double b) { return b < a ? b : a; }
inline float min(float a, float b) { return b < a ? b : a; }
/// a where the mask holds, b elsewhere.
inline double select(bool mask, double a, double b) { return mask ? a : b; }
inline float select(bool mask, float a, float b) { return mask ? a : b; }
inline double sqrt(double x) { return std::sqrt(x); }
inline float sqrt(float x) { return std::sqrt(x); }
inline double abs(double x) { return std::fabs(x); }
inline float abs(float x) { return std::fabs(x); }
inline double log1p(double x) { return std::log1p(x); }
inline float log1p(float x) { return std::log1p(x); }
inline double expm1(double x) { return std::expm1(x); }
inline float expm1(float x) { return std::expm1(x); }

}  // namespace rend

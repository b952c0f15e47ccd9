// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Two doubles or four floats in one register, with the operations that the tree needs: compilers leave minima and
// maxima in short loops scalar. The twin for other compilers does the same operations in the same order, so the bits
// agree.
#pragma once

#include <cstring>

namespace morula::lanes {

#if defined(__GNUC__) && !defined(MORULA_SCALAR)

using Double2 = double __attribute__((vector_size(16)));
using Float4 = float __attribute__((vector_size(16)));

#else

template <class Scalar, int count>
struct Lanes {
  Scalar v[count];
  Scalar operator[](int i) const { return v[i]; }
  Lanes operator-() const {
    Lanes r;
    for (int i = 0; i < count; ++i) r.v[i] = -v[i];
    return r;
  }
  friend Lanes operator+(const Lanes& a, const Lanes& b) {
    Lanes r;
    for (int i = 0; i < count; ++i) r.v[i] = a.v[i] + b.v[i];
    return r;
  }
  friend Lanes operator-(const Lanes& a, const Lanes& b) {
    Lanes r;
    for (int i = 0; i < count; ++i) r.v[i] = a.v[i] - b.v[i];
    return r;
  }
  friend Lanes operator*(const Lanes& a, const Lanes& b) {
    Lanes r;
    for (int i = 0; i < count; ++i) r.v[i] = a.v[i] * b.v[i];
    return r;
  }
};
using Double2 = Lanes<double, 2>;
using Float4 = Lanes<float, 4>;

#endif

inline Double2 load(const double* two) {
  Double2 r;
  std::memcpy(&r, two, sizeof r);
  return r;
}
inline Float4 load(const float* four) {
  Float4 r;
  std::memcpy(&r, four, sizeof r);
  return r;
}
inline void store(Double2 a, double* two) {
  std::memcpy(two, &a, sizeof a);
}
inline void store(Float4 a, float* four) {
  std::memcpy(four, &a, sizeof a);
}
inline Double2 both(double x) {
  return Double2{x, x};
}

// The second operand where either is NaN.
#if defined(__GNUC__) && !defined(MORULA_SCALAR)
inline Double2 max(Double2 a, Double2 b) {
  return a > b ? a : b;
}
inline Float4 max(Float4 a, Float4 b) {
  return a > b ? a : b;
}
inline Float4 min(Float4 a, Float4 b) {
  return a < b ? a : b;
}
#else
inline Double2 max(Double2 a, Double2 b) {
  for (int i = 0; i < 2; ++i) a.v[i] = a.v[i] > b.v[i] ? a.v[i] : b.v[i];
  return a;
}
inline Float4 max(Float4 a, Float4 b) {
  for (int i = 0; i < 4; ++i) a.v[i] = a.v[i] > b.v[i] ? a.v[i] : b.v[i];
  return a;
}
inline Float4 min(Float4 a, Float4 b) {
  for (int i = 0; i < 4; ++i) a.v[i] = a.v[i] < b.v[i] ? a.v[i] : b.v[i];
  return a;
}
#endif

}  // namespace morula::lanes

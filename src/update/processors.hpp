// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The kinds of processor that kernels are compiled for: plain loops everywhere, registers of four floats (SSE2, NEON),
// AVX2, AVX-512.
#pragma once

#include <cstddef>

// Wider registers than the compiler may assume are asked for region by region.
#if defined(__GNUC__) && !defined(MORULA_SCALAR)
#define MORULA_VECTORS 1
#if defined(__x86_64__)
#define MORULA_DISPATCH 1
#include <immintrin.h>
#endif
#endif

namespace morula {

/// How many of the kinds compiled, narrowest first, this processor can run.
inline std::size_t runnable_kinds() {
#if defined(MORULA_DISPATCH)
  if (!__builtin_cpu_supports("avx2")) return 2;
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  return avx512 ? 4 : 3;
#elif defined(MORULA_VECTORS)
  return 2;
#else
  return 1;
#endif
}

}  // namespace morula

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The kinds of processor that kernels are compiled for: plain loops everywhere, registers of four floats (SSE2, NEON),
// AVX2, AVX-512.
#pragma once

#include <atomic>
#include <cstddef>

// Wider registers than the compiler may assume are asked for region by region.
#if defined(__GNUC__) && !defined(MORULA_SCALAR)
#define MORULA_VECTORS 1
#if defined(__x86_64__)
#define MORULA_DISPATCH 1
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif
#endif

namespace morula {

namespace processors {

extern std::atomic<std::size_t> chosen_kinds;  // 0: not yet looked for
/// Looks for them, the first time that somebody asks.
std::size_t choose_kinds();

}  // namespace processors

/// How many of the kinds compiled, narrowest first, this processor can run.
inline std::size_t runnable_kinds() {
  const std::size_t kinds = processors::chosen_kinds.load(std::memory_order_relaxed);
  return kinds != 0 ? kinds : processors::choose_kinds();
}

/// Tests only: from now on at most so many, of those that the processor can run. At least 1, plain loops.
void allow_kinds(std::size_t most);

}  // namespace morula

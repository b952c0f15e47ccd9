// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The kinds of processor that kernels are compiled for: plain loops everywhere, registers of four floats (SSE2, NEON),
// AVX2, AVX-512. This file also has the table that holds a set of kernels once per kind.
#pragma once

#include <atomic>
#include <cstddef>
#include <span>

#include "simd/instructions.hpp"

namespace morula::detail {

#if defined(MORULA_DISPATCH)
inline constexpr std::size_t compiled_kinds = 4;
#elif defined(MORULA_VECTORS)
inline constexpr std::size_t compiled_kinds = 2;
#else
inline constexpr std::size_t compiled_kinds = 1;
#endif

namespace processors {

extern std::atomic<std::size_t> chosen_kinds;  // 0: not determined yet
/// Determines them on the first use.
std::size_t choose_kinds();

}  // namespace processors

/// The number of compiled kinds, narrowest first, that this processor can run.
inline std::size_t runnable_kinds() {
  const std::size_t kinds = processors::chosen_kinds.load(std::memory_order_relaxed);
  return kinds != 0 ? kinds : processors::choose_kinds();
}

/// "plain loops", "registers of four", "AVX2", "AVX-512". kind < compiled_kinds.
const char* kind_name(std::size_t kind);

/// For tests only: limits the kinds to at most so many of the ones that the processor can run. most: at least 1, plain
/// loops.
void allow_kinds(std::size_t most);

/// A set of kernels (a pointer to a function, or a struct of such) for each kind. All kinds give the same bits.
template <class Kernels>
struct KernelTable {
  Kernels of_kind[compiled_kinds];

  /// The sets that this processor can run, the narrowest first.
  std::span<const Kernels> runnable() const { return std::span<const Kernels>(of_kind).first(runnable_kinds()); }
  const Kernels& widest() const { return of_kind[runnable_kinds() - 1]; }
};

// The rows of a KernelTable: the kernel of this name in namespace plain and, after every_processor.inl, in the
// namespaces of the other kinds.
#if defined(MORULA_DISPATCH)
#define MORULA_EVERY_KIND(name) \
  { plain::name, baseline::name, avx2::name, avx512::name }
#elif defined(MORULA_VECTORS)
#define MORULA_EVERY_KIND(name) \
  { plain::name, baseline::name }
#else
#define MORULA_EVERY_KIND(name) \
  { plain::name }
#endif

}  // namespace morula::detail

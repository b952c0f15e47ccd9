// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "simd/processors.hpp"

#include <algorithm>

namespace morula::detail {
namespace {

std::size_t supported_kinds() {
#if defined(MORULA_DISPATCH)
  if (!__builtin_cpu_supports("avx2")) return 2;
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  return avx512 ? 4 : 3;
#else
  return compiled_kinds;
#endif
}

}  // namespace

std::atomic<std::size_t> processors::chosen_kinds{0};

std::size_t processors::choose_kinds() {
  const std::size_t kinds = supported_kinds();
  chosen_kinds.store(kinds, std::memory_order_relaxed);
  return kinds;
}

const char* kind_name(std::size_t kind) {
  constexpr const char* names[]{"plain loops", "registers of four", "AVX2", "AVX-512"};
  return names[kind];
}

void allow_kinds(std::size_t most) {
  processors::chosen_kinds.store(std::clamp(most, std::size_t{1}, supported_kinds()), std::memory_order_relaxed);
}

}  // namespace morula::detail

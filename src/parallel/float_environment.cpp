// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "parallel/float_environment.hpp"

namespace morula::detail {

void StandardFloats::set(Bits bits) noexcept {
#if defined(__SSE2__) || defined(_M_X64)
  _mm_setcsr(static_cast<unsigned>(bits));
#elif defined(__aarch64__)
  __asm__ volatile("msr fpcr, %0" : : "r"(bits) : "memory");
#else
  std::fesetround(static_cast<int>(bits));
#endif
}

}  // namespace morula::detail

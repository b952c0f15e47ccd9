// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The floating-point environment that every error bound of the library assumes, whatever the host has set.
//
// A host may round upwards, flush denormal numbers to zero (a single library linked with -ffast-math is enough, and so
// is an audio thread) or trap on overflow. Every allowance of the library is derived for rounding to nearest with
// gradual underflow, and expansions of exact sums hold for nothing else. So whatever computes switches over at its
// public door and back when it leaves. Where nothing was set, and that is the rule, this costs one read of a register.
#pragma once

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#elif !defined(__aarch64__)
#include <cfenv>
#endif

namespace morula::detail {

class StandardFloats {
 public:
  StandardFloats() noexcept : before_(control()), switched_((before_ & relevant) != standard) {
    if (switched_) [[unlikely]]
      set((before_ & ~relevant) | standard);
  }
  ~StandardFloats() {
    if (switched_) [[unlikely]]
      set(before_);
  }
  StandardFloats(const StandardFloats&) = delete;
  StandardFloats& operator=(const StandardFloats&) = delete;

 private:
  using Bits = unsigned long long;
#if defined(__SSE2__) || defined(_M_X64)
  static constexpr Bits relevant = 0xffc0;  // flush to zero, rounding, masked exceptions, denormals are zero
  static constexpr Bits standard = 0x1f80;  // none, to nearest, all masked, no
  static Bits control() noexcept {
    return _mm_getcsr();
  }
#elif defined(__aarch64__)
  static constexpr Bits relevant = 0x07c89f07;  // rounding, flushing, default NaN, traps
  static constexpr Bits standard = 0;
  static Bits control() noexcept {
    Bits bits = 0;
    __asm__ volatile("mrs %0, fpcr" : "=r"(bits));
    return bits;
  }
#else
  static constexpr Bits relevant = ~Bits{0};
  static constexpr Bits standard = FE_TONEAREST;
  static Bits control() noexcept {
    return static_cast<Bits>(std::fegetround());
  }
#endif
  // Out of line: no arithmetic moves across a call that may do anything.
  static void set(Bits bits) noexcept;

  Bits before_;
  bool switched_;
};

}  // namespace morula::detail

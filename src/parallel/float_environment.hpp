// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The floating-point environment that every error bound of the library assumes, for any setting of the host.
//
// A host may round upwards, flush denormal numbers to zero (a single library linked with -ffast-math is enough, and so
// is an audio thread) or trap on overflow. Every allowance of the library is derived for rounding to nearest with
// gradual underflow, and expansions of exact sums hold only for that. So every public function that computes switches
// to this environment at its entry, and back when it returns. If the environment is standard already, which is usual,
// this costs one read of a register.
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
  static constexpr Bits standard = 0x1f80;  // no flush to zero, rounding to nearest, all exceptions masked, denormals
                                            // kept
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
  // It is out of line: compilers move no arithmetic across a call of unknown effects.
  static void set(Bits bits) noexcept;

  Bits before_;
  bool switched_;
};

}  // namespace morula::detail

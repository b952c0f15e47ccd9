// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of vertex_boxes.cpp: four numbers at once, each equal to plain::rounded_down's.

typedef double FourDoubles __attribute__((vector_size(32)));
typedef double LooseFourDoubles __attribute__((vector_size(32), aligned(8), may_alias));
typedef std::int32_t FourWhole __attribute__((vector_size(16)));

// The argument is a reference: without AVX, compilers differ in how they pass four doubles in a register.
inline Four rounded_down(const FourDoubles& x) {
  const Four nearest = __builtin_convertvector(x, Four);
  FourWhole number = reinterpret_cast<FourWhole>(nearest);
  number ^= (number >> 31) & 0x7fffffff;
  // A true comparison yields −1.
  // mutant surface-box-rounding: `= __builtin_convertvector` -> `= 0 * __builtin_convertvector`
  number += __builtin_convertvector(__builtin_convertvector(nearest, FourDoubles) > x, FourWhole);
  number ^= (number >> 31) & 0x7fffffff;
  return reinterpret_cast<Four>(number);
}

#if MORULA_LANES == 16
void make(const Vec3* lower, const Vec3* upper, std::size_t count, MinBox* boxes) {
  // Both bounds are in one register. The processor itself rounds down.
  const __m512i minus_above = _mm512_setr_epi64(0, 0, 0, 0, 1LL << 63, 1LL << 63, 1LL << 63, 1LL << 63);
  // GCC 12 takes an intrinsic without a mask for a read of an uninitialized value.
  constexpr __mmask8 coordinates = 0x77, every = 0xff;
  for (std::size_t i = 0; i < count; ++i) {
    const __m256d low = _mm256_loadu_pd(&lower[i].x), high = _mm256_loadu_pd(&upper[i].x);
    const __m512d both = _mm512_maskz_insertf64x4(every, _mm512_castpd256_pd512(low), high, 1);
    const __m512d bounds = _mm512_maskz_xor_pd(coordinates, both, _mm512_castsi512_pd(minus_above));
    _mm256_storeu_ps(boxes[i].bound,
                     _mm512_maskz_cvt_roundpd_ps(every, bounds, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC));
  }
}
#else
void make(const Vec3* lower, const Vec3* upper, std::size_t count, MinBox* boxes) {
  for (std::size_t i = 0; i < count; ++i) {
    FourDoubles low = *reinterpret_cast<const LooseFourDoubles*>(lower + i);
    FourDoubles high = *reinterpret_cast<const LooseFourDoubles*>(upper + i);
    low[3] = high[3] = 0;
    Four* const bounds = reinterpret_cast<Four*>(boxes + i);
    bounds[0] = rounded_down(low);
    // −0 is 0 here as well: only negative numbers are below it.
    bounds[1] = rounded_down(-high);
    bounds[1][3] = 0;
  }
}
#endif

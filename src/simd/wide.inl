// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Registers of MORULA_LANES floats, and points in them: the parts of the kernels of all loops. The names are those of
// Float4. every_processor.inl, which includes this file first, explains why no function here comes from a header.

constexpr int lanes = MORULA_LANES;
typedef float Wide __attribute__((vector_size(4 * lanes)));
typedef float LooseWide __attribute__((vector_size(4 * lanes), aligned(4), may_alias));
typedef float Four __attribute__((vector_size(16), may_alias));

inline Wide all(float x) {
  return x - Wide{};
}
// The second if the two are equal or not comparable, like Float4.
inline Wide max(Wide a, Wide b) {
  return a > b ? a : b;
}
inline Wide min(Wide a, Wide b) {
  return a < b ? a : b;
}
inline Wide root(Wide a) {
#if MORULA_LANES == 16
  return _mm512_maskz_sqrt_ps(0xffff, a);  // GCC 12 takes the plain one for a read of an uninitialized value
#elif MORULA_LANES == 8
  return _mm256_sqrt_ps(a);
#elif defined(__x86_64__)
  return _mm_sqrt_ps(a);
#elif defined(__aarch64__)
  return vsqrtq_f32(a);
#elif defined(__wasm_simd128__)
  return __builtin_bit_cast(Wide, wasm_f32x4_sqrt(__builtin_bit_cast(v128_t, a)));
#else
  Wide roots;
  for (int k = 0; k < lanes; ++k) roots[k] = __builtin_sqrtf(a[k]);
  return roots;
#endif
}
// Bit i: lane i of a comparison. Each kind of x86 has its own instructions for it.
#ifdef MORULA_DISPATCH
inline unsigned lanes_equal(Wide a, Wide b) {
#if MORULA_LANES == 16
  return _mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ);
#elif MORULA_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_EQ_OQ)));
#else
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmpeq_ps(a, b)));
#endif
}
inline unsigned lanes_at_most(Wide a, Wide b) {
#if MORULA_LANES == 16
  return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
#elif MORULA_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
#else
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(a, b)));
#endif
}
#else
typedef std::int32_t WideMask __attribute__((vector_size(4 * lanes)));  // lanes of all ones or all zeros
inline unsigned lane_bits(WideMask mask) {
#ifdef __aarch64__
  constexpr uint32x4_t bit_of_lane{1, 2, 4, 8};
  return vaddvq_u32(vandq_u32(__builtin_bit_cast(uint32x4_t, mask), bit_of_lane));
#elif defined(__wasm_simd128__)
  return wasm_i32x4_bitmask(__builtin_bit_cast(v128_t, mask));
#else
  unsigned bits = 0;
  for (int k = 0; k < lanes; ++k) bits |= static_cast<unsigned>(mask[k] & 1) << k;
  return bits;
#endif
}
inline unsigned lanes_equal(Wide a, Wide b) {
  return lane_bits(a == b);
}
inline unsigned lanes_at_most(Wide a, Wide b) {
  return lane_bits(a <= b);
}
#endif

// Registers of half as many doubles.
constexpr int doubles = lanes / 2;
typedef double Doubles __attribute__((vector_size(8 * doubles)));
typedef double LooseDoubles __attribute__((vector_size(8 * doubles), aligned(8), may_alias));
typedef std::int64_t Words __attribute__((vector_size(8 * doubles)));
// Bit i: lane i of a is greater.
inline unsigned greater(Doubles a, Doubles b) {
#ifdef MORULA_DISPATCH
#if MORULA_LANES == 16
  return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ);
#elif MORULA_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ)));
#else
  return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(a, b)));
#endif
#else
  const Words mask = a > b;
#ifdef __wasm_simd128__
  return wasm_i64x2_bitmask(__builtin_bit_cast(v128_t, mask));
#else
  unsigned bits = 0;
  for (int k = 0; k < doubles; ++k) bits |= static_cast<unsigned>(mask[k] & 1) << k;
  return bits;
#endif
#endif
}
inline Doubles root(Doubles a) {
#if MORULA_LANES == 16
  return _mm512_maskz_sqrt_pd(0xff, a);  // masked like the root of floats
#elif MORULA_LANES == 8
  return _mm256_sqrt_pd(a);
#elif defined(__x86_64__)
  return _mm_sqrt_pd(a);
#elif defined(__aarch64__)
  return vsqrtq_f64(a);
#elif defined(__wasm_simd128__)
  return __builtin_bit_cast(Doubles, wasm_f64x2_sqrt(__builtin_bit_cast(v128_t, a)));
#else
  Doubles roots;
  for (int k = 0; k < doubles; ++k) roots[k] = __builtin_sqrt(a[k]);
  return roots;
#endif
}

inline Wide load(const float* first) {
  return *reinterpret_cast<const LooseWide*>(first);
}
inline void store(Wide a, float* first) {
  *reinterpret_cast<LooseWide*>(first) = a;
}
inline Four load_point(const LocalPoint& p) {
  return *reinterpret_cast<const Four*>(&p);
}

// Points 0, step, 2 step … of a list, one after the other. Values are loaded from memory into their lanes: otherwise
// compilers generate shuffles, which all wait for the one unit that executes them.
template <int step>
inline Wide points_apart(const LocalPoint* points, const std::uint32_t* index) {
#if MORULA_LANES == 4
  return load_point(points[index[0]]);
#else
  const auto at = [&](int k) { return reinterpret_cast<const float*>(points + index[k * step]); };
#if MORULA_LANES == 8
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(at(0))), _mm_load_ps(at(1)), 1);
#else
  const __m256 ab = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(at(0))), _mm_load_ps(at(1)), 1);
  const __m512 abc = _mm512_insertf32x4(_mm512_castps256_ps512(ab), _mm_load_ps(at(2)), 2);
  return _mm512_insertf32x4(abc, _mm_load_ps(at(3)), 3);
#endif
#endif
}

// Points, one per lane: four registers whose quarters are points, or coordinate by coordinate.
struct Rows {
  Wide a, b, c, d;
};
struct WidePoints {
  Wide x, y, z;
};

// Within each quarter of a register: four points' rows become columns.
#if MORULA_LANES == 4
#define MORULA_PICK(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, (k) + 4, (l) + 4)
#elif MORULA_LANES == 8
#define MORULA_PICK(a, b, i, j, k, l) \
  __builtin_shufflevector(a, b, i, j, (k) + 8, (l) + 8, (i) + 4, (j) + 4, (k) + 12, (l) + 12)
#else
#define MORULA_PICK(a, b, i, j, k, l)                                                                             \
  __builtin_shufflevector(a, b, i, j, (k) + 16, (l) + 16, (i) + 4, (j) + 4, (k) + 20, (l) + 20, (i) + 8, (j) + 8, \
                          (k) + 24, (l) + 24, (i) + 12, (j) + 12, (k) + 28, (l) + 28)
#endif
inline WidePoints columns(const Rows& rows) {
  const Wide a = rows.a, b = rows.b, c = rows.c, d = rows.d;
  // x and y of a and b in turn, then of c and d.
#if MORULA_LANES == 4
  const Wide ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
#elif MORULA_LANES == 8
  const Wide ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Wide cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
#else
  const Wide ab = __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
  const Wide cd = __builtin_shufflevector(c, d, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
#endif
  const Wide z_ab = MORULA_PICK(a, b, 2, 3, 2, 3), z_cd = MORULA_PICK(c, d, 2, 3, 2, 3);
  return {MORULA_PICK(ab, cd, 0, 1, 0, 1), MORULA_PICK(ab, cd, 2, 3, 2, 3), MORULA_PICK(z_ab, z_cd, 0, 2, 0, 2)};
}
// The number after z in each row: the radius of a sphere.
inline Wide last_column(const Rows& rows) {
  return MORULA_PICK(MORULA_PICK(rows.a, rows.b, 2, 3, 2, 3), MORULA_PICK(rows.c, rows.d, 2, 3, 2, 3), 1, 3, 1, 3);
}
#undef MORULA_PICK

// Points by index, every step-th of a list; their columns are in the order of the list.
template <int step = 1>
inline Rows gather(const LocalPoint* points, const std::uint32_t* index) {
  return {points_apart<4 * step>(points, index), points_apart<4 * step>(points, index + step),
          points_apart<4 * step>(points, index + 2 * step), points_apart<4 * step>(points, index + 3 * step)};
}

// Every fourth of consecutive points: the columns of four such rows are in order.
inline Wide points_in_rows(const LocalPoint* points) {
  constexpr std::uint32_t index[]{0, 4, 8, 12};
  return points_apart<1>(points, index);
}
// One number for each point of a row.
#if MORULA_LANES == 4
inline Wide spread(float a) {
  return all(a);
}
inline Wide spread(const float* numbers) {
  return spread(numbers[0]);
}
#elif MORULA_LANES == 8
inline Wide spread(float a, float b) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_set1_ps(a)), _mm_set1_ps(b), 1);
}
inline Wide spread(const float* numbers) {
  return spread(numbers[0], numbers[1]);
}
#else
// Masks of all ones are used: GCC 12 takes an intrinsic without a mask for a read of an uninitialized value.
inline Wide spread(Four four) {
  return _mm512_maskz_permutevar_ps(0xffff, _mm512_maskz_broadcast_f32x4(0xffff, four),
                                    _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0));
}
inline Wide spread(const float* numbers) {
  return spread(_mm_loadu_ps(numbers));
}
#endif

// Consecutive points, in any order.
inline Rows load_run(const LocalPoint* points) {
  const LooseWide* rows = reinterpret_cast<const LooseWide*>(points);
  return {rows[0], rows[1], rows[2], rows[3]};
}

inline float largest_lane(Wide wide) {
#if MORULA_LANES == 16
  wide = max(wide, __builtin_shufflevector(wide, wide, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7));
  wide = max(wide, __builtin_shufflevector(wide, wide, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11));
  wide = max(wide, __builtin_shufflevector(wide, wide, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13));
  wide = max(wide, __builtin_shufflevector(wide, wide, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14));
#elif MORULA_LANES == 8
  wide = max(wide, __builtin_shufflevector(wide, wide, 4, 5, 6, 7, 0, 1, 2, 3));
  wide = max(wide, __builtin_shufflevector(wide, wide, 2, 3, 0, 1, 6, 7, 4, 5));
  wide = max(wide, __builtin_shufflevector(wide, wide, 1, 0, 3, 2, 5, 4, 7, 6));
#else
  // mutant kernel-lane-lost: `wide = max(wide, __builtin_shufflevector(wide, wide, 2, 3, 0, 1))` -> ``
  wide = max(wide, __builtin_shufflevector(wide, wide, 2, 3, 0, 1));
  wide = max(wide, __builtin_shufflevector(wide, wide, 1, 0, 3, 2));
#endif
  return wide[0];
}
// The largest lane of each of four registers.
inline Four largest_lanes(Wide a, Wide b, Wide c, Wide d) {
  const Rows rows{a, b, c, d};
  const WidePoints three = columns(rows);
  const Wide most = max(max(three.x, three.y), max(three.z, last_column(rows)));
#if MORULA_LANES == 16
  const __m256 half = _mm256_max_ps(__builtin_shufflevector(most, most, 0, 1, 2, 3, 4, 5, 6, 7),
                                    __builtin_shufflevector(most, most, 8, 9, 10, 11, 12, 13, 14, 15));
  return _mm_max_ps(_mm256_castps256_ps128(half), _mm256_extractf128_ps(half, 1));
#elif MORULA_LANES == 8
  return _mm_max_ps(_mm256_castps256_ps128(most), _mm256_extractf128_ps(most, 1));
#else
  return most;
#endif
}
inline float least_lane(Wide wide) {
  return -largest_lane(-wide);
}

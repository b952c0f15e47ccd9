// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Registers of MORULA_LANES floats, and points in them: what the kernels of all loops are made of. The words are those
// of Float4. See every_processor.inl, which includes this first, for why nothing here comes from a header.

constexpr int lanes = MORULA_LANES;
typedef float Wide __attribute__((vector_size(4 * lanes)));
typedef float LooseWide __attribute__((vector_size(4 * lanes), aligned(4), may_alias));
typedef float Four __attribute__((vector_size(16), may_alias));

inline Wide all(float x) {
  return x - Wide{};
}
// The second where the two are equal or not comparable, as of Float4.
inline Wide max(Wide a, Wide b) {
  return a > b ? a : b;
}
inline Wide min(Wide a, Wide b) {
  return a < b ? a : b;
}
// Bit i: lane i of a comparison. x86 has instructions for it, each kind its own.
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
typedef std::int32_t WideMask __attribute__((vector_size(4 * lanes)));  // all ones or zeros
inline unsigned lane_bits(WideMask mask) {
#ifdef __aarch64__
  constexpr uint32x4_t bit_of_lane{1, 2, 4, 8};
  return vaddvq_u32(vandq_u32(__builtin_bit_cast(uint32x4_t, mask), bit_of_lane));
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

inline Wide load(const float* first) {
  return *reinterpret_cast<const LooseWide*>(first);
}
inline void store(Wide a, float* first) {
  *reinterpret_cast<LooseWide*>(first) = a;
}
inline Four load_point(const LocalPoint& p) {
  return *reinterpret_cast<const Four*>(&p);
}

// Points i, i + 4, i + 8 … of a list, one after the other.
inline Wide every_fourth(const LocalPoint* points, const std::uint32_t* index) {
#if MORULA_LANES == 4
  return load_point(points[index[0]]);
#else
  typedef float Eight __attribute__((vector_size(32)));
  const Four a = load_point(points[index[0]]), b = load_point(points[index[4]]);
  const Eight ab = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
#if MORULA_LANES == 8
  return ab;
#else
  const Four c = load_point(points[index[8]]), d = load_point(points[index[12]]);
  const Eight cd = __builtin_shufflevector(c, d, 0, 1, 2, 3, 4, 5, 6, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
#endif
}

// As many points as there are lanes: four registers whose quarters are points, or coordinate by coordinate.
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
// What stands behind z in each row: the radius of a sphere.
inline Wide last_column(const Rows& rows) {
  return MORULA_PICK(MORULA_PICK(rows.a, rows.b, 2, 3, 2, 3), MORULA_PICK(rows.c, rows.d, 2, 3, 2, 3), 1, 3, 1, 3);
}
#undef MORULA_PICK

// Points by index; their columns are in the order of the list.
inline Rows gather(const LocalPoint* points, const std::uint32_t* index) {
  return {every_fourth(points, index), every_fourth(points, index + 1), every_fourth(points, index + 2),
          every_fourth(points, index + 3)};
}

// Points that lie one after the other, in any order.
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
  wide = max(wide, __builtin_shufflevector(wide, wide, 2, 3, 0, 1));
  wide = max(wide, __builtin_shufflevector(wide, wide, 1, 0, 3, 2));
#endif
  return wide[0];
}
inline float least_lane(Wide wide) {
  return -largest_lane(-wide);
}

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of near_points.cpp. Groups are eight wide, as in box_groups.inl.

#if MORULA_LANES == 4
constexpr int point_parts = 2;
typedef Wide PointPart;
inline unsigned points_at_most(PointPart a, PointPart b) {
  return lanes_at_most(a, b);
}
inline PointPart load_points(const float* first) {
  return load(first);
}
#else
constexpr int point_parts = 1;
typedef float PointPart __attribute__((vector_size(32)));
typedef float LoosePointPart __attribute__((vector_size(32), aligned(4), may_alias));
inline unsigned points_at_most(PointPart a, PointPart b) {
#if MORULA_LANES == 16
  return _mm256_cmp_ps_mask(a, b, _CMP_LE_OQ);
#else
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
#endif
}
inline PointPart load_points(const float* first) {
  return *reinterpret_cast<const LoosePointPart*>(first);
}
#endif

std::uint64_t near_of(const PointGroup& a, const PointGroup& b, float squared) {
  PointPart there[3][point_parts];
  for (int k = 0; k < 3; ++k)
    for (int p = 0; p < point_parts; ++p) there[k][p] = load_points(b.at[k] + 4 * p);
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i)
    for (int p = 0; p < point_parts; ++p) {
      const PointPart x = there[0][p] - a.at[0][i], y = there[1][p] - a.at[1][i], z = there[2][p] - a.at[2][i];
      const PointPart none{};
      bits |= static_cast<std::uint64_t>(points_at_most(x * x + y * y + z * z, none + squared)) << (8 * i + 4 * p);
    }
  return bits;
}

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of rest_shapes.cpp. Groups are eight wide, as in box_groups.inl.

#if MORULA_LANES == 4
constexpr int shape_parts = 2;
typedef Wide Number;
inline unsigned numbers_at_most(Number a, Number b) {
  return lanes_at_most(a, b);
}
inline Number load_numbers(const float* first) {
  return load(first);
}
#else
constexpr int shape_parts = 1;
typedef float Number __attribute__((vector_size(32)));
typedef float LooseNumber __attribute__((vector_size(32), aligned(4), may_alias));
inline unsigned numbers_at_most(Number a, Number b) {
#if MORULA_LANES == 16
  return _mm256_cmp_ps_mask(a, b, _CMP_LE_OQ);
#else
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
#endif
}
inline Number load_numbers(const float* first) {
  return *reinterpret_cast<const LooseNumber*>(first);
}
#endif

#include "surface/pairs/shape_distance.inl"

inline LanePoint one_point(const PointGroup& group, int i) {
  const Number zero{};
  return {zero + group.at[0][i], zero + group.at[1][i], zero + group.at[2][i]};
}
inline LanePoint part_of(const PointGroup& group, int part) {
  return {load_numbers(group.at[0] + 4 * part), load_numbers(group.at[1] + 4 * part),
          load_numbers(group.at[2] + 4 * part)};
}

// Rows without a bit are skipped.
#define MORULA_FOR_ROWS(squared_distance)                                                             \
  std::uint64_t near = 0;                                                                             \
  const Number zero{}, most = zero + squared;                                                         \
  for (int i = 0; i < 8; ++i) {                                                                       \
    if ((bits >> (8 * i) & 0xff) == 0) continue;                                                      \
    for (int p = 0; p < shape_parts; ++p)                                                             \
      near |= static_cast<std::uint64_t>(numbers_at_most(squared_distance, most)) << (8 * i + 4 * p); \
  }                                                                                                   \
  return near & bits

inline Number squared_of_points(const LanePoint& a, const LanePoint& b) {
  const LanePoint apart = b - a;
  return dot(apart, apart);
}
std::uint64_t near_corners(const PointGroup* a, const PointGroup* b, std::uint64_t bits, float squared) {
  MORULA_FOR_ROWS(squared_of_points(one_point(a[0], i), part_of(b[0], p)));
}
std::uint64_t near_edges(const PointGroup* a, const PointGroup* b, std::uint64_t bits, float squared) {
  MORULA_FOR_ROWS(squared_of_segments(one_point(a[0], i), one_point(a[1], i), part_of(b[0], p), part_of(b[1], p)));
}
std::uint64_t near_vertex_facets(const PointGroup* a, const PointGroup* b, std::uint64_t bits, float squared) {
  MORULA_FOR_ROWS(squared_to_facet(one_point(a[0], i), part_of(b[0], p), part_of(b[1], p), part_of(b[2], p)));
}
#undef MORULA_FOR_ROWS
constexpr NearShapes near_shapes{near_corners, near_edges, near_vertex_facets};

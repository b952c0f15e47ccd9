// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of facet_columns.cpp, on registers of wide.inl.

inline Wide load_column(const FacetColumns& facets, int k, std::size_t i) {
  return load(facets.column[k] + i);
}
[[gnu::always_inline]] inline Wide axis_gap(Wide p, Wide a, Wide b, Wide c) {
  const Wide lower = min(min(a, b), c), upper = max(max(a, b), c);
  return max(max(lower - p, p - upper), Wide{});
}
inline Wide load_gap(const FacetColumns& facets, int axis, std::size_t i, Wide p) {
  return axis_gap(p, load_column(facets, axis, i), load_column(facets, axis + 3, i), load_column(facets, axis + 6, i));
}

float squared_gaps(const FacetColumns& facets, const Vec3f& p, float* squared) {
  const Wide x = all(p.x), y = all(p.y), z = all(p.z);
  Wide least = all(infinity);
  for (std::size_t i = 0; i < facets.count; i += lanes) {
    const Wide dx = load_gap(facets, 0, i, x), dy = load_gap(facets, 1, i, y), dz = load_gap(facets, 2, i, z);
    const Wide gap = dx * dx + dy * dy + dz * dz;
    store(gap, squared + i);
    least = min(gap, least);
  }
  return least_lane(least);
}

unsigned at_most(const float* numbers, float limit) {
  unsigned bits = 0;
  for (int i = 0; i < static_cast<int>(facet_columns_step); i += lanes)
    bits |= lanes_at_most(load(numbers + i), all(limit)) << i;
  return bits;
}

float reach(const FacetColumns& facets, const Vec3f& direction) {
  const Wide x = all(direction.x), y = all(direction.y), z = all(direction.z);
  Wide most = all(-infinity);
  for (std::size_t i = 0; i < facets.count; i += lanes)
    for (int k = 0; k < 9; k += 3)
      most = max(load_column(facets, k, i) * x + load_column(facets, k + 1, i) * y + load_column(facets, k + 2, i) * z,
                 most);
  return largest_lane(most);
}

constexpr FacetKernels kernels{squared_gaps, at_most, reach};

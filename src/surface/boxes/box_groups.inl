// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of box_groups.cpp. Groups are eight wide: two registers of four, or one of eight, even if the processor
// has wider ones.

#if MORULA_LANES == 4
constexpr int group_parts = 2;
typedef Wide Part;
inline unsigned part_at_most(Part a, Part b) {
  return lanes_at_most(a, b);
}
inline Part load_part(const float* first) {
  return load(first);
}
#else
constexpr int group_parts = 1;
typedef float Part __attribute__((vector_size(32)));
typedef float LoosePart __attribute__((vector_size(32), aligned(4), may_alias));
inline unsigned part_at_most(Part a, Part b) {
#if MORULA_LANES == 16
  return _mm256_cmp_ps_mask(a, b, _CMP_LE_OQ);
#else
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
#endif
}
inline Part load_part(const float* first) {
  return *reinterpret_cast<const LoosePart*>(first);
}
#endif

std::uint64_t meet(const BoxGroup& a, const BoxGroup& b, const BoxReach& reach) {
  Part lower[3][group_parts], upper[3][group_parts];
  for (int k = 0; k < 3; ++k)
    for (int p = 0; p < group_parts; ++p) {
      lower[k][p] = load_part(b.bound[k] + 4 * p) + reach.down[k];
      upper[k][p] = load_part(b.bound[k + 3] + 4 * p) + reach.up[k];
    }
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i)
    for (int p = 0; p < group_parts; ++p) {
      const Part none{};
      unsigned met = part_at_most(none + a.bound[0][i], upper[0][p]);
      met &= part_at_most(none + a.bound[1][i], upper[1][p]);
      met &= part_at_most(none + a.bound[2][i], upper[2][p]);
      met &= part_at_most(lower[0][p], none + a.bound[3][i]);
      met &= part_at_most(lower[1][p], none + a.bound[4][i]);
      met &= part_at_most(lower[2][p], none + a.bound[5][i]);
      bits |= static_cast<std::uint64_t>(met) << (8 * i + 4 * p);
    }
  return bits;
}

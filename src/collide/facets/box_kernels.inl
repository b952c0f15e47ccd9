// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of box_kernels.cpp, on registers of wide.inl.

// One bit for each lane where a is at most b.
inline unsigned lanes_at_most(Wide a, Wide b) {
#ifndef MORULA_DISPATCH
  return lane_bits(a <= b);
#elif MORULA_LANES == 16
  return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
#elif MORULA_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
#else
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(a, b)));
#endif
}

inline Wide load_column(const float* column) {
  return *reinterpret_cast<const LooseWide*>(column);
}

std::size_t select(const BoxList& boxes, const FloatBox& box, std::uint32_t* found) {
  Wide bound[6];
  for (int k = 0; k < 6; ++k) bound[k] = all(box.bound[k]);
  std::size_t count = 0;
  for (std::size_t i = 0; i < boxes.count; i += lanes) {
    unsigned bits = lanes_at_most(load_column(boxes.column[0] + i), bound[3]);
    bits &= lanes_at_most(load_column(boxes.column[1] + i), bound[4]);
    bits &= lanes_at_most(load_column(boxes.column[2] + i), bound[5]);
    bits &= lanes_at_most(bound[0], load_column(boxes.column[3] + i));
    bits &= lanes_at_most(bound[1], load_column(boxes.column[4] + i));
    bits &= lanes_at_most(bound[2], load_column(boxes.column[5] + i));
    for (; bits != 0; bits &= bits - 1)
      found[count++] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(__builtin_ctz(bits));
  }
  return count;
}

inline float least_lane(Wide wide) {
  return -largest_lane(-wide);
}

FloatBox box_of_meeting(const BoxList& boxes, const FloatBox& box) {
  Wide bound[6], lower[3], upper[3];
  for (int k = 0; k < 6; ++k) bound[k] = all(box.bound[k]);
  for (int k = 0; k < 3; ++k) lower[k] = all(FloatBox::infinity), upper[k] = all(-FloatBox::infinity);
  for (std::size_t i = 0; i < boxes.count; i += lanes) {
    const Wide x0 = load_column(boxes.column[0] + i), x1 = load_column(boxes.column[3] + i);
    const Wide y0 = load_column(boxes.column[1] + i), y1 = load_column(boxes.column[4] + i);
    const Wide z0 = load_column(boxes.column[2] + i), z1 = load_column(boxes.column[5] + i);
    const auto meets =
        (x0 <= bound[3]) & (y0 <= bound[4]) & (z0 <= bound[5]) & (bound[0] <= x1) & (bound[1] <= y1) & (bound[2] <= z1);
    lower[0] = smaller(meets ? x0 : lower[0], lower[0]), upper[0] = larger(meets ? x1 : upper[0], upper[0]);
    lower[1] = smaller(meets ? y0 : lower[1], lower[1]), upper[1] = larger(meets ? y1 : upper[1], upper[1]);
    lower[2] = smaller(meets ? z0 : lower[2], lower[2]), upper[2] = larger(meets ? z1 : upper[2], upper[2]);
  }
  FloatBox found;
  for (int k = 0; k < 3; ++k) found.bound[k] = least_lane(lower[k]), found.bound[k + 3] = largest_lane(upper[k]);
  return found;
}

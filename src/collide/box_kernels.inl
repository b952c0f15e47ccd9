// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of box_kernels.cpp, on registers of wide.inl.

// One bit for each lane where a is at most b.
inline unsigned lanes_at_most(Wide a, Wide b) {
#if MORULA_LANES == 16
  return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
#elif MORULA_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(a, b)));
#else
  unsigned bits = 0;
  for (int k = 0; k < lanes; ++k) bits |= static_cast<unsigned>(a[k] <= b[k]) << k;
  return bits;
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

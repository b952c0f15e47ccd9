// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of box_kernels.cpp, on registers of wide.inl.

std::size_t select(const BoxList& boxes, const FloatBox& box, std::uint32_t* found) {
  Wide bound[6];
  for (int k = 0; k < 6; ++k) bound[k] = all(box.bound[k]);
  std::size_t count = 0;
  for (std::size_t i = 0; i < boxes.count; i += lanes) {
    unsigned bits = lanes_at_most(load(boxes.column[0] + i), bound[3]);
    bits &= lanes_at_most(load(boxes.column[1] + i), bound[4]);
    bits &= lanes_at_most(load(boxes.column[2] + i), bound[5]);
    bits &= lanes_at_most(bound[0], load(boxes.column[3] + i));
    bits &= lanes_at_most(bound[1], load(boxes.column[4] + i));
    bits &= lanes_at_most(bound[2], load(boxes.column[5] + i));
    for (; bits != 0; bits &= bits - 1)
      found[count++] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(__builtin_ctz(bits));
  }
  return count;
}

FloatBox box_of_meeting(const BoxList& boxes, const FloatBox& box) {
  Wide bound[6], lower[3], upper[3];
  for (int k = 0; k < 6; ++k) bound[k] = all(box.bound[k]);
  for (int k = 0; k < 3; ++k) lower[k] = all(FloatBox::infinity), upper[k] = all(-FloatBox::infinity);
  for (std::size_t i = 0; i < boxes.count; i += lanes) {
    const Wide x0 = load(boxes.column[0] + i), x1 = load(boxes.column[3] + i);
    const Wide y0 = load(boxes.column[1] + i), y1 = load(boxes.column[4] + i);
    const Wide z0 = load(boxes.column[2] + i), z1 = load(boxes.column[5] + i);
    const auto meets =
        (x0 <= bound[3]) & (y0 <= bound[4]) & (z0 <= bound[5]) & (bound[0] <= x1) & (bound[1] <= y1) & (bound[2] <= z1);
    lower[0] = min(meets ? x0 : lower[0], lower[0]), upper[0] = max(meets ? x1 : upper[0], upper[0]);
    lower[1] = min(meets ? y0 : lower[1], lower[1]), upper[1] = max(meets ? y1 : upper[1], upper[1]);
    lower[2] = min(meets ? z0 : lower[2], lower[2]), upper[2] = max(meets ? z1 : upper[2], upper[2]);
  }
  FloatBox found;
  for (int k = 0; k < 3; ++k) found.bound[k] = least_lane(lower[k]), found.bound[k + 3] = largest_lane(upper[k]);
  return found;
}

constexpr BoxKernels kernels{select, box_of_meeting};

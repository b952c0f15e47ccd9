// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Eight pairs of triangles side by side, and the kernel that finds the pairs that clearly meet or are clearly apart:
// nearly all pairs. triangles_meet() decides the others.
#pragma once

#include <bit>
#include <cstddef>
#include <span>

#include "geometry/triangles/triangles_meet.hpp"

namespace morula::detail {

struct alignas(64) TrianglePairs {
  static constexpr std::size_t size = 8;
  double a[3][3][size] = {}, b[3][3][size] = {};  // corner, axis, pair

  void put(std::size_t pair, const Triangle& of_a, const Triangle& of_b) {
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis) {
        a[corner][axis][pair] = of_a[corner][axis];
        b[corner][axis][pair] = of_b[corner][axis];
      }
  }
};

/// Bit k of `apart`: the triangles of pair k have no common point; of `meeting`: they have one. Neither bit: the pair
/// is in doubt.
struct TriangleVerdicts {
  unsigned apart, meeting;
};
/// Decides like triangles_meet(), but in doubles only, with the bounds of exact_predicates.hpp: by their planes and, if
/// each crosses the other's, by the order of the four corners on the common line; for triangles that lie in one plane
/// or nearly so, by lines of edges, projected along the axis along which a has the largest area. All kinds of
/// processors give the same verdicts. Requires the standard floating-point environment.
using LookAtTriangles = TriangleVerdicts (*)(const TrianglePairs& pairs);
/// The kernels that this processor runs, the narrowest first.
std::span<const LookAtTriangles> all_look_at_triangles();
/// The widest kernel.
LookAtTriangles look_at_triangles();

/// Calls found(i), i ascending from 0, for each pair i whose triangles meet. get(i, put) calls put(a, b) with the
/// triangles.
template <class Get, class Found>
void find_meeting(std::size_t count, const Get& get, const Found& found) {
  const LookAtTriangles look = look_at_triangles();
  TrianglePairs pairs;
  for (std::size_t first = 0; first < count; first += TrianglePairs::size) {
    const std::size_t end = std::min(count, first + TrianglePairs::size);
    for (std::size_t i = first; i < end; ++i)
      get(i, [&](const Triangle& a, const Triangle& b) { pairs.put(i - first, a, b); });
    const unsigned used = (1u << (end - first)) - 1;
    const TriangleVerdicts verdicts = look(pairs);
    // mutant triangle-pairs-used: `used` -> `0xff`
    for (unsigned left = used & ~verdicts.apart; left != 0; left &= left - 1) {
      const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(left));
      if ((verdicts.meeting & left & -left) != 0) {
        found(i);
        continue;
      }
      get(i, [&](const Triangle& a, const Triangle& b) {
        if (triangles_meet(a, b)) found(i);
      });
    }
  }
}

}  // namespace morula::detail

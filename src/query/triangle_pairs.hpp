// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Eight pairs of triangles side by side, and the kernel that finds which of them clearly meet or are clearly apart:
// nearly all. The others go to triangles_meet().
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

/// Bit k of `apart`: the triangles of pair k have no common point; of `meeting`: they have. Neither: in doubt.
struct TriangleVerdicts {
  unsigned apart, meeting;
};
/// As triangles_meet() decides, but in doubles alone, with the bounds of exact_predicates.hpp: by their planes, and
/// where each crosses the other's, by the order of the four corners on the line of both; what lies in one plane or
/// nearly so, by lines of edges, seen along the axis along which a looks largest. All kinds of processor find the same.
/// Standard floating-point environment.
using LookAtTriangles = TriangleVerdicts (*)(const TrianglePairs& pairs);
/// Narrowest first; what this processor runs.
std::span<const LookAtTriangles> all_look_at_triangles();
/// The widest.
LookAtTriangles look_at_triangles();

/// Calls found(i) for i from 0 on where the triangles of pair i meet. get(i, put): calls put(a, b) with them.
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

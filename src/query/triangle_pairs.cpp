// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "query/triangle_pairs.hpp"

#include <cstdint>

#include "geometry/exact_predicates.hpp"
#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

/// What the others have to reproduce.
namespace plain {

bool is_on_one_side(const TrianglePlane& plane, const Triangle& t) {
  const int side = plane.certain_side(t[0]).sign;
  return side != 0 && plane.certain_side(t[1]).sign == side && plane.certain_side(t[2]).sign == side;
}

unsigned apart(const TrianglePairs& pairs) {
  unsigned bits = 0;
  for (unsigned k = 0; k < TrianglePairs::size; ++k) {
    const auto triangle = [k](const double(&of)[3][3][TrianglePairs::size]) {
      Triangle t;
      for (std::size_t corner = 0; corner < 3; ++corner)
        t[corner] = {of[corner][0][k], of[corner][1][k], of[corner][2][k]};
      return t;
    };
    const Triangle a = triangle(pairs.a), b = triangle(pairs.b);
    const TrianglePlane plane(a);
    const bool apart = is_on_one_side(plane, b) || is_on_one_side(TrianglePlane(b), a) ||
                       is_beyond_an_edge(a, b, plane.projection()) || is_beyond_an_edge(b, a, plane.projection());
    bits |= (apart ? 1u : 0u) << k;
  }
  return bits;
}

}  // namespace plain

#define MORULA_KERNELS "query/triangle_pairs.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<ApartTriangles> table{MORULA_EVERY_KIND(apart)};

}  // namespace

std::span<const ApartTriangles> all_apart_triangles() {
  return table.runnable();
}

ApartTriangles apart_triangles() {
  return table.widest();
}

}  // namespace morula::detail

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "query/triangle_pairs.hpp"

#include <cstdint>
#include <utility>

#include "geometry/exact_predicates.hpp"
#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

/// The reference: all other kernels have to return the same verdicts.
namespace plain {

struct Lone {
  Vec3 corner, first, second;
  bool is_below;
};
Lone lone_corner(const Triangle& t, const int (&s)[3]) {
  const std::size_t lone = s[1] == s[2] ? 0 : s[2] == s[0] ? 1 : 2;
  return {t[lone], t[(lone + 1) % 3], t[(lone + 2) % 3], s[lone] < 0};
}
int certain_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Triangle t{a, b, c};
  return TrianglePlane(t).certain_side(d).sign;
}

/// 1: they meet. -1: they are apart. 0: in doubt.
int verdict(const Triangle& a, const Triangle& b) {
  const auto sides_of = [](const TrianglePlane& plane, const Triangle& t, int(&sides)[3]) {
    for (std::size_t k = 0; k < 3; ++k) sides[k] = plane.certain_side(t[k]).sign;
    return sides[0] != 0 && sides[0] == sides[1] && sides[1] == sides[2];
  };
  const TrianglePlane plane_a(a), plane_b(b);
  int a_sides[3], b_sides[3];
  if (sides_of(plane_a, b, b_sides) || sides_of(plane_b, a, a_sides)) return -1;
  const auto all_known = [](const int(&s)[3]) { return s[0] != 0 && s[1] != 0 && s[2] != 0; };
  if (all_known(a_sides) && all_known(b_sides)) {
    Lone of_a = lone_corner(a, a_sides), of_b = lone_corner(b, b_sides);
    if (of_a.is_below) std::swap(of_b.first, of_b.second);
    if (of_b.is_below) std::swap(of_a.first, of_a.second);
    const int begin = certain_orient3d(of_a.corner, of_a.first, of_b.corner, of_b.first);
    const int end = certain_orient3d(of_a.corner, of_a.second, of_b.corner, of_b.second);
    if (begin > 0 || end < 0) return -1;
    if (begin < 0 && end > 0) return 1;
  }
  const Projection projection = plane_a.projection();
  return is_beyond_an_edge(a, b, projection) || is_beyond_an_edge(b, a, projection) ? -1 : 0;
}

TriangleVerdicts look(const TrianglePairs& pairs) {
  TriangleVerdicts verdicts{0, 0};
  for (unsigned k = 0; k < TrianglePairs::size; ++k) {
    const auto triangle = [k](const double(&of)[3][3][TrianglePairs::size]) {
      Triangle t;
      for (std::size_t corner = 0; corner < 3; ++corner)
        t[corner] = {of[corner][0][k], of[corner][1][k], of[corner][2][k]};
      return t;
    };
    const int found = verdict(triangle(pairs.a), triangle(pairs.b));
    verdicts.apart |= (found < 0 ? 1u : 0u) << k;
    verdicts.meeting |= (found > 0 ? 1u : 0u) << k;
  }
  return verdicts;
}

}  // namespace plain

#define MORULA_KERNELS "query/triangle_pairs.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<LookAtTriangles> table{MORULA_EVERY_KIND(look)};

}  // namespace

std::span<const LookAtTriangles> all_look_at_triangles() {
  return table.runnable();
}

LookAtTriangles look_at_triangles() {
  return table.widest();
}

}  // namespace morula::detail

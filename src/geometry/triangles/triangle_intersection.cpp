// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Two triangles meet if and only if an edge of one of them meets the other: their common points are a convex polygon, a
// segment or a point, and each of its corners is a corner of a triangle or on an edge. That is true of triangles of any
// shape, and it is the test if corners lie in planes. Otherwise each plane cuts the other triangle in a segment of one
// line, and two more signs decide whether the two overlap [guigue2003].
#include <array>
#include <morula/geometry/triangle_intersection.hpp>

#include "geometry/exact_predicates.hpp"
#include "geometry/triangles/triangles_meet.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

using Side = TrianglePlane::Side;
using Sides = std::array<Side, 3>;

/// The corners of the intersection of two triangles, each once. If only a verdict is requested, none are kept.
class CommonPoints {
 public:
  void add(const Vec3& p) {
    for (std::size_t k = 0; k < count_; ++k)
      if (points_[k] == p) return;
    if (count_ < points_.size()) points_[count_++] = p;
  }
  Segment longest_diagonal() const {
    Segment longest{points_[0], points_[0]};
    double most = 0;
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t j = i + 1; j < count_; ++j)
        if (const double squared = squared_distance(points_[i], points_[j]); squared > most)
          most = squared, longest = {points_[i], points_[j]};
    return longest;
  }

 private:
  // Six corners, and every edge with every edge, each perhaps with another rounding.
  std::array<Vec3, 6 + 2 * 18> points_;
  std::size_t count_ = 0;
};

/// Between p and q, whose distances from a plane, on opposite sides, are proportional to these values. Overflows only
/// if p or q does.
Vec3 between(const Vec3& p, const Vec3& q, double p_value, double q_value) {
  const double sum = std::abs(p_value) + std::abs(q_value);
  double t = std::abs(p_value) / sum;
  if (!(t >= 0 && t <= 1)) t = 0.5;
  return p * (1 - t) + q * t;
}

bool is_before(const Vec3& p, const Vec3& q) {
  return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
}
/// Whether r, on the line of p and q or at one of them, is between them or at an end.
bool is_on_segment(const Vec3& p, const Vec3& q, const Vec3& r) {
  return is_before(p, q) ? !is_before(r, p) && !is_before(q, r) : !is_before(r, q) && !is_before(p, r);
}

/// Segments whose four ends are in one plane that the projection does not flatten, or on one line.
bool coplanar_segments(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, Projection projection,
                       CommonPoints* common) {
  const int r_side = orient2d(p, q, r, projection), s_side = orient2d(p, q, s, projection);
  const int p_side = orient2d(r, s, p, projection), q_side = orient2d(r, s, q, projection);
  if (r_side * s_side < 0 && p_side * q_side < 0) {
    if (!common) return true;
    // Distances from the other's line are proportional to areas, in double, of the projected triangles.
    const auto area = [&](const Vec3& x) {
      const int i = projection.first, j = projection.second;
      return (s[i] - r[i]) * (x[j] - r[j]) - (s[j] - r[j]) * (x[i] - r[i]);
    };
    common->add(between(p, q, area(p), area(q)));
    return true;
  }
  bool meet = false;
  const auto note = [&](int side, const Vec3& from, const Vec3& to, const Vec3& x) {
    if (side != 0 || !is_on_segment(from, to, x)) return;
    meet = true;
    if (common) common->add(x);
  };
  note(r_side, p, q, r);
  note(s_side, p, q, s);
  note(p_side, r, s, p);
  note(q_side, r, s, q);
  return meet;
}

/// A projection under which a, b, c stay a triangle; none when they are on one line.
std::optional<Projection> faithful_projection(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (const Projection projection : projections)
    if (orient2d(a, b, c, projection) != 0) return projection;
  return {};
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, CommonPoints* common) {
  if (orient3d(p, q, r, s) != 0) return false;
  std::optional<Projection> projection = faithful_projection(p, q, r);
  if (!projection) projection = faithful_projection(p, q, s);
  if (!projection) projection = faithful_projection(r, s, p);
  if (!projection) projection = faithful_projection(r, s, q);
  // All four are on one line: every orientation is 0, and the order on the line decides.
  return coplanar_segments(p, q, r, s, projection.value_or(projections[0]), common);
}

/// A triangle with the data that the tests need.
struct Target {
  const Triangle& t;
  std::optional<Projection> projection;  // projection that keeps its area; none: no area
};

bool coplanar_segment_and_triangle(const Vec3& p, const Vec3& q, const Target& target, CommonPoints* common) {
  const Triangle& t = target.t;
  const Projection projection = *target.projection;
  const int turn = orient2d(t[0], t[1], t[2], projection);
  bool meet = false;
  for (const Vec3* const end : {&p, &q}) {
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) inside = inside && orient2d(t[k], t[(k + 1) % 3], *end, projection) * turn >= 0;
    if (!inside) continue;
    if (!common) return true;
    common->add(*end);
    meet = true;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!coplanar_segments(p, q, t[k], t[(k + 1) % 3], projection, common)) continue;
    if (!common) return true;
    meet = true;
  }
  return meet;
}

bool segment_and_triangle(const Vec3& p, const Vec3& q, const Side& p_side, const Side& q_side, const Target& target,
                          CommonPoints* common) {
  const Triangle& t = target.t;
  if (!target.projection) {
    bool meet = false;
    for (std::size_t k = 0; k < 3; ++k) meet = segments_meet(p, q, t[k], t[(k + 1) % 3], common) || meet;
    return meet;
  }
  if (p_side.sign == 0 && q_side.sign == 0) return coplanar_segment_and_triangle(p, q, target, common);
  // mutant end-in-the-plane-misses: `== q_side.sign` -> `* q_side.sign >= 0`
  if (p_side.sign == q_side.sign) return false;
  bool left = false, right = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const int turn = orient3d(p, q, t[k], t[(k + 1) % 3]);
    left = left || turn > 0;
    right = right || turn < 0;
  }
  if (left && right) return false;
  if (common) common->add(p_side.sign == 0 ? p : q_side.sign == 0 ? q : between(p, q, p_side.value, q_side.value));
  return true;
}

/// Tests any triangles. a_sides: sides of a's corners about b's plane.
bool meet_by_edges(const Triangle& a, const Triangle& b, const Sides& a_sides, const Sides& b_sides,
                   CommonPoints* common) {
  const Target target_a{a, faithful_projection(a[0], a[1], a[2])}, target_b{b, faithful_projection(b[0], b[1], b[2])};
  bool meet = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    meet = segment_and_triangle(a[k], a[next], a_sides[k], a_sides[next], target_b, common) || meet;
    if (meet && !common) return true;
    meet = segment_and_triangle(b[k], b[next], b_sides[k], b_sides[next], target_a, common) || meet;
    if (meet && !common) return true;
  }
  return meet;
}

bool on_one_side(const Sides& s) {
  // mutant corners-in-the-plane-are-apart: `!= 0 && s[0].sign =` -> `=`
  return s[0].sign != 0 && s[0].sign == s[1].sign && s[1].sign == s[2].sign;
}
bool all_off_plane(const Sides& s) {
  return s[0].sign != 0 && s[1].sign != 0 && s[2].sign != 0;
}

/// The sides; none if the triangles are apart. If they are in one plane or nearly so, exact signs are expensive, but in
/// the plane they are often clearly apart, such as neighbors in a flat sheet.
std::optional<Sides> sides_unless_apart(const TrianglePlane& plane, const Triangle& of_plane, const Triangle& t) {
  const Sides sides{plane.certain_side(t[0]), plane.certain_side(t[1]), plane.certain_side(t[2])};
  if (on_one_side(sides)) return {};
  if (all_off_plane(sides)) return sides;
  if (is_beyond_an_edge(of_plane, t, plane.projection()) || is_beyond_an_edge(t, of_plane, plane.projection()))
    return {};
  const Sides exact{plane.side(t[0]), plane.side(t[1]), plane.side(t[2])};
  return on_one_side(exact) ? std::nullopt : std::optional(exact);
}

/// A triangle with corners on both sides of the other's plane and none in it: the corner that is alone on its side,
/// which is made the positive one by the order of the other's, and the two edges that cross.
struct Crossed {
  const Vec3 *lone, *first, *second;
  double lone_value, first_value, second_value;
};
Crossed crossed(const Triangle& t, const Sides& s) {
  const std::size_t lone = s[1].sign == s[2].sign ? 0 : s[2].sign == s[0].sign ? 1 : 2;
  const std::size_t first = (lone + 1) % 3, second = (lone + 2) % 3;
  return {&t[lone], &t[first], &t[second], s[lone].value, s[first].value, s[second].value};
}
void swap_edges(Crossed& c) {
  std::swap(c.first, c.second);
  std::swap(c.first_value, c.second_value);
}

/// Two crossed triangles, the lone corner of each on the positive side of the other. Along the line of both planes a's
/// segment runs from its first edge to its second, and b's from its second to its first.
struct CrossedPair {
  Crossed a, b;

  CrossedPair(const Triangle& ta, const Triangle& tb, const Sides& a_sides, const Sides& b_sides)
      : a(crossed(ta, a_sides)), b(crossed(tb, b_sides)) {
    // Another order of b reverses its plane, and hence the sides of a's corners.
    if (lone_sign(a_sides) < 0) swap_edges(b);
    if (lone_sign(b_sides) < 0) swap_edges(a);
  }
  bool overlap() const {
    // mutant crossing-ends-that-touch: `<= 0` -> `< 0`
    return orient3d(*a.lone, *a.first, *b.lone, *b.first) <= 0 && orient3d(*a.lone, *a.second, *b.lone, *b.second) >= 0;
  }
  Segment common() const {
    const bool b_begins_later = orient3d(*a.lone, *a.first, *b.lone, *b.second) <= 0;
    const bool a_ends_first = orient3d(*a.lone, *a.second, *b.lone, *b.first) <= 0;
    return {b_begins_later ? on_second(b) : on_first(a), a_ends_first ? on_second(a) : on_first(b)};
  }

 private:
  static int lone_sign(const Sides& s) { return -(s[0].sign + s[1].sign + s[2].sign); }
  static Vec3 on_first(const Crossed& c) { return between(*c.lone, *c.first, c.lone_value, c.first_value); }
  static Vec3 on_second(const Crossed& c) { return between(*c.lone, *c.second, c.lone_value, c.second_value); }
};

}  // namespace

bool detail::triangles_meet(const Triangle& a, const Triangle& b) {
  const std::optional<Sides> b_sides = sides_unless_apart(TrianglePlane(a), a, b);
  if (!b_sides) return false;
  const std::optional<Sides> a_sides = sides_unless_apart(TrianglePlane(b), b, a);
  if (!a_sides) return false;
  if (all_off_plane(*a_sides) && all_off_plane(*b_sides)) return CrossedPair(a, b, *a_sides, *b_sides).overlap();
  return meet_by_edges(a, b, *a_sides, *b_sides, nullptr);
}

bool intersect(const Triangle& a, const Triangle& b) {
  const StandardFloats standard;
  return triangles_meet(a, b);
}

std::optional<Segment> intersection(const Triangle& a, const Triangle& b) {
  const StandardFloats standard;
  const std::optional<Sides> b_sides = sides_unless_apart(TrianglePlane(a), a, b);
  if (!b_sides) return {};
  const std::optional<Sides> a_sides = sides_unless_apart(TrianglePlane(b), b, a);
  if (!a_sides) return {};
  if (all_off_plane(*a_sides) && all_off_plane(*b_sides)) {
    const CrossedPair pair(a, b, *a_sides, *b_sides);
    if (!pair.overlap()) return {};
    return pair.common();
  }
  CommonPoints common;
  if (!meet_by_edges(a, b, *a_sides, *b_sides, &common)) return {};
  return common.longest_diagonal();
}

}  // namespace morula

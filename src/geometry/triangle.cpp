// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <morula/geometry/triangle.hpp>
#include <morula/geometry/trigonometry.hpp>

namespace morula {
namespace {

// Nearest point of segment [t[i], t[j]].
TrianglePoint closest_on_edge(const Triangle& t, int i, int j, const Vec3& p) {
  const Vec3 edge = t[j] - t[i];
  const double along = dot(p - t[i], edge);
  const double squared = squared_length(edge);
  const double s = along <= 0 || squared == 0 ? 0.0 : along >= squared ? 1.0 : along / squared;
  TrianglePoint result{};
  result.barycentric[i] = 1.0 - s;
  result.barycentric[j] = s;
  result.point = s == 0.0 ? t[i] : s == 1.0 ? t[j] : t[i] + edge * s;
  result.squared_distance = squared_distance(result.point, p);
  return result;
}

TrianglePoint nearer(const TrianglePoint& a, const TrianglePoint& b) {
  return b.squared_distance < a.squared_distance ? b : a;
}

}  // namespace

TrianglePoint closest_point(const Triangle& t, const Vec3& p) {
  // Voronoi regions of the corners and edges, decided by dot products [ericson2005, 5.1.5].
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {t[0], {1, 0, 0}, squared_distance(t[0], p)};

  const Vec3 bp = p - t[1];
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {t[1], {0, 1, 0}, squared_distance(t[1], p)};

  const Vec3 cp = p - t[2];
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {t[2], {0, 0, 1}, squared_distance(t[2], p)};

  // Signed areas of the three triangles with p, times twice the facet's. By cross products: differences of products of
  // dot products lose the small areas of thin facets.
  const Vec3 normal = cross(ab, ac);
  const double vc = dot(normal, cross(ap, bp));
  const double vb = dot(normal, cross(cp, ap));
  const double va = dot(normal, cross(bp, cp));
  const double sum = squared_length(normal);
  // In slivers these signs are rounding: all edges are tried instead, and the inside if it claims to be nearest.
  constexpr double sliver = 1e-6;
  const bool is_sliver = !(sum > sliver * squared_length(ab) * squared_length(ac));
  if (!is_sliver) {
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return closest_on_edge(t, 0, 1, p);
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return closest_on_edge(t, 0, 2, p);
    if (va <= 0 && d4 >= d3 && d5 >= d6) return closest_on_edge(t, 1, 2, p);
  }
  TrianglePoint best{};
  if (!is_sliver || (va > 0 && vb > 0 && vc > 0 && std::isfinite(1 / sum))) {
    const double v = vb / sum, w = vc / sum;
    const Vec3 point = t[0] + ab * v + ac * w;
    best = {point, {1 - v - w, v, w}, squared_distance(point, p)};
    if (!is_sliver) return best;
    best = nearer(closest_on_edge(t, 0, 1, p), best);
  } else {
    best = closest_on_edge(t, 0, 1, p);
  }
  return nearer(nearer(best, closest_on_edge(t, 1, 2, p)), closest_on_edge(t, 2, 0, p));
}

double solid_angle(const Triangle& t, const Vec3& p) {
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = length(a), lb = length(b), lc = length(c);
  const double numerator = dot(a, cross(b, c));
  const double denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  // In the facet's own plane the angle is 0 or a half space, which no sign decides: take 0.
  if (numerator == 0) return 0;
  return 2 * angle_of(numerator, denominator);
}

}  // namespace morula

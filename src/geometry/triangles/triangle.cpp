// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/triangle.hpp>
#include <optional>

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

// The foot of p, if p is above the inside of a thin triangle: first its height above the longest edge, towards the
// third corner, and then its place along the line at that height. Both are off only by rounding of the longest edge,
// for a triangle of any thinness: the component along that edge is subtracted first, and then lengths across it are
// measured.
std::optional<TrianglePoint> closest_within_sliver(const Triangle& t, const Vec3& p) {
  std::size_t i = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (squared_distance(t[k], t[(k + 1) % 3]) > squared_distance(t[i], t[(i + 1) % 3])) i = k;
  const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
  const Vec3 edge = t[j] - t[i], side = t[k] - t[i], way = p - t[i];
  const double squared = squared_length(edge);
  const auto across = [&](const Vec3& v) { return v - edge * (dot(v, edge) / squared); };
  const Vec3 height = across(side);
  // mutant closest-across: `across(way)` -> `way`
  const double up = dot(across(way), height) / squared_length(height);
  if (!(up > 0 && up < 1)) return std::nullopt;
  const Vec3 from = t[i] + side * up, along = t[j] + (t[k] - t[j]) * up - from;
  const double s = dot(p - from, along) / squared_length(along);
  if (!(s > 0 && s < 1)) return std::nullopt;
  TrianglePoint result{};
  result.barycentric[i] = (1 - up) * (1 - s);
  result.barycentric[j] = (1 - up) * s;
  result.barycentric[k] = up;
  result.point = from + along * s;
  result.squared_distance = squared_distance(result.point, p);
  return result;
}

}  // namespace

TrianglePoint closest_point(const Triangle& t, const Vec3& p) {
  // Voronoi regions of the corners and edges, are decided by dot products [ericson2005, 5.1.5].
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {t[0], {1, 0, 0}, squared_distance(t[0], p)};

  const Vec3 bp = p - t[1];
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {t[1], {0, 1, 0}, squared_distance(t[1], p)};

  const Vec3 cp = p - t[2];
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {t[2], {0, 0, 1}, squared_distance(t[2], p)};

  const Vec3 normal = cross(ab, ac);
  const double sum = squared_length(normal), sides = squared_length(ab) * squared_length(ac);
  // Squares of the sine at the first corner. Below the first, signs of areas are only rounding: all edges and the
  // inside are tried. Below the second, a foot is off by more than rounding, and its residual is corrected once more.
  // mutant closest-narrow: `1e-2` -> `0`
  // mutant closest-sliver: `1e-6` -> `0`
  constexpr double sliver = 1e-6, narrow = 1e-2;
  // Below it, the squares of areas lose digits by underflow.
  // mutant closest-underflow: `0x1p-800` -> `0`
  constexpr double least_sides = 0x1p-800;
  const auto on_any_edge = [&] {
    return nearer(nearer(closest_on_edge(t, 0, 1, p), closest_on_edge(t, 1, 2, p)), closest_on_edge(t, 2, 0, p));
  };
  if (!(sum > sliver * sides && sides > least_sides)) {
    const TrianglePoint best = on_any_edge();
    const std::optional<TrianglePoint> inside = closest_within_sliver(t, p);
    return inside ? nearer(best, *inside) : best;
  }
  // Signed areas of the three triangles with p, times twice the facet's. They are computed by cross products:
  // differences of products of dot products lose the small areas of thin facets. Each is the product of an edge and the
  // vector from one of its ends: from the vectors of two distant corners, the areas of needles would also be lost.
  const double vc = dot(normal, cross(ab, ap));
  // mutant closest-far-corners: `ap, ac` -> `cp, ap`
  const double vb = dot(normal, cross(ap, ac));
  const double va = dot(normal, cross(t[2] - t[1], bp));
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return closest_on_edge(t, 0, 1, p);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return closest_on_edge(t, 0, 2, p);
  if (va <= 0 && d4 >= d3 && d5 >= d6) return closest_on_edge(t, 1, 2, p);
  double v = vb / sum, w = vc / sum;
  if (!(sum > narrow * sides)) {
    const Vec3 rest = p - (t[0] + ab * v + ac * w);
    v += dot(normal, cross(rest, ac)) / sum;
    w += dot(normal, cross(ab, rest)) / sum;
  }
  // A foot beyond an edge is there only by rounding: the edges are as near. Shares of a short side may be only
  // rounding, and shares of sides that nearly cancel must not change by themselves.
  // mutant closest-clamped: `if ... return on_any_edge()` -> `v = std::clamp(v, 0.0, 1.0), w = std::clamp(w, 0.0, 1 - v)`
  if (!(v >= 0 && w >= 0 && v + w <= 1)) return on_any_edge();
  const Vec3 point = t[0] + ab * v + ac * w;
  return {point, {std::max(0.0, 1 - v - w), v, w}, squared_distance(point, p)};
}

double solid_angle(const Triangle& t, const Vec3& p) {
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = length(a), lb = length(b), lc = length(c);
  const double numerator = dot(a, cross(b, c));
  const double denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  // In the facet's own plane the angle is 0 or a half space, which no sign decides: the result is 0.
  if (numerator == 0) return 0;
  return 2 * angle_of(numerator, denominator);
}

}  // namespace morula

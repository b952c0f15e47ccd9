// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Squared distances of points of two shapes, in lanes of Number: a float, or a vector of them. The points are near the
// nearest ones, and belong to the shapes whatever the rounding: parameters are clamped, and 0 in place of NaN.

struct LanePoint {
  Number x, y, z;
};
inline LanePoint operator-(const LanePoint& a, const LanePoint& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline LanePoint operator+(const LanePoint& a, const LanePoint& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline LanePoint operator*(const LanePoint& a, const Number& b) {
  return {a.x * b, a.y * b, a.z * b};
}
inline Number dot(const LanePoint& a, const LanePoint& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Number least(const Number& a, const Number& b) {
  return a < b ? a : b;
}
/// To [0, 1].
inline Number clamped(const Number& x) {
  const Number zero{}, one = zero + 1.0f;
  const Number positive = x > zero ? x : zero;
  return positive < one ? positive : one;
}

/// Of a point and a segment: `to` leads from the segment's first end to the point, `along` to its other end.
inline Number squared_to_segment(const LanePoint& to, const LanePoint& along) {
  const LanePoint apart = to - along * clamped(dot(to, along) / dot(along, along));
  return dot(apart, apart);
}

inline Number squared_of_segments(const LanePoint& a0, const LanePoint& a1, const LanePoint& b0, const LanePoint& b1) {
  const LanePoint a = a1 - a0, b = b1 - b0, from = b0 - a0;
  const Number aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), af = dot(a, from), bf = dot(b, from);
  const Number s = clamped((af * bb - bf * ab) / (aa * bb - ab * ab));
  const Number t = clamped((ab * s - bf) / bb);
  // mutant rest-shapes-clamp: `clamped((ab * t + af) / aa)` -> `(ab * t + af) / aa`
  const LanePoint apart = a * clamped((ab * t + af) / aa) - (from + b * t);
  return dot(apart, apart);
}

inline Number squared_to_facet(const LanePoint& p, const LanePoint& a, const LanePoint& b, const LanePoint& c) {
  const LanePoint to = p - a, ab = b - a, ac = c - a;
  const Number of_edges =
      least(least(squared_to_segment(to, ab), squared_to_segment(to, ac)), squared_to_segment(p - b, c - b));
  const Number bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), tb = dot(to, ab), tc = dot(to, ac);
  const Number determinant = bb * cc - bc * bc;
  const Number v = clamped((tb * cc - tc * bc) / determinant), w = clamped((tc * bb - tb * bc) / determinant);
  const Number zero{}, one = zero + 1.0f, sum = v + w, share = one / (sum > one ? sum : one);
  const LanePoint apart = to - ab * (v * share) - ac * (w * share);
  return least(dot(apart, apart), of_edges);
}

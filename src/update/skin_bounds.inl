// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The formula of skin_bounds.hpp for `lanes` characters at once: skin_bounds_frame.cpp.

struct WidePoint {
  Wide x, y, z;
};
inline WidePoint operator+(const WidePoint& a, const WidePoint& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline WidePoint operator-(const WidePoint& a, const WidePoint& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline WidePoint operator*(const WidePoint& a, Wide b) {
  return {a.x * b, a.y * b, a.z * b};
}
inline Wide absolute(Wide a) {
  return max(a, -a);
}
inline Wide squared(const WidePoint& a) {
  return a.x * a.x + a.y * a.y + a.z * a.z;
}
inline Wide inner(const WidePoint& a, const WidePoint& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline WidePoint least(const WidePoint& a, const WidePoint& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
inline WidePoint largest(const WidePoint& a, const WidePoint& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
inline WidePoint absolute(const WidePoint& a) {
  return {absolute(a.x), absolute(a.y), absolute(a.z)};
}

// A linear map by columns.
struct WideMap {
  WidePoint a, b, c;
};
inline WideMap operator-(const WideMap& m, const WideMap& n) {
  return {m.a - n.a, m.b - n.b, m.c - n.c};
}
inline WidePoint row_lengths(const WideMap& m) {
  return {root(m.a.x * m.a.x + m.b.x * m.b.x + m.c.x * m.c.x), root(m.a.y * m.a.y + m.b.y * m.b.y + m.c.y * m.c.y),
          root(m.a.z * m.a.z + m.b.z * m.b.z + m.c.z * m.c.z)};
}
inline WidePoint row_sums(const WideMap& m) {
  return absolute(m.a) + absolute(m.b) + absolute(m.c);
}
inline Wide stretch_of(const WideMap& m) {
  const Wide ab = absolute(inner(m.a, m.b)), bc = absolute(inner(m.b, m.c)), ca = absolute(inner(m.c, m.a));
  return root(max(max(squared(m.a) + ab + ca, ab + squared(m.b) + bc), ca + bc + squared(m.c)));
}

// One bone of the characters: twelve numbers of its transform, then its lengths of rows, and its stretch.
struct WideBone {
  WideMap map;
  WidePoint shift;
  WidePoint row_lengths;
  Wide stretch;

  WidePoint at(float x, float y, float z) const { return map.a * all(x) + map.b * all(y) + map.c * all(z) + shift; }
};
inline WidePoint load_point(const float* first) {
  return {load(first), load(first + lanes), load(first + 2 * lanes)};
}
inline void store_point(const WidePoint& p, float* first) {
  store(p.x, first), store(p.y, first + lanes), store(p.z, first + 2 * lanes);
}
inline WideMap load_map(const float* bone) {
  return {load_point(bone), load_point(bone + 3 * lanes), load_point(bone + 6 * lanes)};
}
inline WideBone load_bone(const float* bones, std::uint32_t b) {
  const float* bone = bones + b * (skin_bone_words * lanes);
  return {load_map(bone), load_point(bone + 9 * lanes), load_point(bone + 12 * lanes), load(bone + 15 * lanes)};
}

// Computes the last four numbers of each bone, and the size of the transforms.
void prepare_bones(float* bones, std::uint32_t bone_count, float reach, float* size) {
  Wide most = all(reach);
  for (std::uint32_t b = 0; b < bone_count; ++b) {
    float* bone = bones + b * (skin_bone_words * lanes);
    const WideMap map = load_map(bone);
    store_point(row_lengths(map), bone + 12 * lanes);
    store(stretch_of(map), bone + 15 * lanes);
    const WidePoint sums = row_sums(map), shift = absolute(load_point(bone + 9 * lanes));
    most = max(most, max(max(sums.x, sums.y), sums.z) * all(reach) + max(max(shift.x, shift.y), shift.z));
  }
  store(most, size);
}

// The motion of a cluster's middle: its center, the map of places about it, and what they may stray.
struct WideBlend {
  WidePoint center;
  WideMap map;
  Wide stray;
  WidePoint axis_strays;
  WidePoint low, high;
};

inline WideBlend blend_rows(const float* bones, const SkinBoundsCluster& k, const SkinBoundsRow* rows) {
  const WideBone main = load_bone(bones, rows->bone);
  const WidePoint start = main.at(k.center.x, k.center.y, k.center.z);
  const WidePoint ball = main.at(rows->center.x, rows->center.y, rows->center.z);
  const WidePoint reach = main.row_lengths * all(rows->radius);
  WideBlend blend{start, main.map, all(0), {all(0), all(0), all(0)}, ball - reach, ball + reach};
  for (const SkinBoundsRow* row = rows + 1; row != rows + k.row_count; ++row) {
    const WideBone bone = load_bone(bones, row->bone);
    const WidePoint move = bone.at(k.center.x, k.center.y, k.center.z) - start;
    const WideMap turn = bone.map - main.map;
    const Wide weight = all(row->weight), stray = all(row->weight_stray);
    blend.center = blend.center + move * weight;
    blend.map = {blend.map.a + turn.a * weight, blend.map.b + turn.b * weight, blend.map.c + turn.c * weight};
    const Wide moment = root(squared(turn.a) + squared(turn.b) + squared(turn.c)) * all(row->moment_stray);
    blend.stray = blend.stray + (root(squared(move)) * stray + moment);
    blend.axis_strays = blend.axis_strays + (absolute(move) * stray + WidePoint{moment, moment, moment});
    const WidePoint q = bone.at(row->center.x, row->center.y, row->center.z);
    const WidePoint extent = bone.row_lengths * all(row->radius);
    blend.low = least(blend.low, q - extent), blend.high = largest(blend.high, q + extent);
  }
  return blend;
}

inline Wide hull_radius(const float* bones, const SkinBoundsCluster& k, const SkinBoundsRow* rows,
                        const WidePoint& center) {
  Wide farthest = all(0);
  for (const SkinBoundsRow* row = rows; row != rows + k.row_count; ++row) {
    const WideBone bone = load_bone(bones, row->bone);
    const Wide distance = root(squared(bone.at(row->center.x, row->center.y, row->center.z) - center));
    farthest = max(farthest, distance + bone.stretch * all(row->radius));
  }
  return farthest * all(1 + 2 * k.overhang);
}

// Writes center, radius, lower and upper of a cluster.
void bound_cluster(const float* bones, const float* size, const SkinBoundsCluster& k, const SkinBoundsRow* rows,
                   float* bounds) {
  const WideBlend blend = blend_rows(bones, k, rows);
  const Wide growth = all(k.growth), pad = load(size) * all(k.rounding);
  const Wide radius =
      min(stretch_of(blend.map) * all(k.radius) + blend.stray, hull_radius(bones, k, rows, blend.center));
  store_point(blend.center, bounds);
  store(radius * growth + pad, bounds + 3 * lanes);
  const WidePoint extents = absolute(blend.map.a) * all(k.half_extent.x) +
                            absolute(blend.map.b) * all(k.half_extent.y) + absolute(blend.map.c) * all(k.half_extent.z);
  const WidePoint half = (least(extents, row_lengths(blend.map) * all(k.radius)) + blend.axis_strays) * growth;
  const WidePoint over = (blend.high - blend.low) * all(k.overhang), pads{pad, pad, pad};
  store_point(largest(blend.center - half, blend.low - over) - pads, bounds + 4 * lanes);
  store_point(least(blend.center + half, blend.high + over) + pads, bounds + 7 * lanes);
}

constexpr SkinKernels skin_kernels{lanes, prepare_bones, bound_cluster};

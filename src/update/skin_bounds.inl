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

  WidePoint at(const WidePoint& p) const { return map.a * p.x + map.b * p.y + map.c * p.z + shift; }
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

inline WidePoint everywhere(const Vec3f& p) {
  return {all(p.x), all(p.y), all(p.z)};
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

// The largest sum of |entries| of a row of the bones' linear parts, and at least 1.
void largest_row_sums(const float* bones, std::uint32_t bone_count, float* result) {
  Wide most = all(1);
  for (std::uint32_t b = 0; b < bone_count; ++b) {
    const WidePoint sums = row_sums(load_map(bones + b * (skin_bone_words * lanes)));
    most = max(most, max(max(sums.x, sums.y), sums.z));
  }
  store(most, result);
}

// A cluster's rest data as stored.
struct StoredRest {
  const SkinBoundsCluster& k;

  WidePoint center() const { return everywhere(k.center); }
  Wide radius() const { return all(k.radius); }
  WidePoint half_extent() const { return everywhere(k.half_extent); }
  WidePoint center(const SkinBoundsRow& row) const { return everywhere(row.center); }
  Wide radius(const SkinBoundsRow& row) const { return all(row.radius); }
  Wide moment_stray(const SkinBoundsRow& row) const { return all(row.moment_stray); }
};

// A cluster's rest data as moved by morph targets.
struct MorphedRest {
  StoredRest stored;
  WidePoint shift, spreads;
  Wide spread, travel;

  WidePoint center() const { return stored.center() + shift; }
  Wide radius() const { return stored.radius() + spread; }
  WidePoint half_extent() const { return stored.half_extent() + spreads; }
  WidePoint center(const SkinBoundsRow& row) const { return stored.center(row) + shift; }
  // mutant skin-bounds-target-ball: `stored.radius(row) + spread` -> `stored.radius(row)`
  Wide radius(const SkinBoundsRow& row) const { return stored.radius(row) + spread; }
  // mutant skin-bounds-target-moment: `+ all(row.weight_stray) * spread` -> ``
  Wide moment_stray(const SkinBoundsRow& row) const {
    return stored.moment_stray(row) + all(row.weight_stray) * spread;
  }
};

inline MorphedRest morphed_rest(const SkinBoundsCluster& k, const SkinTargets& targets, const float* morphs) {
  const WidePoint zero{all(0), all(0), all(0)};
  MorphedRest rest{{k}, zero, zero, all(0), all(0)};
  for (const SkinBoundsTarget* target = targets.begin; target != targets.end; ++target) {
    const SkinBoundsTarget& t = *target;
    const Wide number = load(morphs + t.target * lanes), size = absolute(number);
    rest.shift = rest.shift + everywhere(t.shift) * number;
    // mutant skin-bounds-target-sign: `everywhere(t.half_extent) * size` -> `everywhere(t.half_extent) * number`
    rest.spreads = rest.spreads + everywhere(t.half_extent) * size;
    rest.spread = rest.spread + all(t.radius) * size;
    const Vec3f& s = t.shift;
    const float x = s.x < 0 ? -s.x : s.x, y = s.y < 0 ? -s.y : s.y, z = s.z < 0 ? -s.z : s.z;
    const float farthest = x > y ? (x > z ? x : z) : (y > z ? y : z);
    rest.travel = rest.travel + all(farthest + t.radius) * size;
  }
  return rest;
}

// The motion of a cluster's middle: its center, the map of places about it, and what they may stray.
struct WideBlend {
  WidePoint center;
  WideMap map;
  Wide stray;
  WidePoint axis_strays;
  WidePoint low, high;
};

template <class Rest>
inline WideBlend blend_rows(const float* bones, const Rest& rest, const SkinRows& rows) {
  const WideBone main = load_bone(bones, rows.begin->bone);
  const WidePoint middle = rest.center(), start = main.at(middle);
  const WidePoint ball = main.at(rest.center(*rows.begin));
  const WidePoint reach = main.row_lengths * rest.radius(*rows.begin);
  WideBlend blend{start, main.map, all(0), {all(0), all(0), all(0)}, ball - reach, ball + reach};
  for (const SkinBoundsRow* place = rows.begin + 1; place != rows.end; ++place) {
    const SkinBoundsRow& row = *place;
    const WideBone bone = load_bone(bones, row.bone);
    const WidePoint move = bone.at(middle) - start;
    const WideMap turn = bone.map - main.map;
    const Wide weight = all(row.weight), stray = all(row.weight_stray);
    blend.center = blend.center + move * weight;
    blend.map = {blend.map.a + turn.a * weight, blend.map.b + turn.b * weight, blend.map.c + turn.c * weight};
    const Wide moment = root(squared(turn.a) + squared(turn.b) + squared(turn.c)) * rest.moment_stray(row);
    // mutant skin-bounds-strays: `blend.stray + (` -> `(`
    blend.stray = blend.stray + (root(squared(move)) * stray + moment);
    // mutant skin-bounds-axis-strays: `blend.axis_strays + (` -> `(`
    blend.axis_strays = blend.axis_strays + (absolute(move) * stray + WidePoint{moment, moment, moment});
    const WidePoint q = bone.at(rest.center(row));
    const WidePoint extent = bone.row_lengths * rest.radius(row);
    blend.low = least(blend.low, q - extent), blend.high = largest(blend.high, q + extent);
  }
  return blend;
}

template <class Rest>
inline Wide hull_radius(const float* bones, const SkinBoundsCluster& k, const Rest& rest, const SkinRows& rows,
                        const WidePoint& center) {
  Wide farthest = all(0);
  for (const SkinBoundsRow* place = rows.begin; place != rows.end; ++place) {
    const SkinBoundsRow& row = *place;
    const WideBone bone = load_bone(bones, row.bone);
    const Wide distance = root(squared(bone.at(rest.center(row)) - center));
    farthest = max(farthest, distance + bone.stretch * rest.radius(row));
  }
  // mutant skin-bounds-sphere-overhang: `all(1 + 2 * k.overhang)` -> `all(1)`
  return farthest * all(1 + 2 * k.overhang);
}

// Writes center, radius, lower and upper of a cluster.
template <class Rest>
inline void write_bounds(const float* bones, const Wide& size, const SkinBoundsCluster& k, const Rest& rest,
                         const SkinRows& rows, float* bounds) {
  const WideBlend blend = blend_rows(bones, rest, rows);
  const Wide growth = all(k.growth), pad = size * all(k.rounding);
  const Wide radius =
      min(stretch_of(blend.map) * rest.radius() + blend.stray, hull_radius(bones, k, rest, rows, blend.center));
  store_point(blend.center, bounds);
  store(radius * growth + pad, bounds + 3 * lanes);
  const WidePoint half_extent = rest.half_extent();
  const WidePoint extents = absolute(blend.map.a) * half_extent.x + absolute(blend.map.b) * half_extent.y +
                            absolute(blend.map.c) * half_extent.z;
  const WidePoint half = (least(extents, row_lengths(blend.map) * rest.radius()) + blend.axis_strays) * growth;
  // mutant skin-bounds-box-overhang: `all(k.overhang)` -> `all(0)`
  const WidePoint over = (blend.high - blend.low) * all(k.overhang), pads{pad, pad, pad};
  store_point(largest(blend.center - half, blend.low - over) - pads, bounds + 4 * lanes);
  store_point(least(blend.center + half, blend.high + over) + pads, bounds + 7 * lanes);
}

void bound_cluster(const SkinFrame& frame, const SkinBoundsCluster& k, const SkinRows& rows, float* bounds) {
  write_bounds(frame.bones, load(frame.size), k, StoredRest{k}, rows, bounds);
}

void bound_morphed_cluster(const SkinFrame& frame, const SkinBoundsCluster& k, const SkinRows& rows,
                           const SkinTargets& targets, float* bounds) {
  const MorphedRest rest = morphed_rest(k, targets, frame.morphs);
  // mutant skin-bounds-target-travel: `+ rest.travel * load(frame.row_sum)` -> ``
  const Wide size = load(frame.size) + rest.travel * load(frame.row_sum);
  write_bounds(frame.bones, size, k, rest, rows, bounds);
}

constexpr SkinKernels skin_kernels{lanes, prepare_bones, largest_row_sums, bound_cluster, bound_morphed_cluster};

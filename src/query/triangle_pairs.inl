// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of triangle_pairs.cpp: TrianglePlane::certain_side, TrianglePlane::projection, certain_orient2d and
// is_beyond_an_edge, operation by operation, in registers of doubles.

constexpr unsigned every = (1u << doubles) - 1;

inline Doubles size_of(Doubles a) {
  return __builtin_bit_cast(Doubles, __builtin_bit_cast(Words, a) & (Words{} + 0x7fffffffffffffff));
}

struct Points {
  Doubles x, y, z;
};
inline Points operator-(const Points& p, const Points& q) {
  return {p.x - q.x, p.y - q.y, p.z - q.z};
}
inline Doubles dot(const Points& p, const Points& q) {
  return p.x * q.x + p.y * q.y + p.z * q.z;
}
struct Triangles {
  Points corner[3];
};
inline Triangles load_triangles(const double (&of)[3][3][TrianglePairs::size], int first) {
  Triangles t;
  for (int k = 0; k < 3; ++k)
    t.corner[k] = {*reinterpret_cast<const Doubles*>(of[k][0] + first),
                   *reinterpret_cast<const Doubles*>(of[k][1] + first),
                   *reinterpret_cast<const Doubles*>(of[k][2] + first)};
  return t;
}

struct Planes {
  Points base, normal, permanent;
};
inline Planes planes_of(const Triangles& t) {
  const Points u = t.corner[1] - t.corner[0], v = t.corner[2] - t.corner[0];
  const Doubles yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z, xy = u.x * v.y, yx = u.y * v.x;
  return {t.corner[0],
          {yz - zy, zx - xz, xy - yx},
          {size_of(yz) + size_of(zy), size_of(zx) + size_of(xz), size_of(xy) + size_of(yx)}};
}
struct Sides {
  Doubles value[3];
  unsigned above[3], below[3];

  unsigned all_above() const { return above[0] & above[1] & above[2]; }
  unsigned all_below() const { return below[0] & below[1] & below[2]; }
  unsigned all_known() const { return (above[0] | below[0]) & (above[1] | below[1]) & (above[2] | below[2]); }
};
inline void find_side(const Planes& planes, const Points& corner, Doubles& value, unsigned& above, unsigned& below) {
  const Points w = corner - planes.base, size{size_of(w.x), size_of(w.y), size_of(w.z)};
  value = dot(planes.normal, w);
  // mutant triangle-pairs-error: `= TrianglePlane::relative_error * dot(planes.permanent, size) +` -> `=`
  const Doubles error = TrianglePlane::relative_error * dot(planes.permanent, size) +
                        TrianglePlane::underflow * (1 + size.x + size.y + size.z);
  above = greater(value, error);
  below = greater(-error, value);
}
inline Sides sides_of(const Planes& planes, const Triangles& t) {
  Sides sides;
  for (int k = 0; k < 3; ++k) find_side(planes, t.corner[k], sides.value[k], sides.above[k], sides.below[k]);
  return sides;
}

inline Points choose(Words mask, const Points& p, const Points& q) {
  return {mask ? p.x : q.x, mask ? p.y : q.y, mask ? p.z : q.z};
}
inline Words have_one_sign(Doubles a, Doubles b) {
  return (__builtin_bit_cast(Words, a) ^ __builtin_bit_cast(Words, b)) >= 0;
}
// The corner that is alone on its side, and the two that follow.
struct Lone {
  Points corner, first, second;
  Words is_below;
};
inline Lone lone_corners(const Triangles& t, const Sides& s) {
  const Words is_first = have_one_sign(s.value[1], s.value[2]), is_second = have_one_sign(s.value[2], s.value[0]);
  const auto pick = [&](const Points& p, const Points& q, const Points& r) {
    return choose(is_first, p, choose(is_second, q, r));
  };
  const Doubles value = is_first ? s.value[0] : is_second ? s.value[1] : s.value[2];
  return {pick(t.corner[0], t.corner[1], t.corner[2]), pick(t.corner[1], t.corner[2], t.corner[0]),
          pick(t.corner[2], t.corner[0], t.corner[1]), value < 0};
}

// The two coordinates of each corner that remain when the axis of the pair is dropped.
struct Flat {
  Doubles first[3], second[3];
};
struct Turns {
  unsigned left, right;
};
inline Turns turns(const Flat& t, int i, int j, const Flat& s, int k) {
  const Doubles left = (t.first[j] - t.first[i]) * (s.second[k] - t.second[i]);
  const Doubles right = (t.second[j] - t.second[i]) * (s.first[k] - t.first[i]);
  // mutant triangle-pairs-flat-error: `orient2d_relative_error ... ) + size_of(right))` -> `Doubles{}`
  const Doubles value = left - right,
                error = orient2d_relative_error * (size_of(left) + size_of(right)) + orient2d_underflow;
  return {greater(value, error), greater(-error, value)};
}
inline unsigned are_beyond_an_edge(const Flat& of, const Flat& t) {
  const Turns turn = turns(of, 0, 1, of, 2);
  unsigned beyond = 0;
  for (int k = 0; k < 3; ++k) {
    // mutant triangle-pairs-edge: `turn.right` -> `every`
    unsigned left = turn.right, right = turn.left;
    for (int corner = 0; corner < 3; ++corner) {
      const Turns of_corner = turns(of, k, (k + 1) % 3, t, corner);
      left &= of_corner.left;
      right &= of_corner.right;
    }
    beyond |= left | right;
  }
  return beyond;
}

// The projection is along the axis along which a has the largest area.
inline unsigned are_beyond_an_edge(const Planes& planes, const Triangles& a, const Triangles& b) {
  const Doubles x = size_of(planes.normal.x), y = size_of(planes.normal.y), z = size_of(planes.normal.z);
  const auto flat = [&](const Triangles& t) {
    Flat f;
    for (int k = 0; k < 3; ++k) {
      const Points& p = t.corner[k];
      const Doubles first_of_two = y > z ? p.z : p.x, second_of_two = y > z ? p.x : p.y;
      f.first[k] = x > y ? (x > z ? p.y : first_of_two) : first_of_two;
      f.second[k] = x > y ? (x > z ? p.z : second_of_two) : second_of_two;
    }
    return f;
  };
  const Flat flat_a = flat(a), flat_b = flat(b);
  const unsigned beyond = are_beyond_an_edge(flat_a, flat_b);
  return beyond == every ? beyond : beyond | are_beyond_an_edge(flat_b, flat_a);
}

// The overlap of triangles that cross each other's planes, with all corners off these planes.
struct Overlaps {
  unsigned none, some;
};
inline Overlaps overlaps_of_crossed(const Triangles& a, const Sides& of_a, const Triangles& b, const Sides& of_b) {
  const Lone lone_a = lone_corners(a, of_a), lone_b = lone_corners(b, of_b);
  const Points a_first = choose(lone_b.is_below, lone_a.second, lone_a.first);
  const Points a_second = choose(lone_b.is_below, lone_a.first, lone_a.second);
  // mutant triangle-pairs-order: `choose(lone_a.is_below, lone_b.second, lone_b.first)` -> `lone_b.first`
  const Points b_first = choose(lone_a.is_below, lone_b.second, lone_b.first);
  const Points b_second = choose(lone_a.is_below, lone_b.first, lone_b.second);
  Doubles value;
  unsigned begins_late, begins_early, ends_late, ends_early;
  find_side(planes_of({{lone_a.corner, a_first, lone_b.corner}}), b_first, value, begins_late, begins_early);
  find_side(planes_of({{lone_a.corner, a_second, lone_b.corner}}), b_second, value, ends_late, ends_early);
  // mutant triangle-pairs-meeting: `begins_early & ends_late` -> `begins_early`
  return {begins_late | ends_early, begins_early & ends_late};
}

TriangleVerdicts look(const TrianglePairs& pairs) {
  TriangleVerdicts verdicts{0, 0};
  for (int first = 0; first < static_cast<int>(TrianglePairs::size); first += doubles) {
    const Triangles a = load_triangles(pairs.a, first), b = load_triangles(pairs.b, first);
    const Planes planes = planes_of(a);
    const Sides of_b = sides_of(planes, b);
    unsigned apart = of_b.all_above() | of_b.all_below(), meeting = 0;
    if (apart != every) {
      const Sides of_a = sides_of(planes_of(b), a);
      apart |= of_a.all_above() | of_a.all_below();
      // The test that decides most pairs comes first. The result does not depend on the order, since no two tests
      // disagree.
      // mutant triangle-pairs-crossed: `() & of_b.all_known()` -> `()`
      const unsigned known = of_a.all_known() & of_b.all_known();
      const bool edges_first = (known | apart) != every;
      if (edges_first) apart |= are_beyond_an_edge(planes, a, b);
      if (const unsigned crossed = known & ~apart; crossed != 0) {
        const Overlaps overlaps = overlaps_of_crossed(a, of_a, b, of_b);
        apart |= crossed & overlaps.none;
        meeting = crossed & overlaps.some;
      }
      if (!edges_first && (apart | meeting) != every) apart |= are_beyond_an_edge(planes, a, b) & ~meeting;
    }
    verdicts.apart |= apart << first;
    verdicts.meeting |= meeting << first;
  }
  return verdicts;
}

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of the skin kernels, on registers of `lanes` floats. skinned.cpp has the names and the proofs.

#ifdef MORULA_LANES
typedef std::int32_t Bits __attribute__((vector_size(4 * lanes)));
typedef float Singles __attribute__((vector_size(4 * doubles)));
typedef float LooseSingles __attribute__((vector_size(4 * doubles), aligned(4), may_alias));
// The largest power of two that is not above a number of at least 0; 0 below 2^-126.
inline Wide power_of(Wide a) {
  return reinterpret_cast<Wide>(reinterpret_cast<Bits>(a) & 0x7f800000);
}
// The inverse of a power of two below 2^127; of 0: 2^127.
inline Wide inverse_of_power(Wide a) {
  return reinterpret_cast<Wide>(0x7f000000 - reinterpret_cast<Bits>(a));
}
inline Doubles narrowed(Doubles a) {
  return __builtin_convertvector(__builtin_convertvector(a, Singles), Doubles);
}
inline Doubles widened(const float* first) {
  return __builtin_convertvector(*reinterpret_cast<const LooseSingles*>(first), Doubles);
}
inline void write_narrowed(Doubles a, float* first) {
  *reinterpret_cast<LooseSingles*>(first) = __builtin_convertvector(a, Singles);
}
#endif
inline Wide read(const float* first) {
  return load(first);
}
inline void write(Wide a, float* first) {
  store(a, first);
}

struct Vectors {
  Wide x, y, z;
};
// GCC 12 without optimization fails to compile these as friends inside.
inline Vectors operator+(const Vectors& a, const Vectors& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vectors operator*(const Wide& s, const Vectors& v) {
  return {s * v.x, s * v.y, s * v.z};
}
inline Vectors each(const Vec3f& v) {
  return {all(v.x), all(v.y), all(v.z)};
}
inline Vectors read(const LaneVectors& v, std::size_t lane) {
  return {read(v.x + lane), read(v.y + lane), read(v.z + lane)};
}
inline void write(const Vectors& v, LaneVectors& to, std::size_t lane) {
  write(v.x, to.x + lane), write(v.y, to.y + lane), write(v.z, to.z + lane);
}
inline Wide dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Wide norm(const Vectors& a) {
  return root(dot(a, a));
}
inline Wide size_of(Wide a) {
  return max(a, -a);
}
inline Wide sum_of_sizes(const Vectors& a) {
  return size_of(a.x) + size_of(a.y) + size_of(a.z);
}

inline Wide largest_of(const Vectors& a) {
  return max(max(size_of(a.x), size_of(a.y)), size_of(a.z));
}

// The matrix with these columns.
struct Matrices {
  Vectors columns[3];

  Vectors operator*(const Vectors& v) const { return v.x * columns[0] + v.y * columns[1] + v.z * columns[2]; }
};
inline Matrices each(const Columns& columns) {
  return {{each(columns[0]), each(columns[1]), each(columns[2])}};
}

// At least the largest stretch, and at most 4 % more: largest_stretch of mode_rows.hpp, in float. Powers of two bring
// the largest entry into 1…2. Entries below 2^-126 count as 0.
inline Wide stretch(const Matrices& f) {
  const Wide power = power_of(max(max(largest_of(f.columns[0]), largest_of(f.columns[1])), largest_of(f.columns[2])));
  const Wide scale = inverse_of_power(power);
  const Vectors a = scale * f.columns[0], b = scale * f.columns[1], c = scale * f.columns[2];
  const Wide aa = dot(a, a), bb = dot(b, b), cc = dot(c, c), ab = dot(a, b), ac = dot(a, c), bc = dot(b, c);
  const Wide mean = (aa + bb + cc) * (1.0f / 3);
  const Wide xx = aa - mean, yy = bb - mean, zz = cc - mean;
  const Wide off = ab * ab + ac * ac + bc * bc;
  const Wide p = root((xx * xx + yy * yy + zz * zz + (off + off)) * (1.0f / 6));
  const Wide cube = p * p * p;
  const Wide determinant = xx * (yy * zz - bc * bc) - ab * (ab * zz - bc * ac) + ac * (ab * bc - yy * ac);
  const Wide right = max(all(-1), min(all(1), determinant / (cube + cube)));
  const auto tangent = [&](float at) {
    return at - (4 * at * at * at - 3 * at) * (1 / (12 * at * at - 3)) + right * (1 / (12 * at * at - 3));
  };
  Wide g = min(min(tangent(1), tangent(0.85f)), min(tangent(0.7f), tangent(0.56f)));
  const Wide gg = g * g;
  g -= (g * (4.0f * gg - 3.0f) - right) / (12.0f * gg - 3.0f);
  g = cube > all(0) ? g : all(1);
  // mutant skinned-stretch: `(mean + 2.0f * p * g) * (1 + 0x1p-15f)` -> `(mean + 2.0f * p * g)`
  return root(mean + 2.0f * p * g) * (1 + 0x1p-15f) * power;
}

// The bounds of some lanes; the center is a displacement.
struct Bounds {
  Vectors center;
  Wide radius, strays, stretched;
  Matrices f;
};

inline Bounds blended(const NodeGroup& group, const SkinFrame& frame, std::size_t lane) {
  const BoneMotion& main = frame.bones[group.bone];
  const Vectors place = read(group.place, lane);
  const Wide rest_radius = read(group.radius + lane);
  Bounds s{};
  s.center = each(main.change.linear) * place;
  s.strays = main.change.size * read(group.turn_stray + lane);
  if (group.first_term == group.end_term) {
    s.radius = main.size * rest_radius + s.strays;
    return s;
  }
  s.f = each(main.linear);
  Wide squares{};
  for (std::uint32_t i = group.first_term; i != group.end_term; ++i) {
    const GroupTerm& t = frame.terms[i];
    const MotionRow& pair = frame.pairs[t.pair];
    const Matrices linear = each(pair.linear);
    const Vectors move = linear * place + each(pair.shift), slope = read(t.slope, lane);
    const Wide scale = read(t.scale + lane);
    s.center = s.center + (read(t.weight + lane) * move + linear * read(t.moment, lane));
    s.f.columns[0] = s.f.columns[0] + (slope.x * move + scale * linear.columns[0]);
    s.f.columns[1] = s.f.columns[1] + (slope.y * move + scale * linear.columns[1]);
    s.f.columns[2] = s.f.columns[2] + (slope.z * move + scale * linear.columns[2]);
    squares += read(t.weight_stray + lane) * dot(move, move);
    s.strays += read(t.moment_stray + lane) * pair.size;
  }
  s.strays += root(read(group.weight_strays + lane) * squares) + main.size * read(group.size_stray + lane);
  s.stretched = stretch(s.f);
  // mutant skinned-strays: `s.stretched * rest_radius + s.strays` -> `s.stretched * rest_radius`
  s.radius = s.stretched * rest_radius + s.strays;
  return s;
}

inline void take_smaller(const Vectors& center, Wide radius, Bounds& s) {
  const auto is_better = radius < s.radius;
  s.center.x = is_better ? center.x : s.center.x;
  s.center.y = is_better ? center.y : s.center.y;
  s.center.z = is_better ? center.z : s.center.z;
  s.radius = is_better ? radius : s.radius;
}

inline void shape(const NodeGroup& group, std::size_t lane, Bounds& s) {
  const Vectors* f = s.f.columns;
  const auto axis = [&](int k) { return read(group.shape_axes[k] + lane); };
  Matrices axes;
  axes.columns[2] = axis(5) * f[2];
  axes.columns[1] = axis(3) * f[1] + axis(4) * f[2];
  axes.columns[0] = axis(0) * f[0] + axis(1) * f[1] + axis(2) * f[2];
  // mutant skinned-shape-strays: `stretch(axes) + s.strays` -> `stretch(axes)`
  const Wide radius = stretch(axes) + s.strays + s.stretched * read(group.shape_stray + lane);
  take_smaller(s.center + s.f * read(group.shape_center, lane), radius, s);
}

struct Ball {
  Vectors center;  // about the moved pivot
  Wide radius;
};
struct Boxes {
  Vectors lower, upper;

  void extend(const Ball& b) {
    lower = {min(b.center.x - b.radius, lower.x), min(b.center.y - b.radius, lower.y),
             min(b.center.z - b.radius, lower.z)};
    upper = {max(b.center.x + b.radius, upper.x), max(b.center.y + b.radius, upper.y),
             max(b.center.z + b.radius, upper.z)};
  }
};

// A ball around the moved balls of the bones: around the middle of their box.
inline void hull(const NodeGroup& group, const SkinFrame& frame, std::size_t lane, Bounds& s) {
  const BoneMotion& main = frame.bones[group.bone];
  const auto moved_ball = [&](const GroupTerm& t) -> Ball {
    const BoneMotion& bone = frame.bones[t.bone];
    const Wide radius = read(t.ball_radius + lane);
    return {each(bone.linear) * read(t.ball, lane) + each(frame.pairs[t.pair].shift),
            radius < all(0) ? all(-infinite) : bone.size * radius};
  };
  const std::span<const GroupTerm> terms(frame.terms + group.first_term, frame.terms + group.end_term);
  const Wide radius_of_main = read(group.ball_radius + lane);
  const Ball ball_of_main{each(main.linear) * read(group.ball, lane), main.size * radius_of_main};
  Boxes box{ball_of_main.center, ball_of_main.center};
  box.extend(ball_of_main);
  Ball kept[most_kept_balls];  // the first ones; the others are computed twice
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Ball ball = moved_ball(terms[i]);
    box.extend(ball);
    if (i < most_kept_balls) kept[i] = ball;
  }
  const Vectors middle = all(0.5f) * (box.lower + box.upper);
  Wide reach = norm(ball_of_main.center - middle) + ball_of_main.radius;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Ball ball = i < most_kept_balls ? kept[i] : moved_ball(terms[i]);
    reach = max(norm(ball.center - middle) + ball.radius, reach);
  }
  const Vectors displaced = middle - all(frame.scale) * read(group.place, lane);
  reach = reach * (1 + 0x1p-20f) + (sum_of_sizes(middle) + sum_of_sizes(displaced)) * 0x1p-22f;
  // mutant skinned-negative-hull: `radius_of_main < all(0) ? s.radius : reach` -> `reach`
  reach = radius_of_main < all(0) ? s.radius : reach;
  take_smaller(displaced, reach, s);
}

void bound(const NodeGroup& group, const SkinFrame& frame, GroupSpheres& spheres) {
  constexpr std::size_t registers = lanes_of_group / lanes;
  const float size = loose * frame.bones[group.bone].size;
  Bounds bounds[registers];
  unsigned loose_lanes = 0;
  for (std::size_t r = 0; r < registers; ++r) {
    bounds[r] = blended(group, frame, r * lanes);
    loose_lanes |= lanes_at_most(size * read(group.radius + r * lanes), bounds[r].radius);
  }
  for (std::size_t r = 0; r < registers; ++r) {
    if (loose_lanes != 0 && group.first_term != group.end_term) {
      shape(group, r * lanes, bounds[r]);
      hull(group, frame, r * lanes, bounds[r]);
    }
    write(bounds[r].center, spheres.center, r * lanes);
    write(bounds[r].radius, spheres.radius + r * lanes);
  }
}

inline Doubles each(double x) {
  return x - Doubles{};
}
inline Doubles read(const double* first) {
  return *reinterpret_cast<const LooseDoubles*>(first);
}
inline Doubles size_of(Doubles a) {
  return a > -a ? a : -a;
}

void differ(const BoneRow* rows, std::span<const BonePair> pairs, double scale, MotionRow* differences) {
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const double *main = rows[pairs[p].main].entries, *other = rows[pairs[p].other].entries;
    float* to = &differences[p].linear[0].x;
    for (std::size_t k = 0; k < 16; k += doubles)
      write_narrowed(scale * (read(other + k) - read(main + k)), to + k);
    float squares = 0;
    for (std::size_t k = 0; k < 9; ++k) squares += to[k] * to[k];
    differences[p].size = __builtin_sqrtf(squares) * (1 + 0x1p-20f);
  }
}

void stretches(const LaneVectors (&columns)[3], LaneFloats& to) {
  for (std::size_t lane = 0; lane < lanes_of_group; lane += lanes) {
    const Matrices f{{read(columns[0], lane), read(columns[1], lane), read(columns[2], lane)}};
    write(stretch(f), to + lane);
  }
}

// The rounding is measured by the sum of its components, which is at least its length.
void narrow(const NodeGroup& group, const SkinFrame& frame, const Vec3& origin, double pad, GroupSpheres& spheres) {
  const Vec3& shift = frame.shifts[group.bone];
  for (std::size_t lane = 0; lane < lanes_of_group; lane += doubles) {
    Doubles lost{};
    const auto place = [&](const double* rest, double moved, float* displacement, double from) {
      const Doubles at = read(rest + lane) + (each(moved) + frame.unit * widened(displacement + lane)) - each(from);
      // Adding zero makes a negative zero positive, like the other rules.
      const Doubles nearest = narrowed(at) + 0.0;
      lost += size_of(nearest - at);
      return nearest;
    };
    const Doubles x = place(group.center_x, shift.x, spheres.center.x, origin.x);
    const Doubles y = place(group.center_y, shift.y, spheres.center.y, origin.y);
    const Doubles z = place(group.center_z, shift.z, spheres.center.z, origin.z);
    // mutant skinned-narrowed-center: `spheres.radius + lane) + lost)` -> `spheres.radius + lane))`
    const Doubles radius = (frame.unit * widened(spheres.radius + lane) + lost) * (1 + 0x1p-40) + pad;
    // mutant skinned-largest-bound: `radius <= each(largest_bound)` -> `radius == radius`
    const auto is_inside = radius <= each(largest_bound);
    write_narrowed(is_inside ? x : each(0), spheres.center.x + lane);
    write_narrowed(is_inside ? y : each(0), spheres.center.y + lane);
    write_narrowed(is_inside ? z : each(0), spheres.center.z + lane);
    // The nearest float is not below the radius.
    write_narrowed((is_inside ? radius : each(largest_bound)) * (1 + 0x1p-23) + 0x1p-149, spheres.radius + lane);
  }
}

constexpr SkinKernels kernels{differ, stretches, bound, narrow};

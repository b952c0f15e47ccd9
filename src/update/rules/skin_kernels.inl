// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of the skin kernels, on registers of `doubles` doubles. skinned.cpp has the names and the proofs.

#ifdef MORULA_LANES
typedef float Singles __attribute__((vector_size(4 * doubles)));
inline Doubles narrowed(Doubles a) {
  return __builtin_convertvector(__builtin_convertvector(a, Singles), Doubles);
}
#endif
inline Doubles each(double x) {
  return x - Doubles{};
}
inline Doubles read(const double* first) {
  return *reinterpret_cast<const LooseDoubles*>(first);
}
inline void write(Doubles a, double* first) {
  *reinterpret_cast<LooseDoubles*>(first) = a;
}
// The second if the two are equal or not comparable.
inline Doubles larger(Doubles a, Doubles b) {
  return a > b ? a : b;
}
inline Doubles smaller(Doubles a, Doubles b) {
  return a < b ? a : b;
}

struct Vectors {
  Doubles x, y, z;
};
// GCC 12 without optimization fails to compile these as friends inside.
inline Vectors operator+(const Vectors& a, const Vectors& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vectors operator*(const Doubles& s, const Vectors& v) {
  return {s * v.x, s * v.y, s * v.z};
}
inline Vectors each(const Vec3& v) {
  return {each(v.x), each(v.y), each(v.z)};
}
inline Vectors read(const LaneVectors& v, std::size_t lane) {
  return {read(v.x + lane), read(v.y + lane), read(v.z + lane)};
}
inline Doubles dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Doubles norm(const Vectors& a) {
  return root(dot(a, a));
}
inline Doubles largest_component(const Vectors& a) {
  const Doubles x = larger(a.x, -a.x), y = larger(a.y, -a.y), z = larger(a.z, -a.z);
  return larger(larger(x, y), z);
}

// The matrix with these columns.
struct Matrices {
  Vectors columns[3];

  Vectors operator*(const Vectors& v) const { return v.x * columns[0] + v.y * columns[1] + v.z * columns[2]; }
};
inline Matrices linear_part(const BoneMotion& bone) {
  return {{each(bone.columns[0]), each(bone.columns[1]), each(bone.columns[2])}};
}

// largest_stretch of mode_rows.hpp. If squares or their cubes leave the range of double, the bound is three times the
// largest entry, which is at least the root of the sum of nine squares.
inline Doubles stretch(const Matrices& f) {
  const Vectors &a = f.columns[0], &b = f.columns[1], &c = f.columns[2];
  const Doubles aa = dot(a, a), bb = dot(b, b), cc = dot(c, c), ab = dot(a, b), ac = dot(a, c), bc = dot(b, c);
  const Doubles mean = (aa + bb + cc) * (1.0 / 3);
  const Doubles xx = aa - mean, yy = bb - mean, zz = cc - mean;
  const Doubles off = ab * ab + ac * ac + bc * bc;
  const Doubles p = root((xx * xx + yy * yy + zz * zz + (off + off)) * (1.0 / 6));
  const Doubles cube = p * p * p;
  const Doubles determinant = xx * (yy * zz - bc * bc) - ab * (ab * zz - bc * ac) + ac * (ab * bc - yy * ac);
  const Doubles right = larger(each(-1), smaller(each(1), determinant / (cube + cube)));
  const auto tangent = [&](double at) { return at + (right - (4 * at * at * at - 3 * at)) * (1 / (12 * at * at - 3)); };
  Doubles g = smaller(smaller(tangent(1), tangent(0.85)), smaller(tangent(0.7), tangent(0.56)));
  g -= (4.0 * g * g * g - 3.0 * g - right) / (12.0 * g * g - 3.0);
  g = cube > each(0) ? g : each(1);
  // The factor is far above the rounding: about fifty units in the last place.
  // mutant skinned-stretch: `(mean + 2.0 * p * g) * (1 + 0x1p-40)` -> `(mean + 2.0 * p * g)`
  const Doubles result = root(mean + 2.0 * p * g) * (1 + 0x1p-40);
  const Doubles least = each(0x1p-200), most = each(0x1p200);
  // mutant skinned-stretch-range: `(least, mean) | greater(mean, most)) == 0` -> `(least, mean) | greater(mean, most)) < 99`
  if ((greater(least, mean) | greater(mean, most)) == 0) return result;
  const Doubles entry = larger(larger(largest_component(a), largest_component(b)), largest_component(c));
  const Doubles bound = 3 * (1 + 0x1p-40) * entry;
  return mean < least ? bound : mean > most ? bound : result;
}

// The bounds of some lanes; the center is a displacement.
struct Bounds {
  Vectors center;
  Doubles radius, strays;
  Matrices f;
};

inline Bounds blended(const NodeGroup& group, const SkinFrame& frame, std::size_t lane) {
  const BoneMotion& main = frame.bones[group.bone];
  const Vectors center = read(group.center, lane);
  Bounds s{};
  s.f = linear_part(main);
  s.center = s.f * center + each(main.shift);
  s.f.columns[0].x += 1, s.f.columns[1].y += 1, s.f.columns[2].z += 1;
  s.radius = each(main.size) * read(group.radius + lane);
  if (group.first_term == group.end_term) return s;
  Doubles squares{};
  for (std::uint32_t i = group.first_term; i != group.end_term; ++i) {
    const GroupTerm& t = frame.terms[i];
    const BoneMotion& pair = frame.pairs[t.pair];
    const Matrices linear = linear_part(pair);
    const Vectors move = linear * center + each(pair.shift), slope = read(t.slope, lane);
    const Doubles scale = read(t.scale + lane);
    s.center = s.center + (read(t.weight + lane) * move + linear * read(t.moment, lane));
    s.f.columns[0] = s.f.columns[0] + (slope.x * move + scale * linear.columns[0]);
    s.f.columns[1] = s.f.columns[1] + (slope.y * move + scale * linear.columns[1]);
    s.f.columns[2] = s.f.columns[2] + (slope.z * move + scale * linear.columns[2]);
    squares += read(t.weight_stray + lane) * dot(move, move);
    s.strays += read(t.moment_stray + lane) * pair.size;
  }
  s.strays += root(read(group.weight_strays + lane) * squares);
  // mutant skinned-strays: `read(group.radius + lane) + s.strays` -> `read(group.radius + lane)`
  s.radius = stretch(s.f) * read(group.radius + lane) + s.strays;
  return s;
}

inline void shape(const NodeGroup& group, std::size_t lane, Bounds& s) {
  Matrices axes;
  for (int k = 0; k < 3; ++k) axes.columns[k] = s.f * read(group.shape_axes[k], lane);
  // mutant skinned-shape-strays: `stretch(axes) + s.strays` -> `stretch(axes)`
  const Doubles radius = stretch(axes) + s.strays;
  const Vectors center = s.center + s.f * read(group.shape_center, lane);
  const auto is_better = radius < s.radius;
  s.center.x = is_better ? center.x : s.center.x;
  s.center.y = is_better ? center.y : s.center.y;
  s.center.z = is_better ? center.z : s.center.z;
  s.radius = is_better ? radius : s.radius;
}

struct Ball {
  Vectors center;
  Doubles radius;
};
struct Boxes {
  Vectors lower, upper;

  void extend(const Ball& b) {
    lower = {smaller(b.center.x - b.radius, lower.x), smaller(b.center.y - b.radius, lower.y),
             smaller(b.center.z - b.radius, lower.z)};
    upper = {larger(b.center.x + b.radius, upper.x), larger(b.center.y + b.radius, upper.y),
             larger(b.center.z + b.radius, upper.z)};
  }
};

// A ball around the moved balls of the bones, about the displaced center: around the middle of their box.
inline void hull(const NodeGroup& group, const SkinFrame& frame, std::size_t lane, Bounds& s) {
  const BoneMotion& main = frame.bones[group.bone];
  Matrices turned = linear_part(main);
  turned.columns[0].x += 1, turned.columns[1].y += 1, turned.columns[2].z += 1;
  const Vectors center = read(group.center, lane), moved = linear_part(main) * center + each(main.shift);
  const auto moved_ball = [&](const GroupTerm& t) -> Ball {
    const BoneMotion& pair = frame.pairs[t.pair];
    const Vectors place = read(t.ball, lane);
    const Doubles radius = read(t.ball_radius + lane);
    return {linear_part(pair) * (center + place) + each(pair.shift) + turned * place,
            radius < each(0) ? each(-infinite) : frame.bones[t.bone].size * radius};
  };
  const std::span<const GroupTerm> terms(frame.terms + group.first_term, frame.terms + group.end_term);
  const Ball ball_of_main{turned * read(group.ball, lane), main.size * read(group.ball_radius + lane)};
  Boxes box{ball_of_main.center, ball_of_main.center};
  box.extend(ball_of_main);
  Ball kept[most_kept_balls];  // the first ones; the others are computed twice
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Ball ball = moved_ball(terms[i]);
    box.extend(ball);
    if (i < most_kept_balls) kept[i] = ball;
  }
  const Vectors middle = each(0.5) * (box.lower + box.upper), displaced = moved + middle;
  Doubles reach = norm(ball_of_main.center - middle) + ball_of_main.radius;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Ball ball = i < most_kept_balls ? kept[i] : moved_ball(terms[i]);
    reach = larger(norm(ball.center - middle) + ball.radius, reach);
  }
  // mutant skinned-negative-hull: `read(group.ball_radius + lane) < each(0) ? s.radius : reach` -> `reach`
  reach = read(group.ball_radius + lane) < each(0) ? s.radius : reach;
  const auto is_better = reach < s.radius;
  s.center.x = is_better ? displaced.x : s.center.x;
  s.center.y = is_better ? displaced.y : s.center.y;
  s.center.z = is_better ? displaced.z : s.center.z;
  s.radius = is_better ? reach : s.radius;
}

inline void write(const Vectors& v, LaneVectors& to, std::size_t lane) {
  write(v.x, to.x + lane), write(v.y, to.y + lane), write(v.z, to.z + lane);
}

void bound(const NodeGroup& group, const SkinFrame& frame, GroupSpheres& spheres) {
  constexpr std::size_t registers = lanes_of_group / doubles;
  const double size = loose * frame.bones[group.bone].size;
  Bounds bounds[registers];
  unsigned loose_lanes = 0;
  for (std::size_t r = 0; r < registers; ++r) {
    bounds[r] = blended(group, frame, r * doubles);
    loose_lanes |= greater(bounds[r].radius, size * read(group.radius + r * doubles));
  }
  for (std::size_t r = 0; r < registers; ++r) {
    if (loose_lanes != 0) {
      shape(group, r * doubles, bounds[r]);
      hull(group, frame, r * doubles, bounds[r]);
    }
    write(bounds[r].center, spheres.center, r * doubles);
    write(bounds[r].radius, spheres.radius + r * doubles);
  }
}

void narrow(const NodeGroup& group, const Vec3& origin, double pad, GroupSpheres& spheres) {
  for (std::size_t lane = 0; lane < lanes_of_group; lane += doubles) {
    const Vectors center = read(group.center, lane) + read(spheres.center, lane) - each(origin);
    // Adding zero makes a negative zero positive, like the other rules.
    const Vectors nearest{narrowed(center.x) + 0.0, narrowed(center.y) + 0.0, narrowed(center.z) + 0.0};
    const Doubles radius = read(spheres.radius + lane);
    write(nearest, spheres.center, lane);
    // mutant skinned-narrowed-center: `radius + norm(nearest - center)` -> `radius`
    write((radius + norm(nearest - center)) * (1 + 0x1p-40) + pad, spheres.radius + lane);
  }
}

constexpr SkinKernels kernels{bound, narrow};

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of farthest.cpp. A maximum does not depend on the order of its terms, so lanes may be combined in any
// order, and points may be read twice: the last register of a list ends with the list. A list shorter than a register
// is filled up with its first point.

template <class Scalar>
struct Registers;
template <>
struct Registers<float> {
  typedef Wide Register;
  static constexpr std::size_t width = lanes;
  static Wide load_from(const float* first) { return load(first); }
};
template <>
struct Registers<double> {
  typedef Doubles Register;
  static constexpr std::size_t width = doubles;
  static Doubles load_from(const double* first) { return *reinterpret_cast<const LooseDoubles*>(first); }
};

inline Doubles max(Doubles a, Doubles b) {
  return a > b ? a : b;
}
inline double largest_lane(Doubles wide) {
  double largest = wide[0];
  for (int k = 1; k < doubles; ++k) largest = wide[k] > largest ? wide[k] : largest;
  return largest;
}
// Bit i: lane i is `most`, and none is more.
inline unsigned lanes_of(Wide wide, float most) {
  return lanes_equal(wide, all(most));
}
inline unsigned lanes_of(Doubles wide, double most) {
  return ~greater(most - Doubles{}, wide) & ((1u << doubles) - 1);
}

// height(first): heights of the points in lanes from `first` on. count: at least one register.
template <std::size_t width, class Height>
inline auto highest(std::size_t count, const Height& height) {
  constexpr std::size_t registers = 4;
  auto most = height(std::size_t{0});
  std::size_t i = width;
  // Several maxima run at once, because each waits for its preceding value.
  if (count >= registers * width) {
    auto b = height(i), c = height(i + width), d = height(i + 2 * width);
    for (i = registers * width; i + registers * width <= count; i += registers * width) {
      most = max(height(i), most), b = max(height(i + width), b);
      c = max(height(i + 2 * width), c), d = max(height(i + 3 * width), d);
    }
    most = max(max(most, b), max(c, d));
  }
  for (; i < count; i += width) most = max(height(i + width <= count ? i : count - width), most);
  return largest_lane(most);
}

template <std::size_t width, class Height>
inline std::size_t first_of_highest(std::size_t count, const Height& height) {
  // Finds the first block that has the maximum, then its place there.
  constexpr std::size_t block = 8 * width;
  auto most = height(std::size_t{0});
  std::size_t in_block = 0;
  auto highest = largest_lane(most);
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t end = begin + block < count ? begin + block : count;
    for (std::size_t i = begin; i < end; i += width) most = max(height(i + width <= count ? i : count - width), most);
    if (const auto here = largest_lane(most); here > highest) highest = here, in_block = begin;
  }
  for (std::size_t i = in_block; i < count; i += width) {
    const std::size_t first = i + width <= count ? i : count - width;
    if (const unsigned of = lanes_of(height(first), highest); of != 0)
      return first + static_cast<std::size_t>(__builtin_ctz(of));
  }
  return in_block;  // coordinates that are NaN
}

// count: at least one register.
template <class Scalar>
struct Padded {
  static constexpr std::size_t width = Registers<Scalar>::width;
  alignas(64) Scalar xyz[3][width];
};
template <class Scalar>
inline BasicPointColumns<Scalar> at_least_a_register(const BasicPointColumns<Scalar>& points, Padded<Scalar>& padded) {
  constexpr std::size_t width = Registers<Scalar>::width;
  if (points.count >= width) return points;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t from = i < points.count ? i : 0;
    padded.xyz[0][i] = points.x[from], padded.xyz[1][i] = points.y[from], padded.xyz[2][i] = points.z[from];
  }
  return {padded.xyz[0], padded.xyz[1], padded.xyz[2], width};
}

// Squared distances of the points in lanes from i on.
template <class Scalar>
struct Squares {
  typedef typename Registers<Scalar>::Register Register;
  BasicPointColumns<Scalar> points;
  Register x, y, z;
  Squares(const BasicPointColumns<Scalar>& all_points, const Vector3<Scalar>& center)
      : points(all_points), x(center.x - Register{}), y(center.y - Register{}), z(center.z - Register{}) {}
  Register operator()(std::size_t i) const {
    const auto load_from = Registers<Scalar>::load_from;
    const Register dx = load_from(points.x + i) - x, dy = load_from(points.y + i) - y, dz = load_from(points.z + i) - z;
    return dx * dx + dy * dy + dz * dz;
  }
};

float squared_distance(const PointColumns& points, const Vec3f& center) {
  Padded<float> padded;
  const Squares<float> squares(at_least_a_register(points, padded), center);
  return highest<lanes>(squares.points.count, squares);
}

template <class Scalar>
std::size_t from(const BasicPointColumns<Scalar>& points, const Vector3<Scalar>& center) {
  Padded<Scalar> padded;
  const Squares<Scalar> squares(at_least_a_register(points, padded), center);
  return first_of_highest<Registers<Scalar>::width>(squares.points.count, squares);
}

std::size_t along(const PointColumns& points, const Vec3f& direction) {
  Padded<float> padded;
  const PointColumns c = at_least_a_register(points, padded);
  const Wide dx = all(direction.x), dy = all(direction.y), dz = all(direction.z);
  return first_of_highest<lanes>(
      c.count, [&](std::size_t i) { return load(c.x + i) * dx + load(c.y + i) * dy + load(c.z + i) * dz; });
}

constexpr FarthestKernels kernels{squared_distance, from<float>, from<double>, along};

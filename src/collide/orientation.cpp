// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/orientation.hpp"

#include <cmath>

namespace morula {
namespace {

// A sum without rounding: parts of growing size that do not overlap. At most `capacity` parts are ever added.
template <int capacity>
class ExactSum {
 public:
  void add(double value) {
    double carried = value;
    for (int i = 0; i < count_; ++i) {
      const double part = parts_[i], sum = carried + part, back = sum - carried;
      parts_[i] = (carried - (sum - back)) + (part - back);
      carried = sum;
    }
    parts_[count_++] = carried;
  }
  void add_product(double a, double b) {
    const double high = a * b;
    add(std::fma(a, b, -high));
    add(high);
  }
  void add_product(double a, double b, double c) {
    const double high = a * b;
    add_product(std::fma(a, b, -high), c);
    add_product(high, c);
  }
  int sign() const {
    for (int i = count_; i-- > 0;)
      if (parts_[i] != 0) return parts_[i] > 0 ? 1 : -1;
    return 0;
  }

 private:
  double parts_[capacity];
  int count_ = 0;
};

int sign_of(double value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

constexpr double unit = 0x1p-53;

}  // namespace

int sign_of_difference(double a, double b, double c, double d) {
  const double first = a * b, second = c * d;
  // Rounding keeps order: different products are in the right one.
  if (first != second) return first > second ? 1 : -1;
  ExactSum<4> sum;
  sum.add_product(a, b);
  sum.add_product(-c, d);
  return sum.sign();
}

int orientation(double ax, double ay, double bx, double by, double px, double py) {
  const double left = (ax - px) * (by - py), right = (ay - py) * (bx - px), det = left - right;
  if (std::abs(det) > (3 + 16 * unit) * unit * (std::abs(left) + std::abs(right))) return sign_of(det);
  ExactSum<12> sum;
  sum.add_product(ax, by);
  sum.add_product(-ax, py);
  sum.add_product(-px, by);
  sum.add_product(-ay, bx);
  sum.add_product(ay, px);
  sum.add_product(py, bx);
  return sum.sign();
}

int orientation(const Triangle& t, const Vec3& p) {
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double bc = b.y * c.z, cb = b.z * c.y, ca = c.y * a.z, ac = c.z * a.y, ab = a.y * b.z, ba = a.z * b.y;
  const double det = a.x * (bc - cb) + b.x * (ca - ac) + c.x * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * std::abs(a.x) +
                           (std::abs(ca) + std::abs(ac)) * std::abs(b.x) +
                           (std::abs(ab) + std::abs(ba)) * std::abs(c.x);
  if (std::abs(det) > (7 + 56 * unit) * unit * permanent) return -sign_of(det);

  // [abc] - [pbc] - [apc] - [abp], each the six products of a determinant of coordinates.
  ExactSum<96> sum;
  const auto add = [&](double sign, const Vec3& x, const Vec3& y, const Vec3& z) {
    sum.add_product(sign * x.x, y.y, z.z);
    sum.add_product(-sign * x.x, y.z, z.y);
    sum.add_product(sign * x.y, y.z, z.x);
    sum.add_product(-sign * x.y, y.x, z.z);
    sum.add_product(sign * x.z, y.x, z.y);
    sum.add_product(-sign * x.z, y.y, z.x);
  };
  add(1, t[0], t[1], t[2]);
  add(-1, p, t[1], t[2]);
  add(-1, t[0], p, t[2]);
  add(-1, t[0], t[1], p);
  return -sum.sign();
}

}  // namespace morula

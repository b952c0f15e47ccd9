// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/nearest_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morula::detail {
namespace {

double product(const Motion& a, const Motion& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += a[i] * b[i];
  return sum;
}

void add(Motion& to, double factor, const Motion& of) {
  for (std::size_t i = 0; i < 6; ++i) to[i] += factor * of[i];
}

/// The half spaces that hold the motion, with an orthonormal basis of their rows.
class HeldRows {
 public:
  std::size_t size = 0;
  std::array<std::uint32_t, 6> side{};
  std::array<double, 6> weight{};

  void push(std::uint32_t k, double w) { side[size] = k, weight[size] = w, ++size; }
  void drop(std::size_t place) {
    for (--size; place < size; ++place) side[place] = side[place + 1], weight[place] = weight[place + 1];
  }

  /// row = sum of share[k] × held row k + rest, with a rest orthogonal to all held rows.
  void split(std::span<const KeptMotions> sides, const Motion& row, std::array<double, 6>& share, Motion& rest) {
    factorize(sides);
    rest = row;
    share.fill(0);
    for (int pass = 0; pass < 2; ++pass)  // the second pass removes what rounding left
      for (std::size_t k = 0; k < size; ++k) {
        const double c = product(basis_[k], rest);
        share[k] += c;
        add(rest, -c, basis_[k]);
      }
    for (std::size_t k = size; k-- > 0;) {
      for (std::size_t j = k + 1; j < size; ++j) share[k] -= upper_[k][j] * share[j];
      share[k] /= upper_[k][k];
    }
  }

 private:
  // Gram-Schmidt: held row j = sum over k ≤ j of upper_[k][j] × basis_[k].
  void factorize(std::span<const KeptMotions> sides) {
    for (std::size_t j = 0; j < size; ++j) {
      Motion left = sides[side[j]].row;
      for (std::size_t k = 0; k < j; ++k) upper_[k][j] = 0;
      for (int pass = 0; pass < 2; ++pass)
        for (std::size_t k = 0; k < j; ++k) {
          const double c = product(basis_[k], left);
          upper_[k][j] += c;
          add(left, -c, basis_[k]);
        }
      upper_[j][j] = std::sqrt(product(left, left));
      for (std::size_t i = 0; i < 6; ++i) basis_[j][i] = left[i] / upper_[j][j];
    }
  }
  std::array<Motion, 6> basis_{}, upper_{};
};

constexpr int most_changes = 200;
constexpr std::uint32_t no_side = std::numeric_limits<std::uint32_t>::max();

std::uint32_t most_violated(std::span<const KeptMotions> sides, const Motion& x, double tolerance) {
  double worst = tolerance;
  std::uint32_t found = no_side;
  for (std::uint32_t k = 0; k < sides.size(); ++k) {
    const double miss = sides[k].offset - product(sides[k].row, x);
    if (miss > worst) worst = miss, found = k;
  }
  return found;
}

/// Adds a violated half space to those that hold x, and moves x onto its border. Those whose weight would become
/// negative are dropped on the way. False if no motion is in all of them.
bool hold(std::span<const KeptMotions> sides, std::uint32_t added, HeldRows& held, Motion& x, int& changes) {
  constexpr double parallel = 1e-14;  // a squared sine of the angle to the span of the held rows
  const KeptMotions& side = sides[added];
  double weight = 0;
  while (++changes < most_changes) {
    std::array<double, 6> share{};
    Motion rest{};
    held.split(sides, side.row, share, rest);
    const double squared = product(rest, rest);
    const bool moves = held.size < 6 && squared > parallel * product(side.row, side.row);
    std::size_t place = held.size;
    double step =
        moves ? std::max(0.0, side.offset - product(side.row, x)) / squared : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < held.size; ++k)
      if (share[k] > 0 && held.weight[k] / share[k] < step) step = held.weight[k] / share[k], place = k;
    if (step == std::numeric_limits<double>::infinity()) return false;
    if (moves) add(x, step, rest);
    for (std::size_t k = 0; k < held.size; ++k) held.weight[k] = std::max(0.0, held.weight[k] - step * share[k]);
    weight += step;
    if (place == held.size) {
      held.push(added, weight);
      return true;
    }
    held.drop(place);
  }
  return false;
}

}  // namespace

NearestMotion nearest_motion(const Motion& goal, std::span<const KeptMotions> sides, double tolerance) {
  NearestMotion result;
  result.motion = goal;
  HeldRows held;
  for (int changes = 0;;) {
    const std::uint32_t violated = most_violated(sides, result.motion, tolerance);
    if (violated == no_side) break;
    if (!hold(sides, violated, held, result.motion, changes)) {
      NearestMotion impossible;
      impossible.motion = goal, impossible.exists = false;
      return impossible;
    }
  }
  result.active_count = held.size;
  result.active = held.side, result.weight = held.weight;
  return result;
}

}  // namespace morula::detail

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/collide/moving_spheres.hpp>
#include <stdexcept>
#include <vector>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double no_touch = std::numeric_limits<double>::infinity();

struct MovingSphere {
  const Sphere &start, &end;
};

// The time before which two moving spheres, each `margin` / 2 wider, do not touch: 0 to 1, or never.
//
// With x(t) the vector between the centers and R(t) the sum of radii and margin, both linear, and n a unit vector, the
// gap |x(t)| - R(t) is at least h(t) = n x(t) - R(t), which is linear: h(0) = h0, h(1) = h1. It is above 0 up to its
// zero, if that is where it falls, and beyond it, if that is where it rises. Each n is that of x at the time up to
// which the gap is proven, so that h is largest there. The gap is convex in t: the zeros of falling h approach its
// first zero from below, with twice as many digits each time; a rising h means that none follows.
//
// Let u = 2^-53, A a bound of all |coordinates|, S = A + R0 + R1. Rounding moves x(0) and x(1) by u 2 A per coordinate,
// R by 2.1 u S, and n x by 3.1 u 3.5 A; |n| exceeds 1 by less than 4 u; vertices that are computed at time t are off by
// 8.9 u (A + R) in each body. Together below 50 u S: allowed 2^-46 S = 128 u S.
double first_touch(const MovingSphere& a, const MovingSphere& b, double margin) {
  const Vec3 x0 = b.start.center - a.start.center, x1 = b.end.center - a.end.center;
  double r0 = a.start.radius + b.start.radius + margin, r1 = a.end.radius + b.end.radius + margin;
  const double largest =
      std::max({max_norm(a.start.center), max_norm(b.start.center), max_norm(a.end.center), max_norm(b.end.center)});
  // mutant touch-rounding: `0x1p-46 *` -> `0 *`
  const double allowed = 0x1p-46 * (largest + r0 + r1);
  r0 += allowed, r1 += allowed;
  double t = 0;
  for (int directions = 0; directions < 16; ++directions) {
    const Vec3 x = x0 + t * (x1 - x0);
    const double apart = length(x);
    // Below 2^-500 squares vanish, and the direction with them.
    if (!(apart > 0x1p-500)) return t;
    const Vec3 n = x / apart;
    const double h0 = dot(n, x0) - r0, h1 = dot(n, x1) - r1;
    if (h1 > 0) {
      // mutant touch-rising: `h0 > 0 || -h0 * (1 + 0x1p-50) < t * (h1 - h0)` -> `true`
      return h0 > 0 || -h0 * (1 + 0x1p-50) < t * (h1 - h0) ? no_touch : t;
    }
    if (!(h0 > 0)) return t;
    // mutant touch-zero: `(1 - 0x1p-50)` -> `(1 + 0x1p-20)`
    const double zero = std::min(1.0, h0 / (h0 - h1) * (1 - 0x1p-50));
    if (zero <= t + 0x1p-40) return std::max(t, zero);
    t = zero;
  }
  return t;
}

struct MovingPair {
  double time;
  std::uint32_t a, b;
};
// The order of a heap with the earliest pair on top; of equal ones that farther down, so that a search among pairs that
// touch already ends soon.
bool touches_later(const MovingPair& x, const MovingPair& y) {
  if (x.time != y.time) return x.time > y.time;
  const std::uint64_t sum_x = std::uint64_t{x.a} + x.b, sum_y = std::uint64_t{y.a} + y.b;
  return sum_x != sum_y ? sum_x < sum_y : x.a < y.a;
}

}  // namespace

struct EarliestTouchQuery::State {
  std::vector<MovingPair> waiting;  // a heap
};

EarliestTouchQuery::EarliestTouchQuery() : state_(std::make_unique<State>()) {}
EarliestTouchQuery::~EarliestTouchQuery() = default;
EarliestTouchQuery::EarliestTouchQuery(EarliestTouchQuery&&) noexcept = default;
EarliestTouchQuery& EarliestTouchQuery::operator=(EarliestTouchQuery&&) noexcept = default;

EarliestTouch EarliestTouchQuery::run(const MovingSpheres& a, const MovingSpheres& b,
                                      const EarliestTouchOptions& options) {
  const StandardFloats standard;
  EarliestTouch answer;
  if (a.size() == 0 || b.size() == 0) {
    answer.status = {Status::Code::body_not_current, static_cast<std::uint8_t>(a.size() == 0 ? 0 : 1)};
    return answer;
  }
  if (!(options.distance >= 0 && std::isfinite(options.distance)) || options.budget.is_time() ||
      options.budget.tests() < 0) {
    answer.status = {Status::Code::bad_option};
    return answer;
  }
  answer.certified = a.covers() && b.covers();
  const double margin = options.distance + a.wider_ + b.wider_;
  const std::size_t most = options.budget.is_tests() ? static_cast<std::size_t>(options.budget.tests())
                                                     : std::numeric_limits<std::size_t>::max();
  std::vector<MovingPair>& waiting = state_->waiting;
  waiting.clear();
  // Children own parts of what their parents own: a time for the parents holds for them.
  const auto push = [&](std::uint32_t node_a, std::uint32_t node_b, double inherited) {
    ++answer.sphere_tests;
    const double time = std::max(
        inherited, first_touch({a.start_[node_a], a.end_[node_a]}, {b.start_[node_b], b.end_[node_b]}, margin));
    if (time == no_touch) return;
    waiting.push_back({time, node_a, node_b});
    std::push_heap(waiting.begin(), waiting.end(), touches_later);
  };
  const SphereTree &tree_a = a.tree(), &tree_b = b.tree();
  push(0, 0, 0);
  while (!waiting.empty()) {
    check_interrupt();
    const MovingPair first = waiting.front();
    const bool both = tree_a.is_leaf(first.a) && tree_b.is_leaf(first.b);
    if (both || answer.sphere_tests >= most) {
      answer.time = first.time;
      answer.nodes = {first.a, first.b};
      answer.complete = both;
      return answer;
    }
    std::pop_heap(waiting.begin(), waiting.end(), touches_later);
    waiting.pop_back();
    const double size_a = std::max(a.start_[first.a].radius, a.end_[first.a].radius);
    const double size_b = std::max(b.start_[first.b].radius, b.end_[first.b].radius);
    if (!tree_a.is_leaf(first.a) && (tree_b.is_leaf(first.b) || size_a >= size_b)) {
      const std::uint32_t child = tree_a.first_child[first.a];
      for (std::uint32_t k = 0; k < tree_a.child_count[first.a]; ++k) push(child + k, first.b, first.time);
    } else {
      const std::uint32_t child = tree_b.first_child[first.b];
      for (std::uint32_t k = 0; k < tree_b.child_count[first.b]; ++k) push(first.a, child + k, first.time);
    }
  }
  answer.time = 1;
  answer.apart = answer.complete = true;
  return answer;
}

EarliestTouch earliest_touch(const MovingSpheres& a, const MovingSpheres& b, const EarliestTouchOptions& options) {
  EarliestTouch answer = EarliestTouchQuery().run(a, b, options);
  if (!answer.status) throw std::invalid_argument(message(answer.status));
  return answer;
}

}  // namespace morula

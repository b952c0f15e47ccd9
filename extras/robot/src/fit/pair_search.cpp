// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/pair_search.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <numbers>

namespace morula::robot {

namespace {

/// The largest distance of a joint from its present value, in the form that a ball needs.
struct Sweep {
  Vec3 point, axis;
  bool slides = false, half_turn = false;  // half_turn: any point of the circle is possible
  double travel = 0;                       // of a slide
  SinCos angle{};
  std::size_t coordinate = 0;
};

/// The ball around all places of a ball.
Sphere swept(const Sphere& ball, const Sweep& by) {
  // mutant robot-pairs-slide: `by.travel` -> `0.97 * by.travel`
  if (by.slides) return {ball.center, ball.radius + by.travel};
  const double squared = squared_length(by.axis);
  const Vec3 foot = by.point + (dot(ball.center - by.point, by.axis) / squared) * by.axis, arm = ball.center - foot;
  // mutant robot-pairs-circle: `length` -> `0.97 * length`
  if (by.half_turn) return {foot, ball.radius + length(arm)};
  // mutant robot-pairs-arc: `by.angle.sin` -> `0.97 * by.angle.sin`
  return {foot + by.angle.cos * arm, ball.radius + by.angle.sin * length(arm)};
}

Sphere swept(Sphere ball, std::span<const Sweep> sweeps) {
  for (const Sweep& by : sweeps) ball = swept(ball, by);
  return ball;
}

/// A link's nodes with their balls, made on first use.
class SweptGroup {
 public:
  explicit SweptGroup(const SphereGroup& group)
      : group_(group), balls_(group.nodes.size()), made_(group.nodes.size()) {}

  void begin(const RigidTransform& at, std::span<const Sweep> sweeps) {
    at_ = at;
    sweeps_ = sweeps;
    ++now_;
  }
  const Sphere& ball(std::uint32_t node) {
    if (made_[node] != now_) {
      const Sphere& s = group_.nodes[node].sphere;
      balls_[node] = swept(Sphere{at_(s.center), s.radius}, sweeps_);
      made_[node] = now_;
    }
    return balls_[node];
  }
  const SphereGroup::Node& node(std::uint32_t index) const { return group_.nodes[index]; }

 private:
  const SphereGroup& group_;
  std::vector<Sphere> balls_;
  std::vector<std::size_t> made_;
  std::size_t now_ = 0;
  RigidTransform at_{};
  std::span<const Sweep> sweeps_;
};

struct JointBox {
  std::vector<CoordinateRange> sides;
  double share = 1;  // of all configurations
};

class Prover {
 public:
  explicit Prover(const LinkPair& pair)
      : pair_(pair), swept_a_(pair.a), swept_b_(pair.b), values_(pair.chain.coordinates.size()) {
    // mutant robot-pairs-rounding: `0x1p-33` -> `0`
    constexpr double rounding = 0x1p-33;
    allowance_ = rounding * (reach_of(pair.chain, pair.ranges) + pair.a.extent + pair.b.extent);
  }

  Verdict run(std::size_t boxes, const StopToken& stop) {
    // The proven share gives an estimate of the number of boxes that the rest will take.
    constexpr std::size_t before_guessing = 1000;
    JointBox all;
    for (const std::size_t c : pair_.chain.coordinates) all.sides.push_back(pair_.ranges.coordinates[c]);
    std::vector<JointBox> waiting{all};
    double proven = 0;
    for (std::size_t done = 1; !waiting.empty(); ++done) {
      if (done > boxes || stop.stop_requested()) return Verdict::undecided;
      if (done > before_guessing && static_cast<double>(done) > static_cast<double>(boxes) * proven) {
        return Verdict::undecided;
      }
      JointBox box = std::move(waiting.back());
      waiting.pop_back();
      center_at(box);
      if (is_apart()) {
        proven += box.share;
        continue;
      }
      if (meets_at_center()) return Verdict::meet;
      if (widest_ == values_.size()) return Verdict::undecided;  // no coordinate is left to divide
      box.share /= 2;
      const double middle = values_[widest_];
      waiting.push_back(box);
      waiting.back().sides[widest_].lower = middle;
      box.sides[widest_].upper = middle;
      waiting.push_back(std::move(box));
    }
    return Verdict::apart;
  }

 private:
  /// The sweep of a joint over the box.
  Sweep sweep_of(const PlacedJoint& placed, const JointBox& box) const {
    const ChainJoint& joint = *placed.joint;
    const CoordinateRange& side = box.sides[joint.coordinate];
    // The half width reaches from the middle to the farther end, for any rounding.
    const double middle = values_[joint.coordinate], half = std::max(side.upper - middle, middle - side.lower);
    Sweep sweep{.point = placed.point, .axis = placed.axis, .slides = joint.slides};
    sweep.coordinate = joint.coordinate;
    const double by = std::abs(joint.factor) * half;
    if (joint.slides) {
      sweep.travel = by * length(joint.axis);
    } else {
      // mutant robot-pairs-half-turn: `pi / 2` -> `pi`
      sweep.half_turn = by >= std::numbers::pi / 2;
      if (!sweep.half_turn) sweep.angle = sin_cos(by);
    }
    return sweep;
  }

  /// Poses and sweeps of a box; cuts the chain where the balls around the whole links are farthest apart.
  void center_at(const JointBox& box) {
    for (std::size_t c = 0; c < values_.size(); ++c) values_[c] = 0.5 * box.sides[c].lower + 0.5 * box.sides[c].upper;
    at_b_ = place(pair_.chain.b, values_, placed_b_);
    at_a_ = place(pair_.chain.a, values_, placed_a_);
    // In the order of the chain, from b to a; those of a's side are applied backwards.
    from_b_.clear();
    for (auto joint = placed_b_.rbegin(); joint != placed_b_.rend(); ++joint) from_b_.push_back(sweep_of(*joint, box));
    for (const PlacedJoint& joint : placed_a_) from_b_.push_back(sweep_of(joint, box));
    from_a_.assign(from_b_.rbegin(), from_b_.rend());
    const std::size_t count = from_b_.size();
    const auto root = [](const SphereGroup& group, const RigidTransform& at) {
      return Sphere{at(group.nodes[0].sphere.center), group.nodes[0].sphere.radius};
    };
    // balls[k]: after k joints from its own end.
    balls_a_.assign(1, root(pair_.a, at_a_));
    balls_b_.assign(1, root(pair_.b, at_b_));
    for (std::size_t k = 0; k < count; ++k) {
      balls_a_.push_back(swept(balls_a_.back(), from_a_[k]));
      balls_b_.push_back(swept(balls_b_.back(), from_b_[k]));
    }
    std::size_t best = 0;  // joints of b's side
    double widest_gap = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k <= count; ++k) {
      const Sphere &of_a = balls_a_[count - k], &of_b = balls_b_[k];
      const double gap = distance(of_a.center, of_b.center) - of_a.radius - of_b.radius;
      if (gap > widest_gap) widest_gap = gap, best = k;
    }
    choose_widest(box, best);
    swept_a_.begin(at_a_, std::span(from_a_).first(count - best));
    swept_b_.begin(at_b_, std::span(from_b_).first(best));
  }

  /// The coordinate whose joints make the balls grow most.
  void choose_widest(const JointBox& box, std::size_t of_b) {
    growth_.assign(values_.size(), 0.0);
    for (std::size_t k = 0; k < of_b; ++k) {
      growth_[from_b_[k].coordinate] += balls_b_[k + 1].radius - balls_b_[k].radius;
    }
    for (std::size_t k = 0; k + of_b < from_a_.size(); ++k) {
      growth_[from_a_[k].coordinate] += balls_a_[k + 1].radius - balls_a_[k].radius;
    }
    widest_ = values_.size();
    for (std::size_t c = 0; c < values_.size(); ++c) {
      const bool divides = box.sides[c].lower < values_[c] && values_[c] < box.sides[c].upper;
      if (divides && (widest_ == values_.size() || growth_[c] > growth_[widest_])) widest_ = c;
    }
  }

  bool are_apart(const Sphere& a, const Sphere& b) const {
    return distance(a.center, b.center) > a.radius + b.radius + allowance_;
  }

  bool is_apart() { return is_apart(0, 0); }
  bool is_apart(std::uint32_t m, std::uint32_t n) {
    if (are_apart(swept_a_.ball(m), swept_b_.ball(n))) return true;
    const SphereGroup::Node &p = swept_a_.node(m), &q = swept_b_.node(n);
    if (p.child_count == 0 && q.child_count == 0) return false;
    const bool first = q.child_count == 0 || (p.child_count != 0 && p.sphere.radius >= q.sphere.radius);
    const SphereGroup::Node& divided = first ? p : q;
    for (std::uint32_t c = divided.first_child; c < divided.first_child + divided.child_count; ++c) {
      if (!(first ? is_apart(c, n) : is_apart(m, c))) return false;
    }
    return true;
  }

  bool meets_at_center() const {
    std::size_t tests = 0;
    return groups_meet(pair_.a, at_a_, pair_.b, at_b_, tests);
  }

  const LinkPair& pair_;
  SweptGroup swept_a_, swept_b_;
  double allowance_ = 0;
  // By coordinate of the present box.
  std::vector<double> values_, growth_;
  RigidTransform at_a_{}, at_b_{};
  std::vector<PlacedJoint> placed_a_, placed_b_;
  std::vector<Sweep> from_a_, from_b_;
  std::vector<Sphere> balls_a_, balls_b_;
  std::size_t widest_ = 0;
};

class Descent {
 public:
  explicit Descent(const LinkPair& pair) : pair_(pair) {
    for (const std::size_t c : pair.chain.coordinates) sides_.push_back(pair.ranges.coordinates[c]);
  }

  bool run(Random& random, const StopToken& stop) {
    constexpr std::size_t draws = 96, starts = 12, finalists = 2;
    constexpr int few_steps = 40, many_steps = 400;
    std::vector<std::pair<double, std::vector<double>>> drawn(draws);
    for (auto& [distance, values] : drawn) {
      for (const CoordinateRange& side : sides_) values.push_back(random.uniform(side.lower, side.upper));
      distance = at(values).distance;
      if (distance <= 0) return true;
    }
    std::partial_sort(drawn.begin(), drawn.begin() + starts, drawn.end());
    for (std::size_t i = 0; i < starts && !stop.stop_requested(); ++i) {
      if (goes_down(drawn[i].first, drawn[i].second, few_steps)) return true;
    }
    // The nearest ones are continued: where a chain is nearly straight, the last way is long.
    std::partial_sort(drawn.begin(), drawn.begin() + finalists, drawn.begin() + starts);
    for (std::size_t i = 0; i < finalists && !stop.stop_requested(); ++i) {
      if (goes_down(drawn[i].first, drawn[i].second, many_steps)) return true;
    }
    return false;
  }

 private:
  NearestSpheres at(const std::vector<double>& values) {
    const RigidTransform a = place(pair_.chain.a, values, placed_a_), b = place(pair_.chain.b, values, placed_b_);
    return nearest_spheres(pair_.a, a, pair_.b, b);
  }

  /// The derivative of the distance by each coordinate, while the same two spheres stay nearest.
  std::vector<double> slope(const NearestSpheres& nearest) const {
    std::vector<double> result(sides_.size(), 0.0);
    const double between = distance(nearest.a, nearest.b);
    if (!(between > 0)) return result;
    const Vec3 direction = (nearest.a - nearest.b) / between;
    const auto add = [&](const std::vector<PlacedJoint>& placed, const Vec3& point, double sign) {
      for (const PlacedJoint& joint : placed) {
        const Vec3 moves = joint.joint->slides ? joint.axis : cross(joint.axis, point - joint.point);
        result[joint.joint->coordinate] += sign * joint.joint->factor * dot(direction, moves);
      }
    };
    add(placed_a_, nearest.a, 1);
    add(placed_b_, nearest.b, -1);
    return result;
  }

  /// Newton's steps towards distance 0 within the ranges, halved if they do not help. Writes the values and the
  /// distance reached; returns true if the spheres meet.
  bool goes_down(double& reached, std::vector<double>& values, int most_steps) {
    constexpr double least_step = 1e-6;
    NearestSpheres nearest = at(values);
    double step = 1;
    for (int i = 0; i < most_steps && step > least_step; ++i) {
      at(values);  // places the joints
      std::vector<double> way = slope(nearest);
      double squared = 0;
      for (std::size_t c = 0; c < way.size(); ++c) {
        const bool is_stuck = way[c] > 0 ? values[c] <= sides_[c].lower : values[c] >= sides_[c].upper;
        if (is_stuck) way[c] = 0;
        squared += way[c] * way[c];
      }
      if (!(squared > 0)) return false;
      std::vector<double> next = values;
      for (std::size_t c = 0; c < way.size(); ++c) {
        const double most = 0.25 * (sides_[c].upper - sides_[c].lower);
        const double by = std::clamp(step * 1.1 * nearest.distance * way[c] / squared, -most, most);
        next[c] = std::clamp(values[c] - by, sides_[c].lower, sides_[c].upper);
      }
      const NearestSpheres there = at(next);
      if (there.distance <= 0) return true;
      if (there.distance < nearest.distance) {
        values = std::move(next);
        nearest = there;
        reached = there.distance;
        step = std::min(1.0, 1.5 * step);
      } else {
        step /= 2;
      }
    }
    return false;
  }

  const LinkPair& pair_;
  std::vector<CoordinateRange> sides_;
  std::vector<PlacedJoint> placed_a_, placed_b_;
};

}  // namespace

Verdict prove_apart(const LinkPair& pair, std::size_t boxes, const StopToken& stop) {
  return Prover(pair).run(boxes, stop);
}

bool descend_to_contact(const LinkPair& pair, std::uint64_t seed, const StopToken& stop) {
  if (pair.chain.coordinates.empty()) return false;
  Random random(seed);
  return Descent(pair).run(random, stop);
}

}  // namespace morula::robot

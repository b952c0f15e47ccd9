// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Edges of random robots, against places of all spheres at many times of each edge. The places come from Rodrigues'
// formula in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <support/meshes.hpp>

#include "moving_robots.hpp"
#include "plan/motion_bounds.hpp"
#include "random_poses.hpp"

namespace morula::test {
namespace {

using robot::MotionResult;
using robot::MotionVerdict;
using robot::ObstacleBox;
using Kind = robot::Joint::Kind;
using Number = long double;
using Point = std::array<Number, 3>;

Point plus(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Point exact(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Point turned(const RigidTransform& at, const Point& p) {
  Point result{};
  for (std::size_t i = 0; i < 3; ++i) result[i] = at.rows[i].x * p[0] + at.rows[i].y * p[1] + at.rows[i].z * p[2];
  return result;
}
/// Turns about a unit axis.
struct Turn {
  Point axis;
  Number cosine, sine;
  Turn(const Point& a, Number angle) : axis(a), cosine(std::cos(angle)), sine(std::sin(angle)) {}
  Point operator()(const Point& p) const {
    const Point& a = axis;
    const Number along = a[0] * p[0] + a[1] * p[1] + a[2] * p[2];
    const Point side{a[1] * p[2] - a[2] * p[1], a[2] * p[0] - a[0] * p[2], a[0] * p[1] - a[1] * p[0]};
    Point result{};
    for (std::size_t i = 0; i < 3; ++i) result[i] = cosine * p[i] + sine * side[i] + (1 - cosine) * along * a[i];
    return result;
  }
};
Number far(const Point& a, const Point& b) {
  return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/// A joint's value is factor × that of coordinate + offset.
struct Drive {
  std::size_t coordinate;
  Number factor, offset;
};
Drive drive_of(const robot::Robot& robot, std::size_t joint) {
  const robot::Joint::Mimic mimic = robot.joints[joint].mimic.value_or(robot::Joint::Mimic{.joint = joint});
  const auto& own = robot.independent_joints;
  const auto leader = std::find(own.begin(), own.end(), mimic.joint) - own.begin();
  return {static_cast<std::size_t>(leader), mimic.multiplier, mimic.offset};
}

/// A link's axes and origin in the world.
struct Placed {
  std::array<Point, 3> axes;
  Point origin;
  Point direction(const Point& p) const {
    Point result{};
    for (std::size_t i = 0; i < 3; ++i) result[i] = axes[0][i] * p[0] + axes[1][i] * p[1] + axes[2][i] * p[2];
    return result;
  }
  Point operator()(const Point& p) const { return plus(direction(p), origin); }
};
/// All links, each after its parent.
std::vector<Placed> place(const MovingRobot& moving, const std::vector<Number>& values) {
  constexpr std::array<Point, 3> units{Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}};
  std::vector<Placed> placed(moving.robot.links.size());
  for (std::size_t i = 0; i < 3; ++i) placed[0].axes[i] = turned(moving.base, units[i]);
  placed[0].origin = exact(moving.base.translation);
  for (const std::size_t j : moving.robot.order) {
    const robot::Joint& joint = moving.robot.joints[j];
    const Placed& parent = placed[joint.parent];
    const Drive drive = drive_of(moving.robot, j);
    const Number value = drive.factor * values[drive.coordinate] + drive.offset;
    const bool slides = joint.kind == Kind::prismatic;
    const Point axis = exact(joint.axis);
    const Turn turn(axis, slides ? 0 : value);
    Placed& own = placed[joint.child];
    for (std::size_t i = 0; i < 3; ++i) own.axes[i] = parent.direction(turned(joint.origin, turn(units[i])));
    const Number way = slides ? value : 0;
    const Point moved = turned(joint.origin, {axis[0] * way, axis[1] * way, axis[2] * way});
    own.origin = parent(plus(moved, exact(joint.origin.translation)));
  }
  return placed;
}
Point place(const MovingRobot& moving, std::size_t link, const Vec3& p, const std::vector<Number>& values) {
  return place(moving, values)[link](exact(p));
}

struct Scene {
  std::vector<Sphere> balls;
  std::vector<ObstacleBox> boxes;
  bool is_mesh = false;  // the first box
  robot::World world() const {
    robot::World world;
    for (const Sphere& ball : balls) world.add(ball);
    for (const ObstacleBox& box : boxes) {
      if (is_mesh && &box == boxes.data())
        world.add(box_mesh(Vec3{} - box.half, box.half), box.pose);
      else
        world.add(box);
    }
    return world;
  }
};

Number distance_of(const ObstacleBox& box, const Point& p) {
  const Point from{p[0] - box.pose.translation.x, p[1] - box.pose.translation.y, p[2] - box.pose.translation.z};
  Number squared = 0;
  for (int k = 0; k < 3; ++k) {
    Number local = 0;
    for (std::size_t i = 0; i < 3; ++i) local += box.pose.rows[i][k] * from[i];
    const Number beyond = std::max(Number{0}, std::abs(local) - box.half[k]);
    squared += beyond * beyond;
  }
  return std::sqrt(squared);
}

struct Ball {
  std::size_t link;
  Point center;  // in the link
  Number radius, speed;
};
/// All spheres. speed: at least how far the center moves along the edge. A joint carries no point farther from its axis
/// than all lengths between it and the point together. Axes have length 1 here.
std::vector<Ball> balls_of(const MovingRobot& moving, const std::vector<double>& from, const std::vector<double>& to) {
  std::vector<Ball> balls;
  for (const robot::LinkSpheres& link : moving.spheres.links) {
    for (const Sphere& s : link.spheres) {
      Number reach = length(s.center), speed = 0;
      for (std::size_t j = moving.robot.links[link.link].joint; j != robot::none;
           j = moving.robot.links[moving.robot.joints[j].parent].joint) {
        const robot::Joint& joint = moving.robot.joints[j];
        const Drive drive = drive_of(moving.robot, j);
        const Number start = from[drive.coordinate], end = to[drive.coordinate],
                     change = std::abs(drive.factor * (end - start));
        if (joint.kind == Kind::prismatic) {
          speed += change;
          reach += std::abs(drive.factor) * std::max(std::abs(start), std::abs(end)) + std::abs(drive.offset);
        } else {
          speed += change * reach;
        }
        reach += length(joint.origin.translation);
      }
      balls.push_back({link.link, exact(s.center), s.radius, speed});
    }
  }
  return balls;
}

struct Gap {
  Number least = 1e30L;  // of the robot from the scene and from itself; boxes that hold a center have distance 0
  Number room = 1;       // earlier and later by less there is no contact
  void add(Number gap, Number speed) {
    least = std::min(least, gap);
    if (gap < room * speed) room = std::max(Number{0}, gap / speed);
  }
};
Gap gap_at(const MovingRobot& moving, const Scene& scene, const std::vector<Ball>& balls,
           const std::vector<Number>& values) {
  const std::vector<Placed> links = place(moving, values);
  std::vector<Point> centers;
  for (const Ball& ball : balls) centers.push_back(links[ball.link](ball.center));
  Gap gap;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Ball& a = balls[i];
    for (const Sphere& ball : scene.balls)
      gap.add(far(centers[i], exact(ball.center)) - a.radius - ball.radius, a.speed);
    for (const ObstacleBox& box : scene.boxes) gap.add(distance_of(box, centers[i]) - a.radius, a.speed);
    for (std::size_t k = 0; k < balls.size(); ++k) {
      const Ball& b = balls[k];
      const bool ignored = std::any_of(moving.self.ignored.begin(), moving.self.ignored.end(),
                                       [&](const auto& pair) { return pair.a == a.link && pair.b == b.link; });
      if (a.link < b.link && !ignored) gap.add(far(centers[i], centers[k]) - a.radius - b.radius, a.speed + b.speed);
    }
  }
  return gap;
}

Vec3 random_axis(Random& random) {
  const Vec3 v = random_point(random, 1);
  return v / length(v);
}

MovingRobot random_robot(Random& random, bool plain_origins) {
  MovingRobot moving;
  const int joints = 2 + static_cast<int>(random.uniform(0, 5));
  for (int j = 0; j < joints; ++j) {
    const std::size_t parent = random.uniform() < 0.8 ? moving.robot.links.size() - 1 : 0;
    const Kind kind = random.uniform() < 0.75 ? Kind::revolute : Kind::prismatic;
    std::vector<Sphere> spheres;
    const int count = static_cast<int>(random.uniform(1, 8));
    for (int i = 0; i < count; ++i) spheres.push_back({random_point(random, 0.12), random.uniform(0.01, 0.06)});
    RigidTransform origin{.translation = random_point(random, 0.3)};
    if (!plain_origins)
      origin = RigidTransform::from_axis(random_axis(random), random.uniform(-3, 3), origin.translation);
    moving.add(parent, kind, random_axis(random), origin, spheres);
    moving.self.ignored.push_back({parent, moving.robot.links.size() - 1, robot::IgnoreReason::adjacent});
  }
  if (joints > 3) {
    moving.robot.joints[2].mimic = robot::Joint::Mimic{.joint = 0, .multiplier = random.uniform(-2, 2), .offset = 0.1};
    std::erase(moving.robot.independent_joints, std::size_t{2});
  }
  if (!plain_origins) moving.base = RigidTransform::from_axis(random_axis(random), 1, random_point(random, 0.5));
  return moving;
}

Scene random_scene(Random& random) {
  Scene scene;
  for (int i = 0; i < 4; ++i) scene.balls.push_back({random_point(random, 1.0), random.uniform(0.01, 0.15)});
  for (int i = 0; i < 4; ++i) {
    const Vec3 half{random.uniform(0.01, 0.2), random.uniform(0.01, 0.2), random.uniform(0.01, 0.2)};
    scene.boxes.push_back(
        {RigidTransform::from_axis(random_axis(random), random.uniform(-3, 3), random_point(random, 1.0)), half});
  }
  return scene;
}

std::vector<double> random_values(const MovingRobot& moving, Random& random) {
  std::vector<double> values;
  for (const std::size_t j : moving.robot.independent_joints) {
    const double range = moving.robot.joints[j].kind == Kind::prismatic ? 0.4 : 2.5;
    values.push_back(random.uniform(-range, range));
  }
  return values;
}

std::vector<Number> at_time(const std::vector<double>& from, const std::vector<double>& to, Number time) {
  std::vector<Number> values;
  for (std::size_t i = 0; i < from.size(); ++i) values.push_back(from[i] + time * (Number(to[i]) - from[i]));
  return values;
}

/// Judges random edges by times at most `step` radians apart, less those at which the gap of an earlier one leaves no
/// room for a contact. Returns how many were free, touched, and undecided.
std::array<int, 3> judge_edges(int first, int last, double step) {
  constexpr double tolerance = 1e-3;
  Random random(17);
  std::array<int, 3> seen{};
  for (int edge = 0; edge < last; ++edge) {
    const MovingRobot moving = random_robot(random, edge % 4 == 0);
    Scene scene = random_scene(random);
    scene.is_mesh = edge % 5 == 0;
    const std::vector<double> from = random_values(moving, random);
    std::vector<double> to = random_values(moving, random);
    if (edge < first) continue;
    double longest = 0;
    for (std::size_t i = 0; i < to.size(); ++i) {
      if (edge % 2 == 0) to[i] = from[i] + 0.1 * (to[i] - from[i]);
      longest = std::max(longest, std::abs(to[i] - from[i]));
    }
    MotionVerdict verdict;
    moving.query().check_motions(from, to, scene.world(), {&verdict, 1}, {.tolerance = tolerance});
    ++seen[static_cast<std::size_t>(verdict.result)];
    const std::vector<Ball> balls = balls_of(moving, from, to);
    const auto gap = [&](Number time) { return gap_at(moving, scene, balls, at_time(from, to, time)); };
    const auto samples = static_cast<int>(longest / step) + 2;
    const bool touches = verdict.result == MotionResult::touches;
    Number least = 1e30L;  // before the contact, if there is one
    for (int i = 0; i <= samples;) {
      const Number time = Number(i) / samples;
      if (touches && time >= verdict.time) break;
      const Gap now = gap(time);
      least = std::min(least, now.least);
      i += std::max(1, static_cast<int>(now.room * samples));
    }
    const Number at = gap(verdict.time).least;
    EXPECT_TRUE(verdict.result != MotionResult::free || least > 0) << edge;
    EXPECT_TRUE(!touches || at < 1e-12L) << edge;
    EXPECT_TRUE(verdict.result != MotionResult::undecided || std::abs(at) < tolerance) << edge;
    EXPECT_GT(least, -1.000001L * tolerance) << edge;
  }
  return seen;
}

void judge_and_count_edges(int edges, double step) {
  const auto [free, touched, undecided] = judge_edges(0, edges, step);
  EXPECT_GT(free, edges / 5);
  EXPECT_GT(touched, edges / 5);
  EXPECT_LT(undecided, edges / 20);
  testing::Test::RecordProperty("undecided", undecided);
}

TEST(Motions, verdicts_are_those_of_many_times_of_each_edge) {
  judge_and_count_edges(300, 2e-3);
}

TEST(Motions, a_deep_contact_is_found_where_it_begins) {
  EXPECT_EQ(judge_edges(4361, 4362, 1e-4)[1], 1);
}

TEST(NightlyMotions, ten_thousand_verdicts_are_those_of_times_close_to_each_other) {
  judge_and_count_edges(10000, 1e-4);
}

TEST(Motions, bounds_hold_for_every_sphere_and_time) {
  Random random(23);
  double error = 0, tightest = 1e9, bent = 1e9;
  for (int round = 0; round < 300; ++round) {
    const MovingRobot moving = random_robot(random, round % 2 == 0);
    const std::vector<double> from = random_values(moving, random), to = random_values(moving, random);
    const robot::ConfigurationQuery query = moving.query();
    robot::MotionVerdict verdict;
    ASSERT_NO_THROW(query.check_motions(from, to, {}, {&verdict, 1}));
    const robot::ConfigurationQuery::Model model(moving.robot, moving.spheres, moving.self);
    robot::MotionBounds bounds(*model.motions, moving.base);
    bounds.set_edge(from, to);
    const double half = std::ldexp(0.5, -static_cast<int>(random.uniform(0, 8))),
                 middle = random.uniform(half, 1 - half);
    bounds.set_part(middle, half);
    for (std::size_t group = 0; group < model.groups.size(); ++group) {
      const auto& spheres = model.groups[group];
      for (std::uint32_t number = 0; number < model.motions->nodes.size(); ++number) {
        const robot::MotionNode& node = model.motions->nodes[number];
        if (node.child_count > 0 || node.body != group) continue;
        const auto same = std::find_if(spheres.spheres.begin(), spheres.spheres.end(),
                                       [&](const Sphere& s) { return s == node.sphere; });
        ASSERT_NE(same, spheres.spheres.end()) << "links here are frames";
        const auto& placed = bounds.placed(number);
        const Point start = place(moving, spheres.link, node.sphere.center, at_time(from, to, middle));
        const double off = static_cast<double>(far(start, exact(placed.center)));
        ASSERT_LE(off, bounds.allowance());
        error = std::max(error, off / bounds.allowance());
        for (int i = -8; i <= 8; ++i) {
          const Number share = Number(i) / 8;
          const Point now = place(moving, spheres.link, node.sphere.center, at_time(from, to, middle + share * half));
          const auto moved = static_cast<double>(far(now, start));
          ASSERT_LE(moved, placed.first + bounds.allowance());
          ASSERT_LE(moved, placed.bound() + bounds.allowance());
          const Vec3 along = static_cast<double>(share) * placed.velocity;
          const auto rest = static_cast<double>(far(now, plus(start, exact(along))));
          ASSERT_LE(rest, placed.bend + bounds.allowance());
          if (i == 8 && moved > 0) tightest = std::min(tightest, placed.bound() / moved);
          if (i == 8 && rest > 1e-6) bent = std::min(bent, placed.bend / rest);
        }
      }
    }
  }
  EXPECT_GT(error, 1e-4) << "places are rounded";
  EXPECT_LT(tightest, 1.05);
  EXPECT_LT(bent, 1.5);
}

}  // namespace
}  // namespace morula::test

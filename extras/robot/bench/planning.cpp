// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Planning: collision checks of random configurations of an arm among boxes, as planners ask for them. Trees over each
// link's spheres against all spheres in a list, and against a list with a sphere around each link. Then many
// configurations in one call, among boxes and a mesh, against these trees.
#include "planning.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/robot/configurations.hpp>
#include <morula/robot/sphere_robot.hpp>
#include <numbers>

#include "scenario.hpp"

namespace morula::bench {
namespace {

using robot::Robot;
using robot::Shape;

constexpr std::size_t box_count = 12;

Shape rod(Shape::Kind kind, double radius, double length, const Vec3& at, const Vec3& axis, double angle) {
  Shape shape;
  shape.kind = kind;
  shape.radius = radius;
  shape.length = length;
  shape.origin = RigidTransform::from_axis(axis, angle, at);
  return shape;
}

Shape box(const Vec3& size, const Vec3& at) {
  Shape shape;
  shape.kind = Shape::Kind::box;
  shape.size = size;
  shape.origin.translation = at;
  return shape;
}

}  // namespace

Robot arm() {
  constexpr double right = std::numbers::pi / 2;
  constexpr Vec3 x{1, 0, 0};
  constexpr auto capsule = Shape::Kind::capsule;
  Robot robot;
  robot.name = "arm";
  const std::vector<std::vector<Shape>> shapes{
      {rod(capsule, 0.09, 0.1, {-0.03, 0, 0.1}, {0, 1, 0}, right),
       rod(Shape::Kind::cylinder, 0.08, 0.14, {0, 0, 0.07}, x, 0)},
      {rod(capsule, 0.065, 0.28, {0, 0, -0.12}, x, 0)},
      {rod(capsule, 0.065, 0.24, {0, -0.12, 0}, x, right)},
      {rod(capsule, 0.06, 0.15, {0, 0, -0.1}, x, 0), rod(capsule, 0.06, 0.06, {0.06, 0, 0}, {0, 1, 0}, right)},
      {rod(capsule, 0.06, 0.15, {-0.08, 0.08, 0}, x, right)},
      {rod(capsule, 0.06, 0.1, {0, 0, -0.26}, x, 0), rod(capsule, 0.035, 0.22, {0, 0.06, -0.12}, x, 0.1)},
      {rod(capsule, 0.055, 0.1, {0.03, 0, 0}, {0, 1, 0}, right)},
      {rod(capsule, 0.05, 0.08, {0, 0, 0.04}, x, 0)},
      {box({0.04, 0.2, 0.07}, {0, 0, 0.03}), box({0.02, 0.02, 0.06}, {0, 0.04, 0.09}),
       box({0.02, 0.02, 0.06}, {0, -0.04, 0.09})}};
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    robot::Link link;
    link.name = "link" + std::to_string(i);
    link.collision = shapes[i];
    link.joint = i == 0 ? robot::none : i - 1;
    robot.links.push_back(link);
  }
  struct Place {
    Vec3 at;
    double turn, lower, upper;
  };
  const std::vector<Place> places{{{0, 0, 0.333}, 0, -2.8973, 2.8973},
                                  {{0, 0, 0}, -right, -1.7628, 1.7628},
                                  {{0, -0.316, 0}, right, -2.8973, 2.8973},
                                  {{0.0825, 0, 0}, right, -3.0718, -0.0698},
                                  {{-0.0825, 0.384, 0}, -right, -2.8973, 2.8973},
                                  {{0, 0, 0}, right, -0.0175, 3.7525},
                                  {{0.088, 0, 0}, right, -2.8973, 2.8973},
                                  {{0, 0, 0.107}, 0, 0, 0}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    robot::Joint joint;
    joint.name = "joint" + std::to_string(i + 1);
    joint.kind = i + 1 < places.size() ? robot::Joint::Kind::revolute : robot::Joint::Kind::fixed;
    joint.parent = i, joint.child = i + 1;
    joint.origin = RigidTransform::from_axis(x, places[i].turn, places[i].at);
    joint.axis = {0, 0, 1};
    joint.lower = places[i].lower, joint.upper = places[i].upper;
    robot.joints.push_back(joint);
    robot.order.push_back(i);
    if (joint.moves()) robot.independent_joints.push_back(i);
  }
  robot.root = 0;
  return robot;
}

namespace {

/// All spheres in a list; `around`: links are looked at as a whole first.
struct Flat {
  const robot::RobotSpheres& spheres;
  std::vector<std::pair<std::size_t, std::size_t>> pairs{};
  std::vector<Sphere> around{};
  bool uses_around = false;
  std::vector<std::vector<Sphere>> moved{};
  std::vector<Sphere> whole{};

  Flat(const robot::RobotSpheres& given, const robot::SelfCollision& self, bool around_links)
      : spheres(given), uses_around(around_links), moved(given.links.size()), whole(given.links.size()) {
    for (const robot::LinkSpheres& link : given.links) around.push_back(enclosing_sphere_of_spheres(link.spheres));
    for (std::size_t a = 0; a < given.links.size(); ++a) {
      for (std::size_t b = a + 1; b < given.links.size(); ++b) {
        const bool ignored = std::any_of(self.ignored.begin(), self.ignored.end(), [&](const robot::IgnoredPair& pair) {
          return std::minmax(pair.a, pair.b) == std::minmax(given.links[a].link, given.links[b].link);
        });
        if (!ignored) pairs.emplace_back(a, b);
      }
    }
  }

  static bool meet(const Sphere& a, const Sphere& b, double more = 0) {
    const double reach = a.radius + b.radius + more;
    return squared_distance(a.center, b.center) <= reach * reach;
  }
  static bool meet(const Sphere& s, const robot::ObstacleBox& box, double more = 0) {
    const Vec3 p = box.pose.inverse_rotate(s.center - box.pose.translation);
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
      const double beyond = std::max(0.0, std::abs(p[k]) - box.half[k]);
      squared += beyond * beyond;
    }
    return squared <= (s.radius + more) * (s.radius + more);
  }

  bool collides(const std::vector<RigidTransform>& poses, const std::vector<robot::ObstacleBox>& boxes) {
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const RigidTransform& at = poses[spheres.links[i].link];
      moved[i].resize(spheres.links[i].spheres.size());
      for (std::size_t k = 0; k < moved[i].size(); ++k) {
        const Sphere& s = spheres.links[i].spheres[k];
        moved[i][k] = {at(s.center), s.radius};
      }
      whole[i] = {at(around[i].center), around[i].radius};
    }
    for (const robot::ObstacleBox& box : boxes) {
      for (std::size_t i = 0; i < moved.size(); ++i) {
        if (uses_around && !meet(whole[i], box, 1e-9)) continue;
        for (const Sphere& s : moved[i]) {
          if (meet(s, box)) return true;
        }
      }
    }
    for (const auto& [a, b] : pairs) {
      if (uses_around && !meet(whole[a], whole[b], 1e-9)) continue;
      for (const Sphere& s : moved[a]) {
        for (const Sphere& t : moved[b]) {
          if (meet(s, t)) return true;
        }
      }
    }
    return false;
  }
};

}  // namespace

std::vector<robot::ObstacleBox> boxes_around(Random& random, std::size_t count) {
  std::vector<robot::ObstacleBox> boxes;
  while (boxes.size() < count) {
    const double angle = random.uniform(-3, 3), far = random.uniform(0.45, 0.9), high = random.uniform(0.1, 1.1);
    const Vec3 half{random.uniform(0.03, 0.15), random.uniform(0.03, 0.15), random.uniform(0.03, 0.15)};
    boxes.push_back({RigidTransform::from_axis({0, 0, 1}, random.uniform(-3, 3),
                                               {far * std::cos(angle), far * std::sin(angle), high}),
                     half});
  }
  return boxes;
}

Mesh rock() {
  constexpr std::uint32_t around = 60, rings = 59;
  Mesh mesh;
  const auto add = [&](double turn, double tilt) {
    const double r = 0.25 + 0.02 * std::sin(5 * turn) * std::sin(7 * tilt) * std::sin(tilt);
    mesh.positions.push_back(
        {0.6 + r * std::sin(tilt) * std::cos(turn), r * std::sin(tilt) * std::sin(turn), 0.3 + r * std::cos(tilt)});
  };
  constexpr double pi = std::numbers::pi;
  for (std::uint32_t k = 1; k <= rings; ++k) {
    for (std::uint32_t i = 0; i < around; ++i) add(2 * pi * i / around, pi * k / (rings + 1));
  }
  add(0, 0), add(0, pi);
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t next = (i + 1) % around, last = (rings - 1) * around;
    mesh.facets.push_back({rings * around, i, next});
    mesh.facets.push_back({rings * around + 1, last + next, last + i});
    for (std::uint32_t k = 0; k + 1 < rings; ++k) {
      const std::uint32_t a = k * around;
      mesh.facets.push_back({a + i, a + around + i, a + around + next});
      mesh.facets.push_back({a + i, a + around + next, a + next});
    }
  }
  return mesh;
}

ArmAmongObstacles::ArmAmongObstacles(std::size_t configurations, const Settings& settings)
    : spheres(robot::fit_spheres(robot, {.spheres = 16}, *settings.workers)),
      self(robot::find_ignored(robot, spheres, {}, *settings.workers)) {
  Random random(8);
  boxes = boxes_around(random, 8);
  for (const robot::ObstacleBox& box : boxes) world.add(box);
  world.add(mesh);
  for (std::size_t i = 0; i < configurations; ++i) {
    for (const std::size_t j : robot.independent_joints)
      values.push_back(random.uniform(robot.joints[j].lower, robot.joints[j].upper));
  }
}

namespace {

/// One call against one configuration after the other.
Result check_in_one_call(std::size_t configurations, const Settings& settings) {
  const ArmAmongObstacles given(configurations, settings);
  const SignedDistance distance(given.mesh);
  const std::size_t coordinates = given.robot.independent_joints.size();
  const robot::ConfigurationQuery query(given.robot, given.spheres, given.self);
  robot::SphereRobot moving(given.robot, given.spheres, given.self);
  Flat list(given.spheres, given.self, false);
  std::vector<robot::ConfigurationVerdict> verdicts(configurations), own(configurations);
  Result result{.scenario = "planning", .item = "configurations", .mesh = "arm"};
  std::vector<double> one_by_one, self_seconds, self_one_by_one, kinematics;
  const auto pose_of = [&](std::size_t i) { return std::span(given.values).subspan(i * coordinates, coordinates); };
  // In turn, so that what disturbs one disturbs the others.
  for (int repeat = 0; repeat < settings.repeats; ++repeat) {
    result.seconds.push_back(seconds_of([&] { query.check(given.values, given.world, verdicts, serial_workers()); }));
    self_seconds.push_back(seconds_of([&] { query.check_self(given.values, own, serial_workers()); }));
    std::size_t hits = 0;
    one_by_one.push_back(seconds_of([&] {
      for (std::size_t i = 0; i < configurations; ++i) {
        moving.set_joint_values(pose_of(i));
        hits +=
            std::any_of(given.boxes.begin(), given.boxes.end(), [&](const auto& b) { return moving.collides(b); }) ||
            moving.self_collision();
      }
    }));
    self_one_by_one.push_back(seconds_of([&] {
      for (std::size_t i = 0; i < configurations; ++i) {
        moving.set_joint_values(pose_of(i));
        hits += moving.self_collision().has_value();
      }
    }));
    kinematics.push_back(seconds_of([&] {
      for (std::size_t i = 0; i < configurations; ++i) hits += link_poses(given.robot, pose_of(i)).size();
    }));
    result.expect(hits > 0, "nothing was done");
  }
  std::size_t wrong = 0, collide = 0, itself = 0;
  for (std::size_t i = 0; i < configurations; ++i) {
    const std::vector<RigidTransform> poses = link_poses(given.robot, pose_of(i));
    bool hit = list.collides(poses, given.boxes);
    for (std::size_t g = 0; g < list.moved.size() && !hit; ++g)
      hit = std::any_of(list.moved[g].begin(), list.moved[g].end(),
                        [&](const Sphere& s) { return distance(s.center) <= s.radius; });
    wrong += hit == verdicts[i].is_free();
    wrong += list.collides(poses, {}) == own[i].is_free();
    collide += hit, itself += !own[i].is_free();
  }
  const double checks = static_cast<double>(configurations);
  result.figures = {{"ns a check", 1e9 * median(result.seconds) / checks},
                    {"ns a check of itself", 1e9 * median(self_seconds) / checks},
                    {"ns of link_poses", 1e9 * median(kinematics) / checks},
                    {"SphereRobot with boxes alone / one call", median(one_by_one) / median(result.seconds)},
                    {"SphereRobot itself / one call", median(self_one_by_one) / median(self_seconds)},
                    {"share that collides", static_cast<double>(collide) / checks},
                    {"share that collides with itself", static_cast<double>(itself) / checks}};
  result.expect(wrong == 0, "one call and the list disagree");
  return result;
}

}  // namespace

std::vector<Result> run_planning(std::size_t configurations, const Settings& settings) {
  std::vector<Result> results;
  const Robot robot = arm();
  for (const std::size_t count : {16u, 64u}) {
    const robot::RobotSpheres spheres = robot::fit_spheres(robot, {.spheres = count}, *settings.workers);
    const robot::SelfCollision self = robot::find_ignored(robot, spheres, {}, *settings.workers);
    Random random(7);
    const std::vector<robot::ObstacleBox> boxes = boxes_around(random, box_count);
    std::vector<std::vector<RigidTransform>> poses;
    for (std::size_t i = 0; i < configurations; ++i) {
      std::vector<double> values;
      for (const std::size_t j : robot.independent_joints)
        values.push_back(random.uniform(robot.joints[j].lower, robot.joints[j].upper));
      poses.push_back(link_poses(robot, values));
    }
    robot::SphereRobot moving(robot, spheres, self);
    Flat list(spheres, self, false), links(spheres, self, true);
    std::vector<char> by_trees(configurations), by_list(configurations), by_links(configurations);
    const auto each = [&](std::vector<char>& verdicts, const auto& collides) {
      for (std::size_t i = 0; i < configurations; ++i) verdicts[i] = collides(poses[i]);
    };
    Result result{.scenario = "planning", .item = std::to_string(count) + " spheres a link", .mesh = "arm"};
    std::vector<double> list_seconds, links_seconds;
    // In turn, so that what disturbs one disturbs the others.
    for (int repeat = 0; repeat < settings.repeats; ++repeat) {
      result.seconds.push_back(seconds_of([&] {
        each(by_trees, [&](const std::vector<RigidTransform>& at) {
          moving.set_link_poses(at);
          return std::any_of(boxes.begin(), boxes.end(),
                             [&](const robot::ObstacleBox& b) { return moving.collides(b); }) ||
                 moving.self_collision().has_value();
        });
      }));
      list_seconds.push_back(seconds_of(
          [&] { each(by_list, [&](const std::vector<RigidTransform>& at) { return list.collides(at, boxes); }); }));
      links_seconds.push_back(seconds_of(
          [&] { each(by_links, [&](const std::vector<RigidTransform>& at) { return links.collides(at, boxes); }); }));
    }
    const double own = median(result.seconds), checks = static_cast<double>(configurations);
    result.figures = {
        {"spheres", static_cast<double>(spheres.sphere_count())},
        {"us a check", 1e6 * own / checks},
        {"list / trees", median(list_seconds) / own},
        {"list with link spheres / trees", median(links_seconds) / own},
        {"share that collides", static_cast<double>(std::count(by_trees.begin(), by_trees.end(), 1)) / checks}};
    result.expect(by_trees == by_list, "trees and the list disagree");
    result.expect(by_links == by_list, "links and the list disagree");
    result.expect(spheres.covered(), "a link is uncovered");
    results.push_back(std::move(result));
  }
  results.push_back(check_in_one_call(configurations, settings));
  results.push_back(run_clearance(configurations, settings));
  for (const bool is_short : {true, false}) results.push_back(run_motions(configurations, settings, is_short));
  return results;
}

}  // namespace morula::bench

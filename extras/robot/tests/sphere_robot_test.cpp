// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A robot of spheres in random configurations: every verdict against all spheres of all links, one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/sphere_robot.hpp>
#include <morula/tree/sphere_tree.hpp>

namespace morula::test {
namespace {

const std::string moving_arm = std::string(MORULA_ROBOTS) + "/arm_description/urdf/arm.urdf";

/// As a list: what a link's spheres are, without trees.
struct Flat {
  const robot::Robot& robot;
  const robot::RobotSpheres& spheres;
  const robot::SelfCollision& self;
  std::vector<RigidTransform> poses{};

  Sphere at(std::size_t place, std::size_t i) const {
    const robot::LinkSpheres& link = spheres.links[place];
    return {poses[link.link](link.spheres[i].center), link.spheres[i].radius};
  }
  template <class Meets>
  bool any(const Meets& meets) const {
    for (std::size_t place = 0; place < spheres.links.size(); ++place) {
      for (std::size_t i = 0; i < spheres.links[place].spheres.size(); ++i) {
        if (meets(at(place, i))) return true;
      }
    }
    return false;
  }
  bool is_ignored(std::size_t a, std::size_t b) const {
    return std::any_of(self.ignored.begin(), self.ignored.end(), [&](const robot::IgnoredPair& pair) {
      return (pair.a == a && pair.b == b) || (pair.a == b && pair.b == a);
    });
  }
  std::optional<std::pair<std::size_t, std::size_t>> self_collision() const {
    for (std::size_t a = 0; a < spheres.links.size(); ++a) {
      for (std::size_t b = a + 1; b < spheres.links.size(); ++b) {
        if (is_ignored(spheres.links[a].link, spheres.links[b].link)) continue;
        for (std::size_t i = 0; i < spheres.links[a].spheres.size(); ++i) {
          for (std::size_t j = 0; j < spheres.links[b].spheres.size(); ++j) {
            const Sphere p = at(a, i), q = at(b, j);
            if (squared_distance(p.center, q.center) <= (p.radius + q.radius) * (p.radius + q.radius))
              return std::pair{a, b};
          }
        }
      }
    }
    return std::nullopt;
  }
};

Vec3 point(Random& random, double reach) {
  const double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

TEST(SphereRobot, verdicts_are_those_of_every_sphere) {
  const robot::Robot read = robot::read_robot(moving_arm);
  const robot::RobotSpheres spheres = robot::fit_spheres(read, {.spheres = 24});
  // Neighbors alone are ignored, so that other links meet now and then.
  const robot::SelfCollision self = robot::find_ignored(read, spheres, {.samples = 0});
  robot::SphereRobot moving(read, spheres, self);
  Flat flat{read, spheres, self};
  EXPECT_EQ(moving.sphere_count(), spheres.sphere_count());
  Random random(11);
  std::size_t self_hits = 0, sphere_hits = 0, box_hits = 0, tree_hits = 0;
  constexpr int rounds = 400;
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> values;
    for (const std::size_t j : read.independent_joints)
      values.push_back(random.uniform(read.joints[j].lower, read.joints[j].upper));
    moving.set_joint_values(values);
    flat.poses = robot::link_poses(read, values);
    const std::vector<Sphere> posed = moving.spheres();
    EXPECT_EQ(posed.front(), flat.at(0, 0));
    EXPECT_EQ(posed.back(), flat.at(spheres.links.size() - 1, spheres.links.back().spheres.size() - 1));
    const auto expected = flat.self_collision();
    EXPECT_EQ(moving.self_collision(), expected) << round;
    self_hits += expected.has_value();
    const Sphere ball{point(random, 0.8), random.uniform(0, 0.3)};
    const bool meets_ball = flat.any([&](const Sphere& s) {
      return squared_distance(s.center, ball.center) <= (s.radius + ball.radius) * (s.radius + ball.radius);
    });
    EXPECT_EQ(moving.collides(ball), meets_ball) << round;
    sphere_hits += meets_ball;
    const Vec3 half{random.uniform(0.01, 0.2), random.uniform(0.01, 0.2), random.uniform(0.01, 0.2)};
    const robot::ObstacleBox box{RigidTransform::from_axis(point(random, 1), random.uniform(-3, 3), point(random, 0.8)),
                                 half};
    const bool meets_box = flat.any([&](const Sphere& s) {
      // The nearest point of the box, in the world.
      const RigidTransform back = inverse(box.pose);
      Vec3 p = back(s.center);
      for (int k = 0; k < 3; ++k) p[k] = std::clamp(p[k], -half[k], half[k]);
      return distance(box.pose(p), s.center) <= s.radius;
    });
    EXPECT_EQ(moving.collides(box), meets_box) << round;
    box_hits += meets_box;
    std::vector<Sphere> scene;
    for (int i = 0; i < 12; ++i) scene.push_back({point(random, 1.2), random.uniform(0.01, 0.1)});
    SphereTree tree = tree_from_spheres(scene);
    if (round % 2 == 0) make_nested(tree);
    const PosedSpheres others(tree);
    const RigidTransform at = RigidTransform::from_axis({1, 2, 3}, 0.1 * round, {0.1, 0, 0.2});
    bool meets_tree = false;
    for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
      if (!tree.is_leaf(node)) continue;
      const Sphere leaf = others.sphere_state().sphere(node);
      const Sphere moved{at(leaf.center), leaf.radius};
      meets_tree = meets_tree || flat.any([&](const Sphere& s) {
        return squared_distance(s.center, moved.center) <= (s.radius + moved.radius) * (s.radius + moved.radius);
      });
    }
    EXPECT_EQ(moving.collides(others.sphere_state(), at), meets_tree) << round;
    tree_hits += meets_tree;
  }
  for (const std::size_t hits : {self_hits, sphere_hits, box_hits, tree_hits}) {
    EXPECT_GT(hits, rounds / 50u) << "both answers come up";
    EXPECT_LT(hits, rounds - rounds / 50u);
  }
}

TEST(SphereRobot, ignored_pairs_are_never_asked_and_copies_move_apart) {
  const robot::Robot read = robot::read_robot(moving_arm);
  const robot::RobotSpheres spheres = robot::fit_spheres(read, {.spheres = 4});
  EXPECT_TRUE(robot::SphereRobot(read, spheres).self_collision()) << "neighbors touch";
  robot::SelfCollision all;
  for (std::size_t a = 0; a < read.links.size(); ++a) {
    for (std::size_t b = a + 1; b < read.links.size(); ++b) all.ignored.push_back({a, b, robot::IgnoreReason::given});
  }
  robot::SphereRobot one(read, spheres, all);
  EXPECT_FALSE(one.self_collision());
  EXPECT_EQ(one.sphere_tests(), 0u);
  robot::SphereRobot two = one;
  std::vector<double> values = robot::rest_values(read);
  values[0] = 1;
  two.set_joint_values(values);
  EXPECT_FALSE(one.spheres() == two.spheres());
  EXPECT_THROW(one.set_joint_values(std::vector{1.0}), std::invalid_argument);
  EXPECT_THROW(one.set_link_poses({}), std::invalid_argument);
}

TEST(SphereRobot, rejects_numbers_that_are_none_and_keeps_its_pose) {
  const robot::Robot robot = robot::read_robot(moving_arm);
  const robot::RobotSpheres spheres = robot::fit_spheres(robot, {.spheres = 4});
  robot::SphereRobot moving(robot, spheres);
  std::vector<double> values = robot::rest_values(robot);
  values.front() = 0.25;
  moving.set_joint_values(values);
  const std::vector<Sphere> before = moving.spheres();
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::vector<double> wrong = values;
      wrong[i] = bad;
      EXPECT_THROW(moving.set_joint_values(wrong), std::invalid_argument);
      EXPECT_THROW(static_cast<void>(robot::link_poses(robot, wrong)), std::invalid_argument);
    }
    std::vector<RigidTransform> poses = robot::link_poses(robot, values);
    poses.back().translation.y = bad;
    EXPECT_THROW(moving.set_link_poses(poses), std::invalid_argument);
    EXPECT_THROW(moving.collides(Sphere{{bad, 0, 0}, 1}), std::invalid_argument);
    EXPECT_THROW(moving.collides(Sphere{{0, 0, 0}, bad}), std::invalid_argument);
    EXPECT_THROW(moving.collides(robot::ObstacleBox{{}, {1, bad, 1}}), std::invalid_argument);
    EXPECT_THROW(moving.collides(robot::ObstacleBox{{.translation = {0, 0, bad}}, {1, 1, 1}}), std::invalid_argument);
    const PosedSpheres ball(tree_from_spheres(std::vector<Sphere>{{{0, 0, 0}, 100}}));
    EXPECT_THROW(moving.collides(ball.sphere_state(), {.translation = {bad, 0, 0}}), std::invalid_argument);
  }
  EXPECT_THROW(moving.collides(Sphere{{0, 0, 0}, -1}), std::invalid_argument);
  EXPECT_THROW(moving.collides(robot::ObstacleBox{{}, {1, 1, -1}}), std::invalid_argument);
  EXPECT_EQ(moving.spheres(), before);
  EXPECT_TRUE(moving.collides(robot::ObstacleBox{{}, {100, 100, 100}}));
}

}  // namespace
}  // namespace morula::test

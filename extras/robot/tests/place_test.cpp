// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Poses of links as planners' queries compute them, compared with link_poses(): verdicts are about the same places.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <morula/robot/configurations.hpp>

#include "plan/model.hpp"
#include "random_poses.hpp"

namespace morula::test::place_of_links {
namespace {

using robot::Joint;

std::size_t below(Random& random, std::size_t count) {
  return random.next() % count;
}

/// A pose from rotations that files often have: none, quarter turns, tiny ones, or any.
RigidTransform file_pose(Random& random, double reach) {
  const Vec3 at = below(random, 4) == 0 ? Vec3{} : random_point(random, reach);
  constexpr double quarter = 1.5707963267948966;
  switch (below(random, 4)) {
    case 0:
      return {.translation = at};
    case 1:
      return RigidTransform::from_axis({0, 0, 1}, quarter, at);
    case 2:
      return RigidTransform::from_axis({0, 1, 0}, random.uniform(-1e-12, 1e-12), at);
    default:
      return RigidTransform::from_axis(random_point(random, 1), random.uniform(-3, 3), at);
  }
}

Vec3 file_axis(Random& random) {
  switch (below(random, 6)) {
    case 0:
      return {1, 0, 0};
    case 1:
      return {0, -1, 0};
    case 2:
      return {0, 0, 1};
    case 3:
      return normalized(Vec3{random.uniform(-1, 1), 1e-170, 1e-14});
    case 4:
      return random.uniform(1e-3, 1e3) * random_point(random, 1);
    default:
      return normalized(random_point(random, 1));
  }
}

/// Link 0 carries link 1 at `base`; the others hang below link 1.
robot::Robot random_robot(Random& random, const RigidTransform& base, double reach) {
  robot::Robot made;
  const std::size_t links = 2 + below(random, 9);
  made.links.resize(links + 1);
  made.joints.push_back({.name = "base", .parent = 0, .child = 1, .origin = base});
  made.order = {0};
  for (std::size_t link = 2; link <= links; ++link) {
    constexpr std::array kinds{Joint::Kind::fixed,     Joint::Kind::revolute, Joint::Kind::continuous,
                               Joint::Kind::prismatic, Joint::Kind::floating, Joint::Kind::planar};
    Joint joint{.name = "joint",
                .kind = kinds[below(random, kinds.size())],
                .parent = 1 + below(random, link - 1),
                .child = link,
                .origin = file_pose(random, reach),
                .axis = file_axis(random)};
    const std::size_t number = made.joints.size();
    // Also joints that follow followers, and those that follow one without a value.
    if (joint.moves() && number > 1 && below(random, 3) == 0)
      joint.mimic = Joint::Mimic{1 + below(random, number - 1), random.uniform(-2, 2), random.uniform(-1, 1)};
    if (joint.moves() && !joint.mimic) made.independent_joints.push_back(number);
    made.joints.push_back(joint);
    made.order.push_back(number);
  }
  return made;
}

/// The robot without link 0: link 1 is the root.
robot::Robot without_base(const robot::Robot& whole) {
  robot::Robot made = whole;
  made.root = 1;
  made.order.erase(made.order.begin());
  return made;
}

std::vector<double> random_values(const robot::Robot& robot, Random& random) {
  std::vector<double> values;
  for (std::size_t k = 0; k < robot.independent_joints.size(); ++k)
    values.push_back(std::array{0.0, random.uniform(-3, 3), random.uniform(-1e-9, 1e-9), random.uniform(-1e4, 1e4),
                                3.141592653589793}[below(random, 5)]);
  return values;
}

/// The numbers of a pose as they lie in memory.
std::array<std::uint64_t, 12> bits(const RigidTransform& pose) {
  std::array<std::uint64_t, 12> result{};
  for (std::size_t i = 0; i < 12; ++i) {
    const double value = i < 9 ? pose.rows[i / 3][static_cast<int>(i % 3)] : pose.translation[static_cast<int>(i - 9)];
    std::memcpy(&result[i], &value, sizeof value);
  }
  return result;
}

TEST(Place, a_query_places_links_with_the_bits_of_link_poses) {
  Random random(51);
  std::size_t compared = 0, followers = 0, moving = 0;
  for (int k = 0; k < 2000; ++k) {
    const double reach = std::array{1.0, 1e-4, 1e5}[below(random, 3)];
    const RigidTransform base = below(random, 3) == 0 ? RigidTransform{} : file_pose(random, 10 * reach);
    const robot::Robot whole = random_robot(random, base, reach);
    robot::ConfigurationQuery::Model model(without_base(whole), {}, {});
    model.base = base;
    for (int pose = 0; pose < 5; ++pose) {
      const std::vector<double> values = random_values(whole, random);
      const std::vector<RigidTransform> expected = robot::link_poses(whole, values);
      std::vector<RigidTransform> placed(whole.links.size());
      model.place(values, placed);
      for (std::size_t link = 1; link < placed.size(); ++link) {
        ASSERT_EQ(bits(placed[link]), bits(expected[link])) << "robot " << k << ", link " << link;
        ++compared;
      }
    }
    for (const Joint& joint : whole.joints) followers += joint.mimic ? 1 : 0, moving += joint.moves() ? 1 : 0;
  }
  EXPECT_GT(compared, 40000u);
  EXPECT_GT(followers, 500u);
  EXPECT_GT(moving, 3000u);
}

}  // namespace
}  // namespace morula::test::place_of_links

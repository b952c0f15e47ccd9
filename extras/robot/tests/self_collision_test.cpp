// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ignored pairs of a sample robot, against configurations that are tested pair by pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/self_collision.hpp>

namespace morula::test {
namespace {

const robot::Robot arm_of_pairs = robot::read_robot(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");

/// All pairs of all spheres, nothing left out.
bool touch_anyhow(const robot::LinkSpheres& a, const robot::LinkSpheres& b, const std::vector<RigidTransform>& poses) {
  for (const Sphere& s : a.spheres) {
    for (const Sphere& t : b.spheres) {
      if (distance(poses[a.link](s.center), poses[b.link](t.center)) <= s.radius + t.radius) return true;
    }
  }
  return false;
}

TEST(SelfCollision, lists_neighbors_what_touches_at_rest_and_what_never_meets) {
  const robot::RobotSpheres fitted = robot::fit_spheres(arm_of_pairs, {.spheres = 8});
  const robot::SelfCollision found =
      robot::find_ignored(arm_of_pairs, fitted, {.samples = 300, .seed = 5, .given = {{"base", "flange"}, {"x", "y"}}});
  EXPECT_EQ(found.pairs, 21u);
  std::map<std::pair<std::size_t, std::size_t>, robot::IgnoreReason> reasons;
  for (const robot::IgnoredPair& pair : found.ignored) {
    EXPECT_LT(pair.a, pair.b);
    EXPECT_TRUE(reasons.emplace(std::pair(pair.a, pair.b), pair.reason).second) << "no pair twice";
  }
  const auto reason = [&](const char* a, const char* b) {
    const auto at = reasons.find(std::minmax(arm_of_pairs.find_link(a), arm_of_pairs.find_link(b)));
    return at == reasons.end() ? std::string_view("none") : robot::name(at->second);
  };
  EXPECT_EQ(reason("base", "flange"), "User");
  EXPECT_EQ(reason("base", "shoulder"), "Adjacent");
  EXPECT_EQ(reason("forearm", "wrist"), "Adjacent");
  // Configurations of another seed, tested without any shortcut.
  Random random(77);
  std::vector<std::vector<RigidTransform>> poses;
  for (int k = 0; k < 3000; ++k) {
    std::vector<double> values;
    for (const std::size_t joint : arm_of_pairs.independent_joints)
      values.push_back(random.uniform(arm_of_pairs.joints[joint].lower, arm_of_pairs.joints[joint].upper));
    poses.push_back(robot::link_poses(arm_of_pairs, values));
  }
  const std::vector<RigidTransform> rest = robot::link_poses(arm_of_pairs, robot::rest_values(arm_of_pairs));
  std::size_t apart = 0, tested = 0;
  for (const robot::LinkSpheres& a : fitted.links) {
    for (const robot::LinkSpheres& b : fitted.links) {
      if (a.link >= b.link) continue;
      const auto at = reasons.find({a.link, b.link});
      const bool met =
          std::any_of(poses.begin(), poses.end(), [&](const auto& pose) { return touch_anyhow(a, b, pose); });
      if (at == reasons.end()) {
        ++tested;
      } else if (at->second == robot::IgnoreReason::never || at->second == robot::IgnoreReason::apart) {
        EXPECT_FALSE(met || touch_anyhow(a, b, rest));
        ++apart;
      } else if (at->second == robot::IgnoreReason::rest) {
        EXPECT_TRUE(touch_anyhow(a, b, rest));
      }
      const bool overlapping = std::any_of(found.overlapping.begin(), found.overlapping.end(), [&](const auto& pair) {
        return pair.a == a.link && pair.b == b.link && pair.rest_distance;
      });
      EXPECT_EQ(overlapping, at == reasons.end() && touch_anyhow(a, b, rest));
    }
  }
  EXPECT_GT(tested, 0u);
  EXPECT_GT(apart, 0u);
}

TEST(SelfCollision, links_without_spheres_do_not_part_neighbors) {
  const robot::RobotSpheres fitted = robot::fit_spheres(arm_of_pairs, {.spheres = 2, .skip = {"elbow"}});
  const robot::SelfCollision found = robot::find_ignored(arm_of_pairs, fitted, {.samples = 0});
  const bool listed = std::any_of(found.ignored.begin(), found.ignored.end(), [&](const robot::IgnoredPair& pair) {
    return pair.a == arm_of_pairs.find_link("upper") && pair.b == arm_of_pairs.find_link("forearm") &&
           pair.reason == robot::IgnoreReason::adjacent;
  });
  EXPECT_TRUE(listed);
  for (const robot::IgnoredPair& pair : found.ignored) EXPECT_NE(pair.reason, robot::IgnoreReason::never);
}

}  // namespace
}  // namespace morula::test

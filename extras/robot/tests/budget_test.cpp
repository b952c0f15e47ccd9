// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Numbers of spheres of links: totals that links share, and shares by size.
#include "fit/budget.hpp"

#include <gtest/gtest.h>

#include <morula/robot/fit.hpp>

#include "expect_covered.hpp"

namespace morula::test {
namespace {

const robot::Robot arm_of_links = robot::read_robot(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");

TEST(FitSpheres, a_common_budget_is_kept_and_goes_where_it_helps) {
  for (const std::size_t total : {7, 40, 90}) {
    const robot::RobotSpheres fitted = robot::fit_spheres(arm_of_links, {.max_total = total});
    EXPECT_LE(fitted.sphere_count(), std::max<std::size_t>(total, 8))
        << "one each, and the flange has a sphere of its own";
    EXPECT_GE(fitted.sphere_count(), total * 7 / 10);
    expect_covered(fitted);
  }
  const robot::RobotSpheres shared = robot::fit_spheres(arm_of_links, {.max_total = 60});
  const robot::RobotSpheres even = robot::fit_spheres(arm_of_links, {.spheres = 60 / 7});
  const auto volume = [](const robot::RobotSpheres& fitted) {
    double sum = 0;
    for (const robot::LinkSpheres& link : fitted.links) sum += link.figures.solid.volume;
    return sum;
  };
  EXPECT_LT(volume(shared), volume(even));
}

TEST(FitSpheres, a_common_budget_includes_links_with_a_number_or_spheres_of_their_own) {
  const robot::RobotSpheres some = robot::fit_spheres(arm_of_links, {.spheres = 6, .quality = Quality::draft});
  robot::FitOptions o{.max_total = 40, .quality = Quality::draft};
  o.fixed_spheres["upper"] = some.of(arm_of_links.find_link("upper"))->spheres;
  o.link_spheres = {{"forearm", 9}};
  const robot::RobotSpheres fitted = robot::fit_spheres(arm_of_links, o);
  EXPECT_EQ(fitted.of(arm_of_links.find_link("upper"))->spheres, o.fixed_spheres["upper"]);
  EXPECT_LE(fitted.of(arm_of_links.find_link("forearm"))->spheres.size(), 9u);
  EXPECT_LE(fitted.sphere_count(), 40u);
  EXPECT_GE(fitted.sphere_count(), 28u);
  EXPECT_TRUE(fitted.notes.empty()) << fitted.notes[0];
  o.max_total = 12;
  const robot::RobotSpheres more = robot::fit_spheres(arm_of_links, o);
  EXPECT_GT(more.sphere_count(), 12u);
  ASSERT_EQ(more.notes.size(), 1u);
  EXPECT_TRUE(more.notes[0].starts_with("the robot has " + std::to_string(more.sphere_count()) +
                                        " spheres, and the largest total is 12: "))
      << more.notes[0];
}

/// A robot of boxes, one per link, which no joint carries.
robot::Robot robot_of_boxes(const std::vector<Vec3>& sizes) {
  robot::Robot made;
  made.name = "boxes";
  made.root = 0;
  for (const Vec3& size : sizes) {
    robot::Link& link = made.links.emplace_back();
    link.name = "l" + std::to_string(made.links.size());
    robot::Shape shape;
    shape.kind = robot::Shape::Kind::box;
    shape.size = size;
    link.collision = {shape};
  }
  return made;
}

std::vector<std::size_t> counts_of(const robot::RobotSpheres& fitted) {
  std::vector<std::size_t> counts;
  for (const robot::LinkSpheres& link : fitted.links) counts.push_back(link.spheres.size());
  return counts;
}

TEST(FitSpheres, by_default_the_number_follows_the_size_of_a_link) {
  // An upper arm, a small sensor, and a hand: the same at every scale and far from the links' origins.
  for (const double scale : {1e-6, 1.0, 1e6}) {
    robot::Robot made = robot_of_boxes({{0.1 * scale, 0.1 * scale, 0.5 * scale},
                                        {0.001 * scale, 0.001 * scale, 0.001 * scale},
                                        {0.05 * scale, 0.1 * scale, 0.1 * scale}});
    made.links[2].collision[0].origin.translation = {4 * scale, 0, 0};
    const robot::RobotSpheres fitted = robot::fit_spheres(made, {.quality = Quality::draft});
    const std::vector<std::size_t> counts = counts_of(fitted);
    EXPECT_EQ(counts[1], 1u);
    EXPECT_GT(counts[0], counts[2]);
    EXPECT_GT(counts[2], 4u);
    EXPECT_LE(fitted.sphere_count(), 48u);
    EXPECT_TRUE(fitted.covered());
  }
  // Links of one size have 16 each, whatever their number; a link with a number of its own leaves the others alone.
  const robot::Robot alike = robot_of_boxes({{1, 2, 3}, {3, 2, 1}, {2, 3, 1}, {1, 2, 3}});
  robot::FitOptions o{.quality = Quality::draft};
  EXPECT_EQ(counts_of(robot::fit_spheres(alike, o)), (std::vector<std::size_t>{16, 16, 16, 16}));
  o.link_spheres = {{"l2", 3}};
  EXPECT_EQ(counts_of(robot::fit_spheres(alike, o)), (std::vector<std::size_t>{16, 3, 16, 16}));
  o.skip = {"l1"};
  EXPECT_EQ(counts_of(robot::fit_spheres(alike, o)), (std::vector<std::size_t>{3, 16, 16}));
  // A number of spheres, or a largest protrusion, takes the place of sizes.
  EXPECT_EQ(counts_of(robot::fit_spheres(alike, {.spheres = 2, .quality = Quality::draft}))[0], 2u);
  const robot::FitOptions close{.max_protrusion = 0.2, .quality = Quality::draft};
  robot::FitOptions also_close = close;
  also_close.spheres = 0;
  EXPECT_EQ(counts_of(robot::fit_spheres(alike, close)), counts_of(robot::fit_spheres(alike, also_close)));
  EXPECT_GT(counts_of(robot::fit_spheres(alike, close))[0], 16u);
}

TEST(FitSpheres, by_default_links_without_extent_and_spheres_among_shapes_have_their_part) {
  robot::Robot made = robot_of_boxes({{1, 1, 1}, {1, 1, 0}, {0, 0, 0}});
  robot::Shape ball;
  ball.kind = robot::Shape::Kind::sphere;
  ball.radius = 0.1;
  made.links[0].collision.push_back(ball);
  robot::Link& only = made.links.emplace_back();
  only.name = "ball";
  only.collision = {ball};
  const robot::RobotSpheres fitted = robot::fit_spheres(made, {.quality = Quality::draft});
  EXPECT_EQ(fitted.of(3)->spheres.size(), 1u);
  EXPECT_TRUE(fitted.covered());
  EXPECT_LE(fitted.sphere_count(), 3 * 16u + 2);
}

TEST(ShareBySize, is_monotone_in_the_total_and_shares_as_the_areas_say) {
  const std::vector<robot::MeshSize> sizes{{16, 1}, {1, 2}, {1e-9, 1}, {0, 3}};
  std::vector<std::size_t> before(4, 1);
  for (std::size_t total = 0; total < 400; ++total) {
    const std::vector<std::size_t> counts = robot::share_by_size(sizes, total);
    std::size_t sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_GE(counts[i], before[i]) << total;
      sum += counts[i] * sizes[i].links;
    }
    EXPECT_LE(sum, std::max<std::size_t>(total, 7));
    before = counts;
  }
  // 16 to the power 3/4 is 8.
  EXPECT_NEAR(static_cast<double>(before[0]) / static_cast<double>(before[1]), 8, 0.3);
  EXPECT_EQ(before[2], 1u);
  EXPECT_TRUE(robot::share_by_size({}, 5).empty());
  EXPECT_EQ(robot::share_by_size(std::vector<robot::MeshSize>{{0, 1}, {0, 1}}, 6), (std::vector<std::size_t>{3, 3}));
}

}  // namespace
}  // namespace morula::test

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Edges between configurations: robots of few links whose first contact has a closed form.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/robot/configurations.hpp>
#include <numbers>
#include <stdexcept>
#include <support/meshes.hpp>

#include "moving_robots.hpp"

namespace morula::test {
namespace {

using robot::ConfigurationQuery;
using robot::MotionOptions;
using robot::MotionResult;
using robot::MotionVerdict;
using robot::ObstacleBox;
using robot::World;
using Kind = robot::Joint::Kind;

constexpr double tolerance = 1e-4;

MotionVerdict check(const MovingRobot& moving, const World& world, const std::vector<double>& from,
                    const std::vector<double>& to, const MotionOptions& options = {}) {
  MotionVerdict verdict;
  moving.query().check_motions(from, to, world, {&verdict, 1}, options);
  return verdict;
}

/// A touch at a time, or as late as the tolerance allows. speed: mesh units by which the gap shrinks along the edge.
void expect_touch(const MotionVerdict& verdict, double time, double speed) {
  EXPECT_EQ(verdict.result, MotionResult::touches);
  EXPECT_GE(verdict.time, time - 1e-12);
  EXPECT_LE(verdict.time, time + 4 * tolerance / speed);
  EXPECT_FALSE(verdict.contact.is_free());
}

/// A ball of radius 0.1 that slides along x.
MovingRobot slider() {
  MovingRobot moving;
  moving.add(0, Kind::prismatic, {1, 0, 0}, {}, {{{0, 0, 0}, 0.1}});
  return moving;
}

/// A ball of radius 0.1 that turns about z, one unit away from it.
MovingRobot bar() {
  MovingRobot moving;
  moving.add(0, Kind::revolute, {0, 0, 1}, {}, {{{1, 0, 0}, 0.1}});
  return moving;
}

World wall_at(double x) {
  World world;
  world.add(ObstacleBox{.pose = {.translation = {x + 0.5, 0, 0}}, .half = {0.5, 3, 3}});
  return world;
}

TEST(Motions, a_slider_touches_a_wall_where_it_stands) {
  const MotionVerdict verdict = check(slider(), wall_at(1), {0}, {2});
  expect_touch(verdict, 0.45, 2);
  EXPECT_EQ(verdict.contact.link, 1u);
  EXPECT_EQ(verdict.contact.obstacle, 0u);
  EXPECT_EQ(check(slider(), wall_at(1), {0}, {0.8995}).result, MotionResult::free);
  EXPECT_EQ(check(slider(), wall_at(1), {-50}, {0.8995}).result, MotionResult::free);
  EXPECT_EQ(check(slider(), wall_at(1), {0.8995}, {-3}), MotionVerdict{});
  World later = wall_at(5);
  later.add(ObstacleBox{.pose = {.translation = {1.5, 0, 0}}, .half = {0.5, 3, 3}});
  EXPECT_EQ(check(slider(), later, {0}, {8}).contact.obstacle, 1u) << "the first along the edge, not by number";
  expect_touch(check(slider(), later, {0}, {8}), 0.9 / 8, 8);
}

TEST(Motions, a_bar_touches_a_ball_where_its_chord_says) {
  World world;
  world.add(Sphere{{std::cos(1.0), std::sin(1.0), 0}, 0.1});
  const double angle = 1 - 2 * std::asin(0.1);
  expect_touch(check(bar(), world, {0}, {2}), angle / 2, 2);
  expect_touch(check(bar(), world, {0}, {-12}), (2 * std::numbers::pi - 1 - 2 * std::asin(0.1)) / 12, 12);
  EXPECT_EQ(check(bar(), world, {0}, {angle - 2e-4}).result, MotionResult::free);
  EXPECT_EQ(check(bar(), world, {1 + 2 * std::asin(0.1) + 2e-4}, {6}).result, MotionResult::free);
}

TEST(Motions, whole_turns_and_chords_hide_nothing) {
  // The middle and both ends are the same pose; the ball is on the other side.
  World world;
  world.add(Sphere{{-1, 0, 0}, 0.01});
  EXPECT_EQ(check(bar(), world, {0}, {4 * std::numbers::pi}).result, MotionResult::touches);
  EXPECT_EQ(check(bar(), world, {-2000 * std::numbers::pi}, {2000 * std::numbers::pi}).result, MotionResult::touches);
  MovingRobot itself = bar();  // the same ball on the root link
  itself.cover(0, {{{-1, 0, 0}, 0.01}});
  EXPECT_EQ(check(itself, {}, {0}, {4 * std::numbers::pi}).result, MotionResult::touches);
  World inside;  // between the ends of each chord
  inside.add(Sphere{{0, 0, 0}, 0.89});
  EXPECT_EQ(check(bar(), inside, {0}, {6}).result, MotionResult::free);
}

TEST(Motions, numbers_beyond_all_sense_are_undecided) {
  // No sine of such an angle is known, so nothing is proven, and the search ends.
  World world;
  world.add(Sphere{{0, 1.3, 0}, 0.1});
  EXPECT_NE(check(bar(), world, {0}, {1e25}).result, MotionResult::free);
  EXPECT_EQ(check(bar(), world, {0}, {0.5}, {.tolerance = 1e-300}).result, MotionResult::free);
  EXPECT_EQ(check(slider(), wall_at(1), {0}, {2}, {.tolerance = 1e-300}).result, MotionResult::touches);
}

TEST(Motions, two_links_fold_onto_the_first) {
  // The second arm turns back over the first one; the middle link carries the ball that it meets.
  MovingRobot moving;
  moving.add(0, Kind::revolute, {0, 0, 1}, {}, {{{0.5, 0, 0}, 0.1}});
  moving.add(1, Kind::revolute, {0, 0, 1}, {.translation = {1, 0, 0}}, {{{0.5, 0, 0}, 0.05}});
  // Both balls are half a unit from the joint: they meet at π less the angle of the chord 0.15.
  const double angle = std::numbers::pi - 2 * std::asin(0.15);
  const MotionVerdict verdict = check(moving, {}, {0.3, 0}, {-5, std::numbers::pi});
  expect_touch(verdict, angle / std::numbers::pi, 0.5 * std::numbers::pi);
  EXPECT_EQ(verdict.contact.link, 1u);
  EXPECT_EQ(verdict.contact.other_link, 2u);
  EXPECT_EQ(check(moving, {}, {0.3, 0}, {-5, angle - 1e-3}).result, MotionResult::free);
  EXPECT_EQ(check(moving, {}, {0, 0.3}, {100, 0.3}), MotionVerdict{}) << "the first joint carries both";
  EXPECT_EQ(check(moving, {}, {0.3, 0}, {-5, 3.1}, {.self = false}), MotionVerdict{});
  moving.self.ignored.push_back({1, 2, robot::IgnoreReason::given});
  EXPECT_EQ(check(moving, {}, {0.3, 0}, {-5, 3.1}), MotionVerdict{});
}

TEST(Motions, a_contact_is_found_where_it_begins_if_the_middle_passes_its_deepest_place) {
  // In the middle of the edge the ball moves at right angles to the depth: no gap shrinks there, and the contact is
  // old.
  World ball;
  ball.add(Sphere{{0, 0.15, 0}, 0.1});
  const double chord = std::sqrt(0.2 * 0.2 - 0.15 * 0.15);
  expect_touch(check(slider(), ball, {-1}, {1}), (1 - chord) / 2, 2 * chord / 0.2);
  EXPECT_EQ(check(slider(), ball, {-chord / 2}, {chord / 2}).time, 0) << "it starts in the contact";
  MovingRobot itself = slider();
  itself.cover(0, {{{0, 0.15, 0}, 0.1}});
  expect_touch(check(itself, {}, {-1}, {1}), (1 - chord) / 2, 2 * chord / 0.2);
  const Vec3 half{0.3, 1, 1}, center{0, 1.05, 0};
  const double beside = std::sqrt(0.1 * 0.1 - 0.05 * 0.05);
  World box, mesh;
  box.add(ObstacleBox{.pose = {.translation = center}, .half = half});
  mesh.add(box_mesh(center - half, center + half));
  for (const World& world : {box, mesh})
    expect_touch(check(slider(), world, {-1}, {1}), (0.7 - beside) / 2, 2 * beside / 0.1);
}

TEST(Motions, followers_move_with_their_leader) {
  MovingRobot moving;
  moving.add(0, Kind::prismatic, {1, 0, 0}, {}, {{{0, 0, 5}, 0.1}});
  moving.add(1, Kind::prismatic, {1, 0, 0}, {}, {{{0, 0, 0}, 0.1}});
  moving.robot.joints[1].mimic = robot::Joint::Mimic{.joint = 0, .multiplier = 2, .offset = 0.05};
  moving.robot.independent_joints = {0};
  World world;
  world.add(ObstacleBox{.pose = {.translation = {1.5, 0, 0}}, .half = {0.5, 1, 1}});
  expect_touch(check(moving, world, {0}, {1}), 0.85 / 3, 3);
  // As fast backwards: it stays at 0.05 while its leader moves on.
  moving.robot.joints[1].mimic->multiplier = -1;
  EXPECT_EQ(check(moving, world, {0}, {10}).result, MotionResult::free);
}

TEST(Motions, the_base_and_held_objects_count) {
  MovingRobot moving = slider();
  moving.base = RigidTransform::from_axis({0, 0, 1}, std::numbers::pi / 2, {0, 0.25, 0});
  World world;
  world.add(ObstacleBox{.pose = {.translation = {0, 1.5, 0}}, .half = {1, 0.5, 1}});
  expect_touch(check(moving, world, {0}, {1}), 0.65, 1);
  ConfigurationQuery query = moving.query();
  query.attach("link1", std::vector<Sphere>{{{0.3, 0, 0}, 0.05}});
  MotionVerdict verdict;
  query.check_motions(std::vector{0.0}, std::vector{1.0}, world, {&verdict, 1});
  expect_touch(verdict, 0.4, 1);
  query.detach("link1");
  query.check_motions(std::vector{0.0}, std::vector{1.0}, world, {&verdict, 1});
  expect_touch(verdict, 0.65, 1);
}

TEST(Motions, contacts_that_are_allowed_do_not_count) {
  // The ball starts in a wall that it may touch, and an object ahead of it in another one.
  const MovingRobot moving = slider();
  World world = wall_at(-0.5);
  world.add(ObstacleBox{.pose = {.translation = {3, 0, 0}}, .half = {0.5, 3, 3}});
  world.add(ObstacleBox{.pose = {.translation = {5, 0, 0}}, .half = {0.5, 3, 3}});
  ConfigurationQuery query = moving.query();
  query.allow_contacts("link1", std::array<std::size_t, 1>{0});
  for (const double resolution : {0.0, 0.01}) {
    const auto edge = [&](double end) {
      MotionVerdict verdict;
      query.check_motions(std::vector{0.0}, std::vector{end}, world, {&verdict, 1}, {.resolution = resolution});
      return verdict;
    };
    query.detach("link1");
    EXPECT_EQ(edge(2.3).result, MotionResult::free);
    EXPECT_EQ(edge(3.3).contact.obstacle, 1u);
    query.attach("link1", std::vector<Sphere>{{{1, 0, 0}, 0.1}}, {}, std::array<std::size_t, 2>{1, 0});
    EXPECT_EQ(edge(2.3).result, MotionResult::free);
    EXPECT_EQ(edge(3.3).contact.obstacle, 1u) << "of the ball itself";
    query.attach("link1", std::vector<Sphere>{{{1, 0, 0}, 0.1}});
    EXPECT_EQ(edge(2.3).contact.obstacle, 1u) << "the object may touch nothing";
  }
}

TEST(Motions, edges_without_length_are_configurations) {
  EXPECT_EQ(check(slider(), wall_at(1), {0.5}, {0.5}), MotionVerdict{});
  const MotionVerdict inside = check(slider(), wall_at(1), {0.95}, {0.95});
  EXPECT_EQ(inside.result, MotionResult::touches);
  EXPECT_EQ(inside.time, 0);
  EXPECT_EQ(check(slider(), wall_at(1), {0.95}, {0.95}, {.resolution = 0.1}), inside);
}

TEST(Motions, contacts_at_the_ends_are_found) {
  World world;
  world.add(Sphere{{1, 0, 0}, 0.25});
  MovingRobot moving;
  moving.add(0, Kind::prismatic, {1, 0, 0}, {}, {{{0, 0, 0}, 0.25}});
  EXPECT_EQ(check(moving, world, {0}, {0.5}).result, MotionResult::touches);
  EXPECT_EQ(check(moving, world, {0}, {0.5}).time, 1);
  EXPECT_EQ(check(moving, world, {0.5}, {0}).result, MotionResult::touches);
  EXPECT_EQ(check(moving, world, {0.5}, {0}).time, 0);
  EXPECT_EQ(check(moving, world, {0.75}, {0}).time, 0);
}

TEST(Motions, a_tangential_touch_is_never_free) {
  for (const double above : {0.0, 1e-14, 1e-9, 1e-6, 3e-5, 9e-5, 2e-4, 1e-2}) {
    World world;
    world.add(Sphere{{0.137, 0.35 + above, 0}, 0.25});
    const MotionVerdict verdict = check(slider(), world, {-1}, {1});
    const bool is_free = verdict.result == MotionResult::free, touches = verdict.result == MotionResult::touches;
    EXPECT_FALSE(above <= 1e-14 ? is_free : touches) << above;
    EXPECT_TRUE(is_free || above <= tolerance) << above;
    if (verdict.result == MotionResult::undecided) {
      EXPECT_NEAR(-1 + 2 * verdict.time, 0.137, 0.02);
    }
  }
}

TEST(Motions, numbers_of_a_terrain_s_own_axes_count_as_rounding) {
  // Its heights are large, and its pose takes them back. The ball is in the ground by less than the heights' rounding.
  constexpr double height = 0x1p20, radius = 0.125 + 0x1p-33 + 0x1p-40, depth = 0x1p-41;
  const std::vector<double> heights(4, height);
  World world;
  world.add({.heights = heights, .columns = 2, .rows = 2, .spacing = 4, .pose = {.translation = {-2, -2, -height}}});
  MovingRobot moving;
  moving.add(0, Kind::prismatic, {1, 0, 0}, {.translation = {0, 0, radius - depth}}, {{{0, 0, 0}, radius}});
  EXPECT_NE(check(moving, world, {0}, {1e-11}, {.tolerance = 1e-11}).result, MotionResult::free);
  moving.robot.joints[0].origin.translation.z += 1e-5;
  EXPECT_EQ(check(moving, world, {0}, {1e-11}, {.tolerance = 1e-11}).result, MotionResult::free);
}

TEST(Motions, closed_meshes_are_solid_and_resolutions_may_miss) {
  World world;
  const Mesh ball = sample_body("blob", 8);
  world.add(ball, {.translation = {50, 0, 0}});
  EXPECT_EQ(check(slider(), world, {49}, {51}).result, MotionResult::touches);
  EXPECT_EQ(check(slider(), world, {0}, {100}).result, MotionResult::touches);
  World thin;
  thin.add(ObstacleBox{.pose = {.translation = {0.37, 0, 0}}, .half = {1e-9, 1, 1}});
  EXPECT_EQ(check(slider(), thin, {0}, {1}, {.resolution = 0.3}).result, MotionResult::free);
  const MotionVerdict found = check(slider(), thin, {0}, {1}, {.resolution = 0.1});
  EXPECT_EQ(found.result, MotionResult::touches);
  EXPECT_EQ(found.time, 0.4) << "it comes before 0.3";
}

TEST(Motions, a_gap_of_the_tolerance_is_proven_beside_a_mesh) {
  // A ball slides along a face of a cube that stands aslant to the axes, so that no box of it helps.
  constexpr double radius = 0.02, room = 0.01;
  const Vec3 out{std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2, 0}, along{out.y, -out.x, 0};
  for (double half = 0.05; half < 0.06; half += 2e-4) {
    World world;
    const Mesh cube = box_mesh({-half, -half, -half}, {half, half, half});
    world.add(cube, RigidTransform::from_axis({0, 0, 1}, std::numbers::pi / 4, {}));
    MovingRobot moving;
    moving.add(0, Kind::prismatic, along, {.translation = (half + radius + room + 1e-5) * out + Vec3{0, 0, 0.01}},
               {{{0, 0, 0}, radius}});
    EXPECT_EQ(check(moving, world, {-0.99 * room}, {0.99 * room}, {.tolerance = room}), MotionVerdict{}) << half;
  }
}

TEST(Motions, the_end_of_an_edge_touches_a_mesh_that_its_middle_is_away_from) {
  // A ball moves onto a face of a cube aslant to the axes, and ends a little inside.
  constexpr double half = 0.5, radius = 0.02, way = 0.4;
  const Vec3 out{std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2, 0};
  World world;
  const Mesh cube = box_mesh({-half, -half, -half}, {half, half, half});
  world.add(cube, RigidTransform::from_axis({0, 0, 1}, std::numbers::pi / 4, {}));
  for (double aside = -0.2; aside < 0.2; aside += 0.013) {
    MovingRobot moving;
    moving.add(0, Kind::prismatic, Vec3{} - out,
               {.translation = (half + radius + way - 5e-4) * out + Vec3{0, 0, aside}}, {{{0, 0, 0}, radius}});
    EXPECT_EQ(check(moving, world, {0}, {way}).result, MotionResult::touches) << aside;
  }
}

TEST(Motions, options_and_sizes_are_tested) {
  const ConfigurationQuery query = slider().query();
  std::vector<MotionVerdict> verdicts(2);
  const std::vector<double> two{0, 1}, one{0};
  EXPECT_NO_THROW(query.check_motions(two, two, {}, verdicts));
  EXPECT_NO_THROW(query.check_motions({}, {}, {}, {}));
  EXPECT_THROW(query.check_motions(one, two, {}, verdicts), std::invalid_argument);
  EXPECT_THROW(query.check_motions(two, one, {}, verdicts), std::invalid_argument);
  EXPECT_THROW(query.check_motions(two, std::vector{0, std::nan("")}, {}, verdicts), std::invalid_argument);
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(query.check_motions(two, two, {}, verdicts, {.tolerance = bad}), std::invalid_argument);
  for (const double bad : {-1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(query.check_motions(two, two, {}, verdicts, {.resolution = bad}), std::invalid_argument);
  EXPECT_THROW(query.check_motions(two, std::vector{0.0, 2.0}, {}, verdicts, {.resolution = 1e-10}),
               std::invalid_argument);
}

}  // namespace
}  // namespace morula::test

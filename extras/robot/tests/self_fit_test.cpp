// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// False self-collisions of robots of boxes, whose collisions are known by geometry.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/robot/self_fit.hpp>
#include <numbers>

namespace morula::test {
namespace {

using robot::Joint;
using robot::none;
using robot::Robot;

/// A post, and a bar that turns above it about z, on the same ground. Bar and post are `gap` apart in every
/// configuration; a block on the bar's way stands at half of the circle.
Robot turnstile(double gap) {
  Robot made;
  const auto add_link = [&](const char* name, const Vec3& center, const Vec3& size) {
    robot::Link link;
    link.name = name;
    if (size.x > 0) {
      robot::Shape shape;
      shape.kind = robot::Shape::Kind::box;
      shape.origin.translation = center;
      shape.size = size;
      link.collision.push_back(shape);
    }
    made.links.push_back(link);
  };
  const auto connect = [&](std::size_t parent, std::size_t child, Joint::Kind kind) {
    Joint joint;
    joint.name = "to_" + made.links[child].name;
    joint.kind = kind, joint.parent = parent, joint.child = child;
    joint.axis = {0, 0, 1};
    joint.lower = -std::numbers::pi, joint.upper = std::numbers::pi;
    made.links[child].joint = made.joints.size();
    made.order.push_back(made.joints.size());
    if (joint.moves()) made.independent_joints.push_back(made.joints.size());
    made.joints.push_back(joint);
  };
  made.root = 0;
  add_link("ground", {0, 0, -5}, {0.2, 0.2, 0.2});
  add_link("post", {0, 0, -0.5}, {1, 1, 1});
  add_link("bar", {0.5, 0, gap + 0.1}, {2, 0.2, 0.2});
  add_link("block", {-1.2, 0, gap + 0.1}, {0.2, 0.2, 0.2});
  connect(0, 1, Joint::Kind::fixed);
  connect(0, 2, Joint::Kind::revolute);
  connect(0, 3, Joint::Kind::fixed);
  return made;
}

/// The bar's far end is at 1.5 along its direction; the block is the square of half width 0.1 at (-1.2, 0).
bool bar_meets_block(double angle) {
  // Separating axes of two rectangles in the plane; the bar's axes in the world, its center at 0.5.
  const double c = std::cos(angle), s = std::sin(angle);
  const double x = -1.2 - 0.5 * c, y = -0.5 * s;
  const double along = c * x + s * y, across = -s * x + c * y, half = 0.1 * (std::abs(c) + std::abs(s));
  if (std::abs(along) > 1 + half || std::abs(across) > 0.1 + half) return false;
  return std::abs(x) <= 0.1 + std::abs(c) + 0.1 * std::abs(s) && std::abs(y) <= 0.1 + std::abs(s) + 0.1 * std::abs(c);
}

TEST(SelfFit, rates_are_those_of_geometry) {
  Robot made = turnstile(0.02);
  const robot::RobotSpheres spheres = robot::fit_spheres(made, {.spheres = 1});
  const std::vector<robot::IgnoredPair> ignored{{0, 2, robot::IgnoreReason::adjacent},
                                                {0, 1, robot::IgnoreReason::adjacent},
                                                {0, 3, robot::IgnoreReason::adjacent},
                                                {1, 3, robot::IgnoreReason::given}};
  const robot::SelfRates rates = robot::self_collision_rates(made, spheres, ignored, {.samples = 4000});
  std::size_t meets = 0;
  constexpr std::size_t count = 100'000;
  for (std::size_t i = 0; i < count; ++i)
    meets += bar_meets_block(2 * std::numbers::pi * static_cast<double>(i) / count) ? 1 : 0;
  EXPECT_NEAR(rates.surfaces, static_cast<double>(meets) / count, 0.02);
  // One sphere around the bar reaches the post in every configuration, and their boxes never meet.
  const auto post =
      std::find_if(rates.pairs.begin(), rates.pairs.end(), [](const auto& p) { return p.a == 1 && p.b == 2; });
  ASSERT_NE(post, rates.pairs.end());
  EXPECT_EQ(post->spheres, 1);
  EXPECT_EQ(post->surfaces, 0);
  EXPECT_NEAR(rates.false_share, 1 - rates.surfaces, 1e-12);
  EXPECT_THROW(robot::self_collision_rates(made, spheres, ignored, {.samples = 0}), std::invalid_argument);
}

TEST(SelfFit, a_block_inside_another_collides) {
  Robot made = turnstile(0.02);
  made.links[3].collision[0].origin.translation = {0, 0, -0.5};  // inside the post
  const robot::RobotSpheres spheres = robot::fit_spheres(made, {.spheres = 2});
  const robot::SelfRates rates = robot::self_collision_rates(made, spheres, {}, {.samples = 5});
  const auto inner =
      std::find_if(rates.pairs.begin(), rates.pairs.end(), [](const auto& p) { return p.a == 1 && p.b == 3; });
  ASSERT_NE(inner, rates.pairs.end());
  EXPECT_EQ(inner->surfaces, 1);
  // A pair that always collides does not hide the others.
  EXPECT_TRUE(inner->always_collides);
  EXPECT_EQ(rates.surfaces, 0);
  for (const robot::SelfPairRate& pair : rates.pairs) EXPECT_EQ(pair.always_collides, pair.surfaces >= 0.95);
}

/// Bar and post are flat, and a tenth of the post apart in every configuration: one large sphere each overlaps.
TEST(SelfFit, more_spheres_are_never_worse_and_the_total_holds) {
  Robot made = turnstile(0.1);
  double last = 1;
  std::vector<robot::SelfFitStep> steps;
  for (const std::size_t total : {16, 32, 64, 128}) {
    const robot::SelfFit fit = robot::fit_for_self_collision(made, {.max_total = total}, {.samples = 60});
    EXPECT_TRUE(fit.spheres.covered());
    EXPECT_LE(fit.spheres.sphere_count(), total);
    EXPECT_LE(fit.rates.false_share, last);
    EXPECT_EQ(fit.rates.surfaces, fit.evenly.surfaces);
    last = fit.rates.false_share;
    // A fit with a larger total starts with the same steps, and each of these fits reaches its own.
    for (std::size_t i = 0; i < steps.size(); ++i) {
      EXPECT_EQ(fit.steps[i].spheres, steps[i].spheres);
      EXPECT_EQ(fit.steps[i].false_share, steps[i].false_share);
    }
    steps.clear();
    for (const robot::SelfFitStep& step : fit.steps) {
      if (step.spheres <= total) steps.push_back(step);
    }
    EXPECT_NEAR(steps.back().false_share, last, 1e-12);
    for (std::size_t i = 1; i < fit.steps.size(); ++i) {
      EXPECT_GT(fit.steps[i].spheres, fit.steps[i - 1].spheres);
      EXPECT_LE(fit.steps[i].false_share, fit.steps[i - 1].false_share);
    }
  }
  EXPECT_LT(last, 0.1);
}

TEST(SelfFit, options_without_a_number_are_refused) {
  const Robot made = turnstile(0.4);
  const auto message_of = [&](const robot::FitOptions& fit) -> std::string {
    try {
      (void)robot::fit_for_self_collision(made, fit, {.samples = 1});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message_of({.max_protrusion = 0.1}).substr(0, 15), "max_protrusion:");
  EXPECT_EQ(message_of({.max_protrusion_share = 0.1}).substr(0, 21), "max_protrusion_share:");
  EXPECT_EQ(message_of({.max_radius = 0.1}).substr(0, 11), "max_radius:");
  EXPECT_EQ(message_of({.tolerance = 0.01, .max_uncovered = 0.1}).substr(0, 14), "max_uncovered:");
}

TEST(SelfFit, workers_do_not_matter_and_kept_spheres_stay) {
  Robot made = turnstile(0.4);
  const std::vector<Sphere> kept{{{0, 0, -5}, 0.3}};
  const robot::FitOptions options{.max_total = 20, .fixed_spheres = {{"ground", kept}}};
  Workers three(3);
  const robot::SelfFit one = robot::fit_for_self_collision(made, options, {.samples = 100}, serial_workers());
  const robot::SelfFit other = robot::fit_for_self_collision(made, options, {.samples = 100}, three);
  ASSERT_EQ(one.spheres.links.size(), other.spheres.links.size());
  for (std::size_t i = 0; i < one.spheres.links.size(); ++i)
    EXPECT_EQ(one.spheres.links[i].spheres, other.spheres.links[i].spheres);
  EXPECT_EQ(one.spheres.of(0)->spheres, kept);
}

TEST(SelfFit, progress_rises_and_a_stop_ends_it) {
  Robot made = turnstile(0.4);
  double last = 0;
  robot::FitOptions options{.max_total = 16};
  options.progress = [&](double share, const std::string&) {
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1);
    last = share;
  };
  (void)robot::fit_for_self_collision(made, options, {.samples = 50});
  EXPECT_EQ(last, 1);
  StopSource source;
  options.stop = source.get_token();
  options.progress = [&](double share, const std::string&) {
    if (share > 0.6) source.request_stop();
  };
  EXPECT_THROW((void)robot::fit_for_self_collision(made, options, {.samples = 50}), BuildStopped);
}

}  // namespace
}  // namespace morula::test

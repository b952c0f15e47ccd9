// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Checks of configurations: random robots in random worlds, against matrices, formulas of their own, and every pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/configurations.hpp>
#include <morula/robot/sphere_robot.hpp>
#include <optional>
#include <tuple>

#include "matrix_robots.hpp"
#include "obstacle_scenes.hpp"
#include "random_poses.hpp"
#include "simd/processors.hpp"

namespace morula::test::configurations {
namespace {

using robot::ConfigurationQuery;
using robot::ConfigurationVerdict;

struct Held {
  std::size_t link;
  std::vector<Sphere> spheres;
  std::vector<std::size_t> touching{}, touching_obstacles{};
};

/// The first contact, by every pair; no value if one is within `doubt` of touching.
std::optional<ConfigurationVerdict> plain_verdict(const Sample& sample, std::span<const double> values,
                                                  const RigidTransform& base, const Scene& scene,
                                                  const std::vector<Held>& held, double doubt) {
  struct Ball {
    std::size_t link;
    bool is_held;
    Sphere sphere;
    const Held* of;
  };
  const std::vector<Matrix> poses = sample.poses(values, base);
  std::vector<Ball> balls;
  for (const robot::LinkSpheres& link : sample.spheres.links) {
    for (const Sphere& s : link.spheres)
      balls.push_back({link.link, false, {moved(poses[link.link], s.center), s.radius}, nullptr});
  }
  for (const Held& object : held) {
    for (const Sphere& s : object.spheres)
      balls.push_back({object.link, true, {moved(poses[object.link], s.center), s.radius}, &object});
  }
  bool doubtful = false;
  ConfigurationVerdict best;
  const auto least = [&](const ConfigurationVerdict& found, double gap) {
    if (std::abs(gap) < doubt) doubtful = true;
    if (gap > 0) return;
    const auto key = [](const ConfigurationVerdict& v) {
      return std::tuple{v.obstacle == v.free_link, v.link, v.other_link, v.obstacle};
    };
    if (best.is_free() || key(found) < key(best)) best = found;
  };
  for (const Ball& ball : balls) {
    for (std::size_t i = 0; i < scene.distances.size(); ++i) {
      const bool counts =
          ball.of == nullptr
              ? std::count(sample.allowed.begin(), sample.allowed.end(), std::array{ball.link, i}) == 0
              : std::count(ball.of->touching_obstacles.begin(), ball.of->touching_obstacles.end(), i) == 0;
      if (!counts) continue;
      least({.link = static_cast<std::uint32_t>(ball.link), .obstacle = static_cast<std::uint32_t>(i)},
            scene.distances[i](ball.sphere.center) - ball.sphere.radius);
    }
  }
  const auto allowed = [](const Ball& a, const Ball& b) {
    return a.of != nullptr && std::count(a.of->touching.begin(), a.of->touching.end(), b.link) > 0;
  };
  for (const Ball& a : balls) {
    for (const Ball& b : balls) {
      if (a.link >= b.link || allowed(a, b) || allowed(b, a)) continue;
      const bool ignored = std::any_of(sample.self.ignored.begin(), sample.self.ignored.end(),
                                       [&](const auto& pair) { return pair.a == a.link && pair.b == b.link; });
      if (ignored && !a.is_held && !b.is_held) continue;
      least({.link = static_cast<std::uint32_t>(a.link), .other_link = static_cast<std::uint32_t>(b.link)},
            distance(a.sphere.center, b.sphere.center) - a.sphere.radius - b.sphere.radius);
    }
  }
  return doubtful ? std::nullopt : std::optional(best);
}

std::vector<ConfigurationVerdict> verdicts_of(const ConfigurationQuery& query, std::span<const double> values,
                                              const World& world, std::size_t count, Workers& workers) {
  std::vector<ConfigurationVerdict> verdicts(count);
  query.check(values, world, verdicts, workers);
  return verdicts;
}

void expect_plain_verdicts(std::uint64_t seed, std::size_t links, double size, const RigidTransform& base,
                           bool holds = false) {
  Random random(seed);
  Sample sample(random, links, size);
  const Scene scene(random, base.translation, size);
  ConfigurationQuery query(sample.robot, sample.spheres, sample.self);
  query.set_base(base);
  std::vector<Held> held;
  if (holds) {
    const std::size_t terrain = scene.distances.size() - 1;
    held.push_back({links - 1, {{random_point(random, 0.2 * size), 0.05 * size}, {{}, 0.03 * size}}, {links - 2}});
    held.push_back({0, {{{0, 0, 0.3 * size}, 0.05 * size}}, {}, {terrain, 1}});
    sample.allowed = {{0, 0}, {0, terrain}, {links - 1, 2}, {links - 1, terrain}};
    query.allow_contacts("link0", std::vector<std::size_t>{terrain, 0, terrain + 5});
    query.allow_contacts(sample.robot.links[links - 1].name, std::vector<std::size_t>{0, 1});  // replaced
    query.allow_contacts(sample.robot.links[links - 1].name, std::vector<std::size_t>{2, terrain});
    for (const Held& object : held) {
      std::vector<std::string> touching;
      for (const std::size_t link : object.touching) touching.push_back(sample.robot.links[link].name);
      query.attach(sample.robot.links[object.link].name, object.spheres, touching, object.touching_obstacles);
    }
  }
  constexpr std::size_t count = 333;
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> one = sample.configuration(random);
    values.insert(values.end(), one.begin(), one.end());
  }
  Workers three(3);
  const auto verdicts = verdicts_of(query, values, scene.world, count, serial_workers());
  EXPECT_EQ(verdicts, verdicts_of(query, values, scene.world, count, three));
  const std::size_t kinds = detail::runnable_kinds();
  for (std::size_t kind = 1; kind <= kinds; ++kind) {
    detail::allow_kinds(kind);
    EXPECT_EQ(verdicts, verdicts_of(query, values, scene.world, count, serial_workers()))
        << detail::kind_name(kind - 1);
  }
  detail::allow_kinds(kinds);
  std::vector<ConfigurationVerdict> self(count);
  query.check_self(values, self);
  std::size_t decided = 0;
  const double doubt = 1e-11 * (size + max_norm(base.translation));
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const double> one(values.data() + i * query.coordinates(), query.coordinates());
    const auto plain = plain_verdict(sample, one, base, scene, held, doubt);
    const auto plain_self = plain_verdict(sample, one, base, {}, held, doubt);
    decided += plain && plain_self;
    EXPECT_EQ(verdicts[i], plain.value_or(verdicts[i])) << i;
    EXPECT_EQ(self[i], plain_self.value_or(self[i])) << i;
  }
  EXPECT_GE(decided, count * 9 / 10);
}

TEST(Configurations, AgreeWithEveryPair) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) expect_plain_verdicts(seed, 3 + seed, 1, {});
}
TEST(Configurations, AgreeWithEveryPairOfRobotsWithoutJoints) {
  expect_plain_verdicts(20, 1, 1, {});
}
TEST(Configurations, AgreeWithEveryPairWhereverTheBaseIs) {
  Random random(3);
  expect_plain_verdicts(31, 8, 1, random_pose(random, 1));
  expect_plain_verdicts(32, 8, 1, random_pose(random, 1e6));
}
TEST(Configurations, AgreeWithEveryPairAtEveryScale) {
  for (const double scale : {1e-20, 1e-6, 1e6, 1e20}) expect_plain_verdicts(40, 7, scale, {});
}
TEST(Configurations, AgreeWithEveryPairOfHeldObjectsAndAllowedContacts) {
  for (std::uint64_t seed = 50; seed < 54; ++seed) expect_plain_verdicts(seed, 7, 1, {}, true);
}

TEST(Configurations, TouchExactlyUpToTheLastBit) {
  const Slider slider;
  const ConfigurationQuery query(slider.robot, slider.spheres);
  const auto touches = [&](const World& world, double at) {
    ConfigurationVerdict verdict;
    query.check(std::span(&at, 1), world, std::span(&verdict, 1));
    return !verdict.is_free();
  };
  World ball, box, rod, points, mesh;
  ball.add(Sphere{{2, 0, 0}, 0.5});
  box.add(ObstacleBox{{.translation = {2, 0, 0}}, {0.5, 0.5, 0.5}});
  rod.add(Capsule{{2, -1, 0}, {2, 1, 0}, 0.5});
  points.add_points(std::vector<Vec3>{{2, 0, 0}, {9, 0, 0}}, 0.5);
  mesh.add(centered_box({0.5, 0.5, 0.5}), {.translation = {2, 0, 0}});
  for (const World* world : {&ball, &box, &rod, &points, &mesh}) {
    EXPECT_TRUE(touches(*world, 1.25));
    EXPECT_TRUE(touches(*world, 2));
    EXPECT_FALSE(touches(*world, std::nextafter(1.25, 0.0)));
    EXPECT_TRUE(touches(*world, std::nextafter(1.25, 2.0)));
  }
  EXPECT_FALSE(touches(World{}, 1.25));
}

TEST(Configurations, DecideInDoubleWhatIsNearlyTouching) {
  Random random(70);
  for (int i = 0; i < 500; ++i) {
    Slider slider;
    slider.spheres.links[0].spheres[0] = {random_point(random, 0.3), random.uniform(0.05, 0.3)};
    const RigidTransform base = random_pose(random, 1);
    const Sphere& own = slider.spheres.links[0].spheres[0];
    const double at = random.uniform(-1, 1), gap = (i % 2 == 0 ? 1 : -1) * std::pow(10, random.uniform(-10, -6));
    const Vec3 center = moved(matrix(base), own.center + Vec3{at, 0, 0});
    const Vec3 direction = normalized(random_point(random, 1));
    const double radius = random.uniform(0.05, 0.3);
    World balls, boxes;
    balls.add(Sphere{center + (own.radius + radius + gap) * direction, radius});
    // The face of a box at right angles to the direction.
    const Vec3 side = normalized(cross(direction, {0.3, 0.5, 0.7})), other = cross(direction, side);
    ObstacleBox box{{}, {radius, 1, 1}};
    for (int k = 0; k < 3; ++k) box.pose.rows[static_cast<std::size_t>(k)] = {direction[k], side[k], other[k]};
    box.pose.translation = center + (own.radius + radius + gap) * direction;
    boxes.add(box);
    ConfigurationQuery query(slider.robot, slider.spheres);
    query.set_base(base);
    for (const World* world : {&balls, &boxes}) {
      ConfigurationVerdict verdict;
      query.check(std::span(&at, 1), *world, std::span(&verdict, 1));
      EXPECT_EQ(verdict.is_free(), gap > 0) << gap;
    }
  }
}

TEST(Configurations, AgreeWithSphereRobotsAboutThemselves) {
  Random random(60);
  const Sample sample(random, 9, 1);
  const ConfigurationQuery query(sample.robot, sample.spheres, sample.self);
  robot::SphereRobot moving(sample.robot, sample.spheres, sample.self);
  for (int i = 0; i < 1000; ++i) {
    const std::vector<double> values = sample.configuration(random);
    ConfigurationVerdict verdict;
    query.check_self(values, std::span(&verdict, 1));
    moving.set_joint_values(values);
    const auto pair = moving.self_collision();
    ASSERT_EQ(verdict.is_free(), !pair);
    if (!pair) continue;
    EXPECT_EQ(verdict.link, moving.links()[pair->first]);
    EXPECT_EQ(verdict.other_link, moving.links()[pair->second]);
  }
}

// Poses with ten digits stretch lengths by less than 1e-9. The spheres around groups, and boxes around obstacles, must
// leave out no contact of single spheres.
TEST(Configurations, MissNoContactByPosesThatAreNotQuiteRotations) {
  RigidTransform longer, shorter;
  for (int k = 0; k < 3; ++k) {
    longer.rows[static_cast<std::size_t>(k)][k] = 1 + 4e-10;
    shorter.rows[static_cast<std::size_t>(k)][k] = 1 - 4e-10;
  }
  Slider slider;
  slider.spheres.links[0].spheres = {{{1, 0, 0}, 0.1}, {{-1, 0, 0}, 0.1}};
  Slider stretched = slider;
  stretched.robot.joints[0].origin = longer;
  ConfigurationQuery based(slider.robot, slider.spheres);
  based.set_base(longer);
  ConfigurationQuery jointed(stretched.robot, stretched.spheres);
  for (const ConfigurationQuery* query : {&based, &jointed}) {
    for (double gap = -1e-9; gap < 1e-9; gap += 0.7e-10) {
      World world;
      world.add(Sphere{{2 + gap, 0, 0}, 0.9});
      const double at = 0;
      ConfigurationVerdict verdict;
      robot::Clearance clearance;
      query->check({&at, 1}, world, {&verdict, 1});
      query->clearance({&at, 1}, world, {&clearance, 1});
      EXPECT_EQ(verdict.is_free(), clearance.distance > 0) << gap;
      EXPECT_NEAR(clearance.distance, gap, 1e-14);
    }
  }
  World box;
  box.add(ObstacleBox{shorter, {1, 1, 1}});
  Slider point;
  point.spheres.links[0].spheres = {{{}, 0}};
  const ConfigurationQuery query(point.robot, point.spheres);
  for (double at = 1 - 1e-9; at < 1 + 1e-9; at += 0.7e-10) {
    ConfigurationVerdict verdict;
    query.check({&at, 1}, box, {&verdict, 1});
    EXPECT_EQ(verdict.is_free(), at > 1) << at - 1;
  }
}

TEST(Configurations, RejectWhatTheyCannotUse) {
  const Slider slider;
  ConfigurationQuery query(slider.robot, slider.spheres);
  std::vector<ConfigurationVerdict> two(2);
  const World world;
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e200})
    EXPECT_THROW(query.check(std::vector<double>{0, bad}, world, two), std::invalid_argument);
  EXPECT_THROW(query.check(std::vector<double>{0}, world, two), std::invalid_argument);
  EXPECT_THROW(query.check_self(std::vector<double>{0, 0, 0}, two), std::invalid_argument);
  EXPECT_THROW(query.attach("nobody", std::vector<Sphere>{{{}, 1}}), std::invalid_argument);
  EXPECT_THROW(query.attach("slide", std::vector<Sphere>{{{}, -1}}), std::invalid_argument);
  EXPECT_THROW(query.detach("nobody"), std::invalid_argument);
  EXPECT_THROW(query.allow_contacts("nobody", {}), std::invalid_argument);
  RigidTransform mirror;
  mirror.rows[0].x = -1;
  EXPECT_THROW(query.set_base(mirror), std::invalid_argument);
  const auto refuses = [](const std::function<void(robot::Robot&)>& change) {
    Slider changed;
    change(changed.robot);
    EXPECT_THROW(ConfigurationQuery(changed.robot, changed.spheres), std::invalid_argument);
  };
  refuses([](robot::Robot& robot) { robot.root = robot::none; });
  refuses([](robot::Robot& robot) { robot.joints[0].axis.y = std::nan(""); });
  refuses([](robot::Robot& robot) { robot.joints[0].origin.translation.x = std::numeric_limits<double>::infinity(); });
  refuses([](robot::Robot& robot) { robot.joints[0].origin.translation.x = 1e200; });
  refuses([&](robot::Robot& robot) { robot.joints[0].origin = mirror; });
  // A multiplier that makes a pose infinite, which would touch nothing.
  refuses([](robot::Robot& robot) {
    robot.links.emplace_back().name = "follower";
    robot.joints.push_back(robot.joints[0]);
    robot.joints[1].child = 2;
    robot.joints[1].mimic = robot::Joint::Mimic{0, 1e300, 0};
    robot.order.push_back(1);
  });
  World bad;
  EXPECT_THROW(bad.add(Sphere{{}, -1}), std::invalid_argument);
  EXPECT_THROW(bad.add(ObstacleBox{{}, {1, std::nan(""), 1}}), std::invalid_argument);
  EXPECT_THROW(bad.add(Capsule{{}, {1e200, 0, 0}, 1}), std::invalid_argument);
  EXPECT_THROW(bad.add(Mesh{}), std::invalid_argument);
  EXPECT_THROW(bad.add_points({}, 1), std::invalid_argument);
  EXPECT_THROW(bad.add(robot::HeightField{std::vector<double>(3), 2, 2}), std::invalid_argument);
  const std::vector<Vec3> unseen{{}, {}, {0, std::nan(""), 0}};
  try {
    bad.add_points(unseen, 1);
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string_view(error.what()).find("point number 2 needs finite"), std::string_view::npos);
  }
  EXPECT_EQ(bad.size(), 0u);
}

}  // namespace
}  // namespace morula::test::configurations

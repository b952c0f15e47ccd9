// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Checks of configurations: random robots in random worlds, against matrices and formulas of their own, and every pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/robot/configurations.hpp>
#include <morula/robot/sphere_robot.hpp>
#include <optional>
#include <tuple>

#include "random_poses.hpp"
#include "simd/processors.hpp"

namespace morula::test::configurations {
namespace {

using robot::ConfigurationQuery;
using robot::ConfigurationVerdict;
using robot::ObstacleBox;
using robot::World;
using Matrix = std::array<std::array<double, 4>, 4>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
    }
  }
  return c;
}
Matrix matrix(const RigidTransform& t) {
  Matrix m{};
  for (std::size_t i = 0; i < 3; ++i) {
    const int k = static_cast<int>(i);
    m[i] = {t.rows[i].x, t.rows[i].y, t.rows[i].z, t.translation[k]};
  }
  m[3][3] = 1;
  return m;
}
Vec3 moved(const Matrix& m, const Vec3& p) {
  Vec3 r;
  for (std::size_t i = 0; i < 3; ++i) r[static_cast<int>(i)] = m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3];
  return r;
}
// Rodrigues' formula.
Matrix turned(const Vec3& a, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), v = 1 - c;
  return {{{c + a.x * a.x * v, a.x * a.y * v - a.z * s, a.x * a.z * v + a.y * s, 0},
           {a.y * a.x * v + a.z * s, c + a.y * a.y * v, a.y * a.z * v - a.x * s, 0},
           {a.z * a.x * v - a.y * s, a.z * a.y * v + a.x * s, c + a.z * a.z * v, 0},
           {0, 0, 0, 1}}};
}

/// A robot, its spheres, and its poses by other means.
struct Sample {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  robot::SelfCollision self{};
  std::vector<std::array<std::size_t, 2>> allowed{};  // a link and an obstacle whose contact does not count
  double scale = 1;

  Sample(Random& random, std::size_t links, double size, std::size_t count = 5) : scale(size) {
    for (std::size_t i = 0; i < links; ++i) {
      robot.links.emplace_back().name = "link" + std::to_string(i);
      // Every fourth link is without spheres.
      if (i % 4 != 3) {
        robot::LinkSpheres link;
        link.link = i;
        for (std::size_t k = 0; k < count; ++k)
          link.spheres.push_back({random_point(random, 0.15 * size), random.uniform(0.01, 0.06) * size});
        spheres.links.push_back(link);
      }
      if (i > 0) add_joint(random, i);
    }
    robot.root = 0;
    self.ignored.clear();
    for (std::size_t i = 0; i + 1 < links; ++i) self.ignored.push_back({i, i + 1});
  }
  void add_joint(Random& random, std::size_t child) {
    using Kind = robot::Joint::Kind;
    robot::Joint joint;
    joint.name = "joint" + std::to_string(child);
    joint.kind = std::array{Kind::revolute, Kind::continuous, Kind::prismatic, Kind::revolute, Kind::fixed}[child % 5];
    joint.parent = child - 1 - (child > 2 && random.uniform(0, 1) < 0.3 ? 1 : 0);
    joint.child = child;
    joint.origin = random_pose(random, 0.35 * scale);
    joint.axis = normalized(random_point(random, 1));
    const std::size_t number = robot.joints.size();
    if (joint.moves() && child % 6 == 0 && !robot.independent_joints.empty())
      joint.mimic = robot::Joint::Mimic{robot.independent_joints[0], -0.7, 0.1};
    robot.links[child].joint = number;
    robot.order.push_back(number);
    if (joint.moves() && !joint.mimic) robot.independent_joints.push_back(number);
    robot.joints.push_back(joint);
  }
  std::vector<double> configuration(Random& random) const {
    std::vector<double> values;
    for (const std::size_t j : robot.independent_joints)
      values.push_back(robot.joints[j].kind == robot::Joint::Kind::prismatic ? random.uniform(-0.3, 0.3) * scale
                                                                             : random.uniform(-3, 3));
    return values;
  }
  std::vector<Matrix> poses(std::span<const double> values, const RigidTransform& base) const {
    std::vector<Matrix> result(robot.links.size());
    result[0] = matrix(base);
    for (const robot::Joint& joint : robot.joints) {
      const auto find = [&](std::size_t j) {
        const auto& all = robot.independent_joints;
        return static_cast<std::size_t>(std::find(all.begin(), all.end(), j) - all.begin());
      };
      const auto number = static_cast<std::size_t>(&joint - robot.joints.data());
      Matrix motion = matrix({});
      if (joint.moves()) {
        const double value = joint.mimic
                                 ? joint.mimic->multiplier * values[find(joint.mimic->joint)] + joint.mimic->offset
                                 : values[find(number)];
        motion = joint.kind == robot::Joint::Kind::prismatic ? matrix({.translation = value * joint.axis})
                                                             : turned(joint.axis, value);
      }
      result[joint.child] = product(product(result[joint.parent], matrix(joint.origin)), motion);
    }
    return result;
  }
};

using Distance = std::function<double(const Vec3&)>;

double box_distance(const ObstacleBox& box, const Vec3& p) {
  const Vec3 d = p - box.pose.translation;
  double outside = 0, inside = -1e300;
  for (int k = 0; k < 3; ++k) {
    const double along = d.x * box.pose.rows[0][k] + d.y * box.pose.rows[1][k] + d.z * box.pose.rows[2][k];
    const double beyond = std::abs(along) - box.half[k];
    outside += beyond > 0 ? beyond * beyond : 0;
    inside = std::max(inside, beyond);
  }
  return outside > 0 ? std::sqrt(outside) : std::min(inside, 0.0);
}
Mesh centered_box(const Vec3& h) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.push_back({(k & 1) != 0 ? h.x : -h.x, (k & 2) != 0 ? h.y : -h.y, (k & 4) != 0 ? h.z : -h.z});
  mesh.facets = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A world, and distances from its obstacles by other means.
struct Scene {
  World world;
  std::vector<Distance> distances{};

  Scene() = default;
  Scene(Random& random, const Vec3& at, double size) {
    const auto pose = [&] {
      RigidTransform t = random_pose(random, 1.2 * size);
      t.translation += at;
      return t;
    };
    const auto half = [&] {
      const double x = random.uniform(0.02, 0.25), y = random.uniform(0.02, 0.25);
      return Vec3{x, y, random.uniform(0.02, 0.25)} * size;
    };
    for (int i = 0; i < 2; ++i) {
      const ObstacleBox box{pose(), half()}, solid{pose(), half()}, plate{pose(), {0.3 * size, 0.2 * size, 0}};
      add(world.add(box), [box](const Vec3& p) { return box_distance(box, p); });
      add(world.add(centered_box(solid.half), solid.pose), [solid](const Vec3& p) { return box_distance(solid, p); });
      Mesh sheet;
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        sheet.positions.push_back({x * plate.half.x, y * plate.half.y, 0});
      sheet.facets = {{0, 1, 2}, {0, 2, 3}};
      add(world.add(sheet, plate.pose), [plate](const Vec3& p) { return std::abs(box_distance(plate, p)); });
      const Sphere ball{pose().translation, 0.15 * size};
      add(world.add(ball), [ball](const Vec3& p) { return distance(p, ball.center) - ball.radius; });
      const Capsule rod{pose().translation, pose().translation, 0.05 * size};
      add(world.add(rod), [rod](const Vec3& p) {
        const Vec3 along = rod.q - rod.p;
        const double t = dot(p - rod.p, along) / dot(along, along);
        return distance(p, t < 0 ? rod.p : t > 1 ? rod.q : rod.p + t * along) - rod.radius;
      });
      std::vector<Vec3> points;
      for (int k = 0; k < 200; ++k) points.push_back(at + random_point(random, 1.5 * size));
      add(world.add_points(points, 0.02 * size), [points, size](const Vec3& p) {
        double least = 1e300;
        for (const Vec3& q : points) least = std::min(least, distance(p, q));
        return least - 0.02 * size;
      });
    }
    const RigidTransform ground{.translation = at - Vec3{size, size, 0}};
    const std::vector<double> heights(12, -0.6 * size);
    add(world.add(robot::HeightField{heights, 4, 3, 0.7 * size, ground}), [at, size](const Vec3& p) {
      const Vec3 q = p - (at - Vec3{size, size, 0});
      const double deep = 1e6 * size;
      return box_distance(
          {{.translation = {1.05 * size, 0.7 * size, -0.6 * size - deep}}, {1.05 * size, 0.7 * size, deep}}, q);
    });
  }
  void add(std::size_t number, const Distance& distance) {
    EXPECT_EQ(number, distances.size());
    distances.push_back(distance);
  }
};

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

/// One link with one sphere, which slides along x.
struct Slider {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  Slider() {
    robot.links.resize(2);
    robot.links[0].name = "rail", robot.links[1].name = "slide";
    robot.links[1].joint = 0;
    robot::Joint joint;
    joint.kind = robot::Joint::Kind::prismatic;
    joint.parent = 0, joint.child = 1;
    robot.joints = {joint};
    robot.order = robot.independent_joints = {0};
    robot.root = 0;
    robot::LinkSpheres link;
    link.link = 1;
    link.spheres = {{{0, 0, 0}, 0.25}};
    spheres.links = {link};
  }
};

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

TEST(Worlds, CopiesKeepWhatTheyHave) {
  World first;
  first.add(Sphere{{}, 1});
  World second = first;
  EXPECT_EQ(second.add(Sphere{{9, 0, 0}, 1}), 1u);
  EXPECT_EQ(first.size(), 1u);
  EXPECT_EQ(second.nearest({8, 0, 0}).obstacle, 1u);
  World moved = std::move(second);
  EXPECT_EQ(moved.size(), 2u);
  // A world that was moved from is empty, also where the other one was not.
  World third = first;
  third = std::move(moved);
  EXPECT_EQ(third.size(), 2u);
  EXPECT_EQ(moved.size(), 0u);  // NOLINT(bugprone-use-after-move)
}

TEST(Worlds, FindTheNearestObstacle) {
  Random random(5);
  const Scene scene(random, {}, 1);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random_point(random, 2);
    double least = 1e300;
    for (const Distance& distance : scene.distances) least = std::min(least, distance(p));
    const robot::NearestObstacle found = scene.world.nearest(p);
    ASSERT_NEAR(found.distance, least, 1e-9);
    EXPECT_NEAR(scene.distances[found.obstacle](p), least, 1e-9);
    EXPECT_NEAR(length(found.direction), 1, 1e-9);
    // Along the direction the distance of that obstacle grows.
    EXPECT_NEAR(scene.distances[found.obstacle](p + 1e-6 * found.direction), least + 1e-6, 2e-7) << found.obstacle;
    EXPECT_EQ(scene.world.nearest(p, least + 1e-6).obstacle, found.obstacle);
    EXPECT_EQ(scene.world.nearest(p, least - 1e-6).obstacle, robot::none);
  }
}

TEST(Worlds, MeshesTouchWhereTheirDistanceSays) {
  Random random(8);
  for (const double size : {1.0, 1e-9, 1e9}) {
    const Vec3 half{0.5 * size, 0.3 * size, 0.1 * size};
    const ObstacleBox box{{}, half};
    World world;
    world.add(centered_box(half));
    Slider slider;
    for (int i = 0; i < 600; ++i) {
      const Vec3 p = random_point(random, 0.55 * size);
      const double exact = box_distance(box, p), gap = (i % 2 == 0 ? 1e-7 : -1e-7) * size;
      if (exact <= gap) continue;
      slider.robot.joints[0].origin.translation = {0, p.y, p.z};
      slider.spheres.links[0].spheres[0].radius = exact - gap;
      ConfigurationVerdict verdict;
      ConfigurationQuery(slider.robot, slider.spheres).check(std::span(&p.x, 1), world, std::span(&verdict, 1));
      EXPECT_EQ(verdict.is_free(), gap > 0);
    }
  }
}

// A triangle and the same one reversed: closed and oriented, without a volume.
TEST(Worlds, FlatMeshesHaveNoInside) {
  Random random(13);
  for (int k = 0; k < 100; ++k) {
    Mesh mesh;
    for (int i = 0; i < 3; ++i) mesh.positions.push_back(random_point(random, 1));
    mesh.facets = {{0, 1, 2}};
    World single, twice;
    single.add(mesh);
    mesh.facets.push_back({0, 2, 1});
    twice.add(mesh);
    for (int i = 0; i < 20; ++i) {
      const Vec3 p = random_point(random, 1);
      EXPECT_NEAR(twice.nearest(p).distance, single.nearest(p).distance, 1e-12);
    }
  }
}

TEST(Worlds, TerrainIsTheSolidBelowItsSurface) {
  // The same solid as a closed mesh with a deep floor.
  Random random(6);
  constexpr std::uint32_t columns = 5, rows = 4;
  std::vector<double> heights;
  for (std::uint32_t i = 0; i < columns * rows; ++i) heights.push_back(random.uniform(-0.5, 0.5));
  Mesh solid;
  for (const bool is_floor : {false, true}) {
    for (std::uint32_t i = 0; i < columns * rows; ++i)
      solid.positions.push_back({0.5 * (i % columns), 0.5 * (i / columns), is_floor ? -100 : heights[i]});
  }
  const std::uint32_t floor = columns * rows;
  for (std::uint32_t k = 0; k + 1 < rows; ++k) {
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = k * columns + i, b = a + 1, c = b + columns, d = a + columns;
      for (const Facet& f : {Facet{a, b, c}, Facet{a, c, d}}) {
        solid.facets.push_back(f);
        solid.facets.push_back({f[2] + floor, f[1] + floor, f[0] + floor});
      }
    }
  }
  const auto wall = [&](std::uint32_t from, std::uint32_t to) {
    solid.facets.push_back({from + floor, to + floor, to});
    solid.facets.push_back({from + floor, to, from});
  };
  for (std::uint32_t i = 0; i + 1 < columns; ++i) wall(i, i + 1), wall(floor - 1 - i, floor - 2 - i);
  for (std::uint32_t k = 0; k + 1 < rows; ++k)
    wall((k + 1) * columns - 1, (k + 2) * columns - 1), wall((k + 1) * columns, k * columns);
  const SignedDistance plain(solid);
  ASSERT_TRUE(plain.has_volume());
  const RigidTransform pose = random_pose(random, 1);
  World world;
  world.add(robot::HeightField{heights, columns, rows, 0.5, pose});
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = Vec3{1, 0.75, 0} + random_point(random, 1.5);
    ASSERT_NEAR(world.nearest(pose(p)).distance, plain(p), 1e-9);
  }
}

TEST(Worlds, BordersOfTerrainLeadOutward) {
  World world;
  world.add(robot::HeightField{std::vector<double>(4), 2, 2});
  const std::array<std::pair<Vec3, Vec3>, 4> borders{{{{0, 0.5, -0.3}, {-1, 0, 0}},
                                                      {{1, 0.5, -0.3}, {1, 0, 0}},
                                                      {{0.5, 0, -0.3}, {0, -1, 0}},
                                                      {{0.5, 1, -0.3}, {0, 1, 0}}}};
  for (const auto& [on, outward] : borders) {
    for (const double out : {-1e-3, 0.0, 1e-200, 1e-3}) {
      const robot::NearestObstacle found = world.nearest(on + out * outward);
      EXPECT_NEAR(found.distance, out, 1e-15);
      EXPECT_EQ(found.direction, outward) << out;
    }
  }
}

}  // namespace
}  // namespace morula::test::configurations

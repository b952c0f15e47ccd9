// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Clearances of configurations, against all spheres and obstacles one by one, in long double: with matrices and
// formulas of their own, and gradients against differences.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/configurations.hpp>

#include "random_poses.hpp"
#include "terrain_distance.hpp"

namespace morula::test::clearance {
namespace {

using Real = long double;
using Point = std::array<Real, 3>;
using robot::Clearance;
using robot::ConfigurationQuery;
using robot::ConfigurationVerdict;
using robot::ObstacleBox;
using robot::World;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::uint32_t no_link = ConfigurationVerdict::free_link;

Point wide(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Real norm(const Point& p) {
  return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}
Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Real inner(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A matrix of 4 × 4 numbers, whose last row is 0, 0, 0, 1.
struct Matrix {
  Real m[4][4]{};
  explicit Matrix(const RigidTransform& t = {}) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& row = t.rows[static_cast<std::size_t>(i)];
      m[i][0] = row.x, m[i][1] = row.y, m[i][2] = row.z, m[i][3] = t.translation[i];
    }
    m[3][3] = 1;
  }
  Matrix operator*(const Matrix& other) const {
    Matrix r;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        r.m[i][j] = 0;
        for (int k = 0; k < 4; ++k) r.m[i][j] += m[i][k] * other.m[k][j];
      }
    }
    return r;
  }
  Point operator()(const Vec3& p) const {
    Point r{};
    for (std::size_t i = 0; i < 3; ++i) r[i] = m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3];
    return r;
  }
};

// Rodrigues' formula.
Matrix rotation(const Vec3& axis, Real angle) {
  Point a = wide(axis);
  const Real size = norm(a), c = std::cos(angle), s = std::sin(angle), v = 1 - c;
  for (Real& x : a) x /= size;
  Matrix r;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) r.m[i][j] = a[i] * a[j] * v + (i == j ? c : 0);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    r.m[i][(i + 1) % 3] -= a[(i + 2) % 3] * s;
    r.m[(i + 1) % 3][i] += a[(i + 2) % 3] * s;
  }
  return r;
}

using Distance = std::function<Real(const Point&)>;

Distance of_sphere(const Sphere& s) {
  return [s](const Point& p) { return norm(minus(p, wide(s.center))) - s.radius; };
}
Distance of_box(const ObstacleBox& box) {
  return [box](const Point& p) {
    const Point d = minus(p, wide(box.pose.translation));
    Real outside = 0, inside = -1e300L;
    for (int k = 0; k < 3; ++k) {
      Real along = 0;
      for (std::size_t i = 0; i < 3; ++i) along += d[i] * box.pose.rows[i][k];
      const Real beyond = std::abs(along) - box.half[k];
      outside += beyond > 0 ? beyond * beyond : 0;
      inside = std::max(inside, beyond);
    }
    return outside > 0 ? std::sqrt(outside) : inside;
  };
}
Real to_segment(const Point& p, const Point& a, const Point& b) {
  const Point ab = minus(b, a), ap = minus(p, a);
  const Real t = std::clamp(inner(ap, ab) / inner(ab, ab), Real{0}, Real{1});
  return norm({ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]});
}
Distance of_capsule(const Capsule& c) {
  return [c](const Point& p) { return to_segment(p, wide(c.p), wide(c.q)) - c.radius; };
}
Distance of_spheres(std::vector<Sphere> spheres) {
  return [spheres](const Point& p) {
    Real least = infinite;
    for (const Sphere& s : spheres) least = std::min(least, norm(minus(p, wide(s.center))) - s.radius);
    return least;
  };
}
/// A convex mesh: inside is where all planes have the point below them.
Distance of_convex(const Mesh& mesh, bool is_solid) {
  return [mesh, is_solid](const Point& p) {
    Real least = infinite;
    bool inside = is_solid;
    for (const Facet& f : mesh.facets) {
      const Point a = wide(mesh.positions[f[0]]), b = wide(mesh.positions[f[1]]), c = wide(mesh.positions[f[2]]);
      const Point u = minus(b, a), v = minus(c, a), d = minus(p, a);
      const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
      const Real uu = inner(u, u), uv = inner(u, v), vv = inner(v, v), du = inner(d, u), dv = inner(d, v);
      const Real s = (du * vv - dv * uv) / (uu * vv - uv * uv), t = (dv * uu - du * uv) / (uu * vv - uv * uv);
      const Real height = inner(d, n) / norm(n);
      if (s >= 0 && t >= 0 && s + t <= 1)
        least = std::min(least, std::abs(height));
      else
        least = std::min({least, to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
      inside = inside && height < 0;
    }
    return inside ? -least : least;
  };
}
Mesh tetrahedron(const Vec3& at, double size) {
  Mesh mesh;
  mesh.positions = {at, at + Vec3{size, 0, 0}, at + Vec3{0, 1.3 * size, 0}, at + Vec3{0, 0, 0.8 * size}};
  mesh.facets = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

struct Exact {
  Real distance = infinite, second = infinite;  // least, and the least of another pair of spheres and obstacles
  std::uint32_t link = no_link, other_link = no_link, obstacle = no_link;
  void add(Real d, std::size_t a, std::uint32_t b, std::uint32_t o) {
    if (d < distance) {
      second = distance, distance = d;
      link = static_cast<std::uint32_t>(a), other_link = b, obstacle = o;
    } else {
      second = std::min(second, d);
    }
  }
};

/// A robot with all kinds of joints in a world with all kinds of obstacles.
struct Scene {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  robot::SelfCollision self;
  RigidTransform base;
  World world;
  std::vector<Distance> obstacles;
  std::size_t holder = robot::none, touched = robot::none;
  std::vector<Sphere> object;
  double scale;

  Scene(std::uint64_t seed, double size, const Vec3& center) : scale(size) {
    Random random(seed);
    base = random_pose(random, 0.1 * scale);
    base.translation = base.translation + center;
    add_links(random);
    for (int k = 0; k < 3; ++k) add_obstacles(random, center);
    add_terrain(random, center);
  }

  void add_links(Random& random) {
    using Kind = robot::Joint::Kind;
    constexpr std::size_t links = 9;
    for (std::size_t i = 0; i < links; ++i) {
      robot.links.emplace_back().name = "link" + std::to_string(i);
      robot::LinkSpheres& link = spheres.links.emplace_back();
      link.link = i;
      for (int k = 0; k < 6; ++k)
        link.spheres.push_back({random_point(random, 0.12 * scale), random.uniform(0.01, 0.05) * scale});
      if (i == 0) continue;
      robot::Joint joint;
      joint.kind = std::array{Kind::revolute, Kind::continuous, Kind::prismatic, Kind::fixed}[i % 4];
      joint.child = i, joint.parent = i == 6 ? 2 : i - 1;
      joint.origin = random_pose(random, 0.35 * scale);
      joint.axis = normalized(random_point(random, 1));
      if (i == 5) joint.mimic = robot::Joint::Mimic{robot.independent_joints[0], -1.7, 0.2};
      if (i == 8) joint.mimic = robot::Joint::Mimic{robot.independent_joints[1], 0.6, -0.1};
      robot.links[i].joint = i - 1;
      robot.order.push_back(i - 1);
      if (joint.moves() && !joint.mimic) robot.independent_joints.push_back(i - 1);
      robot.joints.push_back(joint);
      self.ignored.push_back({joint.parent, i});
    }
    robot.root = 0;
  }

  template <class Shape>
  void add(const Shape& shape, Distance distance) {
    world.add(shape);
    obstacles.push_back(std::move(distance));
  }
  void add_obstacles(Random& random, const Vec3& center) {
    const auto point = [&] { return center + random_point(random, 0.9 * scale); };
    const Sphere sphere{point(), 0.1 * scale};
    add(sphere, of_sphere(sphere));
    ObstacleBox box{random_pose(random, 0), random_point(random, 0.2 * scale)};
    box.half = {std::abs(box.half.x), std::abs(box.half.y), std::abs(box.half.z)};
    box.pose.translation = point();
    add(box, of_box(box));
    const Vec3 end = point();
    const Capsule capsule{end, end + random_point(random, 0.2 * scale), 0.05 * scale};
    add(capsule, of_capsule(capsule));
    const Mesh solid = tetrahedron(point(), 0.3 * scale);
    add(solid, of_convex(solid, true));
    Mesh open = tetrahedron(point(), 0.3 * scale);
    open.facets.pop_back();
    add(open, of_convex(open, false));
    std::vector<Sphere> cloud;
    const Vec3 middle = point();
    for (int k = 0; k < 40; ++k) cloud.push_back({middle + random_point(random, 0.1 * scale), 0.01 * scale});
    world.add_spheres(cloud);
    obstacles.push_back(of_spheres(cloud));
  }

  /// A small terrain whose open side faces the center: its solid has no lower end.
  void add_terrain(Random& random, const Vec3& center) {
    const Vec3 up = normalized(random_point(random, 1)), side = normalized(cross(up, {0.3, -0.5, 0.8}));
    const Vec3 along = cross(up, side);
    RigidTransform pose{{Vec3{side.x, along.x, up.x}, {side.y, along.y, up.y}, {side.z, along.z, up.z}}};
    pose.translation = center - (0.7 * scale) * up;
    std::vector<double> heights;
    for (int k = 0; k < 20; ++k) heights.push_back(random.uniform(-0.1, 0.1) * scale);
    const robot::HeightField field{heights, 5, 4, 0.15 * scale, pose};
    add(field, TerrainDistance(field));
  }

  void hold(ConfigurationQuery& query) {
    holder = 7, touched = 2;
    object = {{{0.1 * scale, 0, 0}, 0.06 * scale}, {{0.2 * scale, 0.05 * scale, 0}, 0.05 * scale}};
    query.attach("link7", object, std::array<std::string, 1>{"link2"}, std::array<std::size_t, 2>{6, 1});
    query.allow_contacts("link0", std::array<std::size_t, 3>{0, 3, 99});
  }
  ConfigurationQuery query() const {
    ConfigurationQuery result(robot, spheres, self);
    result.set_base(base);
    return result;
  }
  std::vector<double> configuration(Random& random) const { return random_values(robot, random, 0.3 * scale); }

  std::vector<Matrix> poses(const std::vector<Real>& values) const {
    std::vector<Matrix> result(robot.links.size());
    result[0] = Matrix(base);
    const auto value_of = [&](std::size_t j) {
      const auto& all = robot.independent_joints;
      return values[static_cast<std::size_t>(std::find(all.begin(), all.end(), j) - all.begin())];
    };
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const robot::Joint& joint = robot.joints[i];
      Matrix motion;
      if (joint.moves()) {
        const Real value =
            joint.mimic ? joint.mimic->multiplier * value_of(joint.mimic->joint) + joint.mimic->offset : value_of(i);
        if (joint.kind == robot::Joint::Kind::prismatic) {
          for (int k = 0; k < 3; ++k) motion.m[k][3] = value * joint.axis[k];
        } else {
          motion = rotation(joint.axis, value);
        }
      }
      result[joint.child] = result[joint.parent] * Matrix(joint.origin) * motion;
    }
    return result;
  }

  struct Ball {
    std::size_t link;
    bool held;
    Point center;
    Real radius;
  };
  std::vector<Ball> balls(const std::vector<Real>& values) const {
    const std::vector<Matrix> at = poses(values);
    std::vector<Ball> result;
    for (const robot::LinkSpheres& link : spheres.links)
      for (const Sphere& s : link.spheres) result.push_back({link.link, false, at[link.link](s.center), s.radius});
    for (const Sphere& s : object) result.push_back({holder, true, at[holder](s.center), s.radius});
    return result;
  }
  bool is_tested(const Ball& a, const Ball& b) const {
    if (a.link == b.link) return false;
    if (a.held || b.held) return (a.held ? b.link : a.link) != touched;
    return std::none_of(self.ignored.begin(), self.ignored.end(), [&](const robot::IgnoredPair& pair) {
      return (pair.a == a.link && pair.b == b.link) || (pair.a == b.link && pair.b == a.link);
    });
  }
  Exact exact(const std::vector<Real>& values, bool with_world = true, bool with_self = true) const {
    Exact result;
    const std::vector<Ball> all = balls(values);
    for (const Ball& ball : all) {
      for (std::size_t o = 0; with_world && o < obstacles.size(); ++o) {
        if (holder != robot::none && (ball.held ? o == 1 || o == 6 : ball.link == 0 && (o == 0 || o == 3))) continue;
        result.add(obstacles[o](ball.center) - ball.radius, ball.link, no_link, static_cast<std::uint32_t>(o));
      }
    }
    for (const Ball& a : all) {
      for (const Ball& b : all) {
        if (with_self && a.link < b.link && is_tested(a, b))
          result.add(norm(minus(a.center, b.center)) - a.radius - b.radius, a.link, static_cast<std::uint32_t>(b.link),
                     no_link);
      }
    }
    return result;
  }
};

std::vector<Real> wide(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}
Clearance one(const ConfigurationQuery& query, const std::vector<double>& values, const World& world,
              const robot::ClearanceOptions& options = {}, std::span<double> gradient = {}) {
  Clearance result;
  query.clearance(values, world, {&result, 1}, gradient, options);
  return result;
}

void expect_same(const Clearance& found, const Exact& exact, double width) {
  EXPECT_LE(found.lower, exact.distance);
  EXPECT_GE(found.upper, exact.distance);
  EXPECT_LE(found.lower, found.distance);
  EXPECT_GE(found.upper, found.distance);
  EXPECT_LE(found.upper - found.lower, width);
  if (exact.second - exact.distance <= width) return;
  EXPECT_EQ(found.link, exact.link);
  EXPECT_EQ(found.other_link, exact.other_link);
  EXPECT_EQ(found.obstacle, exact.obstacle);
}

struct Place {
  double scale;
  Vec3 center;
};
const std::array places{Place{1, {}}, Place{1, {1e6, -2e6, 3e5}}, Place{1e-9, {}}, Place{1e-9, {1e-3, 0, 2e-3}},
                        Place{1e5, {}}};

TEST(Clearance, is_that_of_all_spheres_and_obstacles_one_by_one) {
  std::size_t contacts = 0, of_links = 0, of_terrain = 0, count = 0;
  for (const Place& place : places) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Scene scene(seed, place.scale, place.center);
      ConfigurationQuery query = scene.query();
      if (seed == 2) scene.hold(query);
      const double width = 2e-10 * (max_norm(place.center) + place.scale);
      Random random(seed + 100);
      for (int k = 0; k < 60; ++k) {
        const std::vector<double> values = scene.configuration(random);
        const bool with_world = k % 3 != 1, with_self = k % 3 != 2;
        const Exact exact = scene.exact(wide(values), with_world, with_self);
        const Clearance found = one(query, values, scene.world, {.world = with_world, .self = with_self});
        expect_same(found, exact, width);
        contacts += found.distance < 0, of_links += found.other_link != no_link, ++count;
        of_terrain += found.obstacle + 1 == scene.obstacles.size();
      }
    }
  }
  EXPECT_GT(contacts, count / 5);
  EXPECT_LT(contacts, count);
  EXPECT_GT(of_links, count / 10);
  EXPECT_LT(of_links, count);
  EXPECT_GT(of_terrain, count / 50);
}

TEST(Clearance, a_gradient_is_the_limit_of_differences) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Scene scene(seed, 1, {0.3, 0, -0.2});
    ConfigurationQuery query = scene.query();
    if (seed % 2 == 0) scene.hold(query);
    Random random(seed + 7);
    for (int k = 0; k < 60; ++k) {
      const std::vector<double> values = scene.configuration(random);
      std::vector<double> gradient(values.size(), 5);
      const robot::ClearanceOptions options{.world = k % 2 == 0, .self = k % 2 != 0};
      const Clearance found = one(query, values, scene.world, options, gradient);
      const Real step = 1e-7L;
      std::vector<Real> differences, backward;
      const Exact here = scene.exact(wide(values), options.world, options.self);
      if (here.second - here.distance < 1e-4) continue;
      EXPECT_EQ(found.link, here.link);
      for (std::size_t c = 0; c < values.size(); ++c) {
        std::vector<Real> more = wide(values), less = more;
        more[c] += step, less[c] -= step;
        const Real up = scene.exact(more, options.world, options.self).distance,
                   down = scene.exact(less, options.world, options.self).distance;
        // On a ridge, such as halfway between faces of a box, there is no derivative.
        if (std::abs((up - here.distance) - (here.distance - down)) > 1e-4L * step) continue;
        EXPECT_NEAR(gradient[c], static_cast<double>((up - down) / (2 * step)), 1e-6) << seed << " " << k << " " << c;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 800U);
}

TEST(Clearance, a_limit_hides_what_is_farther_away) {
  Scene scene(5, 1, {});
  for (robot::LinkSpheres& link : scene.spheres.links) {
    for (Sphere& s : link.spheres) s.radius *= 0.02;
  }
  const ConfigurationQuery query = scene.query();
  Random random(3);
  constexpr std::size_t count = 200;
  std::vector<std::vector<double>> configurations, gradients;
  std::vector<Clearance> wholes;
  std::vector<double> distances;
  for (std::size_t k = 0; k < count; ++k) {
    configurations.push_back(scene.configuration(random));
    std::vector<double>& gradient = gradients.emplace_back(query.coordinates());
    wholes.push_back(one(query, configurations.back(), scene.world, {}, gradient));
    distances.push_back(wholes.back().distance);
  }
  std::sort(distances.begin(), distances.end());
  const double limit = distances[count * 3 / 4];
  ASSERT_GT(limit, 0);
  for (std::size_t k = 0; k < count; ++k) {
    const Clearance& whole = wholes[k];
    std::vector<double> gradient(query.coordinates(), 5);
    const Clearance found = one(query, configurations[k], scene.world, {.limit = limit}, gradient);
    const bool is_near = whole.distance < limit;
    EXPECT_EQ(found.distance, is_near ? whole.distance : limit);
    EXPECT_EQ(found.link, is_near ? whole.link : no_link);
    EXPECT_EQ(found.obstacle, is_near ? whole.obstacle : no_link);
    EXPECT_EQ(gradient, is_near ? gradients[k] : std::vector<double>(query.coordinates(), 0.0));
    EXPECT_LE(found.lower, found.distance);
    EXPECT_GE(found.upper, found.distance);
    EXPECT_LE(found.upper, limit);
    EXPECT_LE(found.lower, whole.upper);
  }
}

/// One sphere that slides along x.
struct Slider {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  explicit Slider(double radius = 1) {
    robot.links.resize(2);
    robot.links[0].name = "rail", robot.links[1].name = "slider";
    robot::Joint joint;
    joint.kind = robot::Joint::Kind::prismatic;
    joint.parent = 0, joint.child = 1, joint.axis = {1, 0, 0};
    robot.joints = {joint}, robot.order = {0}, robot.independent_joints = {0};
    robot.links[1].joint = 0, robot.root = 0;
    spheres.links.resize(1);
    spheres.links[0].link = 1;
    spheres.links[0].spheres = {{{}, radius}};
  }
};

TEST(Clearance, of_a_ball_among_known_shapes) {
  const Slider slider;
  const ConfigurationQuery query(slider.robot, slider.spheres);
  double gradient = 0;
  const auto at = [&](double x, const World& world) { return one(query, {x}, world, {}, {&gradient, 1}); };
  World ball;
  ball.add(Sphere{{8, 0, 0}, 2});
  EXPECT_EQ(at(0, ball).distance, 5);
  EXPECT_EQ(gradient, -1);
  EXPECT_EQ(at(7, ball).distance, -2);
  EXPECT_EQ(gradient, -1);
  // At the center every direction leads out; it is the same one each time.
  EXPECT_EQ(at(8, ball).distance, -3);
  const double first = gradient;
  EXPECT_LE(std::abs(first), 1);
  at(8, ball);
  EXPECT_EQ(gradient, first);

  // Inside a closed mesh the distance is the depth; of an open one only the surface counts.
  const Mesh closed = tetrahedron({-1, -1, -1}, 100);
  Mesh open = closed;
  open.facets.erase(open.facets.begin() + 3);
  World inside, surface;
  inside.add(closed), surface.add(open);
  EXPECT_NEAR(at(0, inside).distance, -2, 1e-12);
  EXPECT_NEAR(at(0, surface).distance, 0, 1e-12);

  // Of equals the lowest counts.
  World two;
  two.add(Sphere{{-5, 0, 0}, 1}), two.add(Sphere{{5, 0, 0}, 1});
  EXPECT_EQ(at(0, two).obstacle, 0U);
  EXPECT_EQ(gradient, 1);
  // Also if the link itself is near to another one than the object that it holds.
  ConfigurationQuery holding = query;
  holding.attach("slider", std::vector<Sphere>{{{4, 0, 0}, 1}});
  World apart;
  apart.add(Sphere{{9, 0, 0}, 1}), apart.add(Sphere{{-5, 0, 0}, 1});
  EXPECT_EQ(one(holding, {0}, apart).distance, 3);
  EXPECT_EQ(one(holding, {0}, apart).obstacle, 0U);
  // Of overlapping ones, that which the ball is deepest in.
  two.add(Sphere{{1, 0, 0}, 4});
  EXPECT_EQ(at(0, two).obstacle, 2U);
  EXPECT_EQ(at(0, two).distance, -4);

  const Clearance none = at(0, World{});
  EXPECT_EQ(none.distance, infinite);
  EXPECT_EQ(none.lower, infinite);
  EXPECT_EQ(none.link, no_link);
  EXPECT_EQ(gradient, 0);
}

// The robot is at the origin, where its own numbers are exact; those of the obstacle are not.
TEST(Clearance, bounds_contain_what_rounding_of_obstacles_does) {
  const Slider slider;
  const ConfigurationQuery query(slider.robot, slider.spheres);
  Random random(11);
  for (int k = 0; k < 200; ++k) {
    const Sphere sphere{random_point(random, 1e6), random.uniform(0.1, 1)};
    ObstacleBox box{random_pose(random, 1e6), {1, 2, 3}};
    const std::vector<double> heights{0.3, -0.2, 0.1, 0.4};
    const robot::HeightField field{heights, 2, 2, 1.5, random_pose(random, 1e6)};
    World balls, boxes, fields;
    balls.add(sphere), boxes.add(box), fields.add(field);
    for (const auto& [world, distance] : {std::pair{&balls, of_sphere(sphere)}, std::pair{&boxes, of_box(box)},
                                          std::pair{&fields, Distance(TerrainDistance(field))}}) {
      const Clearance found = one(query, {0}, *world);
      const Real exact = distance({}) - 1;
      EXPECT_LE(found.lower, exact);
      EXPECT_GE(found.upper, exact);
      // Searches of triangles have wider bounds.
      EXPECT_LE(found.upper - found.lower, world == &fields ? 1e-5 : 1e-7);
    }
  }
}

TEST(Clearance, does_not_depend_on_the_batch_or_workers) {
  const Scene scene(9, 1, {});
  const ConfigurationQuery query = scene.query();
  Random random(1);
  std::vector<double> values;
  constexpr std::size_t count = 300;
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> more = scene.configuration(random);
    values.insert(values.end(), more.begin(), more.end());
  }
  std::vector<Clearance> batch(count);
  std::vector<double> gradients(values.size());
  Workers three(3);
  query.clearance(values, scene.world, batch, gradients, {}, three);
  const std::size_t n = query.coordinates();
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::ptrdiff_t>(i * n), end = static_cast<std::ptrdiff_t>(i * n + n);
    std::vector<double> gradient(n);
    const Clearance single = one(query, {values.begin() + at, values.begin() + end}, scene.world, {}, gradient);
    EXPECT_EQ(single.distance, batch[i].distance);
    EXPECT_EQ(single.lower, batch[i].lower);
    EXPECT_EQ(single.upper, batch[i].upper);
    EXPECT_EQ(single.obstacle, batch[i].obstacle);
    EXPECT_EQ(gradient, std::vector<double>(gradients.begin() + at, gradients.begin() + end));
  }
}

// A long arm whose joints turn by large angles: the pose is off by far more than the distance itself is rounded.
TEST(Clearance, bounds_contain_what_rounding_of_joints_does) {
  using Kind = robot::Joint::Kind;
  robot::Robot robot;
  robot.root = 0;
  robot.links.resize(12);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    robot.links[i].name = "link" + std::to_string(i);
    if (i == 0) continue;
    robot::Joint joint;
    joint.kind = Kind::continuous;
    joint.parent = i - 1, joint.child = i, joint.axis = i % 2 == 0 ? Vec3{0, 0, 1} : Vec3{0, 0.6, 0.8};
    joint.origin.translation = {1, 0, 0};
    robot.joints.push_back(joint);
    robot.order.push_back(i - 1), robot.independent_joints.push_back(i - 1), robot.links[i].joint = i - 1;
  }
  robot::RobotSpheres spheres;
  spheres.links.resize(1);
  spheres.links[0].link = 11;
  spheres.links[0].spheres = {{{1000, 0, 0}, 0.5}};
  Scene scene(1, 1, {});
  scene.robot = robot, scene.spheres = spheres, scene.base = {}, scene.self = {};
  scene.world = World{}, scene.obstacles.clear();
  const Sphere target{{3000, 0, 0}, 1};
  scene.add(target, of_sphere(target));
  const ConfigurationQuery query = scene.query();
  Random random(5);
  double largest = 0;
  for (int k = 0; k < 300; ++k) {
    std::vector<double> values = scene.configuration(random);
    for (double& v : values) v *= k % 2 == 0 ? 1 : 1e9;
    const Clearance found = one(query, values, scene.world);
    const Exact exact = scene.exact(wide(values));
    EXPECT_LE(found.lower, exact.distance);
    EXPECT_GE(found.upper, exact.distance);
    EXPECT_LE(found.upper - found.lower, k % 2 == 0 ? 1e-8 : 1);
    largest = std::max(largest, static_cast<double>(std::abs(found.distance - exact.distance)));
  }
  // Far more than what distances of this size are rounded by.
  EXPECT_GT(largest, 1e-6);
}

TEST(Clearance, rejects_what_it_cannot_use) {
  const Slider slider;
  const ConfigurationQuery query(slider.robot, slider.spheres);
  std::vector<Clearance> one_place(1);
  std::vector<double> gradient(1), two(2);
  const std::vector<double> value{0.5}, bad{std::nan("")};
  EXPECT_THROW(query.clearance(bad, {}, one_place), std::invalid_argument);
  EXPECT_THROW(query.clearance(two, {}, one_place), std::invalid_argument);
  EXPECT_THROW(query.clearance(value, {}, one_place, two), std::invalid_argument);
  for (const double limit : {0.0, -1.0, std::nan("")})
    EXPECT_THROW(query.clearance(value, {}, one_place, gradient, {.limit = limit}), std::invalid_argument);
  query.clearance({}, {}, {});
}

}  // namespace
}  // namespace morula::test::clearance

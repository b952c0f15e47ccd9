// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Merge, burst and expand, against brute force on small sets.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <generators/reduce/ball_set.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/medial/medial_balls.hpp>
#include <support/meshes.hpp>

namespace morula {
using namespace detail;
namespace {

std::vector<Vec3> surface_points(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
  std::vector<Vec3> points;
  for (const SurfacePoint& s : sample_surface(mesh, count, seed)) points.push_back(s.point);
  return points;
}

BallSet medial_set(const SignedDistance& shape, std::span<const Vec3> samples) {
  std::vector<Sphere> balls = voronoi_balls(shape, samples).balls;
  std::vector<double> distances;
  for (const Sphere& b : balls) distances.push_back(shape(b.center));
  return {std::move(balls), std::move(distances), samples};
}

bool contain(std::span<const Sphere> spheres, const Vec3& p) {
  return std::any_of(spheres.begin(), spheres.end(),
                     [&](const Sphere& s) { return distance(s.center, p) <= s.radius * (1 + 1e-9); });
}

std::vector<std::vector<Sphere>> all_reductions_of(const BallSet& set, std::size_t branching,
                                                   const SignedDistance& shape) {
  return {merge(set, branching, shape).balls, burst(set, branching, shape).balls, expand(set, branching)};
}

TEST(BallSet, reductions_contain_all_samples_with_few_spheres) {
  for (const char* body : {"limb", "torus", "plate"}) {
    const Mesh mesh = sample_body(body, 16);
    const SignedDistance shape(mesh);
    const std::vector<Vec3> samples = surface_points(mesh, 150, 1);
    const BallSet set = medial_set(shape, samples);
    ASSERT_GT(set.size(), 30u) << body;
    for (const std::size_t branching : {std::size_t{2}, std::size_t{8}, std::size_t{64}})
      for (const std::vector<Sphere>& spheres : all_reductions_of(set, branching, shape)) {
        EXPECT_FALSE(spheres.empty());
        EXPECT_LE(spheres.size(), branching);
        for (const Vec3& p : samples) EXPECT_TRUE(contain(spheres, p)) << body << " " << branching;
      }
  }
}

TEST(BallSet, reductions_are_deterministic) {
  const Mesh mesh = sample_body("blob", 16);
  const SignedDistance shape(mesh);
  const BallSet set = medial_set(shape, surface_points(mesh, 120, 2));
  EXPECT_EQ(all_reductions_of(set, 8, shape), all_reductions_of(set, 8, shape));
}

TEST(BallSet, reductions_of_nothing_are_nothing) {
  const SignedDistance shape(test::icosphere(1));
  const std::vector<Vec3> none, one{{1, 0, 0}};
  for (const BallSet& set : {BallSet({}, {}, one), BallSet({{{0, 0, 0}, 1}}, {-1}, none), BallSet({}, {}, none)})
    for (const std::vector<Sphere>& spheres : all_reductions_of(set, 4, shape)) EXPECT_TRUE(spheres.empty());
}

TEST(BallSet, reductions_survive_samples_that_are_all_equal_or_in_one_line_and_balls_that_are_points) {
  const SignedDistance shape(test::box_mesh({0, 0, 0}, {4, 1, 1}));
  const std::vector<Vec3> equal(10, Vec3{1, 0, 0});
  std::vector<Vec3> line;
  for (int i = 0; i < 10; ++i) line.push_back({0.4 * i, 0, 0});
  for (const std::vector<Vec3>& samples : {equal, line}) {
    std::vector<Sphere> balls;
    for (int i = 0; i < 6; ++i) balls.push_back({{0.5 + 0.5 * i, 0.5, 0.5}, i % 2 == 0 ? 0.0 : 0.5});
    std::vector<double> distances;
    for (const Sphere& b : balls) distances.push_back(shape(b.center));
    const BallSet set(balls, distances, samples);
    for (const std::vector<Sphere>& spheres : all_reductions_of(set, 2, shape)) {
      EXPECT_LE(spheres.size(), 2u);
      for (const Vec3& p : samples) EXPECT_TRUE(contain(spheres, p));
    }
  }
}

TEST(BallSet, every_sample_has_one_owner_and_that_ball_contains_it_when_any_does) {
  const Mesh mesh = sample_body("limb", 12);
  const SignedDistance shape(mesh);
  const std::vector<Vec3> samples = surface_points(mesh, 80, 3);
  std::vector<Vec3> strays = samples;
  for (const Vec3& p : surface_points(mesh, 20, 9)) strays.push_back(p * 1.5);
  std::vector<Sphere> balls = voronoi_balls(shape, samples).balls;
  const BallSet set(balls, std::vector<double>(balls.size(), -1.0), strays);
  const std::vector<SampleSet> owned = samples_owned(set);
  for (std::size_t k = 0; k < strays.size(); ++k) {
    std::size_t owners = 0;
    bool inside_owner = false, inside_any = false;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const bool inside = distance(balls[i].center, strays[k]) <= balls[i].radius * (1 + 1e-5);
      inside_any = inside_any || inside;
      if (owned[i].has(k)) ++owners, inside_owner = inside;
    }
    EXPECT_EQ(owners, 1u);
    EXPECT_EQ(inside_owner, inside_any);
  }
}

// What a ball has grown by, of which all have the same: its radius squared beside that of the ball that just fits.
double growth(double radius, double signed_distance) {
  return radius * radius + signed_distance * std::abs(signed_distance);
}

TEST(BallSet, equally_grown_spheres_have_the_least_growth_that_contains_all_samples) {
  Random random(5);
  std::vector<Sphere> balls;
  std::vector<double> distances;
  for (int i = 0; i < 4; ++i) {
    distances.push_back(random.uniform(-1, 0.1));
    balls.push_back({{random.uniform(), random.uniform(), random.uniform()}, 1});
  }
  std::vector<Vec3> samples;
  for (int i = 0; i < 30; ++i) samples.push_back({random.uniform(), random.uniform(), random.uniform()});
  const std::vector<Sphere> spheres = equally_grown(balls, distances, samples);
  const auto contain_all = [&](double factor) {
    return std::all_of(samples.begin(), samples.end(), [&](const Vec3& p) {
      return std::any_of(spheres.begin(), spheres.end(),
                         [&](const Sphere& s) { return distance(s.center, p) <= factor * s.radius; });
    });
  };
  EXPECT_TRUE(contain_all(1 + 1e-12));
  EXPECT_FALSE(contain_all(1 - 1e-6));
  ASSERT_GE(spheres.size(), 2u);
  std::vector<double> growths;
  for (const Sphere& s : spheres)
    for (std::size_t i = 0; i < balls.size(); ++i)
      if (balls[i].center == s.center) growths.push_back(growth(s.radius, distances[i]));
  for (const double g : growths) EXPECT_NEAR(g, growths[0], 1e-12);
}

struct RandomSet {
  std::vector<Sphere> balls;
  std::vector<double> distances;
  std::vector<Vec3> samples;
};
RandomSet random_set(std::size_t ball_count, std::size_t sample_count, std::uint64_t seed) {
  Random random(seed);
  RandomSet set;
  for (std::size_t i = 0; i < ball_count; ++i) {
    const double radius = random.uniform(0.2, 0.5);
    set.balls.push_back({{random.uniform(), random.uniform(), random.uniform()}, radius});
    set.distances.push_back(-radius);
  }
  for (std::size_t k = 0; k < sample_count; ++k)
    set.samples.push_back({random.uniform(), random.uniform(), random.uniform()});
  return set;
}

// The least stand-off of all choices of at most `branching` balls.
double least_stand_off(const RandomSet& set, int branching) {
  double least = 1e300;
  for (unsigned choice = 1; choice < 1u << set.balls.size(); ++choice) {
    if (std::popcount(choice) > branching) continue;
    double needed = -1e300;
    for (const Vec3& p : set.samples) {
      double first = 1e300;
      for (std::size_t i = 0; i < set.balls.size(); ++i)
        if ((choice >> i & 1u) != 0)
          first = std::min(first, growth(distance(p, set.balls[i].center), set.distances[i]));
      needed = std::max(needed, first);
    }
    least = std::min(least, needed);
  }
  return least;
}

TEST(Expand, finds_the_least_stand_off_of_small_sets_or_nearly) {
  int exact = 0;
  constexpr int trials = 40;
  for (int trial = 0; trial < trials; ++trial) {
    const RandomSet set = random_set(9, 20, 100 + static_cast<std::uint64_t>(trial));
    const double least = least_stand_off(set, 3);
    const std::vector<Sphere> spheres = expand({set.balls, set.distances, set.samples}, 3);
    ASSERT_FALSE(spheres.empty());
    double found = -1e300;
    for (const Sphere& s : spheres)
      for (std::size_t i = 0; i < set.balls.size(); ++i)
        if (set.balls[i].center == s.center) found = std::max(found, growth(s.radius, set.distances[i]));
    EXPECT_GE(found, least - 1e-12);
    EXPECT_LE(found, least + 0.25) << trial;
    exact += found <= least + 1e-12;
  }
  EXPECT_GE(exact, trials / 2);
}

TEST(Expand, needs_one_ball_for_a_ball) {
  const Mesh mesh = test::icosphere(3);
  const std::vector<Vec3> samples = surface_points(mesh, 100, 1);
  const BallSet set({{{0, 0, 0}, 1}, {{0.5, 0, 0}, 0.5}, {{0, 0.5, 0}, 0.5}}, {-1, -0.5, -0.5}, samples);
  const std::vector<Sphere> spheres = expand(set, 2);
  ASSERT_EQ(spheres.size(), 1u);
  EXPECT_EQ(spheres[0].center, (Vec3{0, 0, 0}));
  EXPECT_NEAR(spheres[0].radius, 1, 0.02);
}

// The rule of one merge, the slow way.
std::vector<Sphere> merged_by_brute_force(const BallSet& set, const SignedDistance& shape) {
  const std::vector<SampleSet> owned = samples_owned(set);
  struct Ball {
    std::vector<Vec3> points;
    Sphere sphere;
    double distance;
    double protrusion() const { return std::max(0.0, sphere.radius + distance); }
  };
  std::vector<Ball> balls;
  for (std::size_t i = 0; i < set.size(); ++i) {
    Ball b{{}, set.ball(i), set.distance(i)};
    owned[i].for_each([&](std::size_t k) { b.points.push_back(set.samples()[k]); });
    if (b.points.empty()) continue;
    b.sphere.radius = farthest_distance(b.sphere.center, b.points);
    balls.push_back(b);
  }
  const auto joint = [&](const Ball& a, const Ball& b) {
    Ball best = a;
    best.points.insert(best.points.end(), b.points.begin(), b.points.end());
    const std::vector<Vec3> points = best.points;
    best.sphere = {a.sphere.center, farthest_distance(a.sphere.center, points)};
    Ball other = best;
    other.distance = b.distance;
    other.sphere = {b.sphere.center, farthest_distance(b.sphere.center, points)};
    if (other.protrusion() < best.protrusion()) best = other;
    other.sphere = enclosing_sphere(points);
    other.distance = shape(other.sphere.center);
    return other.protrusion() < best.protrusion() ? other : best;
  };
  std::size_t worst = 0;
  for (std::size_t i = 1; i < balls.size(); ++i)
    if (balls[i].protrusion() > balls[worst].protrusion()) worst = i;
  std::size_t a = 0, b = 0;
  bool found_beneficial = false;
  double least = 1e300;
  for (const bool of_worst : {true, false})
    for (std::size_t i = 0; i < balls.size(); ++i)
      for (std::size_t j = i + 1; j < balls.size(); ++j) {
        if (of_worst && i != worst && j != worst) continue;
        const double p = joint(balls[i], balls[j]).protrusion();
        if (of_worst ? p < std::min(least, balls[worst].protrusion()) : !found_beneficial && p < least) {
          least = p, a = i, b = j;
          found_beneficial = found_beneficial || of_worst;
        }
      }
  std::vector<Sphere> result;
  for (std::size_t i = 0; i < balls.size(); ++i)
    if (i != a && i != b) result.push_back(balls[i].sphere);
  result.push_back(joint(balls[a], balls[b]).sphere);
  return result;
}

TEST(Merge, joins_the_pair_that_brute_force_finds) {
  const Mesh mesh = sample_body("limb", 12);
  const SignedDistance shape(mesh);
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const std::vector<Vec3> samples = surface_points(mesh, 40, seed);
    std::vector<Sphere> balls = voronoi_balls(shape, samples).balls;
    Random random(seed);
    std::vector<Sphere> few;
    std::vector<double> distances;
    for (int i = 0; i < 6; ++i) {
      few.push_back(balls[random.next() % balls.size()]);
      distances.push_back(shape(few.back().center));
    }
    const BallSet set(few, distances, samples);
    std::size_t owners = 0;
    for (const SampleSet& s : samples_owned(set)) owners += !s.empty();
    if (owners != few.size()) continue;
    ++compared;
    const std::vector<Sphere> found = merge(set, few.size() - 1, shape).balls;
    const std::vector<Sphere> expected = merged_by_brute_force(set, shape);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_LT(distance(found[i].center, expected[i].center), 1e-12) << seed;
      EXPECT_NEAR(found[i].radius, expected[i].radius, 1e-12) << seed;
    }
  }
  EXPECT_GE(compared, 4);
}

TEST(Burst, removes_the_ball_that_nobody_misses) {
  // Two balls fill a dumb-bell of two spheres; the third, small one between them owns next to nothing.
  const Mesh mesh = test::joined(test::icosphere(3, 1.0, {-1.2, 0, 0}), test::icosphere(3, 1.0, {1.2, 0, 0}));
  const SignedDistance shape(mesh);
  std::vector<Vec3> samples = surface_points(mesh, 200, 1);
  const std::vector<Sphere> balls{{{-1.2, 0, 0}, 1}, {{-0.5, 0, 0}, 0.31}, {{1.2, 0, 0}, 1}};
  const BallSet set(balls, {-1, -0.3, -1}, samples);
  const Reduced two = burst(set, 2, shape);
  ASSERT_EQ(two.balls.size(), 2u);
  for (const Sphere& s : two.balls) {
    EXPECT_NEAR(std::abs(s.center.x), 1.2, 0.02);
    EXPECT_NEAR(s.radius, 1, 0.02);
  }
}

}  // namespace
}  // namespace morula

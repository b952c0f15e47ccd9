// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Obstacles against surfaces: formulas and dense samples in extended precision, whole, interrupted, over a step.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <morula/surface/obstacles.hpp>
#include <set>
#include <support/allocations.hpp>

#include "surfaces.hpp"

namespace morula {
namespace {

using test::Moving;

struct Far3 {
  long double x, y, z;
};
Far3 far(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Far3 operator-(const Far3& a, const Far3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Far3 operator+(const Far3& a, const Far3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Far3 operator*(const Far3& a, long double s) {
  return {a.x * s, a.y * s, a.z * s};
}
long double operator*(const Far3& a, const Far3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Far3 turned(const Far3& a, const Far3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
long double to_segment(const Far3& x, const Far3& p, const Far3& q) {
  const Far3 d = q - p;
  const long double dd = d * d, s = dd > 0 ? std::fmin(1.0L, std::fmax(0.0L, ((x - p) * d) / dd)) : 0;
  const Far3 out = x - (p + d * s);
  return std::sqrt(out * out);
}
long double to_triangle(const Far3& x, const Far3& a, const Far3& b, const Far3& c) {
  const long double borders = std::fmin(to_segment(x, a, b), std::fmin(to_segment(x, b, c), to_segment(x, c, a)));
  const Far3 n = turned(b - a, c - a);
  if (n * n <= 0) return borders;
  const bool above = turned(b - a, x - a) * n >= 0 && turned(c - b, x - b) * n >= 0 && turned(a - c, x - c) * n >= 0;
  return above ? std::fmin(borders, std::fabs((x - a) * n) / std::sqrt(n * n)) : borders;
}

/// Signed distances by formula. Of a hull: the planes through three of its points that have all others on one side,
/// and outside all triangles of three points, for those that are no sides lie within.
struct Solid {
  Obstacle obstacle;
  std::function<long double(const Far3&)> distance;
};
Solid half_space(const Vec3& normal, double offset) {
  const Far3 n = far(normal);
  return {HalfSpace{normal, offset}, [=](const Far3& x) { return (n * x - offset) / std::sqrt(n * n); }};
}
Solid ball(const Vec3& center, double radius) {
  return {Sphere{center, radius}, [=](const Far3& x) {
            const Far3 d = x - far(center);
            return std::sqrt(d * d) - radius;
          }};
}
Solid capsule(const Vec3& p, const Vec3& q, double radius) {
  return {Capsule{p, q, radius}, [=](const Far3& x) { return to_segment(x, far(p), far(q)) - radius; }};
}
Solid hull(const std::vector<Vec3>& points) {
  struct Plane {
    Far3 normal;
    long double offset;
  };
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        Far3 n = turned(far(points[j]) - far(points[i]), far(points[k]) - far(points[i]));
        const long double size = std::sqrt(n * n);
        if (size < 1e-9L) continue;
        n = n * (1 / size);
        long double least = 0, most = 0;
        for (const Vec3& p : points) {
          const long double h = n * (far(p) - far(points[i]));
          least = std::fmin(least, h), most = std::fmax(most, h);
        }
        if (most < 1e-12L) planes.push_back({n, n * far(points[i])});
        if (least > -1e-12L) planes.push_back({n * -1, n * far(points[i]) * -1});
      }
  return {ConvexHull(points), [=](const Far3& x) {
            long double height = -std::numeric_limits<long double>::infinity();
            for (const Plane& p : planes) height = std::fmax(height, p.normal * x - p.offset);
            if (height <= 0) return height;
            long double least = std::numeric_limits<long double>::infinity();
            for (std::size_t i = 0; i < points.size(); ++i)
              for (std::size_t j = i + 1; j < points.size(); ++j)
                for (std::size_t k = j + 1; k < points.size(); ++k)
                  least = std::fmin(least, to_triangle(x, far(points[i]), far(points[j]), far(points[k])));
            return least;
          }};
}
/// A ball again, as a function that knows nothing of balls; half as steep as a distance.
Solid field(const Vec3& center, double radius) {
  return {DistanceField{.value = [=](const Vec3& x) { return 0.5 * (length(x - center) - radius); },
                        .lipschitz = 0.5,
                        .tolerance = 1e-3},
          [=](const Far3& x) {
            const Far3 d = x - far(center);
            return 0.5L * (std::sqrt(d * d) - radius);
          }};
}

std::vector<Solid> solids(Random& random, double size) {
  const auto some = [&] {
    return Vec3{random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
  };
  std::vector<Vec3> points;
  for (int i = 0; i < 7; ++i) points.push_back(some() * 0.7);
  std::vector<Vec3> corners;
  const Vec3 at = some() * 0.5;
  const RigidTransform turn = RigidTransform::from_axis(some(), random.uniform(0, 3), at);
  for (int k = 0; k < 8; ++k)
    corners.push_back(turn(Vec3{(k & 1) - 0.5, ((k >> 1) & 1) - 0.5, ((k >> 2) & 1) - 0.5} * size));
  return {half_space(some(), random.uniform(-0.5, 0.5) * size),
          ball(some(), random.uniform(0, 0.6) * size),
          capsule(some(), some(), random.uniform(0, 0.3) * size),
          hull(points),
          hull(corners),
          field(some(), random.uniform(0, 0.6) * size)};
}

/// Points of a vertex or a facet on a grid, and how far any point of it is from one of these at the most.
struct Samples {
  std::vector<Far3> points;
  long double spacing = 0;
};
Samples samples(const std::vector<Far3>& corners, int parts) {
  if (corners.size() == 1) return {corners, 0};
  Samples s;
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j)
      s.points.push_back(corners[0] + (corners[1] - corners[0]) * (static_cast<long double>(i) / parts) +
                         (corners[2] - corners[0]) * (static_cast<long double>(j) / parts));
  for (int k = 0; k < 3; ++k) {
    const Far3 side = corners[static_cast<std::size_t>((k + 1) % 3)] - corners[static_cast<std::size_t>(k)];
    s.spacing = std::fmax(s.spacing, std::sqrt(side * side) / parts);
  }
  return s;
}
long double least(const Solid& solid, const Samples& s) {
  long double least = std::numeric_limits<long double>::infinity();
  for (const Far3& x : s.points) least = std::fmin(least, solid.distance(x));
  return least;
}

std::vector<std::vector<std::uint32_t>> features_of(const Moving& m, ObstacleFeatures features) {
  std::vector<std::vector<std::uint32_t>> all;
  if (features == ObstacleFeatures::vertices) {
    for (const auto& v : test::plain_vertices(m.mesh)) all.push_back(v);
  } else {
    all = test::plain_facets(m.mesh);
  }
  return all;
}
std::vector<Far3> corners_at(const Moving& m, const std::vector<std::uint32_t>& vertices, long double t,
                             const Vec3& motion) {
  std::vector<Far3> corners;
  for (const std::uint32_t v : vertices)
    corners.push_back(far(m.from[v]) + (far(m.to[v]) - far(m.from[v])) * t - far(motion) * t);
  return corners;
}

constexpr ObstacleFeatures kinds_of_features[] = {ObstacleFeatures::vertices, ObstacleFeatures::facets};

void expect_met(int rounds, std::uint64_t seed) {
  Random random(seed);
  std::size_t met = 0, deep = 0;
  for (int round = 0; round < rounds; ++round) {
    const double size = round % 2 == 0 ? 1 : 6;
    const Moving m = round % 2 == 0 ? test::wavy_sheet(4, 0.1, random) : test::random_soup(14, 12, 6, random);
    SurfaceTree tree(m.mesh);
    ASSERT_TRUE(tree.update(m.from, m.to));
    for (const Solid& solid : solids(random, size))
      for (const ObstacleFeatures features : kinds_of_features)
        for (const double margin : {0.0, 0.1 * size}) {
          ObstacleQuery query({.margin = margin, .features = features});
          const SurfaceQueryStatus status = query.run(tree, solid.obstacle);
          ASSERT_TRUE(status && status.finished);
          const bool is_field = std::holds_alternative<DistanceField>(solid.obstacle);
          const double slack = 1e-12 * size + (is_field ? 1e-3 : 0);
          auto contact = query.contacts().begin();
          const auto all = features_of(m, features);
          for (std::size_t i = 0; i < all.size(); ++i) {
            const std::uint32_t feature =
                features == ObstacleFeatures::vertices ? all[i][0] : static_cast<std::uint32_t>(i);
            const Samples grid = samples(corners_at(m, all[i], 0, {}), 16);
            const long double sampled = least(solid, grid);
            const bool found = contact != query.contacts().end() && contact->feature == feature;
            // What a sample shows is there; what is there is no nearer than samples allow.
            EXPECT_TRUE(found || sampled > margin - 1e-12L * size);
            if (!found) continue;
            EXPECT_LE(contact->distance, sampled + slack);
            EXPECT_GE(contact->distance, sampled - grid.spacing - slack);
            EXPECT_LE(contact->distance, margin + slack);
            EXPECT_NEAR(contact->distance, static_cast<double>(solid.distance(far(contact->point))), 1e-12 * size);
            Vec3 point;
            for (std::size_t k = 0; k < all[i].size(); ++k) point += m.from[all[i][k]] * contact->weights[k];
            EXPECT_LT(max_norm(point - contact->point), 1e-12 * size);
            EXPECT_NEAR(length(contact->normal), 1, 1e-12);
            // Out of the obstacle: the distance grows along it, by as much as for any direction.
            const double step = 1e-7 * size, steep = is_field ? 0.5 : 1;
            if (contact->distance > 1e-6 * size) {
              EXPECT_NEAR(static_cast<double>(solid.distance(far(contact->point + contact->normal * step))),
                          contact->distance + steep * step, 1e-3 * step);
            }
            ++met;
            deep += contact->distance < 0;
            ++contact;
          }
          EXPECT_EQ(contact, query.contacts().end()) << "in order, each once";
        }
  }
  EXPECT_GT(met, 80u * static_cast<std::size_t>(rounds));
  EXPECT_GT(deep, 30u * static_cast<std::size_t>(rounds));
}
TEST(Obstacles, are_met_where_dense_samples_say_so) {
  expect_met(2, 41);
}
TEST(NightlyObstacles, are_met_where_dense_samples_say_so) {
  expect_met(24, 42);
}

void expect_times(int rounds, std::uint64_t seed) {
  Random random(seed);
  std::size_t impacts = 0, missed = 0, left_out = 0;
  constexpr int parts = 16;
  for (int round = 0; round < rounds; ++round) {
    const double size = round % 2 == 0 ? 1 : 6;
    const Moving m = round % 2 == 0 ? test::wavy_sheet(3, 0.6, random) : test::random_soup(14, 12, 6, random);
    SurfaceTree tree(m.mesh);
    ASSERT_TRUE(tree.update(m.from, m.to));
    const Vec3 motion = round % 3 == 0 ? Vec3{} : Vec3{random.uniform(-size, size), 0.3 * size, -0.5 * size};
    for (const Solid& solid : solids(random, size))
      for (const ObstacleFeatures features : kinds_of_features)
        for (const double margin : {0.0, 0.05 * size}) {
          SweptObstacleQuery query({.margin = margin, .features = features});
          const SurfaceQueryStatus status = query.run(tree, solid.obstacle, motion);
          ASSERT_TRUE(status && status.finished);
          std::map<std::uint32_t, double> times;
          for (const ObstacleImpact& impact : query.impacts()) times.emplace(impact.feature, impact.time);
          EXPECT_EQ(times.size(), query.impacts().size());
          const bool is_field = std::holds_alternative<DistanceField>(solid.obstacle);
          const auto all = features_of(m, features);
          for (std::size_t i = 0; i < all.size(); ++i) {
            const std::uint32_t feature =
                features == ObstacleFeatures::vertices ? all[i][0] : static_cast<std::uint32_t>(i);
            const auto found = times.find(feature);
            for (int k = 0; k <= parts; ++k) {
              const long double t = static_cast<long double>(k) / parts;
              if (least(solid, samples(corners_at(m, all[i], t, motion), 6)) > margin) continue;
              ASSERT_TRUE(found != times.end());
              EXPECT_LE(found->second, static_cast<double>(t) + 1e-12);
              break;
            }
            left_out += found == times.end();
            if (found == times.end()) continue;
            ++impacts;
            // And not much earlier: there is something near at that time. Fields stop a thousandth of the way off.
            const Samples there = samples(corners_at(m, all[i], found->second, motion), 16);
            const long double gap = least(solid, there) - there.spacing - margin;
            const double allowed = is_field ? 0.03 * size : 1e-5 * size;
            missed += gap > allowed;
          }
          const double step = query.collision_free_step();
          for (const auto& [feature, time] : times) EXPECT_LE(step, time);
        }
  }
  EXPECT_GT(impacts, 60u * static_cast<std::size_t>(rounds));
  EXPECT_GT(left_out, 30u * static_cast<std::size_t>(rounds));
  EXPECT_EQ(missed, 0u);
}
TEST(Obstacles, swept_times_are_never_later_than_dense_samples_show) {
  expect_times(2, 43);
}
TEST(NightlyObstacles, swept_times_are_never_later_than_dense_samples_show) {
  expect_times(24, 44);
}

TEST(Obstacles, swept_times_are_those_of_falling_points) {
  Mesh mesh;
  mesh.positions = {{0.25, 0.25, 2}, {0.5, 0.25, 2}, {0.25, 0.5, 2}};
  mesh.facets = {{0, 1, 2}};
  std::vector<Vec3> to = mesh.positions;
  for (Vec3& p : to) p.z = -2;
  SurfaceTree tree(mesh);
  ASSERT_TRUE(tree.update(mesh.positions, to));
  const auto time = [&](const Obstacle& obstacle, double margin, const Vec3& motion = {}) {
    SweptObstacleQuery query({.margin = margin});
    EXPECT_TRUE(query.run(tree, obstacle, motion));
    return query.collision_free_step();
  };
  const Obstacle floor = HalfSpace{{0, 0, 2}, 2};
  EXPECT_NEAR(time(floor, 0), 0.25, 1e-6);
  EXPECT_NEAR(time(floor, 0.5), 0.125, 1e-6);
  EXPECT_NEAR(time(floor, 0, {5, 5, 4}), 0.125, 1e-6) << "both move";
  EXPECT_NEAR(time(floor, 0, {5, 5, -4}), 1, 0) << "as fast as the facet: no impact";
  EXPECT_NEAR(time(Sphere{{0.3, 0.3, 0}, 0.8}, 0), 0.3, 1e-6);
  EXPECT_NEAR(time(Capsule{{-9, 0.3, 0}, {9, 0.3, 0}, 0.8}, 0.2), 0.25, 1e-6);
  EXPECT_NEAR(time(ConvexHull::box({{-1, -1, -1}, {1, 1, 1}}), 0), 0.25, 1e-6);
  EXPECT_EQ(time(ConvexHull::box({{0.6, -1, -1}, {1, 1, 1}}), 0), 1) << "it passes beside";
  // A thin wall that no vertex meets, between its two ends.
  EXPECT_NEAR(time(ConvexHull::box({{0.3, 0.3, -1}, {0.31, 0.31, 1}}), 0), 0.25, 1e-6);
  const Obstacle field = DistanceField{.value = [](const Vec3& x) { return x.z - 1; }};
  EXPECT_LE(time(field, 0), 0.25);
  EXPECT_GT(time(field, 0), 0.23);
}

TEST(Obstacles, interrupted_queries_go_on_to_the_same_and_say_what_is_open) {
  Random random(47);
  const Moving m = test::wavy_sheet(12, 0.2, random);
  SurfaceTree tree(m.mesh);
  ASSERT_TRUE(tree.update(m.from, m.to));
  for (const Solid& solid : solids(random, 1)) {
    ObstacleQuery whole({.margin = 0.2});
    const SurfaceQueryStatus complete = whole.run(tree, solid.obstacle);
    SweptObstacleQuery whole_sweep({.margin = 0.02});
    ASSERT_TRUE(complete && whole_sweep.run(tree, solid.obstacle, {0.1, 0.2, 0.1}));
    for (const unsigned threads : {2u, 3u}) {
      Workers workers(threads);
      ObstacleQuery other({.margin = 0.2});
      ASSERT_TRUE(other.run(tree, solid.obstacle, workers));
      ASSERT_EQ(other.contacts().size(), whole.contacts().size());
      for (std::size_t i = 0; i < other.contacts().size(); ++i) {
        EXPECT_EQ(other.contacts()[i].distance, whole.contacts()[i].distance);
        EXPECT_EQ(other.contacts()[i].point, whole.contacts()[i].point);
      }
    }
    for (const int tests : {8, 40, 136}) {
      ObstacleQuery part({.margin = 0.2, .budget = tests});
      SurfaceQueryStatus status = part.run(tree, solid.obstacle);
      for (int calls = 1; status && !status.finished; ++calls) {
        ASSERT_LT(calls, 1000);
        EXPECT_LE(status.box_tests, static_cast<std::size_t>(tests));
        std::set<std::uint32_t> open;
        for (const auto& facets : part.open()) open.insert(facets.begin(), facets.end());
        std::set<std::uint32_t> found;
        for (const ObstacleContact& contact : part.contacts()) found.insert(contact.feature);
        for (const ObstacleContact& contact : whole.contacts())
          EXPECT_TRUE(found.contains(contact.feature) != open.contains(contact.feature));
        status = part.resume();
      }
      ASSERT_TRUE(status.finished && part.open().empty());
      EXPECT_EQ(status.candidates, complete.candidates);
      ASSERT_EQ(part.contacts().size(), whole.contacts().size());
      for (std::size_t i = 0; i < part.contacts().size(); ++i)
        EXPECT_EQ(part.contacts()[i].point, whole.contacts()[i].point);
      SweptObstacleQuery sweep({.margin = 0.02, .budget = tests});
      for (SurfaceQueryStatus s = sweep.run(tree, solid.obstacle, {0.1, 0.2, 0.1}); !s.finished; s = sweep.resume())
        ASSERT_TRUE(s);
      ASSERT_EQ(sweep.impacts().size(), whole_sweep.impacts().size());
      for (std::size_t i = 0; i < sweep.impacts().size(); ++i)
        EXPECT_EQ(sweep.impacts()[i].time, whole_sweep.impacts()[i].time);
    }
    // A filter of the caller's.
    ObstacleQuery odd({.margin = 0.2, .accepts = [](std::uint32_t f) { return f % 2 == 1; }});
    ASSERT_TRUE(odd.run(tree, solid.obstacle));
    std::size_t expected = 0;
    for (const ObstacleContact& contact : whole.contacts()) expected += contact.feature % 2;
    EXPECT_EQ(odd.contacts().size(), expected);
  }
}

TEST(Obstacles, warm_queries_allocate_nothing_and_bad_questions_are_refused) {
  Random random(53);
  const Moving m = test::wavy_sheet(8, 0.2, random);
  SurfaceTree tree(m.mesh);
  const std::vector<Solid> all = solids(random, 1);
  ObstacleQuery query({.margin = 0.1});
  SweptObstacleQuery sweep({.margin = 0.1});
  const auto ask = [&] {
    bool good = static_cast<bool>(tree.update(m.from, m.to));
    for (const Solid& solid : all) good = good && query.run(tree, solid.obstacle) && sweep.run(tree, solid.obstacle);
    return good;
  };
  ASSERT_TRUE(ask());
  const std::size_t before = test::allocations;
  const bool good = ask();
  EXPECT_EQ(test::allocations - before, 0u);
  EXPECT_TRUE(good);

  EXPECT_EQ(ObstacleQuery().resume().code, Status::Code::no_front);
  // What was farther than the margin is gone.
  query.set_options({.margin = 1});
  EXPECT_EQ(query.resume().code, Status::Code::other_options);
  query.set_options({.margin = 0.1, .features = ObstacleFeatures::vertices});
  EXPECT_EQ(query.resume().code, Status::Code::other_options);
  sweep.set_options({.margin = 0.2});
  EXPECT_EQ(sweep.resume().code, Status::Code::other_options);
  query.set_options({.margin = 0.1}), sweep.set_options({.margin = 0.1});
  EXPECT_TRUE(query.resume());
  ASSERT_TRUE(tree.update(m.to));
  EXPECT_EQ(query.resume().code, Status::Code::other_frame);
  EXPECT_EQ(sweep.resume().code, Status::Code::other_frame);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Obstacle bad[] = {HalfSpace{{0, 0, 0}, 1},
                          HalfSpace{{0, 0, 1}, nan},
                          Sphere{{0, nan, 0}, 1},
                          Sphere{{0, 0, 0}, -1},
                          Capsule{{nan, 0, 0}, {}, 1},
                          DistanceField{},
                          DistanceField{.value = [](const Vec3&) { return 0.0; }, .lipschitz = 0},
                          DistanceField{.value = [](const Vec3&) { return 0.0; }, .tolerance = -1}};
  for (const Obstacle& obstacle : bad) {
    EXPECT_EQ(query.run(tree, obstacle).code, Status::Code::bad_shape);
    EXPECT_EQ(sweep.run(tree, obstacle).code, Status::Code::bad_shape);
  }
  const Obstacle fine = Sphere{{0, 0, 0}, 1};
  EXPECT_EQ(sweep.run(tree, fine, {nan, 0, 0}).code, Status::Code::bad_option);
  EXPECT_THROW(ObstacleQuery({.margin = -1}), std::invalid_argument);
  EXPECT_THROW(SweptObstacleQuery({.margin = nan}), std::invalid_argument);
  EXPECT_THROW(ObstacleQuery({.budget = -1}), std::invalid_argument);
  // What a field cannot say counts as near.
  const Obstacle dumb = DistanceField{.value = [](const Vec3&) { return nan; }};
  ObstacleQuery everything({.features = ObstacleFeatures::vertices});
  ASSERT_TRUE(everything.run(tree, dumb));
  EXPECT_EQ(everything.contacts().size(), test::plain_vertices(m.mesh).size());
}

}  // namespace
}  // namespace morula

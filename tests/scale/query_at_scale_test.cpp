// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Closest points, insides, volumes of balls and medial balls at every size.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/medial/medial_balls.hpp>
#include <morula/query/signed_distance.hpp>

#include "bodies_at_scale.hpp"

namespace morula {
namespace {

const std::vector<Vec3> probes{{0, 0, 0}, {0.3, 0.05, -0.02}, {1.5, 0.2, 0.7}, {-30, 4, 2}, {0.01, 0.02, 0.03}};

TEST(QueryAtScale, answers_as_for_a_unit_body_or_refuses) {
  for (const test::BodyAtScale& body : test::unit_bodies()) {
    const SignedDistance unit(body.mesh);
    for (const double size : test::sizes())
      for (const double offset : test::offsets()) {
        const Mesh mesh = test::placed(body.mesh, size, offset);
        const std::string what = test::told(body.name, size, offset);
        if (test::is_out_of_range(mesh)) {
          EXPECT_TRUE(test::is_refused([&] { TriangleBvh index(mesh); })) << what;
          EXPECT_TRUE(test::is_refused([&] { SignedDistance shape(mesh); })) << what;
          continue;
        }
        const SignedDistance shape(mesh);
        for (const Vec3& probe : probes) {
          const Vec3 p = test::placed(probe, size, offset);
          EXPECT_NEAR(shape(p) / size, unit(probe), 1e-12 * (1 + offset) * 40) << what;
          EXPECT_NEAR(shape.bvh().winding_number(p), unit.bvh().winding_number(probe), 1e-9) << what;
          const double ball = volume({{}, 0.4 * size});
          EXPECT_NEAR(inside_volume(shape, {p, 0.4 * size}) / ball,
                      inside_volume(unit, {probe, 0.4}) / volume({{}, 0.4}), 1e-8)
              << what;
          // A ball that is nothing beside the body, and the point that it is.
          const double minute = inside_volume(shape, {p, 1e-200});
          EXPECT_EQ(minute, 0) << what;
        }
      }
  }
}

TEST(QueryAtScale, far_points_are_answered_or_said_to_be_too_far) {
  const SignedDistance shape(test::unit_bodies()[2].mesh);
  std::vector<std::uint32_t> facets;
  for (const double far : {1e20, 1e50, 1e59}) EXPECT_NEAR(shape({far, 0, 0}) / far, 1, 1e-12) << far;
  for (const double far : {1e100, 1e160, 1e200, 1e300}) {
    EXPECT_FALSE(shape.bvh().closest_point({0, -far, 0}).has_value());
    EXPECT_TRUE(std::isnan(shape({far, 0, 0})));
    EXPECT_EQ(shape.bvh().winding_number({far, 0, 0}), 0);
    EXPECT_TRUE(test::is_refused([&] { inside_volume(shape, {{far, 0, 0}, 1}); }));
    EXPECT_TRUE(test::is_refused([&] { outside_volume(shape, {{0, 0, 0}, far}); }));
    shape.bvh().facets_touching({{far, 0, 0}, 0.5 * far}, facets);
    EXPECT_TRUE(facets.empty());
    shape.bvh().facets_touching({{far, 0, 0}, 1.5 * far}, facets);
    EXPECT_EQ(facets.size(), shape.bvh().facet_count());
  }
}

TEST(QueryAtScale, medial_balls_are_those_of_a_unit_body) {
  const Mesh& ball = test::unit_bodies()[2].mesh;
  std::vector<Vec3> normals;
  for (const Vec3& p : ball.positions) normals.push_back(p / length(p));
  const MedialBalls unit = shrinking_balls(SignedDistance(ball), ball.positions, normals);
  const MedialBalls unit_voronoi = voronoi_balls(SignedDistance(ball), ball.positions);
  ASSERT_FALSE(unit.balls.empty());
  ASSERT_FALSE(unit_voronoi.balls.empty());
  for (const int power : {-98, -60, 60, 98}) {
    const double size = std::ldexp(1.0, power);
    const Mesh mesh = test::placed(ball, size, 0);
    const SignedDistance shape(mesh);
    const MedialBalls medial = shrinking_balls(shape, mesh.positions, normals);
    const MedialBalls voronoi = voronoi_balls(shape, mesh.positions);
    ASSERT_EQ(medial.balls.size(), unit.balls.size()) << power;
    ASSERT_EQ(voronoi.balls.size(), unit_voronoi.balls.size()) << power;
    for (std::size_t i = 0; i < medial.balls.size(); ++i)
      EXPECT_EQ(medial.balls[i].radius, unit.balls[i].radius * size) << power;
  }
  const std::vector<Vec3> far{{1e200, 0, 0}, {0, 1e200, 0}, {0, 0, 1e200}, {0, 0, 0}, {1, 1, 1}};
  EXPECT_TRUE(test::is_refused([&] { voronoi_balls(SignedDistance(ball), far); }));
}

}  // namespace
}  // namespace morula

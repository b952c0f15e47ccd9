// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What proves is right for all finite doubles: no certificate because squares vanished, none refused because they
// overflowed.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/generators/build.hpp>

#include "bodies_at_scale.hpp"

namespace morula {
namespace {

// A tree that was built at a size of 1, its spheres made anew at another from what the judge says they need.
struct Fixture {
  Mesh mesh;
  CoveredTree model;
};
Fixture fixture(const test::BodyAtScale& body, double size, double offset) {
  Fixture made{test::placed(body.mesh, size, offset),
               build(body.mesh, {.method = Method::octree, .branching = 4, .depth = 2})};
  const double pad = 0x1p-48 * test::reach_of(made.mesh);
  for (std::uint32_t node = 0; node < made.model.tree.node_count(); ++node) {
    Sphere& s = made.model.tree.spheres[node];
    s.center = test::placed(s.center, size, offset);
    s.radius = static_cast<double>(test::reach_from(s.center, made.model.cover, node, made.mesh.positions)) + pad;
  }
  made.model.report.mesh_hash = mesh_hash(made.mesh);
  return made;
}

TEST(CertificateAtScale, says_yes_to_spheres_that_contain_and_no_to_any_that_is_one_percent_too_small) {
  for (const test::BodyAtScale& body : test::unit_bodies())
    for (const double size : test::sizes())
      for (const double offset : test::offsets()) {
        Fixture f = fixture(body, size, offset);
        std::vector<Sphere>& spheres = f.model.tree.spheres;
        const std::string what = test::told(body.name, size, offset);
        ASSERT_TRUE(test::covers(f.model.cover, f.mesh.positions, spheres)) << what;
        EXPECT_TRUE(certify(f.model.cover, f.mesh.positions, spheres).covered) << what;
        EXPECT_TRUE(validate(f.mesh, f.model).empty()) << what;
        for (std::uint32_t node = 0; node < spheres.size(); ++node) {
          const double radius = spheres[node].radius;
          spheres[node].radius = 0.99 * radius;
          ASSERT_FALSE(test::covers(f.model.cover, f.mesh.positions, spheres)) << what;
          const Certificate proof = certify(f.model.cover, f.mesh.positions, spheres);
          EXPECT_FALSE(proof.covered) << what;
          EXPECT_EQ(proof.worst_node, node) << what;
          EXPECT_NEAR(proof.worst_excess / radius, 0.01, 1e-9) << what;
          spheres[node].radius = radius;
        }
        spheres[0].radius *= 0.99;
        EXPECT_FALSE(validate(f.mesh, f.model).empty()) << what;
      }
}

// A facet of its own, whose middle is a cut point.
CoveredTree one_sphere(const Sphere& sphere) {
  CoveredTree model;
  model.tree.branching = 2;
  model.tree.append_level({}, std::vector<Sphere>{sphere});
  Cover& cover = model.cover;
  cover.vertex_count = 3;
  cover.facet_count = 1;
  cover.cut_points = {{{0, 1, 2}, {0.25, 0.25, 0.5}}};
  cover.patch_facet = {0, 0, 0};
  cover.corner_begin = {0, 3, 6, 9};
  cover.corners = {0, 1, 3, 1, 2, 3, 2, 0, 3};
  cover.region_begin = {0};
  cover.region_end = {3};
  return model;
}

TEST(CertificateAtScale, compares_numbers_of_any_two_sizes) {
  const auto verdict = [](const std::vector<Vec3>& positions, const Sphere& sphere) {
    const CoveredTree model = one_sphere(sphere);
    const bool expected = test::covers(model.cover, positions, model.tree.spheres);
    const Certificate proof = certify(model.cover, positions, model.tree.spheres);
    EXPECT_EQ(proof.covered, expected) << positions[1].x << " in " << sphere.radius << " about " << sphere.center.x;
    EXPECT_EQ(proof.worst_excess <= 0, expected);
    EXPECT_FALSE(std::isnan(proof.worst_excess));
    return proof.covered;
  };
  int yes = 0, no = 0;
  for (const double size : test::sizes())
    for (const double radius : test::sizes())
      for (const double center : {0.0, 1e-300, -1e-200, 1.0, 1e200, -1e300})
        for (const double factor : {0.9, 1.5})
          (verdict({{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, {{center, 0, 0}, factor * radius}) ? yes : no)++;
  EXPECT_GT(yes, 300);
  EXPECT_GT(no, 300);
  // The ends of the range: nothing is larger than denormals or smaller than the largest number.
  constexpr double least = std::numeric_limits<double>::denorm_min(), most = std::numeric_limits<double>::max();
  EXPECT_TRUE(verdict({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, 0}));
  EXPECT_FALSE(verdict({{0, 0, 0}, {least, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, 0}));
  EXPECT_TRUE(verdict({{0, 0, 0}, {4 * least, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, 16 * least}));
  EXPECT_FALSE(verdict({{0, 0, 0}, {4 * least, 4 * least, 0}, {0, 0, 0}}, {{0, 0, 0}, 5 * least}));
  EXPECT_TRUE(verdict({{0, 0, 0}, {0.5 * most, 0, 0}, {0, 0.5 * most, 0}}, {{0, 0, 0}, most}));
  EXPECT_FALSE(verdict({{most, 0, 0}, {-most, 0, 0}, {0, most, 0}}, {{-most, 0, 0}, most}));
  EXPECT_FALSE(verdict({{most, most, most}, {-most, 0, 0}, {0, most, 0}}, {{0, 0, 0}, most}));
}

// Where products of weights underflow, a cut point is not where its sum says: then only what is certain is certified.
TEST(CertificateAtScale, trusts_no_cut_point_of_denormals) {
  constexpr double least = std::numeric_limits<double>::denorm_min();
  CoveredTree model = one_sphere({});
  // 1/2 of the least double rounds to 0, 3/2 of it to 2.
  model.cover.corners = {3, 3, 3, 3, 3, 3, 3, 3, 3};
  for (int i = 0; i < 50; ++i)
    for (int radius = 0; radius < 40; ++radius) {
      const std::vector<Vec3> positions{
          {i * least, least, 0}, {3 * least, -i * least, least}, {i * least, 7 * least, 0}};
      model.tree.spheres[0] = {{0, 0, 0}, radius * least};
      if (certify(model.cover, positions, model.tree.spheres).covered) {
        EXPECT_TRUE(test::covers(model.cover, positions, model.tree.spheres)) << i << ' ' << radius;
      }
    }
}

}  // namespace
}  // namespace morula

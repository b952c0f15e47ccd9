// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of skinned clusters: how near they are to the least ones, and their values and bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/geometry/sample_bodies.hpp>
#include <support/allocations.hpp>

#include "bodies.hpp"
#include "simd/processors.hpp"
#include "skin_bounds_oracle.hpp"

namespace morula {
namespace {

using test::Specimen;
using test::specimens;
using namespace test::skin_bounds;

// A limb bent by two bones, clusters of some thirty facets.
TEST(SkinBounds, are_near_the_least_ones) {
  const Mesh mesh = sample_body("limb", 48);
  Skin skin{.bone_count = 2, .begin = {0}};
  for (const Vec3& p : mesh.positions) {
    const double second = std::clamp(p.x + 0.5, 0.0, 1.0);
    skin.bones.insert(skin.bones.end(), {0, 1});
    skin.weights.insert(skin.weights.end(), {1 - second, second});
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  const Box box = bounding_box(mesh);
  std::vector<std::uint32_t> clusters;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const Vec3 p = mesh.corners(f)[0];
    clusters.push_back(static_cast<std::uint32_t>(31.9 * (p.x - box.lower.x) / box.extent().x));
  }
  SkinBounds bounds(mesh, skin, clusters);
  Motions motions(2);
  motions[1].columns = {Vec3{0.5, 0.8660254037844386, 0}, Vec3{-0.8660254037844386, 0.5, 0}, Vec3{0, 0, 1}};
  const Bounds result = bounds_of(bounds, motions);
  std::vector<Vec3> positions(mesh.vertex_count());
  move_by_skin(skin, mesh.positions, motions, positions);
  double whole = 0, largest = 0;
  for (std::uint32_t k = 0; k < 32; ++k) {
    Box least;
    for (std::size_t f = 0; f < mesh.facet_count(); ++f)
      if (clusters[f] == k)
        for (const std::uint32_t v : mesh.facets[f]) least.add(positions[v]);
    const Boxf& b = result.boxes[k];
    const double ratio = length(Vec3(b.upper) - Vec3(b.lower)) / least.diagonal();
    whole += ratio / 32, largest = std::max(largest, ratio);
    EXPECT_LE(static_cast<double>(result.spheres[k].radius), 1.25 * least.diagonal() / 2) << k;
  }
  EXPECT_LE(whole, 1.25);
  EXPECT_LE(largest, 1.6);
}

TEST(SkinBounds, of_rest_and_of_one_rotation_are_those_of_rest) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  SkinBounds bounds(mesh, skin, some_clusters(mesh, 20));
  Random random(5);
  for (const AffineTransform& motion : {AffineTransform{}, motion_of_kind(random, 0, 1)}) {
    const Bounds result = bounds_of(bounds, Motions(9, motion));
    for (std::size_t k = 0; k < bounds.cluster_count(); ++k) {
      const SkinBoundsCluster& rest = bounds.data().clusters[k];
      // What is allowed for rounding: 2^-23 times some hundred of the size.
      EXPECT_NEAR(result.spheres[k].radius, rest.radius, 2e-4f);
      if (rest.row_count == 0) continue;
      EXPECT_LE(distance(Vec3(result.spheres[k].center), motion(Vec3(rest.center))), 1e-5);
    }
  }
}

// Many characters, one, stored rest data, any threads and any registers.
TEST(SkinBounds, have_the_same_bits_however_they_are_computed) {
  const Mesh& mesh = specimens()[2].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  SkinBounds bounds(mesh, skin, some_clusters(mesh, 25));
  Random random(9);
  Motions motions;
  constexpr std::size_t characters = 53;
  for (std::size_t k = 0; k < characters * 9; ++k)
    motions.push_back(motion_of_kind(random, static_cast<int>(k / 9 % motion_kinds), 1));
  const Bounds all = bounds_of(bounds, motions);
  for (std::size_t c = 0; c < characters; ++c) {
    const Bounds one = bounds_of(bounds, Motions(motions.begin() + static_cast<std::ptrdiff_t>(9 * c),
                                                 motions.begin() + static_cast<std::ptrdiff_t>(9 * c + 9)));
    const std::size_t n = bounds.cluster_count();
    EXPECT_TRUE(
        std::equal(one.spheres.begin(), one.spheres.end(), all.spheres.begin() + static_cast<std::ptrdiff_t>(c * n)));
    EXPECT_TRUE(std::equal(one.boxes.begin(), one.boxes.end(), all.boxes.begin() + static_cast<std::ptrdiff_t>(c * n)));
    EXPECT_EQ(one.whole_spheres[0], all.whole_spheres[c]);
    EXPECT_EQ(one.whole_boxes[0], all.whole_boxes[c]);
  }
  Workers three(3);
  EXPECT_EQ(bounds_of(bounds, motions, three), all);
  EXPECT_EQ(SkinBounds(mesh, skin, some_clusters(mesh, 25), three).data(), bounds.data());
  SkinBounds stored{SkinBoundsData(bounds.data())};
  EXPECT_EQ(bounds_of(stored, motions), all);
  const std::size_t kinds = detail::runnable_kinds();
  for (std::size_t most = 1; most <= kinds; ++most) {
    detail::allow_kinds(most);
    EXPECT_EQ(bounds_of(bounds, motions), all) << detail::kind_name(most - 1);
  }
  detail::allow_kinds(kinds);
}

TEST(SkinBounds, write_what_is_asked_for_and_allocate_nothing) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  SkinBounds bounds(mesh, skin, some_clusters(mesh, 25));
  const Motions motions(27);
  const Bounds all = bounds_of(bounds, motions);
  Bounds part = all;
  std::fill(part.boxes.begin(), part.boxes.end(), Boxf{});
  std::fill(part.whole_boxes.begin(), part.whole_boxes.end(), Boxf{});
  ASSERT_TRUE(bounds.bounds(motions, {.boxes = part.boxes}));
  EXPECT_EQ(part.boxes, all.boxes);
  ASSERT_TRUE(bounds.bounds(motions, {.whole_boxes = part.whole_boxes}));
  EXPECT_EQ(part, all);
  EXPECT_TRUE(bounds.bounds({}, {}));
  EXPECT_EQ(test::allocations_once_warm([&] { ASSERT_TRUE(bounds.bounds(motions, {.spheres = part.spheres})); }), 0u);

  // A cluster without facets is no part of the whole.
  ASSERT_EQ(bounds.data().clusters[0].row_count, 0u);
  EXPECT_EQ(all.spheres[0], Spheref{});
  EXPECT_EQ(all.boxes[0], Boxf{});
  Mesh away = mesh;
  for (Vec3& p : away.positions) p += Vec3{50, 50, 50};
  SkinBounds far(away, skin, some_clusters(mesh, 25));
  EXPECT_GT(bounds_of(far, motions).whole_boxes[0].lower.x, 40);
  EXPECT_LT(bounds_of(far, motions).whole_spheres[0].radius, 10);
}

}  // namespace
}  // namespace morula

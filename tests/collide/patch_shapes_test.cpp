// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches of shapes that are hard: slender, in great number, near each other, of no thickness, nearly closed.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/collide/contact_patches.hpp>
#include <morula/geometry/inspect.hpp>
#include <set>
#include <support/meshes.hpp>

#include "clipped_overlap.hpp"
#include "placed_bodies.hpp"

namespace morula {
namespace {

using test::PlacedBody;

Mesh box(const Vec3& lower, const Vec3& upper) {
  return test::box_mesh(lower, upper);
}

/// Force and torque about x of a patch's points, less those of the patch.
Vec3 force_error(const ContactPatch& patch) {
  Vec3 force = patch.a.area_vector;
  for (const PatchPoint& point : patch.points) force += point.force;
  return force;
}
Vec3 torque_error(const ContactPatch& patch) {
  Vec3 torque = patch.a.moment;
  for (const PatchPoint& point : patch.points) torque += cross(point.point - patch.centroid, point.force);
  return torque;
}

// A facet whose index repeats is no part of the surface, so the feet stay two components.
TEST(PatchShapes, a_facet_with_a_repeated_index_joins_no_components) {
  Mesh feet = test::joined(box({0, 0, 0}, {1, 1, 1}), box({2, 0.1, 0.1}, {2.5, 0.6, 0.6}));
  feet.facets.push_back({0, 0, 8});
  feet.facets.push_back({0, 8, 8});
  PlacedBody a(feet), b(box({-1, -1, -1}, {4, 4, 0.8}));
  ContactPatchQuery query(a.collider, b.collider), swapped(b.collider, a.collider);
  for (ContactPatchQuery* const run : {&query, &swapped}) {
    ASSERT_TRUE(run->run());
    ASSERT_EQ(run->patches().size(), 2u) << "one foot crosses the surface, the other is wholly inside";
    EXPECT_NEAR(run->volume(), 0.8 + 0.125, 1e-14);
  }
}

TEST(PatchShapes, points_carry_the_torque_of_slender_patches) {
  PlacedBody plate(box({-2, -2, -1}, {2, 2, 0}));
  for (const double width : {1e-1, 1e-3, 1e-4, 1e-5, 1e-6}) {
    PlacedBody bar(box({-0.5, -width / 2, 0}, {0.5, width / 2, 0.5}));
    ContactPatchQuery query(bar.collider, plate.collider);
    for (const double yaw : {0.0, 0.3, 0.785, 2.2})
      for (const std::uint32_t count : {3u, 4u, 7u}) {
        const RigidTransform tilt = RigidTransform::from_axis({1, 0, 0}, 0.2),
                             turn = RigidTransform::from_axis({0, 0, 1}, yaw);
        bar.collider.set_transform(
            inverse(relative_to(RigidTransform{tilt.rows, {0.01, 0.02, -0.05 * width}}, inverse(turn))));
        ASSERT_TRUE(query.run({.max_points = count}));
        ASSERT_EQ(query.patches().size(), 1u);
        const ContactPatch& patch = query.patches()[0];
        ASSERT_GE(patch.points.size(), 3u);
        const double size = length(patch.a.area_vector);
        EXPECT_LE(length(force_error(patch)), 1e-12 * size) << width << ' ' << yaw;
        // Of the torque about the bar's axis the width is the arm; 1e-15 is the rounding of points.
        EXPECT_LE(length(torque_error(patch)), size * (1e-9 * width + 1e-15)) << width << ' ' << yaw;
        for (const PatchPoint& point : patch.points) EXPECT_LE(length(point.force), 10 * size) << width << ' ' << yaw;
      }
  }
}

/// A bar along x with a prong upward near one end, and a prong downward near the other, which is a little wider.
Mesh pronged_bar() {
  const std::vector<std::pair<double, double>> profile{{-1, -0.5},   {-0.6, -0.5}, {-0.6, -2},   {-0.5, -2},
                                                       {-0.5, -0.5}, {1, -0.5},    {1, 0.5},     {0.6, 0.5},
                                                       {0.6, 2},     {0.501, 2},   {0.501, 0.5}, {-1, 0.5}};
  Mesh mesh;
  for (const double y : {-0.05, 0.05})
    for (const auto& [x, z] : profile) mesh.positions.push_back({x, y, z});
  for (std::uint32_t i = 0; i < 12; ++i) {
    const std::uint32_t j = (i + 1) % 12;
    mesh.facets.push_back({i, i + 12, j});
    mesh.facets.push_back({j, i + 12, j + 12});
  }
  for (const Facet& f : {Facet{0, 1, 11}, Facet{1, 10, 11}, Facet{1, 4, 10}, Facet{4, 7, 10}, Facet{4, 5, 7},
                         Facet{5, 6, 7}, Facet{1, 2, 3}, Facet{1, 3, 4}, Facet{7, 8, 9}, Facet{7, 9, 10}}) {
    mesh.facets.push_back(f);
    mesh.facets.push_back({f[2] + 12, f[1] + 12, f[0] + 12});
  }
  return inspect(mesh).volume > 0 ? mesh : test::inverted(mesh);
}

// The prongs leave the other body in opposite directions, so the region's area vector nearly vanishes, and the axis of
// force and torque is far away.
TEST(PatchShapes, points_carry_the_torque_of_nearly_closed_regions) {
  PlacedBody a(pronged_bar()), b(box({-3, -3, -1}, {3, 3, 1}));
  ContactPatchQuery query(a.collider, b.collider), swapped(b.collider, a.collider);
  for (const double yaw : {0.0, 0.4, 1.9}) {
    a.collider.set_transform(RigidTransform::from_axis({0, 0, 1}, yaw, {0.01, 0.02, 0.03}));
    for (ContactPatchQuery* const run : {&query, &swapped})
      for (const std::uint32_t count : {3u, 4u, 8u}) {
        ASSERT_TRUE(run->run({.max_points = count}));
        ASSERT_EQ(run->patches().size(), 1u);
        const ContactPatch& patch = run->patches()[0];
        EXPECT_NEAR(length(patch.a.area_vector), 1e-4, 1e-10);
        ASSERT_GE(patch.points.size(), 3u);
        EXPECT_LE(length(force_error(patch)), 1e-14);
        EXPECT_LE(length(torque_error(patch)), 1e-13);
        for (const PatchPoint& point : patch.points) {
          EXPECT_LE(length(point.point - patch.centroid), 5);
          EXPECT_LE(length(point.force), 1);
        }
      }
  }
}

/// A square tube along z, from z = 0 to 1.
Mesh tube(const Vec3& center, double outer, double inner) {
  Mesh mesh;
  for (const double z : {0.0, 1.0})
    for (const double half : {outer, inner})
      for (const auto& [x, y] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}})
        mesh.positions.push_back(center + Vec3{x * half, y * half, z});
  const auto quad = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r, std::uint32_t s) {
    mesh.facets.push_back({p, q, r});
    mesh.facets.push_back({p, r, s});
  };
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t n = (k + 1) % 4;
    quad(k, n, 8 + n, 8 + k);            // outside
    quad(4 + n, 4 + k, 12 + k, 12 + n);  // inside
    quad(n, k, 4 + k, 4 + n);            // bottom
    quad(8 + k, 8 + n, 12 + n, 12 + k);  // top
  }
  return mesh;
}

// One facet of the plate has hundreds of rings, each with a hole and a foot in it.
TEST(PatchShapes, many_rings_in_one_facet_keep_their_holes) {
  constexpr int count = 15;
  Mesh feet;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) {
      const Vec3 center{double(i), 0.9 * j, 0};
      feet = test::joined(feet, tube(center, 0.3, 0.2));
      feet = test::joined(feet, box(center - Vec3{0.1, 0.1, 0}, center + Vec3{0.1, 0.1, 1}));
    }
  PlacedBody a(feet), plate(box({-1, -1, -2}, {60, 60, 0}));
  a.collider.set_transform({.translation = {0.013, 0.007, -0.01}});
  for (const bool of_a : {true, false}) {
    ContactPatchQuery query(of_a ? a.collider : plate.collider, of_a ? plate.collider : a.collider);
    ASSERT_TRUE(query.run({.max_points = 0, .depths = false}));
    ASSERT_EQ(query.patches().size(), 2u * count * count);
    int rings = 0;
    for (const ContactPatch& patch : query.patches()) {
      const bool is_ring = patch.crossing_count > 20 || patch.volume > 0.001;
      rings += is_ring;
      EXPECT_NEAR(patch.volume, is_ring ? 0.01 * (0.36 - 0.16) : 0.01 * 0.04, 1e-13);
    }
    EXPECT_EQ(rings, count * count);
  }
}

TEST(PatchShapes, many_cavities_belong_to_the_body_around_them) {
  Mesh body = box({-1, -1, -1}, {20, 20, 3});
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      body = test::joined(body, test::inverted(test::icosphere(0, 0.3, {1.5 * i, 1.5 * j, 1.0})));
  PlacedBody a(body), b(box({-5, -5, -5}, {30, 30, 2.9}));
  ContactPatchQuery query(a.collider, b.collider);
  ASSERT_TRUE(query.run({.max_points = 0, .depths = false}));
  ASSERT_EQ(query.patches().size(), 1u);
  PlacedBody ball(test::icosphere(0, 0.3));
  PlacedBody around(box({-1, -1, -1}, {1, 1, 1}));
  const double one = test::clipped_overlap(ball.collider, around.collider).volume;
  EXPECT_NEAR(query.volume(), 21.0 * 21 * 3.9 - 144 * one, 1e-10);
}

// In a vast body wholly around it, a speck's volume has the digits of the speck.
TEST(PatchShapes, a_speck_wholly_inside_a_vast_body_keeps_its_digits) {
  PlacedBody speck(test::icosphere(1, 1e-3)), vast(box({-1e6, -1e6, -1e6}, {1e6, 1e6, 1e6}));
  PlacedBody near(box({-1, -1, -1}, {1, 1, 1}));
  speck.collider.set_transform({.translation = {0.3, 0.2, 0.1}});
  const double expected = test::clipped_overlap(speck.collider, near.collider).volume;
  ContactPatchQuery query(speck.collider, vast.collider), swapped(vast.collider, speck.collider);
  for (ContactPatchQuery* const run : {&query, &swapped}) {
    ASSERT_TRUE(run->run());
    EXPECT_NEAR(run->volume() / expected, 1, 1e-11);
  }
}

// Faces that touch in a plane which no coordinate axis is in overlap by rounding errors alone.
TEST(PatchShapes, centroids_of_faces_that_touch_are_in_the_contact) {
  Random random(17);
  PlacedBody a(box({-0.5, -0.25, 0}, {0.5, 0.25, 1})), b(box({-2, -2, -1}, {2, 2, 0}));
  int seen = 0;
  for (int pose = 0; pose < 400; ++pose) {
    const auto part = [&] { return random.uniform(-1, 1); };
    const RigidTransform place =
        RigidTransform::from_axis({part(), part(), part()}, random.uniform(0, 3), {part(), part(), part()});
    // In half of the poses tilted and moved by a few roundings as well.
    const double tiny = pose % 2 == 0 ? 0 : std::exp2(-52 + pose % 12);
    const RigidTransform tilt =
        RigidTransform::from_axis({part(), part(), part()}, tiny * part(), Vec3{part(), part(), part()} * tiny);
    a.collider.set_transform(inverse(relative_to(tilt, inverse(place))));
    b.collider.set_transform(place);
    ContactPatchQuery query(a.collider, b.collider);
    const Status status = query.run();
    ASSERT_TRUE(status) << message(status) << pose;
    for (const ContactPatch& patch : query.patches()) {
      ++seen;
      EXPECT_LE(patch.volume, 1e-12);
      const Vec3 local = place.inverse_rotate(patch.centroid - place.translation);
      EXPECT_LE(std::abs(local.x), 0.5 + 1e-9) << pose;
      EXPECT_LE(std::abs(local.y), 0.25 + 1e-9) << pose;
      EXPECT_LE(std::abs(local.z), 1e-9) << pose;
    }
  }
  EXPECT_GT(seen, 50);
}

// Feet nearer to each other than the square root of their area, which slide by their spacing from run to run: each is
// then where its neighbor was, for the plate, and where it was itself, for the feet.
TEST(PatchShapes, ids_of_a_row_of_feet_stay_with_the_feet) {
  constexpr int count = 9;
  constexpr double spacing = 0.04;
  Mesh feet;
  for (int i = 0; i < count; ++i) feet = test::joined(feet, box({i * spacing, 0, 0}, {i * spacing + 0.02, 0.5, 1}));
  for (const bool of_a : {true, false})
    for (const double angle : {0.0, 0.7}) {
      PlacedBody row(feet), plate(box({-9, -9, -1}, {9, 9, 0}));
      ContactPatchQuery query(of_a ? row.collider : plate.collider, of_a ? plate.collider : row.collider);
      const RigidTransform turn = RigidTransform::from_axis({0, 0, 1}, angle);
      std::vector<std::uint32_t> ids;
      for (int step = 0; step < 12; ++step) {
        // Forth and back, by the spacing of the feet.
        const double x = spacing * (step < 6 ? step : 12 - step);
        row.collider.set_transform({turn.rows, turn.rotate({x, 0.1, 0}) + Vec3{0, 0, -0.01}});
        ASSERT_TRUE(query.run());
        ASSERT_EQ(query.patches().size(), std::size_t{count});
        std::vector<std::uint32_t> now(count);
        for (const ContactPatch& patch : query.patches()) {
          const double along = turn.inverse_rotate(patch.centroid).x - x;
          now[static_cast<std::size_t>(std::lround((along - 0.01) / spacing))] = patch.id;
        }
        EXPECT_EQ(std::set<std::uint32_t>(now.begin(), now.end()).size(), std::size_t{count});
        if (step == 0) ids = now;
        EXPECT_EQ(now, ids) << step;
      }
    }
}

}  // namespace
}  // namespace morula

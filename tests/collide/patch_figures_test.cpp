// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Figures of contact patches: random poses against clipped tetrahedra; depths and normals of pressed bodies against
// known ones and against the least translation that parts the bodies; forces over slow slides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <morula/collide/contact_patches.hpp>
#include <morula/geometry/box.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <support/meshes.hpp>

#include "clipped_overlap.hpp"
#include "placed_bodies.hpp"

namespace morula {
namespace {

using test::clipped_overlap;
using test::ClippedOverlap;
using test::PlacedBody;

RigidTransform any_place(Random& random, double reach) {
  const auto part = [&] { return random.uniform(-1, 1); };
  const Vec3 axis{part(), part(), part()};
  return RigidTransform::from_axis(axis, random.uniform(0, 3), Vec3{part(), part(), part()} * reach);
}

/// The largest errors over random poses of pairs of small bodies, convex and not.
void compare_random_poses(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::unique_ptr<PlacedBody>> bodies, others;
  for (std::vector<std::unique_ptr<PlacedBody>>* const list : {&bodies, &others}) {
    list->push_back(std::make_unique<PlacedBody>(test::icosphere(0)));
    list->push_back(std::make_unique<PlacedBody>(test::box_mesh({-0.6, -0.5, -0.7}, {0.6, 0.5, 0.7})));
    list->push_back(std::make_unique<PlacedBody>(test::uv_sphere(6, 4, 0.9)));
    list->back()->deform(test::rippled(list->back()->mesh.positions, 0.3, 5));
    list->push_back(std::make_unique<PlacedBody>(test::joined(test::box_mesh({-1, -1, -0.2}, {-0.1, 0.3, 0.4}),
                                                              test::box_mesh({0.1, -0.3, -0.3}, {1, 1, 0.2}))));
  }
  double volume = 0, area = 0, centroid = 0;
  int overlaps = 0;
  for (int pose = 0; pose < count; ++pose) {
    PlacedBody &a = *bodies[static_cast<std::size_t>(pose % 4)], &b = *others[static_cast<std::size_t>(pose / 4 % 4)];
    a.collider.set_transform(any_place(random, 0.6));
    b.collider.set_transform(any_place(random, 0.6));
    ContactPatchQuery query(a.collider, b.collider);
    ASSERT_TRUE(query.run({.max_points = 0, .depths = false}));
    const ClippedOverlap exact = clipped_overlap(a.collider, b.collider);
    Vec3 moment, of_a, of_b;
    for (const ContactPatch& patch : query.patches())
      moment += patch.centroid * patch.volume, of_a += patch.a.area_vector, of_b += patch.b.area_vector;
    volume = std::max(volume, std::abs(query.volume() - exact.volume));
    area = std::max({area, length(of_a - exact.area_vector_a), length(of_b - exact.area_vector_b)});
    if (exact.volume < 1e-9) continue;
    ++overlaps;
    centroid = std::max(centroid, distance(moment / query.volume(), exact.centroid));
  }
  std::cout << count << " poses, " << overlaps << " overlap: largest error of the volume " << volume
            << ", of area vectors " << area << ", of the centroid " << centroid << '\n';
  EXPECT_GT(overlaps, count / 2);
  EXPECT_LE(volume, 1e-9);
  EXPECT_LE(area, 1e-9);
  EXPECT_LE(centroid, 1e-9);
}

TEST(PatchFigures, of_random_poses_are_those_of_clipped_tetrahedra) {
  compare_random_poses(400, 23);
}
// MORULA_PATCH_POSES: so many poses instead.
TEST(NightlyPatchFigures, of_random_poses_are_those_of_clipped_tetrahedra) {
  const char* const poses = std::getenv("MORULA_PATCH_POSES");
  compare_random_poses(poses != nullptr ? std::atoi(poses) : 20000, 29);
}

bool meet(const Collider& a, const Collider& b) {
  std::vector<Triangle> of_b;
  std::vector<Box> boxes;
  for (std::uint32_t g = 0; g < b.mesh_facets().size(); ++g) {
    of_b.push_back(b.triangle(g));
    boxes.emplace_back();
    for (const Vec3& x : {of_b[g][0], of_b[g][1], of_b[g][2]}) boxes[g].add(x);
  }
  for (std::uint32_t f = 0; f < a.mesh_facets().size(); ++f) {
    const Triangle t = a.triangle(f);
    const Vec3 lower = min(min(t[0], t[1]), t[2]), upper = max(max(t[0], t[1]), t[2]);
    for (std::size_t g = 0; g < of_b.size(); ++g) {
      const Vec3 gap = max(lower - boxes[g].upper, boxes[g].lower - upper);
      if (std::max({gap.x, gap.y, gap.z}) <= 0 && test::slow_distance(t, of_b[g]) == 0) return true;
    }
  }
  return false;
}

/// The translation of a along the direction at which surfaces that meet come apart, found by halving.
double least_translation(Collider& a, const Collider& b, const Vec3& direction, double most) {
  const RigidTransform place = a.transform();
  double low = 0, high = most;
  for (int step = 0; step < 24; ++step) {
    const double middle = (low + high) / 2;
    a.set_transform({place.rows, place.translation + direction * middle});
    (meet(a, b) ? low : high) = middle;
  }
  a.set_transform(place);
  return high;
}

double degrees_between(const Vec3& u, const Vec3& v) {
  return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

TEST(PatchFigures, a_ball_pressed_into_a_plate_has_the_depth_of_its_lowest_vertex) {
  Random random(3);
  PlacedBody ball(test::icosphere(3)), plate(test::box_mesh({-3, -3, -1}, {3, 3, 0}, 5));
  for (const double depth : {1e-3, 1e-2, 0.05})
    for (int pose = 0; pose < 20; ++pose) {
      RigidTransform place = any_place(random, 0.5);
      place.translation.z = 0;
      double lowest = 0;
      for (const Vec3& x : ball.mesh.positions) lowest = std::min(lowest, place(x).z);
      place.translation.z = -lowest - depth;
      ball.collider.set_transform(place);
      ContactPatchQuery query(ball.collider, plate.collider);
      ASSERT_TRUE(query.run());
      ASSERT_EQ(query.patches().size(), 1u);
      EXPECT_NEAR(query.patches()[0].depth / depth, 1, 1e-9);
      EXPECT_LE(degrees_between(query.patches()[0].normal, {0, 0, 1}), 1e-6);
    }
}

/// Two limbs, one across the other, pressed together by about a share of their size.
void press_limbs(int detail, double share) {
  const Mesh limb = sample_body("limb", detail);
  const Box box = bounding_box(limb);
  PlacedBody lower(limb), upper(limb);
  const double size = box.diagonal();
  const RigidTransform turn = RigidTransform::from_axis({0, 0, 1}, 1.7);
  const Vec3 center = box.center();
  const auto place = [&](double height) {
    upper.collider.set_transform({turn.rows, center - turn.rotate(center) + Vec3{0.01 * size, 0.02 * size, height}});
  };
  double height = 2 * box.extent().z;
  for (const double step : {0.02 * size, 0.002 * size, 0.0002 * size}) {
    for (; place(height), !meet(upper.collider, lower.collider); height -= step) ASSERT_GT(height, 0);
    height += step;
  }
  place(height - share * size);
  ContactPatchQuery query(upper.collider, lower.collider);
  ASSERT_TRUE(query.run());
  ASSERT_EQ(query.patches().size(), 1u);
  const ContactPatch& patch = query.patches()[0];
  const double exact = least_translation(upper.collider, lower.collider, patch.normal, 4 * share * size);
  EXPECT_LT(exact, 4 * share * size);
  EXPECT_NEAR(patch.depth / exact, 1, 0.02);
  const ClippedOverlap clipped = clipped_overlap(upper.collider, lower.collider);
  const double angle = degrees_between(patch.normal, -clipped.area_vector_a);
  EXPECT_LE(angle, 0.5);
  std::cout << "limbs of " << limb.facet_count() << " facets pressed by " << share << ": depth over exact "
            << patch.depth / exact << ", normal off by " << angle << " degrees\n";
}

TEST(PatchFigures, limbs_pressed_together_have_the_least_translation_as_depth) {
  press_limbs(8, 0.002);
  press_limbs(8, 0.01);
}
TEST(LongPatchFigures, fine_limbs_pressed_together_have_the_least_translation_as_depth) {
  for (const double share : {0.001, 0.005, 0.01}) press_limbs(24, share);
}

/// The largest change of a force from step to step, over the median one.
double unevenness(const std::vector<Vec3>& forces) {
  std::vector<double> changes;
  for (std::size_t i = 1; i < forces.size(); ++i) changes.push_back(distance(forces[i], forces[i - 1]));
  std::sort(changes.begin(), changes.end());
  return changes.back() / changes[changes.size() / 2];
}

/// The forces volume times area vector of all steps, those of points, and those of clipped tetrahedra.
struct Slide {
  std::vector<Vec3> of_patches, of_points, exact;

  template <class Place>
  Slide(PlacedBody& a, PlacedBody& b, int steps, bool clips, const Place& place) {
    ContactPatchQuery query(a.collider, b.collider);
    for (int step = 0; step <= steps; ++step) {
      a.collider.set_transform(place(static_cast<double>(step) / steps));
      EXPECT_TRUE(query.run({.depths = false}));
      Vec3 patches, points;
      for (const ContactPatch& patch : query.patches()) {
        patches -= patch.a.area_vector * patch.volume;
        for (const PatchPoint& point : patch.points) points += point.force * patch.volume;
      }
      of_patches.push_back(patches);
      of_points.push_back(points);
      if (!clips) continue;
      const ClippedOverlap clipped = clipped_overlap(a.collider, b.collider);
      exact.push_back(clipped.area_vector_a * -clipped.volume);
    }
  }
};

// A ball up a ramp, a ball around a larger one, and the tip of a tool along a limb.
void slide_slowly(int steps) {
  const RigidTransform turned = RigidTransform::from_axis({0.1, 1, 0.2}, 1);
  PlacedBody ball(test::icosphere(3)), plate(test::box_mesh({-6, -6, -1}, {6, 6, 0}, 7)), globe(test::icosphere(4, 3));
  PlacedBody limb(sample_body("limb", 48)), tool(sample_body("tool", 48));
  const Box of_limb = bounding_box(limb.mesh), of_tool = bounding_box(tool.mesh);
  const RigidTransform down = RigidTransform::from_axis({0, 1, 0}, std::numbers::pi / 2);
  const Vec3 tip = down(Vec3{of_tool.upper.x, of_tool.center().y, of_tool.center().z});
  const auto expect = [&](const char* name, const Slide& slide) {
    std::cout << name << ", " << steps << " steps: largest change over the median " << unevenness(slide.of_patches)
              << ", of points " << unevenness(slide.of_points) << '\n';
    EXPECT_LE(unevenness(slide.of_patches), 3) << name;
    EXPECT_LE(unevenness(slide.of_points), 3) << name;
    EXPECT_GT(length(slide.of_patches.front()), 0) << name;
    EXPECT_GT(length(slide.of_patches.back()), 0) << name;
  };
  expect("ramp", Slide(ball, plate, steps, false, [&](double t) {
           const double x = 2 * t - 1;
           return RigidTransform{turned.rows, {x, 0.1 * x, 1 - 0.04 - 0.01 * t}};
         }));
  expect("ball around a ball", Slide(ball, globe, steps, false, [&](double t) {
           const double angle = 0.3 + 0.5 * t;
           return RigidTransform{turned.rows, normalized(Vec3{std::cos(angle), std::sin(angle), 0.1}) * 3.9};
         }));
  expect("tool along a limb", Slide(tool, limb, steps, false, [&](double t) {
           const Vec3 e = of_limb.extent(), at{of_limb.lower.x + e.x * (0.25 + 0.05 * t),
                                               of_limb.center().y + 0.02 * e.y, of_limb.upper.z - 0.12 * e.z};
           return RigidTransform{down.rows, at - tip};
         }));
}

TEST(PatchFigures, forces_of_slow_slides_change_evenly) {
  slide_slowly(500);
}
TEST(LongPatchFigures, forces_of_slow_slides_of_ten_thousand_steps_change_evenly) {
  slide_slowly(10000);
}

Slide roll(int subdivisions, int steps, bool clips) {
  PlacedBody ball(test::icosphere(subdivisions)), plate(test::box_mesh({-3, -3, -1}, {3, 3, 0}));
  return Slide(ball, plate, steps, clips, [](double t) {
    return RigidTransform::from_axis({0.1, 1, 0.2}, 3 * t, {3 * t - 1.5, 0.3 * t, 0.88});
  });
}

// The force of a smooth ball that rolls on a plate is constant, so all changes come from the ball's facets: they are
// those of the exact overlap, and grow small with the facets.
TEST(PatchFigures, a_rolling_ball_has_the_changes_of_its_facets) {
  const Slide coarse = roll(1, 300, true);
  for (std::size_t i = 0; i < coarse.exact.size(); ++i) {
    EXPECT_LE(distance(coarse.of_patches[i], coarse.exact[i]), 1e-15);
    EXPECT_LE(distance(coarse.of_points[i], coarse.exact[i]), 1e-15);
  }
  EXPECT_NEAR(unevenness(coarse.of_patches) / unevenness(coarse.exact), 1, 1e-6);
  const auto largest = [](const std::vector<Vec3>& forces) {
    double change = 0;
    for (std::size_t i = 1; i < forces.size(); ++i)
      change = std::max(change, distance(forces[i], forces[i - 1]) / length(forces[i]));
    return change;
  };
  const double of_coarse = largest(coarse.of_patches), of_fine = largest(roll(3, 300, false).of_patches);
  std::cout << "rolling: largest change of a step over the force " << of_coarse << ", with facets of a quarter of the "
            << "edge " << of_fine << '\n';
  EXPECT_LE(of_fine, of_coarse / 4);
}

}  // namespace
}  // namespace morula

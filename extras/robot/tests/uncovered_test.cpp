// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres of robots that leave a share of the surface uncovered, and spheres that grow inside links. Samples judge
// them: areas by points on facets, volumes by points in spheres and solid angles.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/output.hpp>
#include <morula/tree/cover.hpp>
#include <numbers>
#include <support/scratch_folder.hpp>

#include "fit/partial_cover.hpp"
#include "fit/within.hpp"

namespace morula::test::uncovered {
namespace {

const robot::Robot arm = robot::read_robot(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");

/// The distance of a point from the union of the spheres, whose numbers are read as Scalar; below 0 inside.
template <class Scalar = double>
double gap(const Vec3& p, std::span<const Sphere> spheres) {
  double least = std::numeric_limits<double>::infinity();
  for (const Sphere& s : spheres) {
    const auto x = static_cast<double>(static_cast<Scalar>(s.center.x)),
               y = static_cast<double>(static_cast<Scalar>(s.center.y)),
               z = static_cast<double>(static_cast<Scalar>(s.center.z)),
               r = static_cast<double>(static_cast<Scalar>(s.radius));
    least = std::min(least, std::hypot(p.x - x, p.y - y, p.z - z) - r);
  }
  return least;
}

struct Surface {
  double area = 0, bare = 0, deepest = 0;
};

/// The area of a mesh and of its part in no sphere, and the farthest point of it, by points of every facet.
template <class Scalar = double>
Surface judge(const Mesh& mesh, std::span<const Sphere> spheres) {
  Random random(11);
  Surface result;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    const double area = 0.5 * length(cross(b - a, c - a));
    result.area += area;
    constexpr int points = 300;
    for (int k = 0; k < points; ++k) {
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const double distance = gap<Scalar>(a + u * (b - a) + v * (c - a), spheres);
      result.bare += distance > 0 ? area / points : 0;
      result.deepest = std::max(result.deepest, distance);
    }
    for (const Vec3& corner : {a, b, c}) result.deepest = std::max(result.deepest, gap<Scalar>(corner, spheres));
  }
  return result;
}

/// The winding number of a mesh around a point, by solid angles of its facets.
double winding(const Mesh& mesh, const Vec3& p) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    const Vec3 u = a - p, v = b - p, w = c - p;
    const double lu = length(u), lv = length(v), lw = length(w);
    sum += std::atan2(dot(u, cross(v, w)), lu * lv * lw + dot(u, v) * lw + dot(v, w) * lu + dot(w, u) * lv);
  }
  return sum / (2 * std::numbers::pi);
}

/// The volume in the spheres and outside the mesh. A point in k spheres counts as 1 / k of a point.
double outside(const Mesh& mesh, std::span<const Sphere> spheres, int points_of_a_sphere) {
  Random random(5);
  double sum = 0;
  for (const Sphere& s : spheres) {
    const double volume = 4 / 3.0 * std::numbers::pi * s.radius * s.radius * s.radius;
    for (int k = 0; k < points_of_a_sphere; ++k) {
      Vec3 way;
      do way = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      while (!(dot(way, way) <= 1));
      const Vec3 p = s.center + s.radius * way;
      if (winding(mesh, p) > 0.5) continue;
      int in = 0;
      for (const Sphere& other : spheres) in += distance(p, other.center) <= other.radius;
      sum += volume / points_of_a_sphere / std::max(1, in);
    }
  }
  return sum;
}

double outside_of_all(const robot::RobotSpheres& fitted) {
  double sum = 0;
  for (const robot::LinkSpheres& link : fitted.links)
    if (!link.surface.mesh.facets.empty()) sum += outside(link.surface.mesh, link.spheres, 300);
  return sum;
}

double bare_share(const robot::RobotSpheres& fitted) {
  double bare = 0, area = 0;
  for (const robot::LinkSpheres& link : fitted.links) {
    const Surface s = judge(link.surface.mesh, link.spheres);
    bare += s.bare, area += s.area;
  }
  return bare / area;
}

robot::Robot robot_of(const ScratchFolder& folder, const std::string& shapes) {
  return robot::read_robot(folder.file("one.urdf", "<robot name='one'><link name='one'>" + shapes + "</link></robot>"));
}

TEST(Uncovered, keeps_the_share_and_the_tolerance) {
  for (const double share : {0.15, 0.5})
    for (const double tolerance : {0.01, 0.08}) {
      const robot::RobotSpheres fitted =
          robot::fit_spheres(arm, {.spheres = 5, .tolerance = tolerance, .max_uncovered = share});
      EXPECT_TRUE(fitted.notes.empty());
      EXPECT_LE(fitted.uncovered_share(), share);
      EXPECT_NEAR(fitted.uncovered_share(), bare_share(fitted), 0.02);
      EXPECT_LE(fitted.within(), tolerance);
      for (const robot::LinkSpheres& link : fitted.links) {
        EXPECT_LE(link.spheres.size(), link.surface.spheres.size() + 5);
        if (link.surface.mesh.facets.empty()) continue;
        EXPECT_LE(judge<double>(link.surface.mesh, link.spheres).deepest, link.figures.within) << link.link;
        EXPECT_LE(judge<float>(link.surface.mesh, link.spheres).deepest, link.figures.within) << link.link;
      }
    }
}

TEST(Uncovered, takes_less_space_the_more_may_be_bare) {
  double last = outside_of_all(robot::fit_spheres(arm, {.spheres = 5}));
  for (const double share : {0.1, 0.4}) {
    const robot::RobotSpheres fitted =
        robot::fit_spheres(arm, {.spheres = 5, .tolerance = 0.08, .max_uncovered = share});
    EXPECT_GT(fitted.uncovered_share(), 0.7 * share) << "space was bought for nothing";
    const double now = outside_of_all(fitted);
    EXPECT_LT(now, last) << share;
    last = now;
  }
}

// Where the tolerance alone leaves a share uncovered, the same share costs no more space.
TEST(Uncovered, is_no_looser_than_the_tolerance_alone) {
  const robot::RobotSpheres alone = robot::fit_spheres(arm, {.spheres = 5, .tolerance = 0.01});
  const robot::RobotSpheres placed =
      robot::fit_spheres(arm, {.spheres = 5, .tolerance = 0.01, .max_uncovered = alone.uncovered_share()});
  EXPECT_LE(outside_of_all(placed), 1.05 * outside_of_all(alone));
}

TEST(Uncovered, is_the_same_for_any_number_of_workers_and_far_from_the_origin) {
  const ScratchFolder folder;
  std::vector<std::vector<Sphere>> spheres;
  Workers one(1), three(3);
  for (Workers* workers : {&one, &three}) {
    const robot::RobotSpheres fitted =
        robot::fit_spheres(arm, {.spheres = 3, .tolerance = 0.05, .max_uncovered = 0.4}, *workers);
    std::vector<Sphere> all;
    for (const robot::LinkSpheres& link : fitted.links) all.insert(all.end(), link.spheres.begin(), link.spheres.end());
    spheres.push_back(std::move(all));
  }
  EXPECT_EQ(spheres[0], spheres[1]);

  std::vector<double> volumes;
  for (const char* place : {"0 0 0", "3000 -3000 3000"}) {
    const robot::Robot box = robot_of(folder, std::string("<collision><origin xyz='") + place +
                                                  "'/><geometry><box size='0.3 0.2 0.1'/></geometry></collision>");
    const robot::RobotSpheres fitted = robot::fit_spheres(box, {.spheres = 6, .tolerance = 0.05, .max_uncovered = 0.3});
    EXPECT_LE(fitted.uncovered_share(), 0.3) << place;
    EXPECT_LE(judge(fitted.links[0].surface.mesh, fitted.links[0].spheres).deepest, fitted.within()) << place;
    EXPECT_LE(fitted.within(), 0.05) << place;
    volumes.push_back(outside_of_all(fitted));
  }
  EXPECT_NEAR(volumes[1] / volumes[0], 1, 0.3);
}

TEST(Uncovered, keeps_limits_of_radii_and_given_spheres) {
  const std::vector<Sphere> given{{{0, 0, 0.15}, 0.05}};
  const robot::RobotSpheres fitted = robot::fit_spheres(arm, {.spheres = 8,
                                                              .tolerance = 0.05,
                                                              .max_uncovered = 0.9,
                                                              .padding = 0.003,
                                                              .min_radius = 0.02,
                                                              .max_radius = 0.1,
                                                              .fixed_spheres = {{"forearm", given}},
                                                              .clip = {{"base", {{{0, 0, 1}, 0.05}}}}});
  for (const robot::LinkSpheres& link : fitted.links) {
    if (arm.links[link.link].name == "forearm") {
      EXPECT_EQ(link.spheres, given);
      continue;
    }
    for (const Sphere& s : link.spheres) {
      EXPECT_GE(s.radius, 0.02);
      EXPECT_LE(s.radius, 0.1 * (1 + 1e-5)) << arm.links[link.link].name;
    }
    EXPECT_LE(link.figures.within, 0.05) << arm.links[link.link].name;
  }
}

TEST(Uncovered, an_open_surface_is_covered_within_the_tolerance) {
  const ScratchFolder folder;
  (void)folder.file("bowl.obj",
                    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 -.5\n"
                    "f 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n");
  const robot::Robot bowl = robot_of(folder, "<collision><geometry><mesh filename='bowl.obj'/></geometry></collision>");
  const robot::RobotSpheres fitted = robot::fit_spheres(bowl, {.spheres = 6, .tolerance = 0.2, .max_uncovered = 0.5});
  EXPECT_LE(fitted.uncovered_share(), 0.5);
  EXPECT_LE(judge(fitted.links[0].surface.mesh, fitted.links[0].spheres).deepest, fitted.within());
  EXPECT_LE(fitted.within(), 0.2);
}

// Vertices that no facet has are no part of the surface, wherever they are.
TEST(Uncovered, loose_vertices_do_not_count) {
  const ScratchFolder folder;
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 -.5\n",
                    facets = "f 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\nf 1 2 3\nf 1 3 4\n";
  (void)folder.file("plain.obj", corners + facets);
  (void)folder.file("loose.obj", corners + "v 9 8 7\n" + facets);
  const auto fitted = [&](const std::string& file) {
    const robot::Robot one =
        robot_of(folder, "<collision><geometry><mesh filename='" + file + "'/></geometry></collision>");
    return robot::fit_spheres(one, {.spheres = 4, .tolerance = 0.05, .max_uncovered = 0.4}).links[0];
  };
  const robot::LinkSpheres plain = fitted("plain.obj"), loose = fitted("loose.obj");
  EXPECT_EQ(plain.surface.mesh.positions.size(), 5u);
  EXPECT_EQ(loose.surface.mesh.positions, plain.surface.mesh.positions);
  EXPECT_EQ(loose.spheres, plain.spheres);
}

TEST(Uncovered, refuses_what_it_cannot_keep) {
  const auto refused = [](const robot::FitOptions& options) {
    EXPECT_THROW((void)robot::fit_spheres(arm, options), std::invalid_argument);
  };
  for (const double share : {0.0, -0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
    refused({.tolerance = 0.01, .max_uncovered = share});
  refused({.max_uncovered = 0.3});
  refused({.max_protrusion = 0.1, .tolerance = 0.01, .max_uncovered = 0.3});
}

/// A box of 0.4 × 0.2 × 0.1 as a mesh.
Mesh box_mesh(bool closed) {
  Mesh mesh;
  for (const int i : {0, 1, 2, 3, 4, 5, 6, 7})
    mesh.positions.push_back({(i & 1) ? 0.2 : -0.2, (i & 2) ? 0.1 : -0.1, (i & 4) ? 0.05 : -0.05});
  mesh.facets = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  if (!closed) mesh.facets.pop_back();
  return mesh;
}

TEST(Uncovered, spheres_grow_up_to_the_largest_radius_alone) {
  const Mesh box = box_mesh(true);
  const std::vector<Sphere> start{{{0.1, 0, 0}, 0.03}, {{-0.1, 0, 0}, 0.09}};
  robot::PartialCover cover(box, SignedDistance(box), start, 0.5, 0.06, 1);
  cover.set_tolerance(0.01);
  EXPECT_EQ(cover.spheres()[0].radius, 0.06);
  EXPECT_EQ(cover.spheres()[1].radius, 0.09) << "it does not shrink";
  robot::PartialCover free(box, SignedDistance(box), start, 0.5, 1e300, 1);
  free.set_tolerance(0.01);
  for (const Vec3& corner : box.positions) EXPECT_LE(gap(corner, free.spheres()), 0.01 + 1e-6);
}

TEST(FitTolerance, spheres_inside_grow_to_the_surface_and_no_farther) {
  const std::vector<Sphere> before{{{0, 0, 0}, 0.01},   {{0.1, 0.05, 0.02}, 0.001}, {{0, 0, 0.04}, 0.3},
                                   {{0.3, 0, 0}, 0.02}, {{0.19, 0, 0}, 0.01},       {{0, 0, 0.2}, 0.1}};
  const std::vector<double> depths{0.05, 0.03, 0.3, 0.02, 0.01, 0.1};
  std::vector<Sphere> grown = before;
  robot::grow_inside(box_mesh(true), grown, 1);
  for (std::size_t i = 0; i < grown.size(); ++i) {
    EXPECT_EQ(grown[i].center, before[i].center);
    EXPECT_GE(grown[i].radius, before[i].radius) << i;
    EXPECT_NEAR(grown[i].radius, depths[i], 2e-6) << i;
    if (before[i].radius < depths[i]) {
      EXPECT_LT(grown[i].radius, depths[i] - 4e-7 * 0.3) << "rounding has to fit in";
    }
  }
  grown = before;
  robot::grow_inside(box_mesh(true), grown, 0.02);
  EXPECT_EQ(grown[0].radius, 0.02);
  EXPECT_EQ(grown[2], before[2]);
  grown = before;
  robot::grow_inside(box_mesh(false), grown, 1);
  EXPECT_EQ(grown, before) << "an open mesh has no inside";
}

// Reduced leaves of the tree are what the spheres would be without growth.
TEST(FitTolerance, growth_takes_no_space_outside) {
  for (const double tolerance : {0.02, 0.06}) {
    const robot::RobotSpheres fitted = robot::fit_spheres(arm, {.spheres = 6, .tolerance = tolerance});
    double grown_volume = 0, reduced_volume = 0;
    for (const robot::LinkSpheres& link : fitted.links) {
      if (!link.tree || !link.surface.spheres.empty()) continue;
      std::vector<Sphere> plain;
      for (const Sphere& s : level_set_spheres(link.tree->tree, link.tree->tree.level_count() - 1))
        plain.push_back(reduced(s, tolerance));
      EXPECT_LE(outside(link.surface.mesh, link.spheres, 1000), outside(link.surface.mesh, plain, 1000) + 2e-6);
      grown_volume += union_mass(link.spheres).volume;
      reduced_volume += union_mass(plain).volume;
    }
    EXPECT_GT(grown_volume, reduced_volume) << tolerance;
  }
}

}  // namespace
}  // namespace morula::test::uncovered

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What may be left out of a hull, judged in integers; and ownership of aligned bodies, judged by separating lines.
#include "update/points/facet_hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/generators/build.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/aligned.hpp>

#include "../bodies.hpp"
#include "update/points/local_points.hpp"
#include "update/points/ownership_check.hpp"
#include "update/rules/corner_walk.hpp"

namespace morula {
using namespace detail;
namespace {

__extension__ typedef __int128 Wide;

// Coordinates are multiples of 2^-52 below 1, so doubles hold them and products of differences fit into 128 bits.
Wide units(double x) {
  return static_cast<Wide>(static_cast<std::int64_t>(std::ldexp(x, 52)));
}

Wide turn(const FacetPoint& a, const FacetPoint& b, const FacetPoint& c) {
  return (units(b.x) - units(a.x)) * (units(c.y) - units(a.y)) - (units(b.y) - units(a.y)) * (units(c.x) - units(a.x));
}

// In integers: inside a convex polygon, on it, or between two ends where it is a segment.
bool is_inside(const FacetPoint& p, std::span<const FacetPoint> hull) {
  if (hull.size() == 1) return p.x == hull[0].x && p.y == hull[0].y;
  if (hull.size() == 2) {
    const auto within = [](double x, double a, double b) { return std::min(a, b) <= x && x <= std::max(a, b); };
    return turn(hull[0], hull[1], p) == 0 && within(p.x, hull[0].x, hull[1].x) && within(p.y, hull[0].y, hull[1].y);
  }
  for (std::size_t k = 0; k < hull.size(); ++k)
    if (turn(hull[k], hull[(k + 1) % hull.size()], p) < 0) return false;
  return true;
}

double distance_to_segment(const FacetPoint& p, const FacetPoint& a, const FacetPoint& b) {
  double least = 4;
  // By trying: close enough to judge a tolerance by, and nothing like the code that is judged.
  for (int i = 0; i <= 4096; ++i) {
    const double t = i / 4096.0;
    least = std::min(least, std::abs(p.x - (a.x + t * (b.x - a.x))) + std::abs(p.y - (a.y + t * (b.y - a.y))));
  }
  return least;
}

double grid(double x) {
  return std::ldexp(std::floor(std::ldexp(x, 52)), -52);
}

// Corners as cuts make them: on lattice lines, on lines that are off by some ulps, equal ones, all in one place.
std::vector<FacetPoint> corners_of_cuts(Random& random, int kind) {
  std::vector<FacetPoint> points;
  const int count = 1 + static_cast<int>(random.uniform(0, 24));
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    double x = random.uniform(0, 1), y = random.uniform(0, 1);
    const double ulps = std::floor(random.uniform(-2, 3)) * 0x1p-52;
    if (kind == 0) x = std::floor(x * 4) / 4, y = std::floor(y * 4) / 4;  // a coarse lattice
    if (kind == 1) x = 0.375 + ulps;                                      // one cut line, uneven by ulps
    if (kind == 2) y = 0.25 + 0.5 * std::floor(x * 8) / 8 + ulps, x = std::floor(x * 8) / 8;  // a slanted one
    if (kind == 3) x = 0.5 + ulps, y = 0.5 - ulps;                                            // a cluster
    points.push_back({i, grid(x), grid(y)});
  }
  return points;
}

TEST(FacetHull, with_tolerance_zero_every_point_is_in_the_hull_in_integers) {
  Random random(3);
  std::size_t dropped = 0;
  FacetHull hull;
  for (int trial = 0; trial < 20000; ++trial) {
    const std::vector<FacetPoint> all = corners_of_cuts(random, trial % 5);
    std::vector<FacetPoint> points = all;
    const auto kept = hull.surround(points, 0);
    for (const FacetPoint& p : all) ASSERT_TRUE(is_inside(p, kept)) << "trial " << trial << ", corner " << p.corner;
    dropped += all.size() - kept.size();
  }
  EXPECT_GT(dropped, 100000u);
}

TEST(FacetHull, with_a_tolerance_every_point_is_that_near_to_the_hull) {
  Random random(4);
  FacetHull hull;
  for (int trial = 0; trial < 5000; ++trial) {
    const std::vector<FacetPoint> all = corners_of_cuts(random, trial % 5);
    std::vector<FacetPoint> points = all;
    const auto kept = hull.surround(points, hull_tolerance);
    for (const FacetPoint& p : all) {
      if (is_inside(p, kept)) continue;
      double nearest = 4;
      for (std::size_t k = 0; k < kept.size(); ++k)
        nearest = std::min(nearest, distance_to_segment(p, kept[k], kept[(k + 1) % kept.size()]));
      // Trying finds a distance along the segment of up to 2^-12 of its length; across it, none of these is longer
      // than some ulps unless it is far outside.
      ASSERT_LE(nearest, 0x1p-10) << "trial " << trial << ", corner " << p.corner;
      bool near = false;
      for (std::size_t k = 0; k < kept.size() && !near; ++k) {
        const FacetPoint &a = kept[k], &b = kept[(k + 1) % kept.size()];
        const long double dx = static_cast<long double>(b.x) - a.x, dy = static_cast<long double>(b.y) - a.y;
        const long double squared = dx * dx + dy * dy;
        const long double t = squared > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / squared : 0;
        const long double u = std::min(1.0L, std::max(0.0L, t));
        near = std::abs(p.x - a.x - u * dx) + std::abs(p.y - a.y - u * dy) <= hull_tolerance * 1.0000001L;
      }
      ASSERT_TRUE(near) << "trial " << trial << ", corner " << p.corner;
    }
  }
}

// The defect that this was written for: on a cut line along y, x differs by an ulp, so the order in y is arbitrary, and
// a corner far beyond the others looked as if it lay between them.
TEST(FacetHull, keeps_both_ends_of_a_line_that_is_uneven_by_an_ulp) {
  const double x = 0.3333333333333333, next = std::nextafter(x, 1.0);
  std::vector<FacetPoint> points{{0, x, 0.9}, {1, next, 0.1}, {2, next, 0.5}, {3, x, 0.2}};
  FacetHull hull;
  for (const double tolerance : {0.0, hull_tolerance}) {
    std::vector<FacetPoint> copy = points;
    std::vector<std::uint32_t> kept;
    for (const FacetPoint& p : hull.surround(copy, tolerance)) kept.push_back(p.corner);
    EXPECT_EQ(std::count(kept.begin(), kept.end(), 0u), 1) << tolerance;
    EXPECT_EQ(std::count(kept.begin(), kept.end(), 1u), 1) << tolerance;
  }
}

TEST(FacetHull, drops_at_the_tolerance_and_keeps_beyond_it) {
  FacetHull hull;
  for (const double out : {0.9, 1.1}) {
    std::vector<FacetPoint> points{{0, 0, 0.5}, {1, 1, 0.5}, {2, 0.5, 0.5 + out * hull_tolerance}, {3, 0.5, 0.25}};
    const auto kept = hull.surround(points, hull_tolerance);
    const bool accepts = std::any_of(kept.begin(), kept.end(), [](const FacetPoint& p) { return p.corner == 2; });
    EXPECT_EQ(accepts, out > 1) << out;
  }
}

// A slowly bending row: each corner is near the line of its neighbors, all together are not. What is dropped is
// compared with what stays, so it does not add up.
TEST(FacetHull, small_steps_do_not_add_up) {
  std::vector<FacetPoint> points;
  for (std::uint32_t i = 0; i <= 512; ++i) {
    const double x = i / 512.0;
    points.push_back({i, x, 0.25 + 4096 * hull_tolerance * x * (1 - x)});
  }
  const std::vector<FacetPoint> all = points;
  FacetHull hull;
  const auto kept = hull.surround(points, hull_tolerance);
  EXPECT_LT(kept.size(), 100u);
  for (const FacetPoint& p : all) {
    long double nearest = 4;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const FacetPoint &a = kept[k], &b = kept[(k + 1) % kept.size()];
      if (std::min(a.x, b.x) > p.x || std::max(a.x, b.x) < p.x || a.x == b.x) continue;
      const long double t = (static_cast<long double>(p.x) - a.x) / (b.x - a.x);
      nearest = std::min(nearest, std::abs(p.y - (a.y + t * (b.y - a.y))));
    }
    if (!is_inside(p, kept)) {
      EXPECT_LE(nearest, 1.001L * hull_tolerance) << p.corner;
    }
  }
}

enum class Spoil { nothing, leaf, root };

std::vector<std::string> faults_of(const Mesh& mesh, const CoveredTree& model, double tolerance, Spoil spoil) {
  const LeafOrder order = depth_first_leaves(model.tree);
  const std::vector<std::uint8_t> all(order.leaves.size(), 1);
  Ownership owned = share_points(mesh, model.cover, order, all, tolerance);
  share_levels(mesh, model.tree, model.cover, order, tolerance, owned);
  // The root forgets the last point that it tests.
  if (spoil == Spoil::root) *std::find(owned.tested_from.rbegin(), owned.tested_from.rend(), 0u) = 1;
  if (spoil == Spoil::leaf) {
    // Every cut point that some leaf tests is forgotten by the last leaf that does.
    for (auto p = owned.points.end(); p-- != owned.points.begin();)
      if (*p >= owned.vertices.size()) {
        *p = owned.points[owned.begin[0]];
        break;
      }
  }
  return ownership_faults(mesh, model.tree, model.cover, order, owned, all, tolerance);
}

TEST(Ownership, of_aligned_bodies_surrounds_every_corner_for_every_leaf_and_ancestor) {
  std::size_t trees = 0, spoilt = 0, spoilt_above = 0;
  for (const test::NamedMesh& body : test::aligned_bodies())
    for (const Method method : {Method::octree, Method::grid, Method::spawn, Method::optimized}) {
      const bool own = method == Method::optimized;
      const CoveredTree model = build(body.mesh, {.method = method,
                                                  .depth = method == Method::octree || method == Method::grid ? 2 : 1,
                                                  .quality = own ? Quality::draft : Quality::standard});
      for (const double tolerance : {0.0, hull_tolerance}) {
        const auto faults = faults_of(body.mesh, model, tolerance, Spoil::nothing);
        EXPECT_TRUE(faults.empty()) << body.name << ", " << name(method) << ": " << faults.front();
        ++trees;
      }
      spoilt += faults_of(body.mesh, model, hull_tolerance, Spoil::leaf).empty() ? 0u : 1u;
      spoilt_above += faults_of(body.mesh, model, hull_tolerance, Spoil::root).empty() ? 0u : 1u;
    }
  EXPECT_GT(trees, 100u);
  EXPECT_GT(spoilt, 20u) << "a check that cannot fail";
  EXPECT_GT(spoilt_above, 20u) << "a check that cannot fail";
}

// Nodes above leaves look at fewer points than their leaves. What they leave out lies in the hull of what they look at,
// so it is no farther off than rounding.hpp allows for, wherever the vertices are.
TEST(Ownership, nodes_above_leaves_reach_as_far_by_the_few_points_that_they_look_at) {
  std::vector<test::Specimen> bodies = test::specimens();
  for (const test::NamedMesh& body : test::aligned_bodies())
    bodies.push_back({body.name, body.mesh, build(body.mesh, {.method = Method::octree, .depth = 2})});
  const Mesh limb = sample_body("limb", 12);
  bodies.push_back({"limb", limb, build(limb, {.depth = 3})});
  std::size_t few_tests = 0, all_tests = 0, nodes = 0, equal = 0;
  for (const test::Specimen& b : bodies) {
    const LeafOrder order = depth_first_leaves(b.model.tree);
    const std::vector<std::uint8_t> every_leaf(order.leaves.size(), 1), every_node(b.model.tree.node_count(), 1);
    Ownership owned = share_points(b.mesh, b.model.cover, order, every_leaf, hull_tolerance);
    CornerWalk all(b.model.tree, order, owned, every_node);
    share_levels(b.mesh, b.model.tree, b.model.cover, order, hull_tolerance, owned);
    CornerWalk few(b.model.tree, order, owned, every_node);
    all_tests += all.tested_points(), few_tests += few.tested_points();
    LocalPoints local(b.mesh, b.model.cover, owned);
    Random random(7);
    const auto anywhere = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
    for (int frame = 0; frame < 4; ++frame) {
      std::vector<Vec3> positions = b.mesh.positions;
      const double size = max_norm(bounding_box(b.mesh).extent());
      for (Vec3& p : positions) {
        if (frame > 0) p = p + anywhere() * (0.3 * size);
        if (frame == 2) p.z *= 1e-6;
        if (frame == 3) p = {p.x, p.x + 1e-7 * p.y, 0.25 * size};
      }
      const LocalPoints::Frame at = local.move(positions, serial_workers());
      ASSERT_TRUE(at.finite);
      std::vector<Spheref> spheres;
      for (std::size_t node = 0; node < b.model.tree.node_count(); ++node) {
        const LocalPoint& near = local.points()[node % local.points().size()];
        spheres.push_back({Vec3f(Vec3{near.x, near.y, near.z} + anywhere() * (0.1 * size)), 0});
      }
      all.measure(local.points(), spheres, serial_workers());
      few.measure(local.points(), spheres, serial_workers());
      for (std::size_t k = 0; k < spheres.size(); ++k) {
        const double far = std::sqrt(static_cast<double>(all.squared_reach(k)));
        const double found = std::sqrt(static_cast<double>(few.squared_reach(k)));
        EXPECT_LE(found, far);
        EXPECT_GE(found * (1 + 0x1p-22) + 0x1p-20 * at.rounding.largest_coordinate, far) << b.name << ", node " << k;
        ++nodes, equal += found == far;
      }
    }
  }
  EXPECT_LT(few_tests, all_tests * 4 / 5);
  EXPECT_GT(equal, nodes * 99 / 100) << "the farthest point is hardly ever one that is left out";
}

TEST(Ownership, of_specimens_surrounds_every_corner) {
  for (const test::Specimen& s : test::specimens()) {
    const auto faults = faults_of(s.mesh, s.model, hull_tolerance, Spoil::nothing);
    EXPECT_TRUE(faults.empty()) << s.name << ": " << faults.front();
  }
}

}  // namespace
}  // namespace morula

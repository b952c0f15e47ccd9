// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/query/power_diagram.hpp>
#include <stdexcept>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

namespace morula {
namespace {

using test::box_mesh;
using test::grid_plate;

using test::pi;

// Distance to the union, negative inside, by looking at every sphere.
double gap_at(std::span<const Sphere> spheres, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Sphere& s : spheres) least = std::min(least, distance(x, s.center) - s.radius);
  return least;
}

std::vector<Sphere> random_spheres(const Box& box, std::size_t count, double smallest, double largest,
                                   std::uint64_t seed) {
  Random random(seed);
  std::vector<Sphere> spheres;
  const double size = box.diagonal();
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 c;
    for (int axis = 0; axis < 3; ++axis) c[axis] = random.uniform(box.lower[axis], box.upper[axis]);
    spheres.push_back({c, random.uniform(smallest, largest) * size});
  }
  return spheres;
}

// Area of the unit square [0, 1]² at z = 0 outside the spheres: scan lines, each with its exact intervals.
double bare_area_of_unit_square(std::span<const Sphere> spheres, int lines) {
  double bare = 0;
  for (int line = 0; line < lines; ++line) {
    const double y = (line + 0.5) / lines;
    std::vector<std::pair<double, double>> chords;
    for (const Sphere& s : spheres) {
      const double squared = s.radius * s.radius - s.center.z * s.center.z - (y - s.center.y) * (y - s.center.y);
      if (squared > 0) chords.push_back({s.center.x - std::sqrt(squared), s.center.x + std::sqrt(squared)});
    }
    std::sort(chords.begin(), chords.end());
    double reached = 0;
    for (const auto& [begin, end] : chords) {
      if (begin > reached) bare += std::min(begin, 1.0) - reached;
      reached = std::min(1.0, std::max(reached, end));
    }
    bare += 1 - reached;
  }
  return bare / lines;
}

void expect_bounds_agree(const Coverage& c) {
  EXPECT_GE(c.uncovered_distance_upper, c.uncovered_distance);
  EXPECT_LE(c.uncovered_distance_upper, c.uncovered_distance * (1 + 1e-6) + 2 * c.tolerance);
  EXPECT_LE(c.uncovered_area, 1);
  if (c.covered) {
    EXPECT_EQ(c.uncovered_area, 0);
    EXPECT_EQ(c.uncovered_distance, 0);
    EXPECT_EQ(c.uncovered_distance_upper, 0);
  } else {
    EXPECT_GT(c.uncovered_distance_upper, c.tolerance);
  }
}

TEST(Coverage, of_a_plate_with_one_disc_is_exact) {
  for (int n : {1, 2, 7})
    for (const double height : {0.0, 0.1, -0.2})
      for (const double disc : {0.05, 0.2, 0.4999, 0.5}) {
        const std::vector<Sphere> ball{{{0.5, 0.5, height}, std::hypot(disc, height)}};
        const Coverage c = coverage(grid_plate(n), ball);
        EXPECT_FALSE(c.covered);
        EXPECT_NEAR(c.uncovered_area, 1 - pi * disc * disc, 1e-13) << n << " squares, disc " << disc;
        EXPECT_NEAR(c.uncovered_distance, std::sqrt(0.5 + height * height) - ball[0].radius, 1e-13);
        expect_bounds_agree(c);
      }
}

TEST(Coverage, of_a_plate_whose_disc_reaches_over_its_edges_is_exact) {
  // Between the inscribed and the circumscribed circle four caps stick out.
  for (const double r : {0.51, 0.6, 0.7, 0.7071}) {
    const double half_angle = std::acos(0.5 / r);
    const double cap = r * r * (half_angle - std::sin(2 * half_angle) / 2);
    const std::vector<Sphere> ball{{{0.5, 0.5, 0}, r}};
    const Coverage c = coverage(grid_plate(3), ball);
    EXPECT_NEAR(c.uncovered_area, 1 - (pi * r * r - 4 * cap), 1e-14) << r;
    EXPECT_NEAR(c.uncovered_distance, std::sqrt(0.5) - r, 1e-14);
  }
  // The circumscribed sphere passes through the corners, up to rounding.
  EXPECT_TRUE(coverage(grid_plate(3), std::vector<Sphere>{{{0.5, 0.5, 0}, std::sqrt(0.5)}}).covered);
}

TEST(Coverage, of_two_discs_counts_their_lens_once) {
  const double r = 0.25, apart = 0.3;
  const std::vector<Sphere> balls{{{0.35, 0.5, 0}, r}, {{0.65, 0.5, 0}, r}};
  const double lens = 2 * r * r * std::acos(apart / (2 * r)) - apart / 2 * std::sqrt(4 * r * r - apart * apart);
  for (int n : {1, 4}) EXPECT_NEAR(coverage(grid_plate(n), balls).uncovered_area, 1 - 2 * pi * r * r + lens, 1e-13);
}

TEST(Coverage, bare_area_of_a_facet_in_many_cells_agrees_with_scan_lines) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const std::size_t count = seed < 4 ? 3 : 25;
    const Box box{{-0.1, -0.1, -0.15}, {1.1, 1.1, 0.15}};
    const auto spheres = random_spheres(box, count, 0.02, count == 3 ? 0.3 : 0.15, seed);
    const double expected = bare_area_of_unit_square(spheres, 20000);
    for (int n : {1, 5}) {
      const Coverage c = coverage(grid_plate(n), spheres);
      EXPECT_NEAR(c.uncovered_area, expected, 3e-6) << "seed " << seed;
      expect_bounds_agree(c);
    }
  }
}

TEST(Coverage, sees_nested_equal_and_point_spheres_as_nothing_new) {
  const std::vector<Sphere> ball{{{0.4, 0.5, 0.05}, 0.3}};
  const std::vector<Sphere> more{{{0.4, 0.5, 0.05}, 0.3},
                                 {{0.4, 0.5, 0.05}, 0.3},
                                 {{0.45, 0.5, 0}, 0.1},
                                 {{0.5, 0.5, 0}, 0.0},
                                 {{0.4, 0.5, 0.05}, 0.0}};
  const Coverage a = coverage(grid_plate(2), ball), b = coverage(grid_plate(2), more);
  EXPECT_NEAR(a.uncovered_area, b.uncovered_area, 1e-13);
  EXPECT_NEAR(a.uncovered_distance, b.uncovered_distance, 1e-13);
}

// Three spheres through one point of a facet: the power vertex lies on all three, and just there the cover is closed.
TEST(Coverage, closes_at_a_power_vertex_on_the_boundary) {
  const Mesh facet{{{-2, -1, 0}, {2, -1, 0}, {0, 2, 0}}, {{0, 1, 2}}};
  std::vector<Sphere> balls{{{5, 0, 0}, 5}, {{-3, 4, 0}, 5}, {{-3, -4, 0}, 5}};
  EXPECT_TRUE(coverage(facet, balls).covered);
  for (const double less : {1e-12, 1e-9, 1e-6, 1e-3}) {
    for (Sphere& s : balls) s.radius = 5 - less;
    const Coverage c = coverage(facet, balls);
    EXPECT_FALSE(c.covered) << less;
    EXPECT_NEAR(c.uncovered_distance, less, 1e-6 * less + 1e-14);
    EXPECT_LT(c.uncovered_area, 2 * less);
    expect_bounds_agree(c);
  }
}

// The same with spheres of very unequal size, and with some that are nearly equal: their bisectors are ill-defined, so
// power vertices land far from where they belong, and cells with the wrong owners.
TEST(Coverage, closes_at_power_vertices_wherever_rounding_puts_them) {
  Random random(77);
  std::size_t misplaced = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Vec3 p{random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)};
    const Vec3 n = normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    const Vec3 u = normalized(cross(n, Vec3{random.uniform(), random.uniform(), random.uniform()}));
    const auto around = [&](double angle) { return std::cos(angle) * u + std::sin(angle) * cross(n, u); };
    const auto power_of_ten = [&](double from, double to) { return std::pow(10.0, random.uniform(from, to)); };

    // Spheres through p with centers on all sides of it, seen in the facet's plane.
    std::vector<Sphere> balls;
    double smallest = 10;
    const int sides = 3 + trial % 4;
    for (int k = 0; k < sides; ++k) {
      const double size = power_of_ten(-3, 1);
      const Vec3 out = around((2 * pi * k + random.uniform(-0.9, 0.9)) / sides) + random.uniform(-1, 1) * n;
      balls.push_back({p + size * out, 0.0});
      smallest = std::min(smallest, size);
    }
    for (int twins = trial / 4 % 4; twins > 0; --twins) {
      const Vec3 c = balls[random.next() % balls.size()].center;
      balls.push_back({c + power_of_ten(-14, -1) * (c - p) + power_of_ten(-14, -1) * smallest * n, 0.0});
    }
    for (Sphere& s : balls) s.radius = distance(s.center, p);
    if (trial % 2 == 0) balls.push_back({p, 0.0});

    Mesh facet{{}, {{0, 1, 2}}};
    const double size = smallest * power_of_ten(-3, -0.5);
    for (int k = 0; k < 3; ++k)
      facet.positions.push_back(p + size * around(2 * pi / 3 * k + random.uniform(-0.3, 0.3)));
    const Coverage c = coverage(facet, balls);
    EXPECT_TRUE(c.covered) << "trial " << trial << ": gap " << c.uncovered_distance << ", tolerance " << c.tolerance;

    const PowerDiagram diagram(balls);
    std::vector<std::uint32_t> scratch;
    CutFacet cut;
    diagram.cut({facet.corners(0), facet.facets[0]}, scratch, cut);
    for (std::size_t k = 0; k < cut.size(); ++k) {
      std::vector<Vec3> points;
      for (const Barycentric& b : cut.polygon(k)) points.push_back(at_barycentric(facet.corners(0), b));
      misplaced += diagram.least_growth(points).amount > c.tolerance;
    }
  }
  EXPECT_GT(misplaced, 0u) << "no cell was misplaced, so nothing was tried";
}

// What builders do: cells, then radii that just contain them. Neighbors then meet at corners on both their boundaries.
TEST(Coverage, confirms_radii_that_just_contain_the_cells) {
  for (const test::NamedMesh& named : test::all_meshes()) {
    auto spheres = random_spheres(bounding_box(named.mesh), 30, 0.01, 0.2, 21);
    const PowerDiagram diagram(spheres);
    std::vector<double> reach(spheres.size(), 0.0);
    std::vector<std::uint32_t> scratch;
    CutFacet cut;
    for (std::size_t f = 0; f < named.mesh.facet_count(); ++f) {
      cut.clear();
      diagram.cut({named.mesh.corners(f), named.mesh.facets[f]}, scratch, cut);
      for (std::size_t k = 0; k < cut.size(); ++k)
        for (const Barycentric& b : cut.polygon(k)) {
          const std::uint32_t i = cut.owner[k];
          reach[i] = std::max(reach[i], distance(spheres[i].center, at_barycentric(named.mesh.corners(f), b)));
        }
    }
    for (std::size_t i = 0; i < spheres.size(); ++i) spheres[i].radius = reach[i];
    std::erase_if(spheres, [](const Sphere& s) { return s.radius == 0; });
    const Coverage c = coverage(named.mesh, spheres);
    EXPECT_TRUE(c.covered) << named.name << ": gap " << c.uncovered_distance << ", tolerance " << c.tolerance;
  }
}

TEST(Coverage, gap_in_the_middle_of_three_spheres_is_exact) {
  // An acute facet with equal spheres at its corners: the middle of the circumscribed circle is farthest.
  const Mesh facet{{{0, 0, 0}, {1, 0, 0}, {0.4, 0.9, 0}}, {{0, 1, 2}}};
  const double a = distance(facet.positions[1], facet.positions[2]),
               b = distance(facet.positions[0], facet.positions[2]);
  const double circumradius = a * b * 1.0 / (4 * surface_area(facet));
  for (const double r : {0.0, 0.1, 0.5, circumradius - 1e-7}) {
    std::vector<Sphere> balls;
    for (const Vec3& p : facet.positions) balls.push_back({p, r});
    const Coverage c = coverage(facet, balls);
    EXPECT_FALSE(c.covered);
    EXPECT_NEAR(c.uncovered_distance, circumradius - r, 1e-6 * (circumradius - r) + 1e-14);
    expect_bounds_agree(c);
  }
}

TEST(Coverage, agrees_with_sampling_on_random_bodies) {
  std::vector<test::NamedMesh> meshes;
  for (const char* name : {"cube_12", "needle", "sliver_facets", "two_components", "open_scan", "moebius_strip",
                           "three_pages", "facet_soup", "tiny", "huge", "thin_box"})
    meshes.push_back(test::mesh_named(name));
  meshes.push_back({"limb", sample_body("limb", 16), true, true, true, 0});
  std::uint64_t seed = 100;
  for (const test::NamedMesh& named : meshes)
    for (const auto& [count, largest] : {std::pair<std::size_t, double>{1, 0.4}, {8, 0.2}, {80, 0.1}, {300, 0.06}}) {
      const auto spheres = random_spheres(bounding_box(named.mesh), count, 0.01, largest, ++seed);
      const Coverage c = coverage(named.mesh, spheres);
      expect_bounds_agree(c);

      constexpr std::size_t sample_count = 4000;
      std::size_t bare = 0;
      double sampled_gap = 0;
      for (const SurfacePoint& s : sample_surface(named.mesh, sample_count, seed)) {
        const double gap = gap_at(spheres, s.point);
        bare += gap > 0;
        sampled_gap = std::max(sampled_gap, gap);
      }
      const double share = static_cast<double>(bare) / sample_count;
      // Stratified sampling errs less than this bound for independent samples; five of its standard deviations.
      const double error =
          5 * std::sqrt(std::max(c.uncovered_area * (1 - c.uncovered_area), 1.0 / sample_count) / sample_count);
      EXPECT_NEAR(c.uncovered_area, share, error) << named.name << ", " << count;
      EXPECT_GE(c.uncovered_distance_upper + c.tolerance, sampled_gap) << named.name << ", " << count;
      if (c.covered) continue;

      // The gap is attained on the facet that it names: no grid point of it is farther out, and one is nearly so.
      const Triangle worst = named.mesh.corners(c.worst_facet);
      constexpr int steps = 60;
      double nearly = -std::numeric_limits<double>::infinity();
      for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j) {
          const double b1 = static_cast<double>(i) / steps, b2 = static_cast<double>(j) / steps;
          nearly = std::max(nearly, gap_at(spheres, at_barycentric(worst, {1 - b1 - b2, b1, b2})));
        }
      const double spacing =
          std::sqrt(std::max({squared_distance(worst[0], worst[1]), squared_distance(worst[1], worst[2]),
                              squared_distance(worst[2], worst[0])})) /
          steps;
      EXPECT_LE(nearly, c.uncovered_distance_upper + c.tolerance) << named.name << ", " << count;
      EXPECT_LE(c.uncovered_distance, nearly + spacing) << named.name << ", " << count;
    }
}

TEST(Coverage, counts_facets_without_area_for_the_gap_but_not_for_the_area) {
  // A segment between two spheres, and a square that is covered.
  Mesh mesh = grid_plate(1);
  mesh.positions.insert(mesh.positions.end(), {Vec3{0, 0, 0}, Vec3{10, 0, 0}});
  mesh.facets.push_back({4, 5, 5});
  const std::vector<Sphere> balls{{{0.5, 0.5, 0}, 1}, {{10, 0, 0}, 2}};
  const Coverage c = coverage(mesh, balls);
  EXPECT_FALSE(c.covered);
  EXPECT_EQ(c.uncovered_area, 0);
  EXPECT_EQ(c.worst_facet, 2u);
  // |x − (½, ½)| − 1 = 10 − x − 2 on the segment.
  const double x = (81 - 0.5) / (2 * (9 - 0.5));
  EXPECT_NEAR(c.uncovered_distance, 8 - x, 1e-5);
  expect_bounds_agree(c);

  const Mesh point{{{3, 4, 0}}, {{0, 0, 0}}};
  const Coverage of_point = coverage(point, std::vector<Sphere>{{{0, 0, 0}, 1}});
  EXPECT_FALSE(of_point.covered);
  EXPECT_DOUBLE_EQ(of_point.uncovered_distance, 4);
  EXPECT_EQ(of_point.uncovered_area, 0);
}

TEST(Coverage, of_one_facet_far_outside_is_all_bare) {
  const Mesh facet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const Coverage c = coverage(facet, std::vector<Sphere>{{{-3, -4, 0}, 1}});
  EXPECT_DOUBLE_EQ(c.uncovered_area, 1);
  EXPECT_NEAR(c.uncovered_distance, std::sqrt(9 + 25.0) - 1, 1e-14);
}

TEST(Coverage, names_the_lowest_of_equally_bare_facets) {
  const Mesh box = box_mesh({-1, -1, -1}, {1, 1, 1});
  const Coverage c = coverage(box, std::vector<Sphere>{{{0, 0, 0}, 1.5}});
  EXPECT_EQ(c.worst_facet, 0u);
  EXPECT_NEAR(c.uncovered_distance, std::sqrt(3.0) - 1.5, 1e-14);
}

TEST(Coverage, does_not_depend_on_the_place) {
  const Mesh mesh = sample_body("torus", 16);
  const auto spheres = random_spheres(bounding_box(mesh), 60, 0.02, 0.1, 7);
  const Coverage here = coverage(mesh, spheres);
  const Vec3 offset{1e6, -1e6, 1e6};
  auto there = spheres;
  for (Sphere& s : there) s.center += offset;
  const Coverage moved = coverage(test::translated(mesh, offset), there);
  EXPECT_NEAR(moved.uncovered_area, here.uncovered_area, 1e-7);
  EXPECT_NEAR(moved.uncovered_distance, here.uncovered_distance, 1e-6 * here.uncovered_distance + 1e-8);
  EXPECT_GT(moved.tolerance, 1e5 * here.tolerance);

  // A sphere that just contains everything still does, after all coordinates have been rounded.
  const Mesh box = test::translated(box_mesh({-1, -1, -1}, {1, 1, 1}, 4), offset + Vec3{0.1, 0.2, 0.3});
  EXPECT_TRUE(coverage(box, std::vector<Sphere>{{offset + Vec3{0.1, 0.2, 0.3}, std::sqrt(3.0)}}).covered);
}

TEST(Coverage, has_the_same_bits_for_any_number_of_workers) {
  const Mesh mesh = sample_body("limb", 48);
  const auto spheres = random_spheres(bounding_box(mesh), 200, 0.01, 0.08, 5);
  const Coverage one = coverage(mesh, spheres);
  ASSERT_FALSE(one.covered);
  Workers two(2), eight(8);
  Workers backwards(
      [](std::size_t count, ChunkFunction chunk) {
        while (count > 0) chunk(--count);
      },
      3);
  for (Workers* workers : {&two, &eight, &backwards}) {
    const Coverage many = coverage(mesh, spheres, *workers);
    EXPECT_EQ(one.uncovered_area, many.uncovered_area);
    EXPECT_EQ(one.uncovered_distance, many.uncovered_distance);
    EXPECT_EQ(one.uncovered_distance_upper, many.uncovered_distance_upper);
    EXPECT_EQ(one.worst_facet, many.worst_facet);
  }
}

TEST(Coverage, refuses_bad_spheres_by_name) {
  const Mesh mesh = grid_plate(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(coverage(mesh, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(coverage(mesh, std::vector<Sphere>{{{0, 0, 0}, 1}, {{0, nan, 0}, 1}})),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(coverage(mesh, std::vector<Sphere>{{{0, 0, 0}, -1}})), std::invalid_argument);
}

}  // namespace
}  // namespace morula

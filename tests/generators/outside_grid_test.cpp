// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Outside volumes by lines, against exact ones; balls fitted by them.
#include <gtest/gtest.h>

#include <algorithm>
#include <generators/fit/ball_fit.hpp>
#include <generators/fit/extremes.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/query/signed_distance.hpp>
#include <support/meshes.hpp>

namespace morula {
using namespace detail;
namespace {

struct Solid {
  const char* name;
  Mesh mesh;
  double deep;  // about the radius of the largest ball inside
  ObjectShape shape;
  ObjectLines lines;

  Solid(const char* n, Mesh m, double d)
      : name(n), mesh(std::move(m)), deep(d), shape(mesh), lines(mesh, shape, 200, serial_workers()) {}
};
const std::vector<std::unique_ptr<Solid>>& bodies() {
  static const auto all = [] {
    std::vector<std::unique_ptr<Solid>> list;
    list.push_back(std::make_unique<Solid>("icosphere", test::icosphere(4), 1));
    list.push_back(std::make_unique<Solid>("torus", sample_body("torus", 48), 0.35));
    list.push_back(std::make_unique<Solid>("box", test::box_mesh({0, 0, 0}, {2.03, 1.11, 0.97}, 3), 0.48));
    return list;
  }();
  return all;
}

Box with_room(Box box, double room) {
  box.lower = box.lower - Vec3{room, room, room};
  box.upper = box.upper + Vec3{room, room, room};
  return box;
}

// A ball in cells of the grid, and the same ball, rounded alike, in mesh units.
struct GridBall {
  Spheref cells;
  Sphere exact;
  GridBall(const OutsideGrid& grid, const Sphere& s)
      : cells{grid.to_grid(s.center), static_cast<float>(s.radius / grid.cell())},
        exact{grid.from_grid(cells.center), static_cast<double>(cells.radius) * grid.cell()} {}
};
double cubed(double x) {
  return x * x * x;
}
double cost_of(OutsideGrid& grid, const GridBall& ball, float overlap_weight) {
  grid.prepare(ball.cells.center, ball.cells.radius, overlap_weight);
  return grid.cost(ball.cells.center, ball.cells.radius) * cubed(grid.cell());
}

Vec3 direction(Random& random) {
  for (;;) {
    const Vec3 v{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (dot(v, v) > 0.01 && dot(v, v) < 1) return normalized(v);
  }
}
// The length first, by statements of its own: within one expression each compiler has an order of its own.
Vec3 way(Random& random, double least, double most) {
  const double length = random.uniform(least, most);
  return direction(random) * length;
}
Vec3 surface_point(const Solid& body, Random& random) {
  return sample_surface(body.mesh, 1, random.next())[0].point;
}

enum class Kind { deep, big, outside, rim };
constexpr std::array kinds{Kind::deep, Kind::big, Kind::outside, Kind::rim};
constexpr std::array kind_names{"deep", "big", "outside", "rim"};

Sphere random_ball(const Solid& body, Kind kind, Random& random) {
  if (kind == Kind::big) return {bounding_box(body.mesh).center() + direction(random) * 0.2, random.uniform(1.2, 1.8)};
  const Vec3 p = surface_point(body, random);
  if (kind == Kind::rim) return {p, body.deep * random.uniform(0.4, 1)};
  if (kind == Kind::outside) return {p + direction(random) * body.deep * 3.0, body.deep * random.uniform(0.4, 1)};
  for (;;) {
    const Vec3 c = p + way(random, 0.5, 1.2) * body.deep;
    const double depth = -body.shape.distance()(c);
    if (depth > 0.6 * body.deep) return {c, depth * random.uniform(1, 1.1)};
  }
}

struct Errors {
  double worst = 0, mean = 0;
};
// Shares of the balls' volumes.
Errors errors_at(const Solid& body, Kind kind, double cells_per_radius) {
  Random random(7);
  constexpr int trials = 40;
  Errors errors;
  for (int trial = 0; trial < trials; ++trial) {
    const Sphere wanted = random_ball(body, kind, random);
    Box box;
    box.add(wanted.center);
    OutsideGrid grid(body.lines, with_room(box, 1.2 * wanted.radius), wanted.radius / cells_per_radius);
    const GridBall ball(grid, wanted);
    const double error =
        std::abs(cost_of(grid, ball, 0) - outside_volume(body.shape.distance(), ball.exact)) / volume(ball.exact);
    errors.worst = std::max(errors.worst, error);
    errors.mean += error / trials;
  }
  return errors;
}

TEST(OutsideGrid, costs_are_outside_volumes) {
  // At the four cells per radius that fits work with. Measured: about half of these.
  struct Bound {
    double mean, worst;
  };
  constexpr std::array<Bound, 4> bounds{Bound{2e-3, 2e-2}, {3e-2, 8e-2}, {2e-2, 6e-2}, {3e-2, 8e-2}};
  for (const auto& body : bodies())
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const Errors e = errors_at(*body, kinds[k], 4);
      EXPECT_LT(e.mean, bounds[k].mean) << kind_names[k] << " balls, " << body->name;
      EXPECT_LT(e.worst, bounds[k].worst) << kind_names[k] << " balls, " << body->name;
    }
}

TEST(OutsideGrid, gets_more_exact_with_more_cells) {
  for (const auto& body : bodies())
    for (const Kind kind : {Kind::deep, Kind::rim})
      EXPECT_LT(errors_at(*body, kind, 12).mean, 0.7 * errors_at(*body, kind, 3).mean) << body->name;
}

TEST(OutsideGrid, counts_one_ball_the_same_with_and_without_preparation) {
  for (const auto& body : bodies()) {
    OutsideGrid grid(body->lines, with_room(bounding_box(body->mesh), 4.5), 0.09);
    Random random(3);
    const auto compare = [&](const char* when) {
      for (const Kind kind : kinds)
        for (int i = 0; i < 10; ++i) {
          const GridBall ball(grid, random_ball(*body, kind, random));
          ASSERT_TRUE(grid.is_inside(ball.cells.center, ball.cells.radius));
          EXPECT_NEAR(cost_of(grid, ball, 0), grid.new_outside(ball.cells) * cubed(grid.cell()),
                      2e-5 * volume(ball.exact))
              << body->name << ", " << when;
        }
    };
    compare("nothing taken");
    for (int i = 0; i < 5; ++i) grid.add(GridBall(grid, random_ball(*body, Kind::rim, random)).cells);
    compare("some taken");
  }
}

TEST(OutsideGrid, stops_counting_above_enough_and_only_there) {
  const Solid& body = *bodies()[0];
  OutsideGrid grid(body.lines, with_room(bounding_box(body.mesh), 1), 0.1);
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    const GridBall ball(grid, random_ball(body, Kind::rim, random));
    grid.prepare(ball.cells.center, ball.cells.radius, 1);
    const float all = grid.cost(ball.cells.center, ball.cells.radius);
    EXPECT_EQ(grid.cost(ball.cells.center, ball.cells.radius, all), all);
    EXPECT_GT(grid.cost(ball.cells.center, ball.cells.radius, 0.5F * all), 0.5F * all);
  }
}

// Volume that two balls share.
double lens(double d, double a, double b) {
  return std::numbers::pi * (a + b - d) * (a + b - d) * (d * d + 2 * d * (a + b) - 3 * (a - b) * (a - b)) / (12 * d);
}

TEST(OutsideGrid, a_ball_taken_in_makes_another_cost_less_by_their_overlap) {
  const Solid& body = *bodies()[0];
  Box box;
  box.add({3, 0, 0});
  OutsideGrid grid(body.lines, with_room(box, 1.6), 0.06);
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    // Far from the object, where overlaps are lenses.
    const GridBall a(grid, {{3, 0, 0}, random.uniform(0.4, 0.8)});
    const GridBall b(grid, {Vec3{3, 0, 0} + way(random, 0.5, 0.7), random.uniform(0.3, 0.5)});
    const double d = distance(a.exact.center, b.exact.center);
    if (d < std::abs(a.exact.radius - b.exact.radius) || d > a.exact.radius + b.exact.radius) continue;
    const double alone = cost_of(grid, a, 0);
    grid.add(b.cells);
    const double overlap = lens(d, a.exact.radius, b.exact.radius);
    for (const float overlap_weight : {0.0F, 0.15F, 0.6F})
      EXPECT_NEAR(cost_of(grid, a, overlap_weight), alone - (1 - static_cast<double>(overlap_weight)) * overlap,
                  0.01 * volume(a.exact));
    grid.remove(b.cells);
  }
}

TEST(OutsideGrid, counts_the_union_of_balls_across_the_surface) {
  for (const auto& body : bodies()) {
    Random random(11);
    OutsideGrid grid(body->lines, with_room(bounding_box(body->mesh), 1), 0.06);
    for (int trial = 0; trial < 3; ++trial) {
      const GridBall a(grid, random_ball(*body, Kind::rim, random));
      const GridBall b(
          grid, {a.exact.center + direction(random) * 0.7 * a.exact.radius, a.exact.radius * random.uniform(0.7, 1)});
      grid.add(b.cells);
      const double found = cost_of(grid, a, 0);
      grid.remove(b.cells);
      constexpr int samples = 20000;
      int hits = 0;
      for (int i = 0; i < samples; ++i) {
        const double out = std::cbrt(random.uniform());
        const Vec3 p = a.exact.center + direction(random) * a.exact.radius * out;
        hits += distance(p, b.exact.center) > b.exact.radius && !body->shape.distance().is_inside(p);
      }
      EXPECT_NEAR(found / volume(a.exact), static_cast<double>(hits) / samples, 0.02) << body->name;
    }
  }
}

TEST(OutsideGrid, a_ball_put_in_and_taken_out_again_leaves_no_trace) {
  for (const auto& body : bodies()) {
    OutsideGrid grid(body->lines, with_room(bounding_box(body->mesh), 2), 0.1);
    Random random(4);
    for (int i = 0; i < 10; ++i) {
      const GridBall fixed(grid, random_ball(*body, Kind::rim, random));
      const GridBall ball(grid, random_ball(*body, Kind::rim, random));
      const GridBall other(grid, {ball.exact.center + direction(random) * 0.2, ball.exact.radius});
      const double before = cost_of(grid, ball, 0.15F);
      const float new_before = grid.new_outside(ball.cells);
      grid.add(other.cells);
      grid.add(ball.cells);
      EXPECT_LE(cost_of(grid, ball, 0.15F), before * (1 + 1e-5));
      grid.remove(other.cells);
      grid.remove(ball.cells);
      // Sums along lines may begin elsewhere than before.
      EXPECT_NEAR(cost_of(grid, ball, 0.15F), before, 1e-5 * volume(ball.exact));
      EXPECT_EQ(grid.new_outside(ball.cells), new_before);
      grid.add(fixed.cells);  // a different background for the next one
    }
  }
}

TEST(OutsideGrid, keeps_no_steps_that_a_ball_has_changed) {
  // Balls that share most of their space, as around a tube, come and go; between, balls nearby are asked about. A grid
  // that had none of this answers the same.
  for (const auto& body : bodies()) {
    Random random(21);
    const Box box = with_room(bounding_box(body->mesh), 1.5);
    OutsideGrid grid(body->lines, box, 0.08);
    const Vec3 somewhere = surface_point(*body, random);
    const auto near = [&] {
      return GridBall(grid, {somewhere + way(random, 0.05, 0.35), body->deep * random.uniform(0.5, 1.2)}).cells;
    };
    std::vector<Spheref> there;
    for (int change = 0; change < 60; ++change) {
      if (there.size() < 3 || (there.size() < 8 && random.uniform() < 0.5)) {
        there.push_back(near());
        grid.add(there.back());
      } else {
        const auto gone = there.begin() + static_cast<std::ptrdiff_t>(random.next() % there.size());
        grid.remove(*gone);
        there.erase(gone);
      }
      const Spheref asked = near();
      for (const float larger : {1.0F, 1.3F}) {
        grid.prepare(asked.center, larger * asked.radius, 0.15F);
        OutsideGrid fresh(body->lines, box, 0.08);
        for (const Spheref& ball : there) fresh.add(ball);
        fresh.prepare(asked.center, asked.radius, 0.15F);
        const float wanted = fresh.cost(asked.center, asked.radius);
        ASSERT_NEAR(grid.cost(asked.center, asked.radius), wanted, 1e-5F * (1 + cubed(asked.radius)))
            << body->name << ", after " << change;
      }
    }
  }
}

GroupPoints in_grid(const OutsideGrid& grid, std::span<const Vec3> points) {
  GroupPoints result;
  for (const Vec3& p : points) result.push_back(grid.to_grid(p));
  return result;
}
double farthest_of(const GroupPoints& points, const Vec3f& c) {
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f d = points[i] - c;
    farthest = std::max(farthest, std::hypot(static_cast<double>(d.x), d.y, d.z));
  }
  return farthest;
}

TEST(FitBall, contains_its_points_and_never_costs_more_than_a_start) {
  for (const auto& body : bodies()) {
    OutsideGrid grid(body->lines, with_room(bounding_box(body->mesh), 2), 0.07);
    const std::vector<SurfacePoint> samples = sample_surface(body->mesh, 1500, 2);
    Random random(9);
    for (int trial = 0; trial < 15; ++trial) {
      const Vec3 seed = surface_point(*body, random);
      const double reach = body->deep * random.uniform(0.5, 1.5);
      std::vector<Vec3> near;
      for (const SurfacePoint& s : samples)
        if (distance(s.point, seed) < reach) near.push_back(s.point);
      if (near.empty()) continue;
      const GroupPoints points = in_grid(grid, near);
      const Vec3f start = grid.to_grid(seed + direction(random) * 0.3);
      const GroupBall fitted = fit_ball(grid, points, {&start, 1}, 0.15F, 0.25F);
      EXPECT_LE(farthest_of(points, fitted.center), fitted.radius * (1 + 1e-6)) << body->name;
      const float radius = static_cast<float>(farthest_of(points, start));
      if (!grid.is_inside(start, radius)) continue;
      grid.prepare(start, 1.01F * radius, 0.15F);
      const double whole = 0.001 * volume(Sphere{{0, 0, 0}, radius});  // see ball_fit.cpp
      const double at_start = grid.cost(start, radius) + whole;
      EXPECT_LE(fitted.cost, at_start + 1e-4 * volume(Sphere{{0, 0, 0}, radius})) << body->name;
      grid.add({fitted.center, fitted.radius});  // the next one has siblings
    }
  }
}

TEST(FitBall, finds_the_deep_center_of_a_cap_from_the_spheres_center) {
  const Solid& body = *bodies()[0];
  OutsideGrid grid(body.lines, with_room(bounding_box(body.mesh), 1.5), 0.06);
  for (const double above : {0.3, 0.6, 0.8}) {
    std::vector<Vec3> cap;
    for (const SurfacePoint& s : sample_surface(body.mesh, 2000, 3))
      if (s.point.z > above) cap.push_back(s.point);
    const GroupPoints points = in_grid(grid, cap);
    const Vec3f middle = grid.to_grid({0, 0, 0});
    const GroupBall shallow = fit_ball(grid, points, {}, 0.15F, 0.05F);
    const GroupBall deep = fit_ball(grid, points, {&middle, 1}, 0.15F, 0.25F);
    const double all = volume(Sphere{{0, 0, 0}, 1}) / cubed(grid.cell());
    EXPECT_LT(deep.cost, 0.004 * all) << above;
    EXPECT_LE(deep.cost, shallow.cost * (1 + 1e-4)) << above;
  }
}

TEST(FitBall, of_points_that_are_one_point_is_that_point) {
  const Solid& body = *bodies()[0];
  OutsideGrid grid(body.lines, with_room(bounding_box(body.mesh), 0.5), 0.1);
  const GroupPoints points = in_grid(grid, std::vector<Vec3>(3, {1, 0, 0}));
  const GroupBall fitted = fit_ball(grid, points, {}, 0.15F, 0.25F);
  EXPECT_LT(fitted.radius, 1e-3F);
  EXPECT_TRUE(std::isfinite(fitted.cost));
  EXPECT_LE(farthest_of(points, fitted.center), fitted.radius);
}

TEST(Extremes, decide_the_radius_nearly_as_all_points_do) {
  for (const auto& body : bodies()) {
    OutsideGrid grid(body->lines, with_room(bounding_box(body->mesh), 0.5), 0.1);
    Random random(6);
    double worst = 1;
    for (int trial = 0; trial < 10; ++trial) {
      const Vec3 seed = surface_point(*body, random);
      std::vector<Vec3> near;
      for (const SurfacePoint& s : sample_surface(body->mesh, 20000, 2))
        if (distance(s.point, seed) < body->deep) near.push_back(s.point);
      ASSERT_GT(near.size(), 300u);
      const GroupPoints few = extremes(near, grid), all = in_grid(grid, near);
      EXPECT_LE(few.size(), 200u);
      const Sphere around = enclosing_sphere(near);
      for (int i = 0; i < 30; ++i) {
        const Vec3f c = grid.to_grid(around.center + way(random, 0, 1) * around.radius);
        worst = std::min(worst, farthest_of(few, c) / farthest_of(all, c));
      }
    }
    EXPECT_GT(worst, 0.97) << body->name;
  }
}

// What is proposed may be any ball: it counts as far as the grid goes.
TEST(OutsideGrid, takes_balls_of_any_size) {
  const Solid& body = *bodies()[0];
  OutsideGrid grid(body.lines, with_room(bounding_box(body.mesh), 0.5), 0.1);
  const GridBall ball(grid, {{0, 0, 0}, 1.2});
  const float alone = grid.new_outside(ball.cells);
  for (const float radius : {1e5F, 1e10F, 1e18F}) {
    const Spheref huge{ball.cells.center, radius};
    grid.add(huge);
    EXPECT_EQ(grid.new_outside(ball.cells), 0) << radius;
    grid.remove(huge);
    EXPECT_EQ(grid.new_outside(ball.cells), alone) << radius;
    // Beside the grid they take nothing.
    const Spheref beside{{-3 * radius, 0, 0}, radius};
    grid.add(beside);
    EXPECT_EQ(grid.new_outside(ball.cells), alone) << radius;
    grid.remove(beside);
  }
}

TEST(Extremes, of_few_points_are_all_of_them) {
  const Solid& body = *bodies()[0];
  const OutsideGrid grid(body.lines, bounding_box(body.mesh), 0.1);
  std::vector<Vec3> points;
  for (const SurfacePoint& s : sample_surface(body.mesh, 150, 2)) points.push_back(s.point);
  EXPECT_EQ(extremes(points, grid).size(), 150u);
  EXPECT_EQ(extremes({}, grid).size(), 0u);
}

}  // namespace
}  // namespace morula

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The balls of one node while their places are sought, and the seeds they start from.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <generators/divide/node_fit.hpp>
#include <generators/fit/medial_seeds.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/meshes.hpp>

namespace morula {
using namespace detail;
namespace {

// A whole mesh as the node whose children are sought.
struct WholeFit {
  Mesh mesh;
  ObjectShape shape;
  ObjectLines lines;
  FitInput input;
  BuildNode node;
  RegionPoints points;
  NodeFit fit;

  static BuildNode root_of(const Mesh& mesh, std::uint64_t seed) {
    BuildNode root;
    root.region = whole_surface(mesh);
    root.sphere = enclosing_sphere(mesh.positions);
    root.seed = seed;
    return root;
  }
  explicit WholeFit(Mesh m, std::size_t most = 8, std::uint64_t seed = 1, double cell = 0.25)
      : mesh(std::move(m)),
        shape(mesh),
        lines(mesh, shape, lattice_cells(mesh, shape, 8, 3), serial_workers()),
        input(fit_input(mesh, shape, lines)),
        node(root_of(mesh, seed)),
        points(region_points(input, node, most, 0.1)),
        fit(input, node, points, most, 0, {.cell = cell}) {}
};

void expect_all_contained(const WholeFit& whole, const ChildFit& children, const std::string& after) {
  const std::vector<Sphere> spheres = children.spheres();
  const OutsideGrid& grid = const_cast<WholeFit&>(whole).fit.grid();
  for (std::size_t i = 0; i < whole.fit.points().size(); ++i) {
    const Vec3 p = grid.from_grid(whole.fit.points()[i]);
    ASSERT_TRUE(std::any_of(
        spheres.begin(), spheres.end(),
        [&](const Sphere& s) { return distance(s.center, p) <= s.radius * (1 + 2e-5) + 1e-5 * grid.cell(); }))
        << "after " << after;
  }
}

std::vector<GroupBall> random_seeds(WholeFit& whole, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<GroupBall> seeds;
  const auto& points = whole.fit.points();
  for (std::size_t i = 0; i < count; ++i) seeds.push_back({points[random.next() % points.size()], 2, 0});
  return seeds;
}

TEST(ChildFit, splits_one_ball_into_as_many_as_wanted) {
  for (const char* body : {"limb", "torus", "blob", "two"})
    for (const std::size_t most : {std::size_t{2}, std::size_t{5}, std::size_t{8}, std::size_t{20}}) {
      WholeFit whole(sample_body(body, 16), most);
      ChildFit& children = whole.fit.children();
      children.split_from_one();
      expect_all_contained(whole, children, "splitting");
      // The halves of a ring overlap so much that splitting it may not pay.
      if (std::string_view(body) == "torus")
        EXPECT_LE(children.spheres().size(), most);
      else
        EXPECT_EQ(children.spheres().size(), most) << body;
    }
}

TEST(ChildFit, covers_a_ball_with_eight_at_most) {
  WholeFit whole(test::icosphere(3), 8);
  whole.fit.children().split_from_one();
  EXPECT_GE(whole.fit.children().spheres().size(), 1u);
  EXPECT_LE(whole.fit.children().spheres().size(), 8u);
  expect_all_contained(whole, whole.fit.children(), "splitting");
}

TEST(ChildFit, keeps_all_points_inside_through_every_operation) {
  for (const char* body : {"limb", "torus"}) {
    WholeFit whole(sample_body(body, 16));
    ChildFit& children = whole.fit.children();
    children.split_from_one();
    for (const float overlap_weight : {0.6F, 0.15F})
      for (const bool exclusive : {true, false}) {
        children.sweep(overlap_weight, exclusive);
        expect_all_contained(whole, children, "a sweep");
      }
    children.sweep_inscribed(0.15F);
    expect_all_contained(whole, children, "an inscribed sweep");
    children.try_changes(12, 5);
    expect_all_contained(whole, children, "changes");
    children.try_inscribed(2, 2);
    expect_all_contained(whole, children, "inscribed sweeps");
    children.try_seeds(random_seeds(whole, 8, 1), 1, 1);
    expect_all_contained(whole, children, "seeds");
    // Balls from anywhere, once they are fitted.
    children.start_from({{whole.node.sphere, {whole.node.sphere.center + Vec3{0.5, 0, 0}, 0.1}}});
    children.sweep(0.15F, true);
    expect_all_contained(whole, children, "taking balls");
    const NodeFit::Exact exact = whole.fit.exact();
    for (std::size_t i = 0; i < exact.spheres.size(); ++i) {
      std::vector<Vec3> corners;
      corner_positions(whole.mesh, exact.regions[i], corners);
      EXPECT_FALSE(corners.empty());
      for (const Vec3& p : corners) ASSERT_LE(distance(exact.spheres[i].center, p), exact.spheres[i].radius);
    }
  }
}

TEST(ChildFit, tries_never_make_it_worse) {
  for (const char* body : {"limb", "blob", "plate"})
    for (const std::uint64_t seed : {1u, 2u}) {
      WholeFit whole(sample_body(body, 16), 8, seed);
      ChildFit& children = whole.fit.children();
      children.split_from_one();
      double before = children.objective();
      const auto expect_no_worse = [&](const char* what) {
        const double now = children.objective();
        EXPECT_LE(now, before * (1 + 1e-6)) << what << " on " << body;
        before = now;
      };
      children.try_changes(15, 5);
      expect_no_worse("changes");
      children.try_inscribed(2, 2);
      expect_no_worse("inscribed");
      children.try_seeds(random_seeds(whole, 3, seed), 1, 1);
      expect_no_worse("seeds");
    }
}

TEST(ChildFit, repeats_itself_to_the_bit) {
  std::vector<std::vector<Sphere>> results;
  for (int run = 0; run < 2; ++run) {
    WholeFit whole(sample_body("limb", 16));
    ChildFit& children = whole.fit.children();
    children.split_from_one();
    children.try_changes(10, 5);
    results.push_back(children.spheres());
  }
  EXPECT_EQ(results[0], results[1]);
}

// Of a ball that was better whole, while its siblings go elsewhere and come back: around a tube and in thin walls most
// splits are refused.
TEST(ChildFit, has_the_same_balls_when_rejected_splits_are_retried) {
  std::size_t sweeps_with_free_places = 0;
  for (const Mesh& mesh : {sample_body("capsule", 24), sample_body("torus", 16), sample_body("limb", 16)})
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      std::vector<std::vector<Sphere>> results[2];
      for (const bool retries_splits : {false, true}) {
        constexpr std::size_t most = 8;
        WholeFit whole(mesh, most, seed);
        ChildFit::Settings settings;
        settings.retries_splits = retries_splits;
        ChildFit children(whole.fit.grid(), whole.fit.points(), whole.shape, most, whole.node.sphere, settings, seed);
        const auto keep = [&] {
          results[retries_splits ? 1 : 0].push_back(children.spheres());
          sweeps_with_free_places += results[0].back().size() < most;
        };
        children.split_from_one();
        keep();
        // One sphere gone at a time, so that others have other neighbors, and all of them again.
        for (std::size_t gone = 0; gone < most; ++gone) {
          std::vector<Sphere> fewer = results[0].front();
          if (gone < fewer.size()) fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(gone));
          for (const auto& balls : {fewer, results[0].front()}) {
            children.start_from(balls);
            children.sweep(settings.overlap_weight, true);
            keep();
            children.sweep(settings.overlap_weight, true);
            keep();
          }
        }
        for (int round = 0; round < 4; ++round) {
          children.try_changes(10, 2);
          keep();
          children.try_inscribed(1, 1);
          keep();
        }
      }
      EXPECT_TRUE(results[0] == results[1]) << mesh.facets.size() << " facets, seed " << seed;
    }
  EXPECT_GT(sweeps_with_free_places, 20u);
}

TEST(ChildFit, objective_is_the_outside_volume_of_the_union) {
  for (const char* body : {"limb", "torus", "blob"}) {
    WholeFit whole(sample_body(body, 16), 8, 1, 0.12);
    ChildFit& children = whole.fit.children();
    children.split_from_one();
    children.sweep(0.15F, true);
    const double found = children.objective() * std::pow(whole.fit.grid().cell(), 3);
    const std::vector<Sphere> spheres = children.spheres();
    Box box;
    for (const Sphere& s : spheres) {
      box.add(s.center - Vec3{s.radius, s.radius, s.radius});
      box.add(s.center + Vec3{s.radius, s.radius, s.radius});
    }
    Random random(1);
    constexpr int samples = 60000;
    int hits = 0;
    for (int i = 0; i < samples; ++i) {
      const Vec3 e = box.extent();
      const Vec3 p = box.lower + Vec3{e.x * random.uniform(), e.y * random.uniform(), e.z * random.uniform()};
      hits += std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& s) { return power(s, p) < 0; }) &&
              !whole.shape.distance().is_inside(p);
    }
    const double expected = box.extent().x * box.extent().y * box.extent().z * hits / samples;
    EXPECT_NEAR(found, expected, 0.02 * (expected + signed_volume(whole.mesh))) << body;
  }
}

float growth(Dilation dilation, const GroupBall& ball, const Vec3f& p) {
  const float d = std::hypot(p.x - ball.center.x, p.y - ball.center.y, p.z - ball.center.z);
  return dilation == Dilation::length ? d - ball.radius : std::sqrt(std::max(0.0F, d * d - ball.radius * ball.radius));
}

struct SeedProblem {
  std::vector<GroupBall> candidates;
  GroupPoints points;
  explicit SeedProblem(std::uint64_t seed) {
    Random random(seed);
    const auto unit = [&] { return static_cast<float>(random.uniform()); };
    for (int i = 0; i < 9; ++i) candidates.push_back({{unit(), unit(), unit()}, 0.1F + 0.1F * unit(), 0});
    for (int i = 0; i < 25; ++i) points.push_back({unit(), unit(), unit()});
  }
  // Whether balls that contain most of what is left, one after the other, cover with few enough.
  bool greedy_covers(Dilation kind, float dilation, std::size_t most) const {
    std::vector<bool> covered(points.size(), false);
    for (std::size_t chosen = 0; chosen <= most; ++chosen) {
      if (std::find(covered.begin(), covered.end(), false) == covered.end()) return true;
      const auto gain = [&](const GroupBall& c) {
        int count = 0;
        for (std::size_t i = 0; i < points.size(); ++i) count += !covered[i] && growth(kind, c, points[i]) <= dilation;
        return count;
      };
      const GroupBall* best = &candidates[0];
      for (const GroupBall& c : candidates)
        if (gain(c) > gain(*best)) best = &c;
      for (std::size_t i = 0; i < points.size(); ++i)
        if (growth(kind, *best, points[i]) <= dilation) covered[i] = true;
    }
    return false;
  }
};

TEST(MedialSeeds, need_on_the_mean_no_more_growth_than_a_greedy_cover) {
  for (const Dilation kind : {Dilation::length, Dilation::square})
    for (std::uint64_t trial = 1; trial <= 20; ++trial)
      for (const std::size_t most : {std::size_t{1}, std::size_t{3}, std::size_t{5}}) {
        const SeedProblem problem(trial);
        // From this dilation on the greedy cover is small enough.
        std::vector<float> critical{0};
        for (const GroupBall& c : problem.candidates)
          for (std::size_t i = 0; i < problem.points.size(); ++i)
            critical.push_back(growth(kind, c, problem.points[i]));
        std::sort(critical.begin(), critical.end());
        std::size_t from = critical.size();
        while (from > 0 && problem.greedy_covers(kind, critical[from - 1] + 1e-6F, most)) --from;
        ASSERT_LT(from, critical.size());
        const float tolerance = 2 * critical.back() / 1024;

        const std::vector<GroupBall> seeds = medial_seeds(problem.candidates, problem.points, most, kind);
        ASSERT_FALSE(seeds.empty());
        EXPECT_LE(seeds.size(), most);
        for (const GroupBall& s : seeds)
          EXPECT_EQ(std::count_if(problem.candidates.begin(), problem.candidates.end(),
                                  [&](const GroupBall& c) { return c.center == s.center && c.radius == s.radius; }),
                    1);
        double mean = 0;
        for (std::size_t i = 0; i < problem.points.size(); ++i) {
          float least = std::numeric_limits<float>::infinity();
          for (const GroupBall& s : seeds) least = std::min(least, growth(kind, s, problem.points[i]));
          mean += std::max(0.0F, least) / static_cast<double>(problem.points.size());
        }
        EXPECT_LE(mean, std::max(0.0F, critical[from]) + tolerance) << trial << ", at most " << most;
      }
}

TEST(MedialSeeds, of_nothing_are_none) {
  const SeedProblem problem(1);
  EXPECT_TRUE(medial_seeds({}, problem.points, 3, Dilation::length).empty());
  EXPECT_TRUE(medial_seeds(problem.candidates, {}, 3, Dilation::length).empty());
}

}  // namespace
}  // namespace morula

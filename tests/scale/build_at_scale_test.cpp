// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees at every size: right, or refused; and nothing in a builder depends on the size.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/generators/build.hpp>
#include <support/meshes.hpp>

#include "bodies_at_scale.hpp"

namespace morula {
namespace {

BuildOptions small_tree(Method method) {
  BuildOptions options{.method = method, .branching = 4, .depth = 2};
  if (method == Method::optimized) options.quality = Quality::fast;
  return options;
}

void expect_right(const Mesh& mesh, const CoveredTree& model, const std::string& what) {
  EXPECT_TRUE(test::covers(model.cover, mesh.positions, model.tree.spheres)) << what;
  EXPECT_EQ(validate(mesh, model), std::vector<std::string>{}) << what;
  std::vector<Sphere> smaller = model.tree.spheres;
  for (Sphere& s : smaller) s.radius *= 0.99;
  EXPECT_EQ(certify(model.cover, mesh.positions, smaller).covered, test::covers(model.cover, mesh.positions, smaller))
      << what;
}

TEST(BuildAtScale, covers_by_the_judge_or_refuses) {
  int built_ones = 0, refused_ones = 0;
  for (const test::BodyAtScale& body : test::unit_bodies())
    for (const double size : test::sizes())
      for (const double offset : test::offsets())
        for (const Method method : all_methods()) {
          const Mesh mesh = test::placed(body.mesh, size, offset);
          const std::string what = test::told(body.name, size, offset) + ", " + std::string(name(method));
          if (test::is_out_of_range(mesh)) {
            EXPECT_TRUE(test::is_refused([&] { build(mesh, small_tree(method)); })) << what;
            ++refused_ones;
          } else if (method == Method::octree || method == Method::grid ||
                     (body.name == "octahedron" && offset == 1e3)) {
            expect_right(mesh, build(mesh, small_tree(method)), what);
            ++built_ones;
          }
        }
  EXPECT_GT(built_ones, 100);
  EXPECT_GT(refused_ones, 1000);
}

// A power of two changes no digit, so a builder without absolute thresholds makes the same tree at another size.
TEST(BuildAtScale, gives_the_same_bits_at_every_power_of_two) {
  for (const test::BodyAtScale& body : test::unit_bodies())
    for (const Method method : all_methods()) {
      const bool is_quick = method == Method::octree || method == Method::grid || method == Method::hubbard;
      if (!is_quick && body.name != "octahedron" && body.name != "capsule") continue;
      const CoveredTree unit = build(body.mesh, small_tree(method));
      for (const int power : {-98, 95}) {
        const double size = std::ldexp(1.0, power);
        const Mesh mesh = test::placed(body.mesh, size, 0);
        const CoveredTree model = build(mesh, small_tree(method));
        ASSERT_EQ(model.tree.node_count(), unit.tree.node_count()) << body.name << ' ' << name(method) << ' ' << power;
        std::size_t different = 0;
        for (std::uint32_t node = 0; node < unit.tree.node_count(); ++node) {
          const Sphere &s = unit.tree.spheres[node], &t = model.tree.spheres[node];
          different += !(t == Sphere{s.center * size, s.radius * size});
        }
        EXPECT_EQ(different, 0u) << body.name << ' ' << name(method) << ' ' << power;
        EXPECT_EQ(model.cover.cut_points, unit.cover.cut_points) << body.name << ' ' << name(method) << ' ' << power;
        expect_right(mesh, model, body.name);
      }
    }
}

TEST(BuildAtScale, flat_sets_too) {
  for (const double size : test::sizes()) {
    const Mesh mesh = test::placed(test::unit_bodies()[2].mesh, size, 0);
    BuildOptions options = small_tree(Method::grid);
    options.spheres = 9;
    BuildOptions near = small_tree(Method::grid);
    near.max_protrusion = 0.3 * size;
    for (const BuildOptions& o : {options, near}) {
      if (test::is_out_of_range(mesh)) {
        EXPECT_TRUE(test::is_refused([&] { build(mesh, o); })) << size;
        continue;
      }
      const CoveredTree model = build(mesh, o);
      expect_right(mesh, model, test::told("ball", size, 0));
      ASSERT_TRUE(model.report.protrusion_bound.has_value());
      EXPECT_GE(*model.report.protrusion_bound, 0);
      EXPECT_LT(*model.report.protrusion_bound, 2 * size);
    }
  }
}

TEST(BuildAtScale, trees_made_elsewhere_are_covered_or_refused) {
  for (const test::BodyAtScale& body : test::unit_bodies()) {
    const SphereTree unit = build(body.mesh, small_tree(Method::octree)).tree;
    for (const double size : test::sizes())
      for (const double offset : test::offsets()) {
        const Mesh mesh = test::placed(body.mesh, size, offset);
        SphereTree tree = unit;
        for (Sphere& s : tree.spheres) s = {test::placed(s.center, size, offset), 0.9 * s.radius * size};
        const std::string what = test::told(body.name, size, offset);
        if (test::is_out_of_range(mesh)) {
          EXPECT_TRUE(test::is_refused([&] { cover(mesh, tree); })) << what;
          continue;
        }
        const CoveredTree model = cover(mesh, tree);
        expect_right(mesh, model, what);
        tree.spheres[0].radius = 1e200;
        EXPECT_TRUE(test::is_refused([&] { cover(mesh, tree); })) << what;
      }
  }
}

// Bodies that are no more than what their coordinates are rounded to.
TEST(BuildAtScale, points_and_what_is_minute_beside_its_coordinates) {
  const double ulp = 0x1p-52;
  std::vector<test::BodyAtScale> bodies{
      {"a point at the origin", {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}}}},
      {"a point", {{{0.3, 0.7, -1.1}, {0.3, 0.7, -1.1}, {0.3, 0.7, -1.1}}, {{0, 1, 2}}}},
      {"one vertex", {{{5, 5, 5}}, {{0, 0, 0}}}},
      {"two points", {{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}}},
      {"a few ulps",
       {{{1, 1, 1}, {1 + ulp, 1, 1}, {1, 1 + ulp, 1}, {1, 1, 1 + 3 * ulp}},
        {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}},
      {"a plate of 1e-200", {{{0, 0, 1}, {1e-200, 0, 1}, {0, 1e-200, 1}, {1e-200, 1e-200, 1}}, {{0, 1, 2}, {1, 3, 2}}}},
      {"a facet of 1e-200 and others",
       {{{0, 0, 0}, {1e-200, 0, 0}, {0, 1e-200, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        {{0, 1, 2}, {0, 3, 4}, {3, 4, 5}, {0, 3, 5}}}},
      {"a segment", {{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}, {{0, 1, 2}}}},
      {"a sliver", {{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-300, 0}}, {{0, 1, 2}}}}};
  for (const test::BodyAtScale& body : bodies)
    for (const Method method : all_methods())
      for (const int branching : {2, 3}) {
        // Where casts overflowed was spawn with two children; the thorough methods take their time.
        if (branching == 2 && method != Method::spawn && method != Method::grid) continue;
        BuildOptions options = small_tree(method);
        options.branching = branching;
        expect_right(body.mesh, build(body.mesh, options), body.name + ", " + std::string(name(method)));
      }
}

}  // namespace
}  // namespace morula

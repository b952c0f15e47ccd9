// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Inside and outside against winding numbers summed over all facets, exact shapes, and points nothing is easy about.
#include <gtest/gtest.h>

#include <morula/collide/containment.hpp>
#include <morula/collide/distance.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "placed_bodies.hpp"
#include "stale_pose.hpp"

namespace morula {
namespace {

using test::PlacedBody;

TEST(Containment, locate_equals_the_sum_of_solid_angles) {
  Random random(31);
  for (const char* name : {"limb", "torus", "two"}) {
    PlacedBody body(sample_body(name, 16));
    InsideQuery inside(body.collider);
    int in = 0, out = 0;
    for (int round = 0; round < 300; ++round) {
      if (round % 20 == 0) body.deform(test::rippled(body.mesh.positions, 0.15, static_cast<std::uint64_t>(round)));
      const Vec3 about = round % 4 == 3 ? Vec3{3e5, 1e6, -2e5} : Vec3{};
      body.collider.set_transform(test::random_transform(random, 0.5, about));
      // Near the surface, where it matters.
      const auto facet = static_cast<std::uint32_t>(random.next() % body.mesh.facet_count());
      const Vec3 p = at_barycentric(body.collider.triangle(facet), {0.25, 0.35, 0.4}) + test::random_point(random, 0.3);
      const double winding = test::slow_winding(body.collider, p);
      ASSERT_NEAR(winding, std::round(winding), 1e-3);
      const PointLocation found = inside.locate(p);
      ASSERT_TRUE(found.status && found.certified);
      EXPECT_EQ(found.winding, static_cast<int>(std::round(winding))) << name << " " << round;
      EXPECT_EQ(found.inside, std::round(winding) != 0) << name << " " << round;
      EXPECT_FALSE(found.on_surface);
      ++(found.inside ? in : out);
    }
    EXPECT_GT(in, 40) << name;
    EXPECT_GT(out, 40) << name;
  }
}

TEST(Containment, half_lines_through_vertices_and_edges_are_counted_once) {
  // A lattice of which every half line along an axis goes through corners, along edges and along sides.
  const Mesh box = test::box_mesh({-1, -1, -1}, {1, 1, 1}, 4);
  PlacedBody body(box);
  InsideQuery inside(body.collider);
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j)
      for (int k = -5; k <= 5; ++k) {
        const Vec3 p{0.25 * i, 0.25 * j, 0.25 * k};
        const PointLocation found = inside.locate(p);
        const double reach = max_norm(p);
        EXPECT_EQ(found.on_surface, reach == 1) << i << " " << j << " " << k;
        EXPECT_EQ(found.inside, reach <= 1) << i << " " << j << " " << k;
        EXPECT_EQ(found.winding, reach < 1 ? 1 : 0) << i << " " << j << " " << k;
      }
  // As near to the surface as doubles go.
  for (const double y : {0.0, 0.25, 0.3}) {
    EXPECT_TRUE(inside.locate({std::nextafter(1.0, 0.0), y, 0.5}).inside);
    EXPECT_FALSE(inside.locate({std::nextafter(1.0, 2.0), y, 0.5}).inside);
    EXPECT_TRUE(inside.locate({1.0, y, 0.5}).on_surface);
  }
}

TEST(Containment, knows_vertices_edges_and_slanted_facets_as_surface) {
  PlacedBody body(test::icosphere(2));
  InsideQuery inside(body.collider);
  for (std::uint32_t f = 0; f < body.mesh.facet_count(); ++f) {
    const Triangle t = body.collider.triangle(f);
    EXPECT_TRUE(inside.locate(t[0]).on_surface);
    for (const double s : {0.999999, 1.000001}) {
      const PointLocation beside = inside.locate(((t[0] + t[1]) * 0.5) * s);
      EXPECT_EQ(beside.inside, s < 1) << f;
      EXPECT_FALSE(beside.on_surface);
    }
  }
  PlacedBody tent({{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}}, 1);
  InsideQuery in_tent(tent.collider);
  EXPECT_TRUE(in_tent.locate({0.5, 0.5, 1}).on_surface) << "on the slanted side, exactly";
  EXPECT_TRUE(in_tent.locate({1, 1, 0}).on_surface) << "on an edge";
  EXPECT_TRUE(in_tent.locate({0.5, 0.5, std::nextafter(1.0, 0.0)}).inside);
  EXPECT_FALSE(in_tent.locate({0.5, 0.5, std::nextafter(1.0, 0.0)}).on_surface);
  EXPECT_FALSE(in_tent.locate({0.5, 0.5, std::nextafter(1.0, 2.0)}).inside);
}

TEST(Containment, understands_cavities_overlaps_and_inverted_bodies) {
  const Mesh outer = test::icosphere(2, 2.0), inner = test::icosphere(2, 1.0);
  const auto winding_at_center = [](Mesh mesh) {
    PlacedBody body(std::move(mesh));
    return InsideQuery(body.collider).locate({0.01, 0.02, 0.03});
  };
  EXPECT_FALSE(winding_at_center(test::joined(outer, test::inverted(inner))).inside) << "a cavity";
  EXPECT_EQ(winding_at_center(test::joined(outer, inner)).winding, 2) << "two layers";
  EXPECT_EQ(winding_at_center(test::inverted(outer)).winding, -1);
  EXPECT_TRUE(winding_at_center(test::inverted(outer)).inside);
  Mesh turned = outer;
  std::swap(turned.facets[7][1], turned.facets[7][2]);
  const PointLocation parity = winding_at_center(turned);
  EXPECT_TRUE(parity.inside) << "not oriented: by parity";
  EXPECT_EQ(parity.winding, 0);
}

TEST(Containment, tells_which_components_are_inside) {
  PlacedBody shell(test::icosphere(3, 3.0));
  PlacedBody pair(test::joined(test::icosphere(1, 0.5), test::icosphere(1, 0.5, {4, 0, 0})));
  const std::vector<std::uint32_t> parts = component_vertices(pair.mesh);
  EXPECT_EQ(parts.size(), inspect(pair.mesh).component_count);
  InsideQuery in_shell(shell.collider), in_pair(pair.collider);
  Containment found;
  ASSERT_TRUE(in_shell.components_inside(pair.collider, parts, found));
  EXPECT_EQ(found.inside, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_TRUE(found.any());
  EXPECT_FALSE(found.all());
  EXPECT_GT(distance(shell.collider, pair.collider).lower, 0) << "so all of each is where its vertex is";

  pair.collider.set_transform({.translation = {-1.5, 0, 0}});
  ASSERT_TRUE(in_shell.components_inside(pair.collider, parts, found));
  EXPECT_TRUE(found.all() || distance(shell.collider, pair.collider).crossing);
  ASSERT_TRUE(in_pair.components_inside(shell.collider, component_vertices(shell.mesh), found));
  EXPECT_FALSE(found.any()) << "the other way round";
}

TEST(Containment, components_are_those_that_inspection_counts) {
  for (const test::NamedMesh& named : test::all_meshes())
    EXPECT_EQ(component_vertices(named.mesh).size(), inspect(named.mesh).component_count) << named.name;
}

TEST(Containment, a_probe_knows_its_side) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 3));
  box.collider.set_transform({.translation = {10, 0, 0}});
  InsideQuery inside(box.collider);
  const Probe deep = inside.probe({{10.5, 0.1, 0.2}, 0.1});
  EXPECT_TRUE(deep.inside && deep.touches);
  EXPECT_NEAR(deep.distance, -0.5, 1e-15);
  EXPECT_NEAR(deep.depth, 0.6, 1e-15);
  EXPECT_LE(distance(deep.normal, Vec3{1, 0, 0}), 1e-15);
  const Probe shallow = inside.probe({{11.05, 0.1, 0.2}, 0.1});
  EXPECT_FALSE(shallow.inside);
  EXPECT_NEAR(shallow.depth, 0.05, 1e-14);
  EXPECT_LE(distance(shallow.normal, Vec3{1, 0, 0}), 1e-14);
  const Probe away = inside.probe({{13, 0, 0}, 0.1});
  EXPECT_FALSE(away.touches);
  EXPECT_NEAR(away.distance, 2, 1e-15);
  const Probe on = inside.probe({{11, 0.1, 0.2}, 0.1});
  EXPECT_NEAR(on.distance, 0, 1e-15);
  EXPECT_LE(distance(on.normal, Vec3{1, 0, 0}), 1e-14) << "along the facet's normal";
}

TEST(Containment, refuses_open_surfaces_and_bad_points) {
  PlacedBody plate(test::grid_plate(3));
  EXPECT_THROW(InsideQuery{plate.collider}, std::invalid_argument);
  PlacedBody ball(test::icosphere(1));
  InsideQuery inside(ball.collider);
  using Code = Status::Code;
  using test::nan;
  EXPECT_EQ(inside.locate({0, nan, 0}).status.code, Code::bad_shape);
  EXPECT_EQ(inside.probe({{0, 0, 0}, -1}).status.code, Code::bad_shape);
  Containment found;
  EXPECT_TRUE(inside.components_inside(plate.collider, component_vertices(plate.mesh), found))
      << "the inner may be open";
  const std::uint32_t none = 1000;
  EXPECT_FALSE(inside.components_inside(plate.collider, {&none, 1}, found));
  EXPECT_EQ(found.status.code, Code::bad_option);
  test::StalePose late(ball.mesh, ball.model.cover, ball.body.sphere_state());
  late.collider.set_positions(ball.mesh.positions);
  InsideQuery in_late(late.collider);
  EXPECT_TRUE(in_late.locate({0, 0, 0}).status);
  late.next_frame();
  EXPECT_EQ(in_late.locate({0, 0, 0}).status.code, Code::positions_not_current);
  EXPECT_FALSE(in_late.components_inside(plate.collider, component_vertices(plate.mesh), found));
  EXPECT_EQ(found.status, (Status{Code::positions_not_current, 1}));
}

}  // namespace
}  // namespace morula

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/signed_distance.hpp>
#include <scenes/brute_force.hpp>
#include <support/meshes.hpp>

#include "points.hpp"

namespace morula {
namespace {

using test::box_mesh;
using test::hard_points;
using test::icosphere;
using test::inverted;
using test::joined;
using test::mesh_named;
using test::translated;

// A body of thin ridges, spikes and saddles: every vertex of a fine sphere moved in or out by chance.
Mesh thistle(int subdivisions, std::uint64_t seed) {
  Mesh mesh = icosphere(subdivisions);
  Random random(seed);
  for (Vec3& p : mesh.positions) p *= random.uniform(0.2, 1.0);
  return mesh;
}

// Inside by all solid angles of a closed mesh. Near the surface rounding decides: `unsure` then.
enum class Side { inside, outside, unsure };
Side exact_side(const Mesh& mesh, const Vec3& p, double orientation) {
  const double turns = orientation * brute_force::winding_number(mesh, p);
  const double off = std::sqrt(brute_force::closest_point(mesh, p).squared_distance);
  const Box box = bounding_box(mesh);
  const double scale = std::max(max_norm(box.lower), max_norm(box.upper));
  if (off < 1e-13 * scale || std::abs(turns - std::round(turns)) > 0.1) return Side::unsure;
  return turns > 0.5 ? Side::inside : Side::outside;
}

void expect_right_sides(const Mesh& mesh, const SignedDistance& object, std::size_t count, std::uint64_t seed) {
  std::size_t sure = 0;
  for (const Vec3& p : hard_points(mesh, count, seed)) {
    SCOPED_TRACE(testing::Message() << "point " << p.x << ' ' << p.y << ' ' << p.z);
    const SignedDistance::Result result = object.at(p);
    EXPECT_EQ(result.distance * result.distance == 0, result.closest.squared_distance == 0);
    EXPECT_DOUBLE_EQ(std::abs(result.distance), std::sqrt(brute_force::closest_point(mesh, p).squared_distance));
    const Side side = exact_side(mesh, p, object.orientation());
    if (side == Side::unsure) continue;
    ++sure;
    EXPECT_EQ(result.distance < 0, side == Side::inside) << "distance " << result.distance;
    EXPECT_EQ(object.is_inside(p), side == Side::inside);
  }
  EXPECT_GT(sure, count / 3);
}

TEST(SignedDistance, knows_inside_of_every_closed_mesh_by_either_method) {
  for (const test::NamedMesh& named : test::all_meshes()) {
    if (!named.has_volume()) continue;
    SCOPED_TRACE(named.name);
    expect_right_sides(named.mesh, SignedDistance(named.mesh), 150, 3);
    expect_right_sides(named.mesh, SignedDistance(named.mesh, SignMethod::winding_number), 90, 4);
  }
}

TEST(SignedDistance, pseudo_normals_are_right_at_spikes_ridges_and_saddles) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const Mesh mesh = thistle(2, seed);
    const SignedDistance object(mesh);
    ASSERT_EQ(object.method(), SignMethod::pseudo_normal);
    expect_right_sides(mesh, object, 600, seed);
  }
}

// Every edge of a turned box is parted at places that no longer lie on it by rounding, and a facet as thin as that
// fills the slit: its computed normal points anywhere. What is inside the box is known without the mesh.
TEST(SignedDistance, facets_as_thin_as_rounding_do_not_turn_it_around) {
  Random random(11);
  for (int turn = 0; turn < 12; ++turn) {
    const RigidTransform placed = RigidTransform::from_axis(
        {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0.1, 3), {});
    Mesh mesh = box_mesh({-1, -1, -1}, {1, 1, 1});
    for (Vec3& p : mesh.positions) p = placed(p);
    const std::vector<Facet> whole = mesh.facets;
    mesh.facets.clear();
    for (const Facet& f : whole) {
      // From the first side of each facet, which is the second or third of its neighbor or the same.
      const auto m = static_cast<std::uint32_t>(mesh.positions.size());
      const double t = random.uniform(0.2, 0.8);
      mesh.positions.push_back(mesh.positions[f[0]] * (1 - t) + mesh.positions[f[1]] * t);
      mesh.facets.push_back({f[0], m, f[2]});
      mesh.facets.push_back({m, f[1], f[2]});
      mesh.facets.push_back({f[0], f[1], m});
    }
    const SignedDistance object(mesh, SignMethod::pseudo_normal);
    for (std::size_t v = 8; v < mesh.positions.size(); ++v)
      for (int k = 0; k < 40; ++k) {
        const double far = std::pow(10, random.uniform(-8, -0.5));
        const Vec3 p =
            mesh.positions[v] + far * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        const double out = max_norm(placed.inverse_rotate(p)) - 1;  // from the faces, roughly; the sign is exact enough
        if (std::abs(out) < 1e-3 * far) continue;
        EXPECT_EQ(object.at(p).distance < 0, out < 0) << "vertex " << v << ", " << far << " away, " << out;
      }
  }
}

// A sheet far thinner than its rim is long: at the rim the mean of two normals that nearly cancel is what rounding
// left.
TEST(SignedDistance, razor_edges_do_not_turn_it_around) {
  Random random(12);
  for (const double thickness : {1e-9, 1e-12, 1e-15})
    for (int turn = 0; turn < 12; ++turn) {
      const RigidTransform placed = RigidTransform::from_axis(
          {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0.1, 3), {});
      // Two pyramids, almost flat, on a common square.
      Mesh mesh;
      mesh.positions = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {0.1, 0.2, thickness}, {0.1, 0.2, -thickness}};
      for (Vec3& p : mesh.positions) p = placed(p);
      for (std::uint32_t i = 0; i < 4; ++i) {
        mesh.facets.push_back({i, (i + 1) % 4, 4});
        mesh.facets.push_back({(i + 1) % 4, i, 5});
      }
      const SignedDistance object(mesh, SignMethod::pseudo_normal);
      for (int k = 0; k < 400; ++k) {
        // Beside the square, in its plane and off it.
        const Vec3 at{random.uniform(1.001, 2), random.uniform(-2, 2),
                      random.uniform() < 0.5 ? 0.0 : random.uniform(-1, 1)};
        EXPECT_GE(object.at(placed(at)).distance, 0) << thickness << ' ' << at.x << ' ' << at.y << ' ' << at.z;
      }
    }
}

// A plain sum of facet normals at the tip of this body points to the wrong side for many directions; weighted by angle
// it does not. The tip's fan has one wide facet and many narrow ones on the other side.
TEST(SignedDistance, pseudo_normals_do_not_depend_on_how_a_fan_is_cut) {
  Mesh mesh{{{0, 0, 1}, {1, 0, 0}, {-0.5, 0.8, 0}}, {}};
  const std::uint32_t narrow = 40;
  for (std::uint32_t i = 0; i <= narrow; ++i) {
    const double along = static_cast<double>(i) / narrow;
    mesh.positions.push_back({-0.5 - 0.3 * along, -0.8 + 0.1 * along, 0});
  }
  const auto first = std::uint32_t{3}, last = first + narrow;
  mesh.facets = {{0, 1, 2}, {0, 2, last}, {0, first, 1}};
  for (std::uint32_t i = first; i < last; ++i) mesh.facets.push_back({0, i + 1, i});
  mesh.facets.insert(mesh.facets.end(), {Facet{2, 1, first}});
  for (std::uint32_t i = first; i < last; ++i) mesh.facets.push_back({2, i, i + 1});
  const SignedDistance object(mesh);
  ASSERT_EQ(object.method(), SignMethod::pseudo_normal);
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = Vec3{0, 0, 1} + test::random_direction(random) * 0.05;
    const Side side = exact_side(mesh, p, 1);
    if (side == Side::unsure) continue;
    EXPECT_EQ(object.is_inside(p), side == Side::inside);
  }
}

TEST(SignedDistance, is_exact_for_boxes) {
  const Vec3 lower{-1, 0, 2}, upper{3, 1, 2.5};
  for (const int n : {1, 3}) {
    const SignedDistance object(box_mesh(lower, upper, n));
    Random random(4);
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = test::point_around({lower, upper}, 0.3, random);
      const double outside = std::sqrt(squared_distance(Box{lower, upper}, p));
      const Vec3 to_lower = p - lower, to_upper = upper - p;
      const double inside = std::min({to_lower.x, to_lower.y, to_lower.z, to_upper.x, to_upper.y, to_upper.z});
      EXPECT_NEAR(object(p), outside > 0 ? outside : -inside, 1e-14);
    }
  }
}

TEST(SignedDistance, is_zero_on_vertices) {
  const Mesh mesh = sample_body("limb", 24);
  const SignedDistance object(mesh);
  for (const Vec3& p : mesh.positions) EXPECT_EQ(object(p), 0.0);
}

TEST(SignedDistance, chooses_the_method_by_what_the_mesh_is) {
  const auto method_for = [](const Mesh& mesh) { return SignedDistance(mesh).method(); };
  for (const std::string_view name : sample_body_names())
    EXPECT_EQ(method_for(sample_body(name, 24)), SignMethod::pseudo_normal) << name;
  for (const char* name : {"cube_12", "needle", "thin_box", "tiny", "huge", "far_away", "two_components",
                           "nested_shells", "inverted", "unused_vertices"})
    EXPECT_EQ(method_for(mesh_named(name).mesh), SignMethod::pseudo_normal) << name;
  for (const test::NamedMesh& named : test::all_meshes()) {
    if (named.has_volume() && named.manifold) continue;
    EXPECT_EQ(method_for(named.mesh), SignMethod::winding_number) << named.name;
  }
  // Closed, oriented, manifold, and still the closest feature does not tell.
  EXPECT_EQ(method_for(mesh_named("folded_facet").mesh), SignMethod::winding_number);
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1}, 2);
  EXPECT_EQ(method_for(joined(cube, translated(cube, {0.5, 0.5, 0.5}))), SignMethod::winding_number);
  EXPECT_EQ(method_for(joined(icosphere(2), icosphere(2, 0.5))), SignMethod::winding_number);
  EXPECT_EQ(method_for(joined(icosphere(2), inverted(icosphere(2, 0.5, {3, 0, 0})))), SignMethod::winding_number);
}

TEST(SignedDistance, takes_the_union_of_shells_that_overlap) {
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1}, 2);
  const SignedDistance object(joined(cube, translated(cube, {0.5, 0.5, 0.5})));
  Random random(9);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = test::point_around({{0, 0, 0}, {1.5, 1.5, 1.5}}, 0.1, random);
    const auto in_cube = [&](double at) {
      return std::min({p.x, p.y, p.z}) > at && std::max({p.x, p.y, p.z}) < at + 1;
    };
    EXPECT_EQ(object.is_inside(p), in_cube(0) || in_cube(0.5));
  }
}

TEST(SignedDistance, a_turned_shell_is_a_cavity_and_an_unturned_one_is_not) {
  const SignedDistance hollow(mesh_named("nested_shells").mesh);
  EXPECT_EQ(hollow.orientation(), 1);
  EXPECT_DOUBLE_EQ(hollow({2, 2, 2}), 1);
  EXPECT_DOUBLE_EQ(hollow({2, 2, 0.75}), -0.25);
  const SignedDistance filled(joined(box_mesh({0, 0, 0}, {4, 4, 4}), box_mesh({1, 1, 1}, {3, 3, 3})));
  EXPECT_DOUBLE_EQ(filled({2, 2, 2}), -1);
  EXPECT_DOUBLE_EQ(filled({2, 2, 0.75}), -0.25);
}

TEST(SignedDistance, reads_an_inside_out_mesh_the_right_way_round) {
  const Mesh mesh = sample_body("torus", 16);
  for (const SignMethod method : {SignMethod::pseudo_normal, SignMethod::winding_number}) {
    const SignedDistance upright(mesh, method), turned(inverted(mesh), method);
    EXPECT_EQ(upright.orientation(), 1);
    EXPECT_EQ(turned.orientation(), -1);
    for (const Vec3& p : hard_points(mesh, 150, 12))
      if (exact_side(mesh, p, 1) != Side::unsure) {
        EXPECT_NEAR(turned(p), upright(p), 1e-15);
      }
  }
}

TEST(SignedDistance, open_surfaces_have_a_sensible_inside) {
  const Mesh& scan = mesh_named("open_scan").mesh;
  const SignedDistance object(scan);
  EXPECT_FALSE(object.has_volume());
  EXPECT_TRUE(object.is_inside({0, 0, 0}));
  EXPECT_FALSE(object.is_inside({0, 0, 1.5}));
  EXPECT_FALSE(object.is_inside({1.2, 0, 0}));
  const SignedDistance plate(mesh_named("flat_plate").mesh);
  Random random(3);
  for (int i = 0; i < 200; ++i) EXPECT_FALSE(plate.is_inside(test::point_around({{0, 0, -1}, {1, 1, 1}}, 0.1, random)));
}

TEST(SignedDistance, protrusion_bound_is_exact_for_boxes) {
  const Box box{{0, 0, 0}, {1, 2, 3}};
  const SignedDistance object(box_mesh(box.lower, box.upper, 2));
  Random random(5);
  const std::vector<Vec3> directions = fibonacci_directions(4000);
  for (int i = 0; i < 40; ++i) {
    const Sphere ball{test::point_around(box, 0.2, random), random.uniform(0.05, 1.5)};
    double farthest = 0;
    for (const Vec3& u : directions)
      farthest = std::max(farthest, std::sqrt(squared_distance(box, ball.center + u * ball.radius)));
    EXPECT_GE(object.protrusion_bound(ball), farthest - 1e-14);
    EXPECT_LE(object.protrusion_bound(ball), farthest + 0.05 * ball.radius);
  }
}

TEST(SignedDistance, is_the_same_whatever_is_said_to_be_known) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const char* name : {"icosphere", "needle", "folded_facet", "moebius_strip"}) {
    const Mesh& mesh = mesh_named(name).mesh;
    const SignedDistance object(mesh);
    for (const Vec3& p : hard_points(mesh, 200, 11)) {
      const SignedDistance::Result expected = object.at(p);
      const double d = std::abs(expected.distance);
      for (const double known : {d, 0.999 * d, 1.5 * d, 0.0, -1.0, infinity, std::nan("")}) {
        const SignedDistance::Result found = object.at(p, known);
        EXPECT_EQ(found.distance, expected.distance);
        EXPECT_EQ(found.closest.facet, expected.closest.facet);
        EXPECT_EQ(found.closest.point, expected.closest.point);
      }
    }
  }
}

TEST(SignedDistance, what_is_not_a_number_is_nowhere) {
  const SignedDistance object(icosphere(1));
  EXPECT_TRUE(std::isnan(object({std::nan(""), 0, 0})));
  EXPECT_FALSE(object.is_inside({0, std::nan(""), 0}));
  EXPECT_TRUE(std::isnan(object.at({0, 0, std::nan("")}, 1).distance));
}

TEST(SignedDistance, has_the_same_bits_for_any_number_of_workers) {
  const Mesh mesh = sample_body("blob", 60);
  ASSERT_GT(mesh.facet_count(), 4096u);
  const SignedDistance alone(mesh);
  for (const unsigned count : {2u, 3u, 8u}) {
    Workers workers(count);
    const SignedDistance shared(mesh, workers);
    for (const Vec3& p : hard_points(mesh, 200, 6)) EXPECT_EQ(shared(p), alone(p));
  }
}

}  // namespace
}  // namespace morula

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches: clipped tetrahedra, boxes by hand, differences of volumes, translations that part.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/collide/contact_patches.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/error_text.hpp>
#include <support/meshes.hpp>

#include "clipped_overlap.hpp"
#include "placed_bodies.hpp"

namespace morula {
namespace {

using test::clipped_overlap;
using test::ClippedOverlap;
using test::PlacedBody;

RigidTransform random_place(Random& random, double reach, const Vec3& about = {}) {
  const auto part = [&] { return random.uniform(-1, 1); };
  const Vec3 axis{part(), part(), part()};
  return RigidTransform::from_axis(axis, random.uniform(0, 3), about + Vec3{part(), part(), part()} * reach);
}

/// The sums over all patches.
struct Total {
  double volume = 0;
  Vec3 first_moment, area_vector_a, area_vector_b;
  explicit Total(const ContactPatchQuery& query) {
    for (const ContactPatch& patch : query.patches()) {
      volume += patch.volume;
      first_moment += patch.centroid * patch.volume;
      area_vector_a += patch.a.area_vector;
      area_vector_b += patch.b.area_vector;
    }
  }
};

void expect_overlap(const ContactPatchQuery& query, const Collider& a, const Collider& b, double tolerance) {
  const ClippedOverlap expected = clipped_overlap(a, b);
  const Total total(query);
  EXPECT_NEAR(total.volume, expected.volume, tolerance);
  EXPECT_NEAR(query.volume(), expected.volume, tolerance);
  EXPECT_LE(length(total.area_vector_a - expected.area_vector_a), tolerance);
  EXPECT_LE(length(total.area_vector_b - expected.area_vector_b), tolerance);
  EXPECT_LE(length(total.first_moment - expected.centroid * expected.volume),
            tolerance * (1 + length(expected.centroid)));
}

/// Relations that hold for every patch.
void expect_consistent(const ContactPatchQuery& query, double tolerance, double of_coordinates = 0) {
  for (const ContactPatch& patch : query.patches()) {
    EXPECT_GE(patch.volume, 0);
    EXPECT_LE(length(patch.a.area_vector + patch.b.area_vector), tolerance) << "action equals reaction";
    EXPECT_LE(length(patch.a.moment + patch.b.moment), tolerance);
    for (const PatchSide* side : {&patch.a, &patch.b}) {
      Vec3 gradients, facets;
      double area = 0;
      for (const VertexGradient& g : side->gradients) gradients += g.gradient;
      for (const PatchFacet& f : side->facets) facets += f.area_vector, area += length(f.area_vector);
      EXPECT_LE(length(gradients - side->area_vector), tolerance);
      EXPECT_LE(length(facets - side->area_vector), tolerance);
      EXPECT_NEAR(area, side->area, tolerance);
    }
    if (patch.points.size() < 3) continue;
    Vec3 force, moment;
    double volume = 0;
    for (const PatchPoint& point : patch.points) {
      force += point.force;
      moment += cross(point.point - patch.centroid, point.force);
      volume += point.volume;
    }
    EXPECT_LE(length(force + patch.a.area_vector), tolerance);
    EXPECT_LE(length(moment + patch.a.moment), tolerance + of_coordinates);
    EXPECT_NEAR(volume, patch.volume, 20 * tolerance);
  }
}

TEST(ContactPatches, of_random_poses_are_those_of_clipped_tetrahedra) {
  Random random(11);
  std::vector<std::unique_ptr<PlacedBody>> bodies;
  bodies.push_back(std::make_unique<PlacedBody>(test::icosphere(1)));
  bodies.push_back(std::make_unique<PlacedBody>(test::box_mesh({-0.6, -0.5, -0.7}, {0.6, 0.5, 0.7}, 2)));
  bodies.push_back(std::make_unique<PlacedBody>(test::uv_sphere(9, 6, 0.9)));
  bodies.back()->deform(test::rippled(bodies.back()->mesh.positions, 0.2, 5));
  for (const auto& a : bodies)
    for (const auto& b : bodies) {
      PlacedBody other(b->mesh);
      other.deform(b->positions);
      ContactPatchQuery query(a->collider, other.collider);
      for (int pose = 0; pose < 6; ++pose) {
        a->collider.set_transform(random_place(random, 0.6));
        other.collider.set_transform(random_place(random, 0.6));
        ASSERT_TRUE(query.run());
        EXPECT_TRUE(query.certified());
        expect_overlap(query, a->collider, other.collider, 1e-13);
        expect_consistent(query, 1e-13);
      }
    }
}

// Coplanar faces, shared edges and vertices, bodies that only touch, and identical bodies.
TEST(ContactPatches, of_boxes_on_a_grid_are_boxes) {
  PlacedBody a(test::box_mesh({0, 0, 0}, {1, 1, 1}, 2)), b(test::box_mesh({0, 0, 0}, {1, 1, 1}, 2));
  ContactPatchQuery query(a.collider, b.collider);
  for (int x = -4; x <= 4; ++x)
    for (int y = -4; y <= 4; ++y)
      for (int z = -4; z <= 4; ++z) {
        const Vec3 shift = Vec3{double(x), double(y), double(z)} * 0.25;
        b.collider.set_transform({.translation = shift});
        ASSERT_TRUE(query.run());
        const double volume = (1 - std::abs(shift.x)) * (1 - std::abs(shift.y)) * (1 - std::abs(shift.z));
        ASSERT_NEAR(query.volume(), volume, 1e-15) << x << ' ' << y << ' ' << z;
        expect_consistent(query, 1e-14);
        if (volume == 0) continue;
        const Total total(query);
        const Vec3 center = (Vec3{1, 1, 1} + shift) * 0.5;
        EXPECT_LE(length(total.first_moment / volume - center), 1e-14);
      }
}

TEST(ContactPatches, are_the_same_for_exchanged_bodies_and_after_rigid_motions) {
  Random random(3);
  PlacedBody a(test::icosphere(2)), b(test::box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 3));
  ContactPatchQuery query(a.collider, b.collider), exchanged(b.collider, a.collider);
  for (int pose = 0; pose < 10; ++pose) {
    const RigidTransform place_a = random_place(random, 0.5), place_b = random_place(random, 0.5);
    a.collider.set_transform(place_a);
    b.collider.set_transform(place_b);
    ASSERT_TRUE(query.run());
    ASSERT_TRUE(exchanged.run());
    ASSERT_EQ(query.patches().size(), exchanged.patches().size());
    const Total total(query), other(exchanged);
    EXPECT_NEAR(total.volume, other.volume, 1e-15);
    EXPECT_LE(length(total.area_vector_a - other.area_vector_b), 1e-14);
    EXPECT_LE(length(total.first_moment - other.first_moment), 1e-14);
    double depths = 0, others = 0;
    for (const ContactPatch& patch : query.patches()) depths += patch.depth;
    for (const ContactPatch& patch : exchanged.patches()) others += patch.depth;
    EXPECT_NEAR(depths, others, 1e-13);
    const RigidTransform move = random_place(random, 1);
    const auto moved = [&](const RigidTransform& t) { return inverse(relative_to(t, inverse(move))); };
    a.collider.set_transform(moved(place_a));
    b.collider.set_transform(moved(place_b));
    ASSERT_TRUE(query.run());
    EXPECT_NEAR(query.volume(), total.volume, 1e-14);
    EXPECT_LE(length(Total(query).area_vector_a - move.rotate(total.area_vector_a)), 1e-13);
    // Far away positions are rounded to 2^-33, and the result is that of the rounded positions.
    const Vec3 far{1e6, -3e6, 2e6};
    a.collider.set_transform({place_a.rows, place_a.translation + far});
    b.collider.set_transform({place_b.rows, place_b.translation + far});
    ASSERT_TRUE(query.run());
    EXPECT_NEAR(query.volume(), total.volume, 1e-8);
    expect_consistent(query, 1e-13, 1e-8);
  }
}

// Far from the origin results are those of the rounded positions, to the same digits.
TEST(ContactPatches, far_from_the_origin_are_as_exact) {
  Random random(5);
  PlacedBody a(test::icosphere(1)), b(test::icosphere(1, 0.8));
  ContactPatchQuery query(a.collider, b.collider);
  for (int pose = 0; pose < 5; ++pose) {
    a.collider.set_transform(random_place(random, 0.5, {1e6, 2e6, -1e6}));
    b.collider.set_transform(random_place(random, 0.5, {1e6, 2e6, -1e6}));
    ASSERT_TRUE(query.run());
    const ClippedOverlap expected = clipped_overlap(a.collider, b.collider);
    EXPECT_NEAR(query.volume(), expected.volume, 1e-13);
    EXPECT_LE(length(Total(query).area_vector_a - expected.area_vector_a), 1e-12);
  }
}

TEST(ContactPatches, gradients_are_differences_of_volumes) {
  Random random(7);
  PlacedBody a(test::icosphere(1)), b(test::uv_sphere(8, 6, 0.8));
  for (int pose = 0; pose < 4; ++pose) {
    a.collider.set_transform(random_place(random, 0.4));
    b.collider.set_transform(random_place(random, 0.4));
    ContactPatchQuery query(a.collider, b.collider);
    ASSERT_TRUE(query.run());
    for (PlacedBody* const body : {&a, &b}) {
      std::vector<Vec3> expected(body->mesh.vertex_count());
      ASSERT_TRUE(query.run());
      for (const ContactPatch& patch : query.patches())
        for (const VertexGradient& g : (body == &a ? patch.a : patch.b).gradients) expected[g.vertex] += g.gradient;
      const std::vector<Vec3> rest = body->positions;
      constexpr double step = 1e-5;
      for (std::uint32_t v = 0; v < rest.size(); ++v)
        for (int axis = 0; axis < 3; ++axis) {
          double volume[2];
          for (int k = 0; k < 2; ++k) {
            std::vector<Vec3> moved = rest;
            moved[v][axis] += k == 0 ? -step : step;
            body->deform(moved);
            ASSERT_TRUE(query.run({.max_points = 0, .depths = false}));
            volume[k] = query.volume();
          }
          Vec3 along;
          along[axis] = 1;
          const double slope = (volume[1] - volume[0]) / (2 * step);
          EXPECT_NEAR(slope, dot(expected[v], body->collider.transform().rotate(along)), 2e-7);
        }
      body->deform(rest);
    }
  }
}

/// True if lines along the normal meet each region at most once, because its facets face the other body.
bool is_facing(const ContactPatch& patch) {
  for (const PatchFacet& f : patch.a.facets)
    if (dot(f.area_vector, patch.normal) > 0) return false;
  for (const PatchFacet& f : patch.b.facets)
    if (dot(f.area_vector, patch.normal) < 0) return false;
  return true;
}

TEST(ContactPatches, part_after_a_translation_by_their_depth) {
  Random random(13);
  std::vector<std::pair<Mesh, Mesh>> pairs;
  pairs.emplace_back(test::icosphere(2), test::box_mesh({-3, -3, -5}, {3, 3, 0}));
  pairs.emplace_back(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2), test::box_mesh({-1, -1, -1}, {1, 1, 1}, 1));
  pairs.emplace_back(test::icosphere(1), test::icosphere(2, 0.7));
  int facing = 0;
  for (auto& [mesh_a, mesh_b] : pairs) {
    PlacedBody a(mesh_a), b(mesh_b);
    ContactPatchQuery query(a.collider, b.collider);
    for (int pose = 0; pose < 60; ++pose) {
      const RigidTransform place = random_place(random, 1.4);
      a.collider.set_transform(place);
      b.collider.set_transform(random_place(random, 0.3));
      ASSERT_TRUE(query.run());
      if (query.patches().empty()) continue;
      ASSERT_EQ(query.patches().size(), 1u) << "convex bodies";
      const ContactPatch patch = query.patches()[0];
      if (patch.normal == Vec3{}) continue;
      EXPECT_GT(patch.depth, 0);
      a.collider.set_transform({place.rows, place.translation + patch.normal * (patch.depth * (1 - 1e-6))});
      ASSERT_TRUE(query.run());
      EXPECT_GT(query.volume(), 0) << "no shorter way parts the regions";
      if (!is_facing(patch)) continue;
      ++facing;
      EXPECT_GE(patch.depth, patch.mean_depth * (1 - 1e-12));
      a.collider.set_transform({place.rows, place.translation + patch.normal * (patch.depth * (1 + 1e-12))});
      ASSERT_TRUE(query.run());
      EXPECT_LT(query.volume(), 1e-14) << pose;
    }
  }
  EXPECT_GT(facing, 20);
}

TEST(ContactPatches, of_a_box_pressed_into_a_plate_are_known) {
  PlacedBody box(test::box_mesh({-0.5, -0.5, 0}, {0.5, 0.5, 1})), plate(test::box_mesh({-2, -2, -1}, {2, 2, 0}, 4));
  ContactPatchQuery query(box.collider, plate.collider);
  for (const double depth : {1e-3, 1e-2, 0.05}) {
    box.collider.set_transform({.translation = {0.01, 0.02, -depth}});
    ASSERT_TRUE(query.run());
    ASSERT_EQ(query.patches().size(), 1u);
    const ContactPatch& patch = query.patches()[0];
    EXPECT_NEAR(patch.volume, depth, 1e-15);
    EXPECT_NEAR(patch.depth, depth, 1e-15);
    EXPECT_NEAR(patch.mean_depth, depth, 1e-15);
    EXPECT_LE(length(patch.normal - Vec3{0, 0, 1}), 1e-14);
    EXPECT_LE(length(patch.centroid - Vec3{0.01, 0.02, -depth / 2}), 1e-14);
    EXPECT_NEAR(patch.b.area, 1, 1e-14);
    EXPECT_NEAR(patch.a.area, 1 + 4 * depth, 1e-14);
    ASSERT_EQ(patch.points.size(), 4u);
    for (const PatchPoint& point : patch.points) {
      EXPECT_NEAR(point.depth, depth, 1e-13);
      EXPECT_LE(length(point.force - Vec3{0, 0, 0.25}), 1e-13);
      EXPECT_NEAR(point.on_a.point.z, -depth, 1e-15);
      EXPECT_NEAR(point.on_b.point.z, 0, 1e-15);
      EXPECT_NEAR(std::abs(point.point.x - 0.01), 0.25, 0.1);
    }
    expect_consistent(query, 1e-14);
  }
}

/// A stem of the half width 0.5 on a head of the half width 1.5, from z = -0.7 to -0.5, about the z axis.
Mesh mushroom() {
  Mesh mesh;
  for (const auto& [half, z] : {std::pair{0.5, 1.0}, std::pair{0.5, -0.5}, std::pair{1.5, -0.5}, std::pair{1.5, -0.7}})
    for (const auto& [x, y] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}})
      mesh.positions.push_back({x * half, y * half, z});
  for (std::uint32_t ring = 0; ring < 12; ring += 4)
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t from = ring + i, to = ring + (i + 1) % 4;
      mesh.facets.push_back({from, from + 4, to});
      mesh.facets.push_back({to, from + 4, to + 4});
    }
  for (const Facet& f : {Facet{0, 1, 2}, Facet{0, 2, 3}, Facet{12, 14, 13}, Facet{12, 15, 14}})
    mesh.facets.push_back(f);
  return inspect(mesh).volume > 0 ? mesh : test::inverted(mesh);
}

// The loop is around the stem, but most lines along the normal pass through the head alone: volume over area exceeds
// the whole depth, and the mean length of the lines does not.
TEST(ContactPatches, of_a_head_under_a_surface_have_points_as_deep_as_the_head_is_thick) {
  PlacedBody head(mushroom()), plate(test::box_mesh({-3, -3, -2}, {3, 3, 0}));
  ContactPatchQuery query(head.collider, plate.collider), exchanged(plate.collider, head.collider);
  constexpr double volume = 1 * 0.5 + 9 * 0.2;
  for (ContactPatchQuery* each : {&query, &exchanged}) {
    ASSERT_TRUE(each->run());
    ASSERT_EQ(each->patches().size(), 1u);
    const ContactPatch& patch = each->patches()[0];
    EXPECT_NEAR(patch.volume, volume, 1e-13);
    EXPECT_NEAR(patch.depth, 0.7, 1e-13);
    EXPECT_NEAR(patch.mean_depth, volume, 1e-13);
    ASSERT_EQ(patch.points.size(), 4u);
    for (const PatchPoint& point : patch.points) {
      EXPECT_NEAR(point.volume, volume / 4, 1e-13);
      EXPECT_NEAR(length(point.force), 0.25, 1e-13);
      EXPECT_NEAR(point.depth, volume / 9, 1e-13);
    }
  }
}

/// A prism along x with a groove of a right angle, its lowest line at z = 0.
Mesh groove() {
  Mesh mesh;
  for (const double x : {-3.0, 3.0})
    for (const auto& [y, z] : {std::pair{-2, -1}, std::pair{2, -1}, std::pair{2, 1}, std::pair{1, 1}, std::pair{0, 0},
                               std::pair{-1, 1}, std::pair{-2, 1}})
      mesh.positions.push_back({x, double(y), double(z)});
  for (std::uint32_t i = 0; i < 7; ++i) {
    const std::uint32_t j = (i + 1) % 7;
    mesh.facets.push_back({i, i + 7, j});
    mesh.facets.push_back({j, i + 7, j + 7});
  }
  for (const Facet& f : {Facet{0, 1, 4}, Facet{1, 2, 3}, Facet{1, 3, 4}, Facet{0, 4, 5}, Facet{0, 5, 6}}) {
    mesh.facets.push_back(f);
    mesh.facets.push_back({f[2] + 7, f[1] + 7, f[0] + 7});
  }
  return inspect(mesh).volume > 0 ? mesh : test::inverted(mesh);
}

// A capsule of radius 0.5 has a line of vertices at each wall, 0.5 from its axis.
TEST(ContactPatches, of_a_capsule_in_a_groove_are_one_for_each_wall) {
  PlacedBody capsule(sample_body("capsule", 24)), walls(groove());
  ContactPatchQuery query(capsule.collider, walls.collider);
  for (const double depth : {1e-3, 1e-2, 0.05}) {
    capsule.collider.set_transform({.translation = {0.01, 0, (0.5 - depth) * std::sqrt(2.0)}});
    ASSERT_TRUE(query.run());
    ASSERT_EQ(query.patches().size(), 2u);
    for (const ContactPatch& patch : query.patches()) {
      EXPECT_NEAR(patch.depth, depth, 1e-9);
      EXPECT_LE(length(patch.normal - Vec3{0, std::copysign(std::sqrt(0.5), patch.normal.y), std::sqrt(0.5)}), 1e-9);
    }
    EXPECT_LT(query.patches()[0].normal.y * query.patches()[1].normal.y, 0);
    expect_consistent(query, 1e-14);
  }
}

TEST(ContactPatches, on_one_facet_fall_apart) {
  const Mesh feet = test::joined(test::box_mesh({0, 0, 0}, {0.1, 0.1, 1}), test::box_mesh({0.3, 0, 0}, {0.4, 0.1, 1}));
  PlacedBody a(feet), plate(test::box_mesh({-2, -2, -1}, {2, 3, 0}));
  a.collider.set_transform({.translation = {0.2, 0.1, -0.01}});
  ContactPatchQuery query(a.collider, plate.collider);
  ASSERT_TRUE(query.run());
  ASSERT_EQ(query.patches().size(), 2u);
  const std::uint32_t ids[2] = {query.patches()[0].id, query.patches()[1].id};
  EXPECT_NE(ids[0], ids[1]);
  for (int step = 0; step < 50; ++step) {
    a.collider.set_transform({.translation = {0.2 + 0.005 * step, 0.1, -0.01}});
    ASSERT_TRUE(query.run());
    ASSERT_EQ(query.patches().size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(query.patches()[k].id, ids[k]) << "it stays";
      EXPECT_NEAR(query.patches()[k].volume, 1e-4, 1e-16);
      ASSERT_EQ(query.patches()[k].points.size(), 4u);
      for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(query.patches()[k].points[i].id, i);
    }
  }
}

// A ring on a plate has two loops, one a hole in the other. A pit's loop is a hole in a facet that is wholly inside
// otherwise.
TEST(ContactPatches, with_holes_are_one) {
  const Mesh torus = sample_body("torus", 14);
  PlacedBody ring(torus), plate(test::box_mesh({-40, -40, -40}, {40, 40, 0}));
  Box box = bounding_box(torus);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 along;
    along[axis] = 1;
    // The axis of the ring points up if its box is thinnest there.
    if (box.extent()[axis] > std::min({box.extent().x, box.extent().y, box.extent().z}) * 1.001) continue;
    const RigidTransform turn = RigidTransform::from_axis(cross(along, Vec3{0, 0, 1}), axis == 2 ? 0 : std::acos(0.0));
    ring.collider.set_transform({turn.rows, Vec3{0.1, 0.2, box.extent()[axis] * 0.4} - turn.rotate(box.center())});
    ContactPatchQuery query(ring.collider, plate.collider);
    ASSERT_TRUE(query.run());
    ASSERT_EQ(query.patches().size(), 1u);
    expect_overlap(query, ring.collider, plate.collider, 1e-11);
  }
}

TEST(ContactPatches, of_bodies_inside_others) {
  PlacedBody ball(test::icosphere(1, 0.2)), box(test::box_mesh({-1, -1, -1}, {1, 1, 1}));
  ContactPatchQuery query(ball.collider, box.collider), other(box.collider, ball.collider);
  ball.collider.set_transform({.translation = {0.3, 0.2, 0.1}});
  for (ContactPatchQuery* const q : {&query, &other}) {
    ASSERT_TRUE(q->run());
    ASSERT_EQ(q->patches().size(), 1u);
    const ContactPatch& patch = q->patches()[0];
    EXPECT_EQ(patch.crossing_count, 0u);
    EXPECT_EQ(patch.normal, Vec3{});
    EXPECT_LE(length(patch.centroid - Vec3{0.3, 0.2, 0.1}), 1e-14);
    EXPECT_NEAR(patch.volume, clipped_overlap(ball.collider, box.collider).volume, 1e-15);
  }
  // A shell with a cavity: wholly inside, and half inside with the cavity wholly inside.
  const Mesh shell = test::joined(test::icosphere(1, 0.5), test::inverted(test::icosphere(1, 0.2)));
  PlacedBody hollow(shell);
  ContactPatchQuery cavity(hollow.collider, box.collider);
  for (const double x : {0.2, 0.7}) {
    hollow.collider.set_transform({.translation = {x, 0.1, 0.05}});
    ASSERT_TRUE(cavity.run());
    ASSERT_EQ(cavity.patches().size(), 1u) << x;
    expect_overlap(cavity, hollow.collider, box.collider, 1e-13);
  }
}

TEST(ContactPatches, change_continuously_across_edges_and_vertices) {
  PlacedBody a(test::icosphere(1, 0.3)), b(test::box_mesh({0, 0, 0}, {1, 1, 1}, 3));
  ContactPatchQuery query(a.collider, b.collider);
  double volume = -1;
  Vec3 force, moment;
  constexpr int steps = 3000;
  for (int step = 0; step <= steps; ++step) {
    // Through the top along its edge lines, past a vertex and off the rim.
    const double x = 1.6 * step / steps - 0.3;
    a.collider.set_transform({.translation = {x, x * 0.5, 1.15}});
    ASSERT_TRUE(query.run());
    const Total total(query);
    if (volume >= 0) {
      EXPECT_LE(std::abs(total.volume - volume), 2e-4);
      EXPECT_LE(length(total.area_vector_a - force), 2e-3) << step;
      EXPECT_LE(length(total.first_moment - moment), 4e-4) << step;
    }
    volume = total.volume, force = total.area_vector_a, moment = total.first_moment;
  }
}

TEST(ContactPatches, of_deforming_bodies_and_tiny_ones_are_those_of_clipped_tetrahedra) {
  PlacedBody a(test::icosphere(2)), b(test::icosphere(1));
  ContactPatchQuery query(a.collider, b.collider);
  for (std::uint64_t frame = 1; frame < 5; ++frame) {
    a.deform(test::rippled(a.mesh.positions, 0.1, frame));
    b.deform(test::rippled(b.mesh.positions, 0.1, frame + 9));
    b.collider.set_transform({.translation = {0.9, 0.3, 0.2}});
    ASSERT_TRUE(query.run());
    expect_overlap(query, a.collider, b.collider, 1e-13);
    expect_consistent(query, 1e-13);
  }
  PlacedBody speck(test::icosphere(1, 1e-7)), box(test::box_mesh({-1, -1, -1}, {1, 1, 1}));
  ContactPatchQuery tiny(speck.collider, box.collider);
  speck.collider.set_transform({.translation = {1 + 3e-8, 0.3, 0.2}});
  ASSERT_TRUE(tiny.run());
  ASSERT_EQ(tiny.patches().size(), 1u);
  const ContactPatch& patch = tiny.patches()[0];
  EXPECT_NEAR(patch.depth / 7e-8, 1, 0.2);
  EXPECT_LE(length(patch.normal - Vec3{1, 0, 0}), 1e-7);
  EXPECT_LE(length(patch.a.area_vector + patch.b.area_vector), 1e-8 * patch.a.area);
}

TEST(ContactPatches, refuse_open_unoriented_and_inverted_surfaces_by_name) {
  PlacedBody good(test::icosphere(1)), open(test::grid_plate(3)), inverted(test::inverted(test::icosphere(1)));
  const auto refusal = [](const Collider& a, const Collider& b) {
    return test::error_text([&] { ContactPatchQuery(a, b); });
  };
  EXPECT_NE(refusal(open.collider, good.collider).find("first body is not closed: 12 of its edges"), std::string::npos);
  EXPECT_NE(refusal(good.collider, open.collider).find("second body is not closed"), std::string::npos);
  EXPECT_NE(refusal(good.collider, inverted.collider).find("second body is inside out"), std::string::npos);
  EXPECT_NE(refusal(inverted.collider, good.collider).find("first body is inside out"), std::string::npos);
  const Collider spheres(good.body.sphere_state());
  EXPECT_NE(refusal(spheres, good.collider).find("spheres alone"), std::string::npos);
}

TEST(ContactPatches, keep_the_last_result_when_a_run_is_rejected) {
  PlacedBody a(test::icosphere(1)), b(test::icosphere(1));
  b.collider.set_transform({.translation = {1, 0.1, 0}});
  ContactPatchQuery query(a.collider, b.collider);
  EXPECT_TRUE(query.patches().empty());
  ASSERT_TRUE(query.run());
  ASSERT_EQ(query.patches().size(), 1u);
  const double volume = query.volume();
  EXPECT_EQ(query.run({.max_points = 17}).code, Status::Code::bad_option);
  std::vector<Vec3> mirrored = b.mesh.positions;
  for (Vec3& p : mirrored) p.x = -p.x;
  b.deform(mirrored);
  const Status status = query.run();
  EXPECT_EQ(status.code, Status::Code::inside_out);
  EXPECT_EQ(status.body, 1);
  EXPECT_NE(message(status).find("the second body is inside out where it meets the other"), std::string::npos);
  EXPECT_EQ(query.volume(), volume);
  ASSERT_EQ(query.patches().size(), 1u);
  EXPECT_EQ(query.patches()[0].volume, volume);
  b.deform(b.mesh.positions);
  ASSERT_TRUE(query.run());
  EXPECT_EQ(query.volume(), volume);
  EXPECT_EQ(query.patches()[0].id, 0u);
}

// No vertex of the plate is inside the ball, so only the loops tell that the ball is inside out.
TEST(ContactPatches, reject_an_inverted_body_that_holds_no_vertex) {
  PlacedBody ball(test::icosphere(2)), plate(test::box_mesh({-4, -4, -1}, {4, 4, 0.5}));
  for (const double height : {1.2, 1.45}) {
    ball.collider.set_transform({.translation = {0.03, 0.02, height}});
    ball.deform(ball.mesh.positions);
    ContactPatchQuery first(ball.collider, plate.collider), second(plate.collider, ball.collider);
    ASSERT_TRUE(first.run() && second.run());
    const double volume = first.volume();
    ASSERT_GT(volume, 0);
    std::vector<Vec3> mirrored = ball.mesh.positions;
    for (Vec3& p : mirrored) p.x = -p.x;
    ball.deform(mirrored);
    const Status in_a = first.run(), in_b = second.run();
    EXPECT_EQ(in_a.code, Status::Code::inside_out) << height;
    EXPECT_EQ(in_a.body, 0);
    EXPECT_EQ(in_b.code, Status::Code::inside_out) << height;
    EXPECT_EQ(in_b.body, 1);
    EXPECT_EQ(first.volume(), volume);
  }
}

/// A box with a cavity in the shape of another box, or with a box that overlaps it.
Mesh box_and(const Mesh& outer, const Mesh& other) {
  return test::joined(outer, other);
}
double box_overlap(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  double volume = 1;
  for (int k = 0; k < 3; ++k) volume *= std::max(0.0, std::min(a1[k], b1[k]) - std::max(a0[k], b0[k]));
  return volume;
}

TEST(ContactPatches, of_bodies_with_cavities_that_overlap_are_those_by_hand) {
  const auto hole = [](const Vec3& lower, const Vec3& upper) { return test::inverted(test::box_mesh(lower, upper)); };
  const Vec3 h0{-0.3, -0.3, -0.3}, h1{0.3, 0.3, 0.3}, g0{0.1, 0.05, 0.02}, g1{0.7, 0.6, 0.65};
  // Each body with its cavity; the cavities overlap.
  PlacedBody a(box_and(test::box_mesh({-1, -1, -1}, {1, 1, 1}), hole(h0, h1)));
  PlacedBody b(box_and(test::box_mesh({-1.2, -1.3, -1.4}, {1.25, 1.35, 1.45}), hole(g0, g1)));
  const double holes = box_overlap(h0, h1, h0, h1) + box_overlap(g0, g1, g0, g1) - box_overlap(h0, h1, g0, g1);
  // A cavity that touches the other body's faces from inside.
  PlacedBody c(box_and(test::box_mesh({-2, -2, -2}, {2, 2, 2}), hole({0, 0, 0}, {0.5, 0.5, 0.5})));
  PlacedBody d(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  // A body that overlaps itself, so that points count twice there, and the cavity of the other.
  PlacedBody e(box_and(test::box_mesh({-2, -2, -2}, {2, 2, 2}), hole({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5})));
  PlacedBody f(box_and(test::box_mesh({-1, -1, -1}, {1, 1, 1}), test::box_mesh({0.3, 0.2, 0.1}, {1.1, 0.6, 0.7})));
  const auto expect = [](PlacedBody& p, PlacedBody& q, double volume) {
    ContactPatchQuery query(p.collider, q.collider), swapped(q.collider, p.collider);
    for (ContactPatchQuery* const run : {&query, &swapped}) {
      ASSERT_TRUE(run->run());
      EXPECT_NEAR(run->volume(), volume, 1e-12);
      ASSERT_EQ(run->patches().size(), 1u);
      EXPECT_NEAR(run->patches()[0].volume, volume, 1e-12);
    }
  };
  expect(a, b, 8 - holes);
  expect(c, d, 1 - 0.125);
  expect(e, f,
         8 - 1 + 0.8 * 0.4 * 0.6 - box_overlap({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {0.3, 0.2, 0.1}, {1.1, 0.6, 0.7}));
}

// The rim of a shaft, or one vertex of it, on an edge or a face of the other body.
TEST(ContactPatches, of_a_shaft_that_touches_the_rim_are_those_by_hand) {
  Mesh octahedron{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, {}};
  octahedron.facets = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const auto placed = [&](const Vec3& center, double radius) {
    Mesh result = octahedron;
    for (Vec3& p : result.positions) p = center + p * radius;
    return result;
  };
  ASSERT_NEAR(signed_volume(octahedron), 4.0 / 3, 1e-12);
  struct Case {
    Vec3 center;
    double radius, share;  // of the octahedron, in the first box
  };
  for (const Case& at : {Case{{0.75, 0.5, 1}, 0.25, 0.5}, {{0.3, 0.2, -0.5}, 0.5, 1}, {{-0.5, 0.2, 0.1}, 0.5, 1}}) {
    PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}));
    PlacedBody around(box_and(test::box_mesh({-3, -3, -3}, {3, 3, 3}), test::inverted(placed(at.center, at.radius))));
    const double volume = 8 - at.share * 4.0 / 3 * at.radius * at.radius * at.radius;
    ContactPatchQuery query(box.collider, around.collider), swapped(around.collider, box.collider);
    for (ContactPatchQuery* const run : {&query, &swapped}) {
      ASSERT_TRUE(run->run());
      EXPECT_NEAR(run->volume(), volume, 1e-12);
      ASSERT_EQ(run->patches().size(), 1u);
      EXPECT_NEAR(run->patches()[0].volume, volume, 1e-12);
    }
  }
}

TEST(ContactPatches, are_the_same_bits_in_every_run) {
  Random random(21);
  PlacedBody a(test::icosphere(2)), b(test::uv_sphere(12, 9));
  ContactPatchQuery used(a.collider, b.collider);
  for (int pose = 0; pose < 10; ++pose) {
    a.collider.set_transform(random_place(random, 0.5));
    ASSERT_TRUE(used.run());
    ContactPatchQuery fresh(a.collider, b.collider);
    ASSERT_TRUE(fresh.run());
    ASSERT_EQ(used.patches().size(), fresh.patches().size());
    for (std::size_t i = 0; i < used.patches().size(); ++i) {
      const ContactPatch &p = used.patches()[i], &q = fresh.patches()[i];
      EXPECT_EQ(p.volume, q.volume);
      EXPECT_EQ(p.centroid, q.centroid);
      EXPECT_EQ(p.normal, q.normal);
      EXPECT_EQ(p.depth, q.depth);
      EXPECT_EQ(p.a.moment, q.a.moment);
    }
  }
}

}  // namespace
}  // namespace morula

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches of a body with itself: pairs of clipped tetrahedra, lobes as bodies of their own, boxes by hand,
// differences of volumes.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <morula/collide/contact_patches.hpp>
#include <morula/geometry/inspect.hpp>
#include <numbers>
#include <support/error_text.hpp>
#include <support/meshes.hpp>

#include "clipped_overlap.hpp"
#include "collide/patches/self_predicates.hpp"
#include "placed_bodies.hpp"

namespace morula::self_patches {
namespace {

using test::clipped_overlap;
using test::ClippedOverlap;
/// The tree matters little here: a coarse one is made sooner.
struct PlacedBody : test::PlacedBody {
  explicit PlacedBody(const Mesh& m) : test::PlacedBody(m, 2) {}
};

double signed_volume_of(const Collider& body) {
  double volume = 0;
  const Vec3 o = body.triangle(0)[0];
  for (std::uint32_t f = 0; f < body.mesh_facets().size(); ++f) {
    const Triangle t = body.triangle(f);
    volume += dot(t[0] - o, cross(t[1] - o, t[2] - o)) / 6;
  }
  return volume;
}

/// The integral of w (w - 1) / 2: the clipped tetrahedra of the body with itself give that of w².
double self_overlap(const Collider& body) {
  return (clipped_overlap(body, body).volume - signed_volume_of(body)) / 2;
}

double sum_of_volumes(const ContactPatchQuery& query) {
  double sum = 0;
  for (const ContactPatch& patch : query.patches()) sum += patch.volume;
  return sum;
}

Vec3 first_moment(const ContactPatchQuery& query) {
  Vec3 sum;
  for (const ContactPatch& patch : query.patches()) sum += patch.centroid * patch.volume;
  return sum;
}

std::vector<Vec3> gradients(const ContactPatchQuery& query, std::size_t vertices) {
  std::vector<Vec3> sum(vertices);
  for (const ContactPatch& patch : query.patches())
    for (const PatchSide* side : {&patch.a, &patch.b})
      for (const VertexGradient& g : side->gradients) sum[g.vertex] += g.gradient;
  return sum;
}

/// Relations that hold for every patch.
void expect_consistent(const ContactPatchQuery& query, double tolerance, double of_coordinates = 0) {
  for (const ContactPatch& patch : query.patches()) {
    EXPECT_LE(length(patch.a.area_vector + patch.b.area_vector), tolerance) << "action equals reaction";
    EXPECT_LE(length(patch.a.moment + patch.b.moment), tolerance);
    for (const PatchSide* side : {&patch.a, &patch.b}) {
      Vec3 gradient, facets;
      for (const VertexGradient& g : side->gradients) gradient += g.gradient;
      for (const PatchFacet& f : side->facets) facets += f.area_vector;
      EXPECT_LE(length(gradient - side->area_vector), tolerance);
      EXPECT_LE(length(facets - side->area_vector), tolerance);
    }
    if (patch.points.size() < 3) continue;
    Vec3 force, moment;
    for (const PatchPoint& point : patch.points) {
      force += point.force;
      moment += cross(point.point - patch.centroid, point.force);
    }
    EXPECT_LE(length(force + patch.a.area_vector), tolerance);
    EXPECT_LE(length(moment + patch.a.moment), tolerance + of_coordinates);
  }
}

/// A closed tube through rings of the same number of points; caps are fans.
Mesh tube(const std::vector<std::vector<Vec3>>& rings) {
  Mesh mesh;
  const auto around = static_cast<std::uint32_t>(rings[0].size()), count = static_cast<std::uint32_t>(rings.size());
  for (const std::vector<Vec3>& ring : rings) mesh.positions.insert(mesh.positions.end(), ring.begin(), ring.end());
  for (std::uint32_t r = 0; r + 1 < count; ++r)
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t next = (k + 1) % around, low = r * around, high = low + around;
      mesh.facets.push_back({low + k, low + next, high + k});
      mesh.facets.push_back({low + next, high + next, high + k});
    }
  const std::uint32_t last = (count - 1) * around;
  for (std::uint32_t k = 1; k + 1 < around; ++k) {
    mesh.facets.push_back({0, k + 1, k});
    mesh.facets.push_back({last, last + k, last + k + 1});
  }
  return inspect(mesh).volume > 0 ? mesh : test::inverted(mesh);
}

/// Rings of a hook: a bent rod whose end goes into its beginning.
std::vector<std::vector<Vec3>> hook_rings(double turn, double tilt) {
  std::vector<std::vector<Vec3>> rings;
  constexpr int count = 24, around = 7;
  for (int r = 0; r < count; ++r) {
    const double t = turn * r / (count - 1), c = std::cos(t), s = std::sin(t);
    std::vector<Vec3> ring;
    for (int k = 0; k < around; ++k) {
      const double u = 2 * std::numbers::pi * k / around;
      ring.push_back(Vec3{c, s, tilt * t} + Vec3{c, s, 0} * (0.3 * std::cos(u)) + Vec3{0, 0, 0.3 * std::sin(u)});
    }
    rings.push_back(ring);
  }
  return rings;
}
using Rings = std::vector<std::vector<Vec3>>;
Rings part(const Rings& rings, std::size_t begin, std::size_t end) {
  return {rings.begin() + static_cast<std::ptrdiff_t>(begin), rings.begin() + static_cast<std::ptrdiff_t>(end)};
}

/// A rod of a square cross-section of width 2 that bends in a square; its end goes into its beginning.
Mesh square_hook(double begin, double end, double lift) {
  const auto ring = [](double x, double y, double out_x, double out_y, double z) {
    return std::vector<Vec3>{{x + out_x, y + out_y, z + 1},
                             {x - out_x, y - out_y, z + 1},
                             {x - out_x, y - out_y, z - 1},
                             {x + out_x, y + out_y, z - 1}};
  };
  return tube({ring(begin, 0, 0, -1, 0), ring(6, 0, 1, -1, 0), ring(6, 6, 1, 1, 0), ring(0, 6, -1, 1, lift),
               ring(0, end, -1, 0, lift)});
}

TEST(SelfPatches, of_a_hook_are_those_of_its_lobes) {
  for (const double turn : {6.3, 6.5, 6.8}) {
    const Rings rings = hook_rings(turn, 0.013);
    PlacedBody hook(tube(rings)), first(tube(part(rings, 0, 8))), second(tube(part(rings, 16, 24)));
    ContactPatchQuery query(hook.collider);
    ASSERT_TRUE(query.run());
    EXPECT_TRUE(query.certified());
    const ClippedOverlap expected = clipped_overlap(first.collider, second.collider);
    ASSERT_EQ(query.patches().size(), 1u);
    const ContactPatch& patch = query.patches()[0];
    EXPECT_NEAR(query.volume(), expected.volume, 1e-14);
    EXPECT_LE(length(patch.centroid - expected.centroid), 1e-12);
    // The lowest facets are those of the first lobe.
    EXPECT_LE(length(patch.a.area_vector - expected.area_vector_a), 1e-13);
    EXPECT_LE(length(patch.b.area_vector - expected.area_vector_b), 1e-13);
    expect_consistent(query, 1e-13);
    ContactPatchQuery pair(first.collider, second.collider);
    ASSERT_TRUE(pair.run());
    ASSERT_EQ(pair.patches().size(), 1u);
    EXPECT_LE(length(pair.patches()[0].normal - patch.normal), 1e-13);
    EXPECT_NEAR(pair.patches()[0].depth, patch.depth, 1e-13);
    EXPECT_EQ(pair.patches()[0].crossing_count, patch.crossing_count);
    ASSERT_EQ(patch.points.size(), 4u);
    EXPECT_NEAR(self_overlap(hook.collider), expected.volume, 1e-13) << "both oracles agree";
  }
}

TEST(SelfPatches, of_a_hook_of_boxes_on_a_grid_are_boxes) {
  PlacedBody body(square_hook(1, 1, 0));
  ContactPatchQuery query(body.collider);
  for (const double begin : {-2.0, -1.0, -0.5, 0.0, 1.0, 2.0})
    for (const double end : {-2.0, -1.0, -0.5, 0.0, 1.0, 2.0})
      for (const double lift : {-2.0, 0.0, 0.25, 2.0}) {
        body.deform(square_hook(begin, end, lift).positions);
        ASSERT_TRUE(query.run());
        const double volume =
            std::clamp(1 - begin, 0.0, 2.0) * std::clamp(1 - end, 0.0, 2.0) * std::max(0.0, 2 - std::abs(lift));
        EXPECT_NEAR(query.volume(), volume, 1e-13) << begin << ' ' << end << ' ' << lift;
        EXPECT_NEAR(sum_of_volumes(query), volume, 1e-13);
        expect_consistent(query, 1e-13);
      }
}

// The overlaps of bodies that are parts of one mesh are counted by pairs.
TEST(SelfPatches, of_several_bodies_in_one_mesh_are_those_of_all_pairs) {
  Random random(3);
  for (int pose = 0; pose < 8; ++pose) {
    const auto place = [&](const Mesh& mesh) {
      const auto u = [&] { return random.uniform(-1, 1); };
      // Half of the poses are on a grid.
      const Vec3 shift{u(), u(), u()};
      if (pose % 2 == 0) return test::translated(mesh, {std::round(2 * shift.x) / 2, std::round(2 * shift.y) / 2, 0});
      return test::placed(mesh, RigidTransform::from_axis({u(), u(), u()}, random.uniform(0, 3), shift));
    };
    const Mesh box = test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2);
    const std::vector<Mesh> meshes{place(box), place(box), place(test::icosphere(1)), place(box)};
    Mesh all;
    std::vector<std::unique_ptr<PlacedBody>> bodies;
    for (const Mesh& mesh : meshes) {
      bodies.push_back(std::make_unique<PlacedBody>(mesh));
      all = test::joined(all, mesh);
    }
    double volume = 0;
    Vec3 moment;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const ClippedOverlap pair = clipped_overlap(bodies[i]->collider, bodies[j]->collider);
        volume += pair.volume;
        if (pair.volume > 0) moment += pair.centroid * pair.volume;
      }
    PlacedBody body(all);
    ContactPatchQuery query(body.collider);
    ASSERT_TRUE(query.run());
    EXPECT_NEAR(query.volume(), volume, 1e-12);
    EXPECT_NEAR(sum_of_volumes(query), volume, 1e-12);
    EXPECT_LE(length(first_moment(query) - moment), 1e-12);
    expect_consistent(query, 1e-12);
  }
}

// Fans that cross themselves, winding numbers below 0, and on the grid: vertices in one place, coplanar facets.
TEST(SelfPatches, of_tangled_surfaces_are_those_of_clipped_tetrahedra) {
  Random random(17);
  for (int round = 0; round < 24; ++round) {
    const bool on_grid = round % 2 == 1;
    PlacedBody body(round % 3 == 0 ? test::uv_sphere(6, 5) : test::icosphere(round % 3 == 1 ? 0 : 1));
    std::vector<Vec3> moved = body.mesh.positions;
    for (Vec3& p : moved)
      for (int k = 0; k < 3; ++k) {
        p[k] += random.uniform(-1, 1) * (round < 12 ? 0.7 : 3);
        if (on_grid) p[k] = std::round(2 * p[k]) / 2;
      }
    ContactPatchQuery query(body.collider);
    body.deform(moved);
    ASSERT_TRUE(query.run());
    const double volume = query.volume();
    EXPECT_NEAR(sum_of_volumes(query), volume, 1e-11 * (1 + volume)) << round;
    expect_consistent(query, 1e-11 * (1 + volume));
    // The tetrahedra need general position; the volume is continuous.
    if (on_grid) {
      for (Vec3& p : moved) p += Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * 1e-9;
      body.deform(moved);
    }
    EXPECT_NEAR(volume, self_overlap(body.collider), (on_grid ? 1e-6 : 1e-11) * (1 + volume)) << round;
  }
}

TEST(SelfPatches, gradients_are_differences_of_volumes) {
  Random random(5);
  PlacedBody hook(tube(hook_rings(6.6, 0.02))), ball(test::icosphere(1));
  std::vector<Vec3> dented = ball.positions;
  for (Vec3& p : dented) p = p + Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * 0.6;
  ball.deform(dented);
  for (PlacedBody* const body : {&hook, &ball}) {
    ContactPatchQuery query(body->collider);
    ASSERT_TRUE(query.run());
    ASSERT_GT(query.volume(), 0.01);
    const std::vector<Vec3> expected = gradients(query, body->positions.size()), rest = body->positions;
    constexpr double step = 1e-6;
    for (std::uint32_t v = 0; v < rest.size(); v += 5)
      for (int axis = 0; axis < 3; ++axis) {
        double volume[2];
        for (int k = 0; k < 2; ++k) {
          std::vector<Vec3> moved = rest;
          moved[v][axis] += k == 0 ? -step : step;
          body->deform(moved);
          ASSERT_TRUE(query.run({.max_points = 0, .depths = false}));
          volume[k] = query.volume();
        }
        EXPECT_NEAR((volume[1] - volume[0]) / (2 * step), expected[v][axis], 1e-5) << v;
      }
  }
}

// A dent that goes out through the other side, and a vertex that is drawn through its neighbors.
TEST(SelfPatches, without_two_sides_have_volume_and_gradients) {
  PlacedBody ball(test::icosphere(2));
  ContactPatchQuery query(ball.collider);
  ASSERT_TRUE(query.run());
  EXPECT_TRUE(query.patches().empty());
  std::vector<Vec3> moved = ball.mesh.positions;
  const Vec3 top = moved[0];
  for (Vec3& p : moved)
    if (const double near = dot(p, top); near > 0.8) p = p - top * (2.4 * (near - 0.8) / 0.2);
  ball.deform(moved);
  ASSERT_TRUE(query.run());
  ASSERT_EQ(query.patches().size(), 1u);
  const ContactPatch& dent = query.patches()[0];
  EXPECT_NEAR(dent.volume, self_overlap(ball.collider), 1e-13);
  EXPECT_GT(dent.volume, 0.001);
  EXPECT_GT(dot(dent.normal, dent.normal), 0.9) << "the dent and the other side of the ball are two sides";
  expect_consistent(query, 1e-13);

  // A vertex drawn across the facets around it: they cross themselves in curves that end there.
  PlacedBody box(test::box_mesh({0, 0, 0}, {1, 1, 1}, 4));
  moved = box.mesh.positions;
  for (Vec3& p : moved)
    if (distance(p, {0.5, 0.5, 1}) < 1e-9) p = {0.95, 0.6, 1.3};
  box.deform(moved);
  ContactPatchQuery fold(box.collider);
  ASSERT_TRUE(fold.run());
  const double expected = self_overlap(box.collider);
  EXPECT_NEAR(fold.volume(), expected, 1e-14);
  for (const ContactPatch& patch : fold.patches()) {
    if (!patch.b.facets.empty()) continue;
    EXPECT_EQ(patch.normal, Vec3{});
    EXPECT_EQ(patch.depth, 0);
    EXPECT_TRUE(patch.points.empty());
    EXPECT_FALSE(patch.a.gradients.empty());
  }
  expect_consistent(fold, 1e-13);
}

TEST(SelfPatches, of_parts_without_loops) {
  // A ball in a ball counts twice there; a cavity does not.
  PlacedBody twice(test::joined(test::icosphere(2), test::icosphere(1, 0.4, {0.1, 0, 0})));
  PlacedBody hollow(test::joined(test::icosphere(2), test::inverted(test::icosphere(1, 0.4, {0.1, 0, 0}))));
  ContactPatchQuery query(twice.collider), none(hollow.collider);
  ASSERT_TRUE(query.run());
  ASSERT_EQ(query.patches().size(), 1u);
  EXPECT_NEAR(query.volume(), signed_volume(test::icosphere(1, 0.4)), 1e-14);
  EXPECT_EQ(query.patches()[0].normal, Vec3{});
  EXPECT_EQ(query.patches()[0].crossing_count, 0u);
  ASSERT_TRUE(none.run());
  EXPECT_EQ(none.volume(), 0);
  // A body that is mirrored is the overlap of the outside with itself.
  PlacedBody ball(test::icosphere(1));
  ContactPatchQuery inside_out(ball.collider);
  std::vector<Vec3> mirrored = ball.positions;
  for (Vec3& p : mirrored) p.x = -p.x;
  ball.deform(mirrored);
  ASSERT_TRUE(inside_out.run());
  EXPECT_NEAR(inside_out.volume(), signed_volume(ball.mesh), 1e-14);
}

TEST(SelfPatches, are_the_same_after_rigid_motions_far_away_and_small) {
  const Mesh mesh = tube(hook_rings(6.6, 0.02));
  PlacedBody hook(mesh);
  ContactPatchQuery query(hook.collider);
  ASSERT_TRUE(query.run());
  const double volume = query.volume(), depth = query.patches()[0].depth;
  const Vec3 normal = query.patches()[0].normal;
  Random random(9);
  for (int pose = 0; pose < 3; ++pose) {
    const auto u = [&] { return random.uniform(-1, 1); };
    const RigidTransform place = RigidTransform::from_axis({u(), u(), u()}, random.uniform(0, 3), {u(), u(), u()});
    hook.collider.set_transform(place);
    ASSERT_TRUE(query.run());
    ASSERT_EQ(query.patches().size(), 1u);
    EXPECT_NEAR(query.volume(), volume, 1e-14);
    EXPECT_NEAR(query.patches()[0].depth, depth, 1e-13);
    EXPECT_LE(length(query.patches()[0].normal - place.rotate(normal)), 1e-13);
    hook.collider.set_transform({place.rows, place.translation + Vec3{1e6, -3e6, 2e6}});
    ASSERT_TRUE(query.run());
    EXPECT_NEAR(query.volume(), volume, 1e-8);
    expect_consistent(query, 1e-12, 1e-8);
  }
  for (const double size : {1e-9, 1e7}) {
    PlacedBody scaled(test::scaled(mesh, size));
    ContactPatchQuery other(scaled.collider);
    ASSERT_TRUE(other.run());
    EXPECT_NEAR(other.volume() / (size * size * size), volume, 1e-13);
    EXPECT_NEAR(other.patches()[0].depth / size, depth, 1e-12);
  }
}

TEST(SelfPatches, change_continuously_and_keep_ids_and_sides) {
  PlacedBody hook(tube(hook_rings(6.0, 0)));
  ContactPatchQuery query(hook.collider);
  double volume = 0;
  bool had = false;
  std::uint32_t id = 0;
  Vec3 normal, force;
  constexpr int steps = 300;
  for (int step = 0; step <= steps; ++step) {
    std::vector<Vec3> moved;
    for (const auto& ring : hook_rings(6.2 + 0.6 * step / steps, 0.01))
      moved.insert(moved.end(), ring.begin(), ring.end());
    hook.deform(moved);
    ASSERT_TRUE(query.run());
    EXPECT_LE(std::abs(query.volume() - volume), 2e-3) << step;
    volume = query.volume();
    if (query.patches().empty()) continue;
    ASSERT_EQ(query.patches().size(), 1u);
    const ContactPatch& patch = query.patches()[0];
    if (had) {
      EXPECT_EQ(patch.id, id);
      EXPECT_GT(dot(patch.normal, normal), 0.9) << "a stays a";
      EXPECT_LE(length(patch.a.area_vector - force), 0.06) << step;
    }
    had = true, id = patch.id, normal = patch.normal, force = patch.a.area_vector;
  }
  EXPECT_GT(volume, 0.05);
}

TEST(SelfPatches, are_the_same_bits_in_every_run) {
  PlacedBody hook(tube(hook_rings(6.6, 0.02)));
  ContactPatchQuery used(hook.collider);
  for (int run = 0; run < 3; ++run) {
    ASSERT_TRUE(used.run());
    ContactPatchQuery fresh(hook.collider);
    ASSERT_TRUE(fresh.run());
    ASSERT_EQ(used.patches().size(), fresh.patches().size());
    for (std::size_t i = 0; i < used.patches().size(); ++i) {
      EXPECT_EQ(used.patches()[i].volume, fresh.patches()[i].volume);
      EXPECT_EQ(used.patches()[i].normal, fresh.patches()[i].normal);
      EXPECT_EQ(used.patches()[i].depth, fresh.patches()[i].depth);
    }
  }
  EXPECT_EQ(used.run({.max_points = 17}).code, Status::Code::bad_option);
  EXPECT_EQ(used.patches().size(), 1u);
}

TEST(SelfPatches, refuse_open_and_inverted_surfaces_by_name) {
  PlacedBody open(test::grid_plate(3)), inverted(test::inverted(test::icosphere(1)));
  const auto refusal = [](const Collider& body) { return test::error_text([&] { ContactPatchQuery{body}; }); };
  EXPECT_NE(refusal(open.collider).find("the body is not closed: 12 of its edges"), std::string::npos);
  EXPECT_NE(refusal(inverted.collider).find("the body is inside out"), std::string::npos);
  // Two tetrahedra with a common edge, each closed: the edge has four facets.
  Mesh joined;
  joined.positions = {{0, 0, 0}, {0, 0, 2}, {1, 0, 1}, {0, 1, 1}, {1, 0.2, 1}, {0.2, 1, 1}};
  joined.facets = {{0, 2, 3}, {0, 3, 1}, {0, 1, 2}, {1, 3, 2}, {0, 4, 5}, {0, 5, 1}, {0, 1, 4}, {1, 5, 4}};
  if (signed_volume(joined) < 0) joined = test::inverted(joined);
  PlacedBody with_edge(joined);
  EXPECT_NE(refusal(with_edge.collider).find("the body has 1 edges with more than two facets"), std::string::npos);
  // The same tetrahedra, with vertices of their own, are two parts that overlap.
  Mesh apart = joined;
  apart.positions.push_back(joined.positions[0]), apart.positions.push_back(joined.positions[1]);
  for (std::size_t f = 4; f < 8; ++f)
    for (std::uint32_t& v : apart.facets[f])
      if (v < 2) v += 6;
  PlacedBody parts(apart);
  ContactPatchQuery query(parts.collider);
  ASSERT_TRUE(query.run());
  // Cross sections at z = 1: the triangle (0, 0) (1, 0) (0, 1), and (0, 0) (1, 0.2) (0.2, 1) with the corner cut off by
  // x + y = 1, which leaves a share of 1 / 1.2 of its two long edges.
  EXPECT_NEAR(query.volume(), (1 - 0.2 * 0.2) / 1.2 / 1.2 / 3, 1e-15);
}

// Fans of two parts that have one vertex in common, and nothing else.
TEST(SelfPatches, of_parts_with_a_common_vertex_are_those_of_the_parts) {
  Mesh apart = test::icosphere(1), other = test::translated(test::icosphere(1), {0.4, 0.3, 0.2});
  const auto count = static_cast<std::uint32_t>(apart.positions.size());
  // The highest vertices of both move to one place.
  const auto highest = [](const Mesh& m) {
    std::uint32_t v = 0;
    for (std::uint32_t i = 0; i < m.positions.size(); ++i)
      if (m.positions[i].z > m.positions[v].z) v = i;
    return v;
  };
  const std::uint32_t top = highest(apart), other_top = highest(other);
  other.positions[other_top] = apart.positions[top];
  apart.positions.insert(apart.positions.end(), other.positions.begin(), other.positions.end());
  for (const Facet& f : other.facets) apart.facets.push_back({f[0] + count, f[1] + count, f[2] + count});
  Mesh joined = apart;
  for (Facet& f : joined.facets)
    for (std::uint32_t& v : f)
      if (v == count + other_top) v = top;
  PlacedBody a(apart), b(joined);
  ContactPatchQuery of_apart(a.collider), of_joined(b.collider);
  ASSERT_TRUE(of_apart.run());
  ASSERT_TRUE(of_joined.run());
  EXPECT_GT(of_apart.volume(), 0.1);
  EXPECT_NEAR(of_joined.volume(), of_apart.volume(), 1e-12);
}

/// Polynomials in e_0, e_1, e_2 (the last point's translation decides nothing), by powers; the first key dominates.
using Powers = std::array<int, 4>;
using Polynomial = std::map<Powers, long>;
Polynomial times(const Polynomial& p, const Polynomial& q) {
  Polynomial product;
  for (const auto& [m, c] : p)
    for (const auto& [n, d] : q) product[{m[0] + n[0], m[1] + n[1], m[2] + n[2], m[3] + n[3]}] += c * d;
  return product;
}
Polynomial minus(Polynomial p, const Polynomial& q) {
  for (const auto& [m, c] : q) p[m] -= c;
  return p;
}
int leading_sign(const Polynomial& p) {
  // The last e decides first: its lowest power is largest, whatever the powers of the others.
  for (const auto& [m, c] : p)
    if (c != 0) return c > 0 ? 1 : -1;
  return 0;
}

TEST(SelfPredicates, are_the_leading_terms_of_translated_points) {
  Random random(1);
  int zeros = 0;
  for (int round = 0; round < 20000; ++round) {
    std::array<long, 12> c;
    const int range = 1 + round % 3;
    for (long& x : c) x = static_cast<long>(random.uniform(0, range + 0.999));
    std::array<std::uint32_t, 4> index{0, 1, 2, 3};
    for (std::size_t k = 3; k > 0; --k)
      std::swap(index[k], index[static_cast<std::size_t>(random.uniform(0, k + 0.999))]);
    std::array<detail::IndexedPoint, 4> points;
    std::array<std::array<Polynomial, 3>, 4> x;
    for (std::size_t p = 0; p < 4; ++p) {
      points[p] = {{double(c[3 * p]), double(c[3 * p + 1]), double(c[3 * p + 2])}, 10 + 7 * index[p]};
      for (std::size_t k = 0; k < 3; ++k) {
        // Keys are compared from the last e to the first.
        Powers powers{};
        powers[3 - index[p]] = static_cast<int>(k) + 1;
        x[p][k] = {{Powers{}, c[3 * p + k]}, {powers, 1}};
      }
    }
    std::array<std::array<Polynomial, 3>, 3> d;
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t k = 0; k < 3; ++k) d[p][k] = minus(x[p + 1][k], x[0][k]);
    Polynomial determinant;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t m = (k + 1) % 3, n = (k + 2) % 3;
      const Polynomial term = times(d[2][k], minus(times(d[0][m], d[1][n]), times(d[0][n], d[1][m])));
      for (const auto& [powers, value] : term) determinant[powers] += value;
    }
    const int expected = leading_sign(determinant);
    ASSERT_NE(expected, 0);
    ASSERT_EQ(detail::perturbed_orient3d(points[0], points[1], points[2], points[3]), expected) << round;
    zeros += determinant[Powers{}] == 0 ? 1 : 0;
  }
  EXPECT_GT(zeros, 5000);
}

}  // namespace
}  // namespace morula::self_patches

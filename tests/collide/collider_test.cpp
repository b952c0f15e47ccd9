// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/collide/collider.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/pair_walk.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <support/numbers.hpp>
#include <utility>

#include "stale_pose.hpp"

namespace morula {
namespace {

TEST(RigidTransform, undoes_and_composes) {
  const RigidTransform a = RigidTransform::from_axis({1, 2, -3}, 0.7, {4, 5, 6});
  const RigidTransform b = RigidTransform::from_quaternion(0.2, -3, 1, 0.5, {-1, 0, 2});
  EXPECT_LE(deviation_from_rigid(a), 1e-15);
  EXPECT_LE(deviation_from_rigid(b), 1e-15);
  const Vec3 p{0.3, -0.8, 1.9};
  EXPECT_LE(distance(inverse(a)(a(p)), p), 1e-14);
  EXPECT_LE(distance(relative_to(a, b)(p), inverse(a)(b(p))), 1e-14);
  EXPECT_EQ(RigidTransform{}(p), p) << "the identity keeps bits";
}

TEST(RigidTransform, turns_right_handed_about_its_axis) {
  const Vec3 turned = RigidTransform::from_axis({0, 0, 5}, std::numbers::pi / 2)({1, 0, 7});
  EXPECT_LE(distance(turned, Vec3{0, 1, 7}), 1e-15);
}

TEST(RigidTransform, tells_what_is_not_rigid) {
  using test::infinity;
  RigidTransform t;
  t.rows[1].y = -1;
  EXPECT_EQ(deviation_from_rigid(t), infinity) << "a reflection";
  t = {};
  t.translation.z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(deviation_from_rigid(t), infinity);
  t = {};
  t.rows[0].x = 1.5;
  EXPECT_DOUBLE_EQ(deviation_from_rigid(t), 1.25) << "a stretch";
}

/// A turn by the formula of Rodrigues, its entries rounded to single precision.
RigidTransform in_single_precision(const Vec3& unit_axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  const auto& [x, y, z] = unit_axis;
  const double exact[3][3]{{c + k * x * x, k * x * y - s * z, k * x * z + s * y},
                           {k * x * y + s * z, c + k * y * y, k * y * z - s * x},
                           {k * x * z - s * y, k * y * z + s * x, c + k * z * z}};
  RigidTransform t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t.rows[static_cast<std::size_t>(i)][j] = static_cast<float>(exact[i][j]);
  t.translation = {0.1, -7, 1e6};
  return t;
}

TEST(RigidTransform, nearest_rotation_of_one_in_single_precision) {
  double largest = 0;
  for (int k = 0; k < 200; ++k) {
    const double u = 0.37 * k;
    const Vec3 axis = normalized(Vec3{std::sin(u), std::cos(3 * u), std::sin(7 * u) + 0.01});
    RigidTransform given = in_single_precision(axis, 0.21 * k);
    // A short product in single precision leaves more than one rounding.
    if (k % 2 == 1)
      for (Vec3& row : given.rows) row = (1 + 4e-6 * std::sin(5.0 * k)) * row;
    largest = std::max(largest, deviation_from_rigid(given));
    const RigidTransform nearest = orthonormalized(given);
    EXPECT_LE(deviation_from_rigid(nearest), 1e-15);
    EXPECT_EQ(nearest.translation, given.translation);
    // A rotation Q is the nearest to A exactly when A Q^T is symmetric (and positive).
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_NEAR(dot(given.rows[i], nearest.rows[j]), dot(given.rows[j], nearest.rows[i]), 1e-15);
  }
  EXPECT_GT(largest, 5e-6) << "the sample reaches most of what is allowed";
  EXPECT_LE(largest, largest_float_deviation);
}

TEST(RigidTransform, that_is_rigid_keeps_its_bits_and_one_that_is_not_is_named_with_its_digits) {
  const RigidTransform turn = RigidTransform::from_axis({1, 2, -3}, 0.7, {4, 5, 6});
  EXPECT_EQ(rigid_or_throw(turn, "x"), turn);
  RigidTransform nearly = turn;
  nearly.rows[0] = (1 + 4e-10) * nearly.rows[0];
  EXPECT_EQ(rigid_or_throw(nearly, "x"), nearly);
  const auto message = [](const RigidTransform& t) {
    try {
      rigid_or_throw(t, "the transform of a thing");
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const double stretch : {2e-5, 1e-4, 0.5}) {
    RigidTransform t = turn;
    t.rows[1] = (1 + stretch) * t.rows[1];
    const std::string text = message(t);
    EXPECT_TRUE(text.starts_with("the transform of a thing")) << text;
    EXPECT_EQ(text.find("0.000000"), std::string::npos) << text;
    const std::string by = "deviate by ";
    ASSERT_NE(text.find(by), std::string::npos) << text;
    EXPECT_NEAR(std::stod(text.substr(text.find(by) + by.size())), (1 + stretch) * (1 + stretch) - 1, 0.02 * stretch);
  }
  RigidTransform mirror;
  mirror.rows[2].z = -1;
  EXPECT_NE(message(mirror).find("a reflection"), std::string::npos);
}

struct Limb : ::testing::Test {
  Mesh mesh = sample_body("limb");
  CoveredTree model = build(mesh, {.method = Method::octree, .depth = 3});
  Body body{mesh, model};
};

TEST_F(Limb, collider_lists_the_facets_of_each_region) {
  const Collider collider(mesh, body);
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node) {
    std::set<std::uint32_t> owned;
    for (std::uint32_t p = model.cover.region_begin[node]; p < model.cover.region_end[node]; ++p)
      owned.insert(model.cover.patch_facet[p]);
    const auto listed = collider.facets(node);
    EXPECT_EQ(std::set<std::uint32_t>(listed.begin(), listed.end()), owned);
    if (model.tree.is_leaf(node)) {
      EXPECT_EQ(listed.size(), owned.size());
    }
  }
}

TEST_F(Limb, collider_knows_whether_its_positions_are_current) {
  Collider collider(mesh, body);
  EXPECT_TRUE(collider.has_current_positions()) << "at rest the mesh's own serve";
  EXPECT_EQ(collider.triangle(7), mesh.corners(7));

  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p.x *= 1.5;
  ASSERT_TRUE(body.update(moved));
  EXPECT_TRUE(collider.has_current_positions()) << "the body was given them";
  EXPECT_EQ(collider.vertex(11), moved[11]);
  test::StalePose late(mesh, model.cover, body.sphere_state());
  EXPECT_FALSE(late.collider.has_current_positions());
  late.collider.set_positions(moved);
  EXPECT_TRUE(late.collider.has_current_positions());
  EXPECT_EQ(late.collider.vertex(11), moved[11]);
  late.next_frame();
  EXPECT_FALSE(late.collider.has_current_positions());
  const RigidTransform transform = RigidTransform::from_axis({1, 1, 0}, 1.0, {0, 0, 3});
  collider.set_transform(transform);
  EXPECT_EQ(collider.vertex(11), transform(moved[11]));
}

TEST_F(Limb, collider_refuses_what_does_not_fit_and_changes_nothing) {
  Collider collider(mesh, body);
  RigidTransform bent;
  bent.rows[0].y = 0.1;
  EXPECT_THROW(collider.set_transform(bent), std::invalid_argument);
  EXPECT_EQ(collider.transform(), RigidTransform{});
  // Queries allow for what is left of a deviation, so a rotation in single precision is stored as a better one.
  const RigidTransform coarse = in_single_precision(normalized(Vec3{1, -2, 0.5}), 0.9);
  ASSERT_GT(deviation_from_rigid(coarse), largest_rigid_deviation);
  collider.set_transform(coarse);
  EXPECT_LE(deviation_from_rigid(collider.transform()), largest_rigid_deviation);
  collider.set_transform({});
  const std::vector<Vec3> few(3);
  EXPECT_THROW(collider.set_positions(few), std::invalid_argument);
  EXPECT_TRUE(collider.has_current_positions());
  const Mesh torus = sample_body("torus");
  EXPECT_THROW(Collider(torus, body), std::invalid_argument);
}

TEST_F(Limb, body_counts_good_updates_and_knows_when_it_lags) {
  const Body twin(mesh, model);
  const Body other(mesh, build(mesh, {.method = Method::grid, .depth = 3}));
  EXPECT_EQ(body.cover_id(), twin.cover_id());
  EXPECT_NE(body.cover_id(), other.cover_id());

  EXPECT_EQ(body.frame(), 0u);
  ASSERT_TRUE(body.update(mesh.positions));
  EXPECT_EQ(body.frame(), 1u);
  std::vector<Vec3> bad = mesh.positions;
  bad[mesh.facets[0][0]].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(body.update(bad));
  EXPECT_EQ(body.frame(), 1u);
  EXPECT_FALSE(body.is_current());
  ASSERT_TRUE(body.update(mesh.positions));
  EXPECT_TRUE(body.is_current());
  EXPECT_EQ(body.frame(), 2u);
}

// What colliders borrow of a body they keep: they never look at what is gone, and queries refuse them by name.
struct Ended : ::testing::Test {
  Mesh mesh = sample_body("limb", 6), other_mesh = sample_body("blob", 5);
  CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
  CoveredTree other_built = build(other_mesh, {.method = Method::octree, .depth = 2});
  Body standing{mesh, model};
  Collider other{mesh, standing};

  void expect_refused(const Collider& ended) {
    using Code = Status::Code;
    EXPECT_EQ(askable(ended).code, Code::body_replaced);
    ContactQuery contacts;
    contacts.add(ended, other);
    EXPECT_EQ(contacts.run().code, Code::body_replaced);
    EXPECT_EQ(contacts.start().code, Code::body_replaced);
    EXPECT_EQ(contacts.carry().code, Code::body_replaced);
    EXPECT_EQ(CrossingQuery().run(other, ended).code, Code::body_replaced);
    EXPECT_EQ(DistanceQuery().run(other, ended).status.code, Code::body_replaced);
    EXPECT_THROW(static_cast<void>(collide(ended, other)), std::invalid_argument);
    EXPECT_THROW(overlap(ended, other), std::invalid_argument);
    EXPECT_THROW(crossings(ended, other), std::invalid_argument);
    EXPECT_THROW(walk_pairs(ended, other, {}, [](NodePair, bool) { return Step::open; }), std::invalid_argument);
    EXPECT_EQ(RayQuery().run(ended, {}).status.code, Code::body_replaced);
    EXPECT_EQ(TouchQuery().run(ended, Sphere{{}, 1}).status.code, Code::body_replaced);
  }
};

TEST_F(Ended, colliders_of_a_body_that_another_was_assigned_to_are_refused) {
  for (int way = 0; way < 4; ++way) {
    Body body(mesh, model);
    const Collider collider(mesh, body), copy = collider;
    ContactQuery kept;
    kept.add(collider, other);
    ASSERT_TRUE(kept.start());
    if (way == 0) body = standing;
    if (way == 1) body = Body(mesh, model);
    if (way == 2) body = Body(other_mesh, other_built);
    if (way == 3) {
      Body next(mesh, model);
      body = std::move(next);
    }
    EXPECT_EQ(kept.carry().code, Status::Code::body_replaced);
    for (const Collider* ended : {&collider, &copy}) {
      expect_refused(*ended);
      EXPECT_EQ(ended->facets(0).size(), other.facets(0).size()) << "it has what it had";
      EXPECT_EQ(ended->cover().facet_count, mesh.facet_count());
    }
    // The body is as good as any.
    const Mesh& now = way == 2 ? other_mesh : mesh;
    const Collider anew(now, body);
    EXPECT_EQ(askable(anew), Status{});
    const Body same = body;
    EXPECT_EQ(overlap(anew, other), overlap(Collider(now, same), other));
  }
}

TEST_F(Ended, colliders_of_a_body_that_is_gone_are_refused) {
  std::optional<Body> body(std::in_place, mesh, model);
  const Collider collider(mesh, *body);
  body.reset();
  expect_refused(collider);
  std::optional<PosedSpheres> spheres(std::in_place, model.tree);
  const Collider alone(spheres->sphere_state());
  EXPECT_TRUE(overlap(alone, other));
  spheres.emplace(model.tree);
  EXPECT_THROW(overlap(alone, other), std::invalid_argument);
  const Collider again(spheres->sphere_state());
  *spheres = PosedSpheres(model.tree);
  EXPECT_THROW(overlap(again, other), std::invalid_argument);
  EXPECT_TRUE(overlap(Collider(spheres->sphere_state()), other));
}

TEST_F(Ended, colliders_follow_a_body_that_is_moved_from_place_to_place) {
  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p += Vec3{0.25, 0.5, 0};
  Body first(mesh, model);
  const Collider collider(mesh, first);
  Body second(std::move(first));
  Body third(mesh, model);
  const Collider left(mesh, third);
  third = std::move(second);
  ASSERT_TRUE(third.update(moved));
  EXPECT_EQ(askable(collider), Status{});
  EXPECT_EQ(collider.vertex(3), moved[3]);
  EXPECT_EQ(askable(left).code, Status::Code::body_replaced);
  Body& itself = third;
  third = std::move(itself);
  EXPECT_EQ(askable(collider), Status{});
  third = itself;  // by copy: what is assigned is a new body, whatever it is a copy of
  EXPECT_EQ(askable(collider).code, Status::Code::body_replaced);
}

TEST_F(Ended, copies_of_a_collider_are_sides_of_their_own_over_the_same_body) {
  Body body(mesh, model);
  auto original = std::make_unique<Collider>(mesh, body);
  original->set_transform(RigidTransform::from_axis({0, 0, 1}, 1, {5, 0, 0}));
  Collider copy = *original, assigned(mesh, standing);
  assigned = copy;
  copy.set_transform(RigidTransform::from_axis({0, 0, 1}, 2, {0, 1, 0}));
  EXPECT_EQ(original->transform().translation, (Vec3{5, 0, 0}));
  EXPECT_EQ(assigned.transform().translation, (Vec3{5, 0, 0}));
  original.reset();
  std::vector<Collider> many(20, copy);  // grows, and moves them
  for (int i = 0; i < 100; ++i) many.push_back(many.front());
  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p = p * 1.5;
  ASSERT_TRUE(body.update(moved));
  const Collider fresh(mesh, body);
  for (const Collider* c : {&copy, &assigned, &many.front(), &many.back()}) {
    EXPECT_EQ(askable(*c), Status{});
    for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
      EXPECT_TRUE(std::equal(c->facets(node).begin(), c->facets(node).end(), fresh.facets(node).begin(),
                             fresh.facets(node).end()));
  }
  Collider placed = fresh;
  placed.set_transform(copy.transform());
  EXPECT_EQ(crossings(copy, other), crossings(placed, other));
  EXPECT_EQ(distance(assigned, other).upper, [&] {
    placed.set_transform(assigned.transform());
    return distance(placed, other).upper;
  }());
}

}  // namespace
}  // namespace morula

// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere states: everything that has spheres over a tree can be asked, and colliders survive moves of what they borrow.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/pair_walk.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/kdop_tree.hpp>
#include <set>

#include "specimens.hpp"

namespace morula {
namespace {

using test::Specimen;

const BuildOptions shallow{.method = Method::octree, .branching = 8, .depth = 2};

std::vector<Vec3> rippled(const Mesh& mesh, double amount, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p = p + amount * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  return moved;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> facet_pairs(std::span<const Crossing> crossings) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Crossing& c : crossings) pairs.insert({c.facet_a, c.facet_b});
  return pairs;
}

// In double, one pair of nodes at a time, down from the roots: what is surely near, and what is perhaps.
void near_leaves(const Collider& a, const Collider& b, double margin, double unsure, NodePair at,
                 std::set<std::pair<std::uint32_t, std::uint32_t>>& found) {
  const Sphere s = a.sphere_state().sphere(at.a), t = b.sphere_state().sphere(at.b);
  const double gap = distance(a.transform()(s.center), b.transform()(t.center)) - s.radius - t.radius;
  if (gap > margin + unsure) return;
  const SphereTree &tree_a = a.tree(), &tree_b = b.tree();
  if (tree_a.is_leaf(at.a) && tree_b.is_leaf(at.b)) {
    found.insert({at.a, at.b});
    return;
  }
  const auto below = [](const SphereTree& tree, std::uint32_t node) {
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t k = 0; k < tree.child_count[node]; ++k) nodes.push_back(tree.first_child[node] + k);
    if (nodes.empty()) nodes.push_back(node);
    return nodes;
  };
  for (const std::uint32_t i : below(tree_a, at.a))
    for (const std::uint32_t j : below(tree_b, at.b)) near_leaves(a, b, margin, unsure, {i, j}, found);
}

TEST(SphereState, boxes_of_a_kdop_tree_find_every_crossing) {
  Specimen limb("limb", 8, shallow), torus("torus", 8, shallow);
  Random random(3);
  std::size_t crossed = 0;
  for (const int k : {6, 14, 26}) {
    KDopTree tree(limb.mesh, limb.model, k);
    PosedSpheres spheres = tree.posed();
    Collider boxes(limb.mesh, limb.model.cover, spheres.sphere_state());
    EXPECT_TRUE(boxes.sphere_state().covers);
    for (int frame = 0; frame < 8; ++frame) {
      const std::vector<Vec3> moved = rippled(limb.mesh, 0.03 * frame, 7 * frame + 1);
      ASSERT_TRUE(tree.update(moved));
      tree.pose(spheres);
      boxes.set_positions(moved);
      // The spheres contain the k-DOPs, corner by corner.
      for (std::uint32_t node = 0; node < boxes.tree().node_count(); ++node) {
        const Sphere s = spheres.sphere_state().sphere(node);
        for (int corner = 0; corner < 8; ++corner) {
          const auto at = [&](int axis) {
            return static_cast<double>((corner >> axis & 1) != 0 ? tree.upper(node)[axis] : tree.lower(node)[axis]);
          };
          ASSERT_LE(distance(tree.origin() + Vec3{at(0), at(1), at(2)}, s.center), s.radius);
        }
      }
      torus.set_transform(test::random_transform(random, 0.8));
      const auto expected = facet_pairs(brute_force::crossings(boxes, *torus.collider));
      EXPECT_EQ(facet_pairs(crossings(boxes, *torus.collider)), expected);
      crossed += expected.size();
    }
  }
  EXPECT_GT(crossed, 100u);
}

TEST(SphereState, imported_spheres_are_asked_like_those_of_a_body) {
  Specimen limb("limb", 8, shallow), torus("torus", 8, shallow);
  const PosedSpheres imported(limb.model.tree);
  Collider alone(imported.sphere_state());
  EXPECT_FALSE(alone.sphere_state().covers);
  Random random(5);
  int touching = 0;
  for (int i = 0; i < 60; ++i) {
    torus.set_transform(test::random_transform(random, 3));
    const bool expected = overlap(*limb.collider, *torus.collider);
    EXPECT_EQ(overlap(alone, *torus.collider), expected);
    std::set<std::pair<std::uint32_t, std::uint32_t>> surely, perhaps, found;
    near_leaves(alone, *torus.collider, 0, -1e-4, {0, 0}, surely);
    near_leaves(alone, *torus.collider, 0, 1e-4, {0, 0}, perhaps);
    for (const Contact& c : collide(alone, *torus.collider).contacts) found.insert({c.node_a, c.node_b});
    EXPECT_TRUE(std::includes(found.begin(), found.end(), surely.begin(), surely.end()));
    EXPECT_TRUE(std::includes(perhaps.begin(), perhaps.end(), found.begin(), found.end()));
    touching += expected;
  }
  EXPECT_GT(touching, 10);
  EXPECT_LT(touching, 50);

  // What needs facets says so.
  EXPECT_FALSE(alone.has_surface());
  EXPECT_TRUE(alone.facets(0).empty());
  EXPECT_EQ(askable(alone).code, Status::Code::no_surface);
  CrossingQuery crossing;
  EXPECT_EQ(crossing.run(alone, *torus.collider).code, Status::Code::no_surface);
  EXPECT_EQ(crossing.run(*torus.collider, alone), (Status{.code = Status::Code::no_surface, .body = 1}));
  EXPECT_THROW(static_cast<void>(collide(alone, *torus.collider, {.surfaces = true})), std::invalid_argument);
  EXPECT_EQ(DistanceQuery().run(alone, *torus.collider).status.code, Status::Code::no_surface);
}

TEST(SphereState, spheres_that_were_set_are_the_ones_asked) {
  Specimen limb("limb", 6, shallow), torus("torus", 6, shallow);
  PosedSpheres spheres(limb.model.tree);
  Collider collider(spheres.sphere_state());
  const Vec3 away{50, 0, 0};
  EXPECT_TRUE(overlap(collider, *torus.collider));
  std::vector<Sphere> moved = limb.model.tree.spheres;
  for (Sphere& s : moved) s.center = s.center + away;
  spheres.set(moved);
  EXPECT_EQ(spheres.sphere_state().frame, 1u);
  EXPECT_FALSE(overlap(collider, *torus.collider));
  torus.set_transform(RigidTransform::from_axis({0, 0, 1}, 0, away));
  EXPECT_TRUE(overlap(collider, *torus.collider));
  // Float spheres as they come back from elsewhere, bit for bit.
  limb.deform(*std::make_unique<Random>(2), 0.05);
  const SphereState& pose = limb.body->sphere_state();
  spheres.set(pose.spheres, pose.origin);
  for (std::uint32_t i = 0; i < pose.spheres.size(); ++i) {
    EXPECT_EQ(spheres.sphere_state().sphere(i).center, pose.sphere(i).center);
    EXPECT_EQ(spheres.sphere_state().sphere(i).radius, pose.sphere(i).radius);
  }
}

TEST(SphereState, is_nested_where_every_sphere_contains_those_below_in_this_frame) {
  const Mesh mesh = sample_body("limb", 8);
  SphereTree tree = build(mesh, {.method = Method::octree, .depth = 3}).tree;
  make_nested(tree);
  PosedSpheres posed(tree);
  const auto is_nested = [&] {
    const SphereState& state = posed.sphere_state();
    for (std::uint32_t node = 1; node < tree.node_count(); ++node) {
      const Sphere outer = state.sphere(tree.parent[node]), inner = state.sphere(node);
      if (distance(outer.center, inner.center) + inner.radius > outer.radius + 1e-15) return false;
    }
    return true;
  };
  std::vector<Sphere> grown = tree.spheres;
  for (std::uint32_t node = 0; node < grown.size(); ++node)
    if (!tree.is_leaf(node)) grown[node].radius *= 1.01;
  // Inner spheres need room for those below, which are rounded up.
  for (std::uint32_t node = static_cast<std::uint32_t>(grown.size()); node-- > 1;) {
    Sphere& outer = grown[tree.parent[node]];
    outer.radius =
        std::max(outer.radius, (distance(outer.center, grown[node].center) + grown[node].radius) * (1 + 1e-6));
  }
  posed.set(grown);
  EXPECT_TRUE(is_nested());
  EXPECT_TRUE(posed.sphere_state().nested);
  EXPECT_TRUE(PosedSpheres(posed.sphere_state()).sphere_state().nested);
  std::vector<Sphere> torn = grown;
  torn.back().radius += 1;
  posed.set(torn);
  EXPECT_FALSE(is_nested());
  EXPECT_FALSE(posed.sphere_state().nested);
  posed.set(grown);
  EXPECT_TRUE(posed.sphere_state().nested);
}

TEST(SphereState, refuses_spheres_that_are_none_and_changes_nothing) {
  Specimen limb("limb", 4, shallow);
  PosedSpheres spheres(limb.model.tree);
  const std::vector<Spheref> before(spheres.sphere_state().spheres.begin(), spheres.sphere_state().spheres.end());
  const auto refused = [&](auto change) {
    std::vector<Spheref> bad = before;
    change(bad);
    EXPECT_THROW(spheres.set(bad, {}), std::invalid_argument);
    EXPECT_EQ(spheres.sphere_state().frame, 0u);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), spheres.sphere_state().spheres.begin()));
  };
  refused([](auto& s) { s.pop_back(); });
  refused([](auto& s) { s.back().radius = -1; });
  refused([](auto& s) { s.front().radius = std::numeric_limits<float>::infinity(); });
  refused([](auto& s) { s.front().center.y = std::numeric_limits<float>::quiet_NaN(); });
  refused([](auto& s) { s.front().center.x = 0x1p60f; });
  EXPECT_THROW(spheres.set(before, Vec3{0, std::numeric_limits<double>::quiet_NaN(), 0}), std::invalid_argument);
  SphereTree broken = limb.model.tree;
  broken.parent[1] = 7;
  EXPECT_THROW(PosedSpheres{broken}, std::invalid_argument);
  EXPECT_THROW(PosedSpheres{SphereTree{}}, std::invalid_argument);
}

TEST(SphereState, two_poses_of_one_body_are_asked_against_each_other) {
  Specimen limb("limb", 8, shallow);
  const PosedSpheres then(limb.body->sphere_state());
  Collider before(limb.mesh, limb.model.cover, then.sphere_state());
  const std::vector<Vec3> rest = limb.mesh.positions;
  before.set_positions(rest);
  std::vector<Vec3> bent = rest;
  for (Vec3& p : bent) p.y += 0.3 * p.x * p.x;
  ASSERT_TRUE(limb.body->update(bent));
  limb.positions = bent;
  Collider& now = *limb.collider;
  EXPECT_NE(before.sphere_state().frame, now.sphere_state().frame);
  const auto expected = facet_pairs(brute_force::crossings(before, now));
  EXPECT_GT(expected.size(), 20u);
  EXPECT_EQ(facet_pairs(crossings(before, now)), expected);
  EXPECT_EQ(DistanceQuery().run(before, now).upper, 0);
}

// Bodies in a vector that grows: mesh, body and collider move, and the collider asks the same body as before.
TEST(Collider, stays_good_when_its_owner_moves) {
  struct Thing {
    Mesh mesh;
    CoveredTree model;
    Body body;
    Collider collider;
    explicit Thing(Mesh m) : mesh(std::move(m)), model(build(mesh, shallow)), body(mesh, model), collider(mesh, body) {}
  };
  std::vector<Thing> things;
  std::vector<std::size_t> contacts;
  for (int i = 0; i < 6; ++i) {
    things.emplace_back(sample_body("limb", 4 + i));
    things.back().collider.set_transform(RigidTransform::from_axis({0, 0, 1}, 0.3 * i, {0.1 * i, 0, 0}));
    if (i > 0)
      contacts.push_back(
          collide(things.front().collider, things.back().collider, {.find_crossings = true}).crossings.size());
  }
  for (int i = 1; i < 6; ++i) {
    const std::vector<Crossing> found = crossings(things[0].collider, things[i].collider);
    EXPECT_EQ(found.size(), contacts[i - 1]);
    EXPECT_EQ(found.size(), brute_force::crossings(things[0].collider, things[i].collider).size());
  }
  // An update after the move is seen.
  std::vector<Vec3> far = things[0].mesh.positions;
  for (Vec3& p : far) p.x += 100;
  ASSERT_TRUE(things[0].body.update(far));
  EXPECT_FALSE(overlap(things[0].collider, things[1].collider));
  EXPECT_EQ(things[0].collider.vertex(0), far[0]);
}

TEST(Collider, reads_positions_where_the_body_was_given_them) {
  Specimen limb("limb", 6, shallow), torus("torus", 6, shallow);
  Collider fresh(limb.mesh, *limb.body);
  std::vector<Vec3f> narrow;
  for (const Vec3& p : limb.mesh.positions) narrow.push_back(Vec3f(p + Vec3{0.1, 0.2, 0.05}));
  ASSERT_TRUE(limb.body->update(narrow));
  EXPECT_TRUE(fresh.has_current_positions());
  EXPECT_EQ(fresh.vertex(3), Vec3(narrow[3]));
  EXPECT_EQ(facet_pairs(crossings(fresh, *torus.collider)),
            facet_pairs(brute_force::crossings(fresh, *torus.collider)));
  // A refused update keeps the good frame's.
  std::vector<Vec3f> bad = narrow;
  bad[0].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(limb.body->update(bad));
  EXPECT_EQ(fresh.vertex(0), Vec3(narrow[0]));
  EXPECT_EQ(askable(fresh).code, Status::Code::body_not_current);
}

TEST(PairWalk, visits_the_leaf_pairs_within_the_margin) {
  Specimen a("limb", 8, shallow), b("torus", 8, shallow);
  Random random(11);
  std::size_t seen = 0;
  for (int i = 0; i < 40; ++i) {
    a.deform(random, 0.02);
    b.set_transform(test::random_transform(random, 1.5));
    const double margin = i % 2 == 0 ? 0 : 0.15;
    std::set<std::pair<std::uint32_t, std::uint32_t>> surely, perhaps, found;
    near_leaves(*a.collider, *b.collider, margin, -1e-4, {0, 0}, surely);
    near_leaves(*a.collider, *b.collider, margin, 1e-4, {0, 0}, perhaps);
    walk_pairs(*a.collider, *b.collider, {.margin = margin}, [&](NodePair pair, bool is_final) {
      if (is_final) {
        EXPECT_TRUE(found.insert({pair.a, pair.b}).second);
      }
      return Step::open;
    });
    EXPECT_TRUE(std::includes(found.begin(), found.end(), surely.begin(), surely.end()));
    EXPECT_TRUE(std::includes(perhaps.begin(), perhaps.end(), found.begin(), found.end()));
    seen += found.size();
  }
  EXPECT_GT(seen, 200u);
}

TEST(PairWalk, skips_and_stops_where_it_is_told) {
  Specimen a("limb", 8, shallow), b("torus", 8, shallow);
  std::size_t all = 0, first = 0, without = 0;
  const auto count = [&](std::size_t& n, Step answer_of_final) {
    walk_pairs(*a.collider, *b.collider, {}, [&](NodePair, bool is_final) {
      n += is_final;
      return is_final ? answer_of_final : Step::open;
    });
  };
  count(all, Step::open);
  count(first, Step::stop);
  EXPECT_GT(all, 10u);
  EXPECT_EQ(first, 1u);
  // Nothing below the first child of a's root.
  const std::uint32_t left_out = a.model.tree.first_child[0];
  walk_pairs(*a.collider, *b.collider, {}, [&](NodePair pair, bool is_final) {
    if (pair.a == left_out) return Step::skip;
    for (std::uint32_t node = pair.a; node != no_node; node = a.model.tree.parent[node]) EXPECT_NE(node, left_out);
    without += is_final;
    return Step::open;
  });
  EXPECT_LT(without, all);
  EXPECT_THROW(walk_pairs(*a.collider, *b.collider, {.margin = -1}, [](NodePair, bool) { return Step::open; }),
               std::invalid_argument);
  EXPECT_THROW(walk_pairs(*a.collider, *b.collider, {.level = 9}, [](NodePair, bool) { return Step::open; }),
               std::invalid_argument);
}

TEST(ContactQuery, surfaces_under_a_budget_are_those_of_finished_contacts) {
  Specimen a("limb", 10, shallow), b("torus", 10, shallow);
  ContactQuery whole({.surfaces = true}), part({.budget = 65, .surfaces = true});
  whole.add(*a.collider, *b.collider);
  part.add(*a.collider, *b.collider);
  ASSERT_TRUE(whole.run());
  ASSERT_TRUE(part.run());
  const Contacts &all = whole.contacts(), &some = part.contacts();
  ASSERT_FALSE(some.finished);
  ASSERT_GT(some.contacts.size(), some.finished_count);
  EXPECT_EQ(some.surfaces.size(), some.finished_count);
  EXPECT_EQ(all.surfaces.size(), all.contacts.size());
  // Those of coarse contacts are had one at a time: the nearest facets of both nodes.
  for (std::size_t i = some.finished_count; i < some.contacts.size(); ++i) {
    const Contact& c = some.contacts[i];
    const ContactSurface s = part.surface(i);
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t f : a.collider->facets(c.node_a))
      least = std::min(least, closest_point(a.collider->triangle(f), c.point).squared_distance);
    EXPECT_NEAR(distance(s.on_a.point, c.point), std::sqrt(least), 1e-9);
  }
  EXPECT_THROW(part.surface(some.contacts.size()), std::invalid_argument);
}

TEST(ContactQuery, warming_up_changes_no_answer) {
  Specimen a("limb", 8, shallow), b("torus", 8, shallow);
  for (const CollideOptions& options :
       {CollideOptions{.surfaces = true, .find_crossings = true}, CollideOptions{.budget = 40}}) {
    ContactQuery cold(options), warm(options);
    cold.add(*a.collider, *b.collider);
    warm.add(*a.collider, *b.collider);
    ASSERT_TRUE(warm.warm_up());
    EXPECT_TRUE(warm.contacts().contacts.empty());
    EXPECT_EQ(warm.resume().code, Status::Code::no_front);
    ASSERT_TRUE(cold.start());
    ASSERT_TRUE(warm.start());
    EXPECT_EQ(warm.front(), cold.front());
    ASSERT_EQ(warm.contacts().contacts.size(), cold.contacts().contacts.size());
    EXPECT_EQ(warm.contacts().crossings, cold.contacts().crossings);
  }
}

}  // namespace
}  // namespace morula

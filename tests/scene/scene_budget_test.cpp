// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes within a budget: it is kept, work goes on where it ended, and every pair has its turn.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <morula/collide/contacts.hpp>
#include <morula/scene/broad_phase.hpp>
#include <new>
#include <set>

#include "scene_bodies.hpp"

namespace morula {
namespace {

using test::Crowd;
using test::make_thing;
using test::Thing;
using namespace std::chrono_literals;

TEST(Scene, no_pair_waits_for_ever_not_even_one_whose_roots_only_touch) {
  Thing a(test::grid_plate(8, 1.4, 1.0)), b(test::grid_plate(8, 1.4, 1.0));
  Thing c(test::icosphere(2, 0.6)), d(test::icosphere(2, 0.6));
  const double apart = (c.body.sphere(0).radius + d.body.sphere(0).radius) * (1 + 1e-8);
  c.collider.set_transform({.translation = {0, 0, 50}});
  d.collider.set_transform({.translation = {apart, 0, 50}});
  Scene scene({.budget = 72});
  scene.add(a.collider), scene.add(b.collider);
  const BodyId id_c = scene.add(c.collider), id_d = scene.add(d.collider);
  ASSERT_TRUE(scene.update());
  const auto is_open = [&] {
    const ScenePair* pair = scene.find(id_c, id_d);
    return pair != nullptr && !pair->finished;
  };
  ASSERT_TRUE(is_open());
  int frame = 0;
  for (; frame < 5000 && is_open(); ++frame) {
    a.collider.set_transform({.translation = {0.1 * (frame % 3), 0, 0}});
    ASSERT_TRUE(scene.update());
  }
  EXPECT_LT(frame, 5000);
}

// Time may end a pair's surfaces, by the clock that was given. A pair that rests gets them as soon as there is time.
TEST(Scene, surfaces_that_time_has_ended_come_later_where_bodies_rest) {
  Thing a(test::icosphere(2, 0.6)), b(test::icosphere(2, 0.6, {0.3, 0.1, 0}));
  std::chrono::nanoseconds time{0};
  SceneOptions options{.budget = 60us, .surfaces = true, .clock = [&] { return time += 2us; }};
  Scene scene(options);
  scene.add(a.collider), scene.add(b.collider);
  std::size_t contacts = 0, surfaces = 0;
  for (int frame = 0; frame < 20; ++frame) {
    ASSERT_TRUE(scene.update());
    ASSERT_EQ(scene.pairs().size(), 1u);
    const ScenePair& pair = scene.pairs()[0];
    if (pair.finished) contacts = pair.contacts.size(), surfaces = pair.surfaces.size();
  }
  ASSERT_GT(contacts, 40u);
  EXPECT_GT(surfaces, 0u);
  EXPECT_LT(surfaces, contacts);
  options.budget = 10ms;
  scene.set_options(options);
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.pairs()[0].surfaces.size(), contacts);
}

// By the clock that was given, which takes its time for whoever reads it: work costs nothing, so what is late is what
// was begun too late.
TEST(Scene, a_budget_in_time_ends_within_a_tenth_of_it) {
  std::vector<std::unique_ptr<Thing>> things;
  std::chrono::nanoseconds time{0};
  Scene scene({.budget = 1ms, .clock = [&] { return time += 20us; }});
  Random random(5);
  for (std::size_t i = 0; i < 24; ++i) {
    things.push_back(make_thing(i));
    things.back()->id = scene.add(things.back()->collider);
  }
  std::size_t late = 0, stopped = 0, finished = 0;
  for (int frame = 0; frame < 10000; ++frame) {
    for (const auto& thing : things)
      thing->collider.set_transform(test::random_transform(random, frame % 2 == 0 ? 1.0 : 3.0));
    const std::chrono::nanoseconds before = time;
    const SceneStatus status = scene.update();
    ASSERT_TRUE(status);
    late += time - before > 1100us;
    (status.finished ? finished : stopped) += 1;
  }
  EXPECT_EQ(late, 0u);
  EXPECT_GT(stopped, 1000u);
  EXPECT_GT(finished, 1000u);
}

// The clock of a machine that is busy elsewhere for a while, whatever is just being done.
TEST(Scene, a_long_wait_does_not_keep_pairs_from_being_begun_later) {
  std::vector<std::unique_ptr<Thing>> things;
  for (std::size_t i = 0; i < 12; ++i) things.push_back(make_thing(i));
  Random random(6);
  for (int at = 1; at < 12; ++at) {
    std::chrono::nanoseconds time{0};
    int reads = 0, wait_at = 0;
    Scene scene({.budget = 1ms, .clock = [&] { return time += ++reads == wait_at ? 5000us : 1us; }});
    for (const auto& thing : things) thing->id = scene.add(thing->collider);
    const auto update = [&] {
      for (const auto& thing : things) thing->collider.set_transform(test::random_transform(random, 1));
      reads = 0;
      const SceneStatus status = scene.update();
      EXPECT_TRUE(status);
      return status;
    };
    // In the first updates of all, and in later ones.
    for (int waits = 1; waits < 5; ++waits) {
      wait_at = at;
      for (int k = 0; k < waits; ++k) ASSERT_TRUE(update());
      wait_at = 0;
      int updates = 0;
      while (!update().finished && updates < 1000) ++updates;
      EXPECT_LT(updates, 60) << at << ' ' << waits;
    }
  }
}

TEST(Scene, goes_on_where_it_ended_while_bodies_rest) {
  Crowd crowd(8);
  Scene scene({.budget = 300});
  for (int step = 0; step < 12; ++step) crowd.step(scene, false);
  std::size_t updates = 0, open = std::numeric_limits<std::size_t>::max();
  for (SceneStatus status{}; !status.finished; ++updates) {
    status = scene.update();
    ASSERT_TRUE(status);
    ASSERT_LE(status.open_pairs, open);
    open = status.open_pairs;
    ASSERT_LT(updates, 1000u);
  }
  EXPECT_GT(updates, 2u);
  const SceneStatus at_rest = scene.update();
  ASSERT_TRUE(at_rest) << message(at_rest);
  EXPECT_EQ(at_rest.pair_tests, 0u);
  EXPECT_TRUE(scene.ended().empty());
  for (const ScenePair& pair : scene.pairs()) EXPECT_FALSE(pair.began);
}

TEST(Scene, gives_a_budget_to_the_important_first_and_leaves_nobody_out_for_ever) {
  std::vector<std::unique_ptr<Thing>> things;
  Scene scene({.budget = 100});
  // Eight pairs far from each other, each as deep as the others; the fourth is important.
  for (int i = 0; i < 16; ++i) {
    things.push_back(std::make_unique<Thing>(test::icosphere(2, 0.6)));
    things.back()->collider.set_transform({.translation = {10.0 * (i / 2) + 0.3 * (i % 2), 0, 0}});
    things.back()->id = scene.add(things.back()->collider, {.weight = i / 2 == 3 ? 10.0 : 1.0});
  }
  std::set<std::uint32_t> refined;
  const auto look = [&] {
    for (const ScenePair& pair : scene.pairs())
      if (pair.contacts.size() > 1) refined.insert(pair.a.place / 2);
  };
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 8u);
  look();
  EXPECT_EQ(refined, std::set<std::uint32_t>{3});
  Random random(1);
  for (int step = 0; step < 30; ++step) {
    for (const auto& thing : things) {
      RigidTransform moved = thing->collider.transform();
      moved.translation = moved.translation + Vec3{0, random.uniform(-0.01, 0.01), 0};
      thing->collider.set_transform(moved);
    }
    ASSERT_TRUE(scene.update());
    look();
  }
  EXPECT_EQ(refined.size(), 8u);
}

// A pair of nodes of such trees takes more tests to open than a pair usually gets at a time.
TEST(Scene, pairs_of_wide_trees_are_opened_within_a_budget) {
  for (const std::uint32_t branching : {24u, 48u, 64u}) {
    const auto wide = [&](const Vec3& center) {
      std::vector<Sphere> leaves;
      Random random(branching);
      for (int i = 0; i < 2000; ++i) leaves.push_back({center + test::random_point(random, 1), 0.02});
      return PosedSpheres(tree_from_spheres(leaves, branching));
    };
    const PosedSpheres first = wide({}), second = wide({0.3, 0.2, 0.1});
    const Collider a(first.sphere_state()), b(second.sphere_state());
    ASSERT_EQ(a.tree().branching, branching);
    for (const bool by_time : {false, true}) {
      std::chrono::nanoseconds time{0};
      SceneOptions options{.budget = std::size_t{branching} * branching};
      if (by_time) options.budget = 1ms, options.clock = [&] { return time += 100us; };
      Scene scene(options);
      scene.add(a), scene.add(b);
      SceneStatus status;
      int updates = 0;
      for (; updates < 5000 && !status.finished; ++updates) {
        status = scene.update();
        ASSERT_TRUE(status);
        EXPECT_EQ(status.tests_to_open, status.finished ? 0 : std::size_t{branching} * branching);
      }
      EXPECT_TRUE(status.finished) << branching << by_time;
      if (!by_time) {
        EXPECT_GT(updates, 1) << "the budget ends some of them";
      }
      const Contacts all = collide(a, b);
      ASSERT_EQ(scene.pairs().size(), 1u);
      EXPECT_EQ(scene.pairs()[0].contacts.size(), all.contacts.size());
    }
  }
}

// The least budget with which a pair of nodes of branching 8 is opened. Bodies move a little, in every update.
TEST(Scene, a_budget_of_one_pair_of_nodes_finishes_bodies_that_move_a_little) {
  const Mesh mesh = test::box_mesh({-0.7, -0.4, -0.3}, {0.7, 0.4, 0.3}, 6);
  const Body body(mesh, build(mesh, {.method = Method::grid, .branching = 8, .depth = 2}));
  Collider a(mesh, body), b(mesh, body);
  Scene scene({.budget = 64});
  scene.add(a), scene.add(b);
  SceneStatus status;
  int updates = 0;
  for (; updates < 300 && !status.finished; ++updates) {
    b.set_transform({.translation = {0.8, 0.1, 0.05 + (updates % 2 == 0 ? 1e-7 : 0.0)}});
    status = scene.update();
    ASSERT_TRUE(status);
    ASSERT_LE(status.pair_tests, 64u);
    ASSERT_EQ(status.tests_to_open, status.finished ? 0u : 64u);
  }
  EXPECT_TRUE(status.finished);
  EXPECT_GT(updates, 5);
  ASSERT_EQ(scene.pairs().size(), 1u);
  EXPECT_EQ(scene.pairs()[0].contacts.size(), collide(a, b).contacts.size());
}

// The memory of a pair that has waited for long serves other bodies, which have not waited.
TEST(Scene, bodies_do_not_inherit_the_waiting_of_others) {
  std::vector<std::unique_ptr<Thing>> things;
  for (int i = 0; i < 6; ++i) {
    things.push_back(std::make_unique<Thing>(test::icosphere(2, 0.6)));
    things.back()->collider.set_transform({.translation = {10.0 * (i / 2) + 0.3 * (i % 2), 0, 0}});
  }
  const auto refined = [&](bool after_others) {
    Scene scene({.budget = 0});
    if (after_others) {
      // The first two wait for a long time, with the lowest weight, and are removed.
      const BodyId first = scene.add(things[4]->collider, {.weight = 0.01});
      const BodyId second = scene.add(things[5]->collider, {.weight = 0.01});
      for (int i = 0; i < 200; ++i) EXPECT_TRUE(scene.update());
      scene.remove(first), scene.remove(second);
      EXPECT_TRUE(scene.update());
    }
    scene.add(things[0]->collider, {.weight = 0.1}), scene.add(things[1]->collider, {.weight = 0.1});
    scene.add(things[2]->collider), scene.add(things[3]->collider);
    scene.set_options({.budget = 100});
    EXPECT_TRUE(scene.update());
    std::vector<std::size_t> contacts;
    for (const ScenePair& pair : scene.pairs()) contacts.push_back(pair.contacts.size());
    return contacts;
  };
  const std::vector<std::size_t> fresh = refined(false);
  ASSERT_EQ(fresh.size(), 2u);
  EXPECT_EQ(fresh[0], 1u);
  EXPECT_GT(fresh[1], 1u);
  EXPECT_EQ(refined(true), fresh);
}

TEST(Scene, the_greatest_margin_finds_all_pairs) {
  Thing a(test::icosphere(1, 0.6)), b(test::icosphere(1, 0.6));
  b.collider.set_transform({.translation = {1e30, 0, 0}});
  for (const bool later : {false, true}) {
    const double most = std::numeric_limits<double>::max();
    Scene scene({.margin = later ? 0 : most});
    scene.add(a.collider), scene.add(b.collider);
    ASSERT_TRUE(scene.update());
    if (later) {
      ASSERT_TRUE(scene.pairs().empty());
      scene.set_options({.margin = most});
      ASSERT_TRUE(scene.update());
    }
    ASSERT_EQ(scene.pairs().size(), 1u);
    EXPECT_TRUE(scene.pairs()[0].finished);
  }
}

TEST(Scene, rejects_sizes_for_which_there_is_no_memory) {
  Scene scene;
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  for (const std::size_t size : {most, most / 2 + 1, most / 4 + 1, std::size_t{1} << 32}) {
    EXPECT_THROW(scene.reserve({.bodies = size}), std::bad_alloc);
    EXPECT_THROW(scene.reserve({.near_pairs = size}), std::bad_alloc);
    EXPECT_THROW(scene.reserve({.bodies = 1, .near_pairs = 1, .contacts = size}), std::bad_alloc);
    BroadPhase broad;
    EXPECT_THROW(broad.reserve(size, 0), std::bad_alloc);
    EXPECT_THROW(broad.reserve(0, size), std::bad_alloc);
  }
}

}  // namespace
}  // namespace morula

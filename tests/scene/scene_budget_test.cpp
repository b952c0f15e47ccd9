// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes within a budget: it is kept, work goes on where it ended, and every pair has its turn.
#include <gtest/gtest.h>

#include <chrono>
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

}  // namespace
}  // namespace morula

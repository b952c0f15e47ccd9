// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Events of scenes under budgets: none is false, by brute force over spheres and facets, and late ones are counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "scene_bodies.hpp"

namespace morula {
namespace {

using test::Crowd;
using test::make_thing;
using test::Thing;
using namespace std::chrono_literals;

/// The events of one scene, frame by frame, compared with brute force.
class Judge {
 public:
  explicit Judge(const Crowd& crowd) : crowd_(crowd) {}

  void look(const Scene& scene, const SceneStatus& status) {
    for (const EndedPair& pair : scene.ended()) {
      ++ended;
      ASSERT_EQ(touching_.erase(pair.id), 1u);
      const Thing *a = of(pair.a), *b = of(pair.b);
      if (a == nullptr || b == nullptr || !crowd_.may_meet(*a, *b)) continue;
      EXPECT_TRUE(test::crossings_by_force(a->collider, b->collider).empty()) << "ended, and they cross";
    }
    std::size_t late = 0;
    for (const ScenePair& pair : scene.pairs()) {
      const Thing &a = *of(pair.a), &b = *of(pair.b);
      const double margin = scene.options().margin;
      const double gap = test::least_gap(a.collider, b.collider, scene.options().level);
      if (pair.confirmed) {
        EXPECT_LT(gap, margin + test::gap_in_doubt) << "confirmed, and they are apart";
      }
      if (pair.began) {
        ++began;
        EXPECT_TRUE(pair.confirmed);
        EXPECT_TRUE(touching_.emplace(pair.id, std::pair(pair.a, pair.b)).second);
      }
      EXPECT_EQ(pair.touches, touching_.count(pair.id) == 1);
      const bool crosses = !test::crossings_by_force(a.collider, b.collider).empty();
      late += (crosses && !pair.touches) || (gap > margin + test::gap_in_doubt && pair.touches);
      maybe += !pair.touches;
    }
    EXPECT_LE(late, status.undecided_pairs);
    EXPECT_LE(status.undecided_pairs, status.open_pairs);
    were_late += late;
  }

  std::size_t began = 0, ended = 0, maybe = 0, were_late = 0;

 private:
  const Thing* of(BodyId id) const {
    for (const auto& thing : crowd_.things)
      if (thing->id == id) return thing.get();
    return nullptr;
  }
  const Crowd& crowd_;
  std::map<std::uint64_t, std::pair<BodyId, BodyId>> touching_;
};

TEST(SceneEvents, none_is_false_for_any_budget) {
  std::size_t began = 0, ended = 0, maybe = 0, late = 0;
  std::chrono::nanoseconds time{0};
  for (const std::int64_t budget : {-2, -1, 0, 64, 300, 700, 3000})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Crowd crowd(40 + seed);
      SceneOptions options{.level = seed == 2 ? std::optional<std::uint32_t>(1) : std::nullopt,
                           .margin = seed == 3 ? 0.1 : 0.0};
      if (budget >= 0) options.budget = budget;
      if (budget == -2) options.budget = 60us, options.clock = [&] { return time += 3us; };
      Scene scene(options);
      Judge judge(crowd);
      for (int step = 0; step < 60; ++step) {
        crowd.step(scene, true);
        const SceneStatus status = scene.update();
        ASSERT_TRUE(status) << message(status);
        if (budget == -1) {
          ASSERT_EQ(status.undecided_pairs, 0u);
        }
        judge.look(scene, status);
        ASSERT_FALSE(HasFailure()) << "budget " << budget << ", seed " << seed << ", step " << step;
      }
      began += judge.began, ended += judge.ended, maybe += judge.maybe, late += judge.were_late;
    }
  EXPECT_GT(began, 500u);
  EXPECT_GT(ended, 400u);
  EXPECT_GT(maybe, 500u);
  EXPECT_GT(late, 100u);
}

TEST(SceneEvents, all_late_ones_come_while_bodies_rest) {
  for (const std::size_t budget : {std::size_t{100}, std::size_t{700}}) {
    Crowd crowd(8);
    Scene scene({.budget = budget});
    Judge judge(crowd);
    for (int round = 0; round < 6; ++round) {
      for (int step = 0; step < 5; ++step) {
        crowd.step(scene, false);
        const SceneStatus status = scene.update();
        ASSERT_TRUE(status) << message(status);
        judge.look(scene, status);
      }
      SceneStatus status = scene.update();
      judge.look(scene, status);
      for (int updates = 0; status.undecided_pairs > 0; ++updates) {
        ASSERT_LT(updates, 400);
        const std::size_t before = status.undecided_pairs;
        status = scene.update();
        ASSERT_TRUE(status) << message(status);
        EXPECT_LE(status.undecided_pairs, before);
        judge.look(scene, status);
      }
      Scene whole;
      for (const auto& thing : crowd.things) whole.add(thing->collider, thing->options);
      ASSERT_TRUE(whole.update());
      std::size_t touches = 0;
      for (const ScenePair& pair : scene.pairs()) {
        EXPECT_TRUE(pair.touches && pair.confirmed);
        ++touches;
      }
      EXPECT_EQ(touches, whole.pairs().size());
    }
    EXPECT_GT(judge.began, 20u);
  }
}

/// Two plates above each other, whose roots overlap where their leaves do not.
struct TwoPlates {
  TwoPlates() : a(test::grid_plate(8, 1.4, 1.0)), b(test::grid_plate(8, 1.4, 1.0)) {
    id_a = scene.add(a.collider), id_b = scene.add(b.collider);
  }
  void place(double height) { b.collider.set_transform({.translation = {0.05, 0.02, height}}); }
  /// The pair after an update with so many tests, or without a budget.
  const ScenePair* after(std::optional<std::size_t> tests) {
    SceneOptions options;
    if (tests) options.budget = *tests;
    scene.set_options(options);
    EXPECT_TRUE(scene.update());
    return scene.find(id_a, id_b);
  }

  Thing a, b;
  Scene scene;
  BodyId id_a, id_b;
};

TEST(SceneEvents, a_touch_begins_where_it_is_confirmed_and_stays_until_it_is_refuted) {
  TwoPlates two;
  const double near = 1.2;
  two.place(0.05);
  const ScenePair* pair = two.after(0);
  ASSERT_NE(pair, nullptr) << "no touch is missed";
  EXPECT_FALSE(pair->touches || pair->began || pair->confirmed || pair->finished);
  EXPECT_EQ(pair->id, 0u);
  ASSERT_EQ(pair->contacts.size(), 1u);
  pair = two.after({});
  ASSERT_TRUE(pair->touches && pair->began && pair->confirmed && pair->finished);
  const std::uint64_t id = pair->id;
  // It moves, and no budget looks at it.
  two.place(near);
  pair = two.after(0);
  ASSERT_NE(pair, nullptr);
  EXPECT_TRUE(pair->touches && !pair->began && !pair->confirmed);
  EXPECT_EQ(pair->id, id);
  EXPECT_TRUE(two.scene.ended().empty());
  // Its leaves are apart.
  EXPECT_GT(test::least_gap(two.a.collider, two.b.collider, {}), 0);
  EXPECT_EQ(two.after({}), nullptr);
  ASSERT_EQ(two.scene.ended().size(), 1u);
  EXPECT_EQ(two.scene.ended()[0].id, id);
  // Again, and as roots that part.
  two.place(0.05);
  pair = two.after({});
  ASSERT_TRUE(pair->began);
  EXPECT_NE(pair->id, id);
  two.place(50);
  EXPECT_EQ(two.after(0), nullptr);
  EXPECT_EQ(two.scene.ended().size(), 1u);
}

TEST(SceneEvents, a_descent_that_a_budget_stops_confirms_what_it_has_found) {
  const Mesh mesh = test::box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 7);
  const Body body(mesh, build(mesh, {.method = Method::octree, .branching = 8, .depth = 3}));
  Collider a(mesh, body), b(mesh, body);
  b.set_transform({.translation = {0.7, 0.2, 0.1}});
  Scene whole;
  whole.add(a), whole.add(b);
  const std::size_t all = whole.update().pair_tests;
  ASSERT_GT(all, 768u);
  std::size_t coarse = 0;
  for (std::size_t tests = 512; tests < all; tests += 128) {
    Scene scene({.budget = tests});
    scene.add(a), scene.add(b);
    const SceneStatus status = scene.update();
    ASSERT_TRUE(status) << message(status);
    ASSERT_EQ(scene.pairs().size(), 1u);
    const ScenePair& pair = scene.pairs()[0];
    EXPECT_EQ(status.undecided_pairs, pair.touches ? 0u : 1u);
    coarse += pair.touches && std::none_of(pair.contacts.begin(), pair.contacts.end(),
                                           [](const Contact& contact) { return contact.finished; });
  }
  EXPECT_GT(coarse, 0u);
}

TEST(SceneEvents, a_touch_outlasts_other_colliders_sleep_and_options_and_ends_with_masks_and_bodies) {
  TwoPlates two;
  two.place(0.05);
  const ScenePair* pair = two.after({});
  ASSERT_TRUE(pair->began);
  const std::uint64_t id = pair->id;
  const auto expect_kept = [&](bool confirmed) {
    pair = two.scene.find(two.id_a, two.id_b);
    ASSERT_NE(pair, nullptr);
    EXPECT_TRUE(pair->touches && !pair->began);
    EXPECT_EQ(pair->confirmed, confirmed);
    EXPECT_EQ(pair->id, id);
    EXPECT_TRUE(two.scene.ended().empty());
  };
  Collider other(two.b.mesh, two.b.body);
  other.set_transform(two.b.collider.transform());
  two.scene.replace(two.id_b, other);
  two.after(0);
  expect_kept(false);
  two.scene.sleep(two.id_a), two.scene.sleep(two.id_b);
  two.after({});
  expect_kept(true);
  two.after(0);
  expect_kept(true);  // at rest
  two.scene.set_options({.level = 1, .budget = 0});
  ASSERT_TRUE(two.scene.update());
  expect_kept(false);
  two.scene.set_masks(two.id_a, 1, 2);
  EXPECT_EQ(two.after(0), nullptr);
  EXPECT_EQ(two.scene.ended().size(), 1u);
  two.scene.set_masks(two.id_a, 1, 1);
  EXPECT_FALSE(two.after(0)->touches) << "a mask has ended the touch";
  EXPECT_TRUE(two.after({})->began);
  two.scene.remove(two.id_b);
  EXPECT_EQ(two.after(0), nullptr);
  EXPECT_EQ(two.scene.ended().size(), 1u);
}

}  // namespace
}  // namespace morula

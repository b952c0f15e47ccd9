// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes: no crossing outside the contacts, whatever comes, goes, moves and runs out of budget.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <support/allocations.hpp>

#include "scene_bodies.hpp"

namespace morula {
namespace {

using namespace std::chrono_literals;
using test::Crossed;
using test::Crowd;
using test::make_thing;
using test::Thing;

TEST(Scene, has_every_crossing_within_a_contact_wherever_a_budget_ends) {
  std::size_t crossed = 0, interrupted = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Crowd crowd(seed);
    Scene scene;
    Workers workers(2);
    std::chrono::nanoseconds time{0};
    std::map<std::uint64_t, std::pair<BodyId, BodyId>> touching;
    for (int step = 0; step < 60; ++step) {
      crowd.step(scene, true);
      SceneOptions options{.level = crowd.random.next() % 4 == 0 ? std::optional<std::uint32_t>(1) : std::nullopt};
      const std::uint64_t how = crowd.random.next() % 8;
      const std::size_t tests = std::array<std::size_t, 6>{0, 1, 64, 700, 3000, 100000}[how % 6];
      if (how < 6) options.budget = tests;
      if (how == 6) options.budget = 40us, options.clock = [&] { return time += 3us; };
      scene.set_options(options);
      const SceneStatus status = scene.update(workers);
      ASSERT_TRUE(status) << message(status);
      if (how < 6) {
        ASSERT_LE(status.pair_tests, tests);
      }
      if (how == 7) {
        ASSERT_TRUE(status.finished);
      }
      interrupted += !status.finished;
      std::size_t touches = 0;
      for (const EndedPair& ended : scene.ended()) {
        ASSERT_EQ(touching.count(ended.id), 1u);
        ASSERT_EQ(touching[ended.id], std::pair(ended.a, ended.b));
        touching.erase(ended.id);
      }
      for (const ScenePair& pair : scene.pairs()) {
        ASSERT_FALSE(pair.contacts.empty());
        ASSERT_EQ(pair.touches, pair.id != 0);
        if (!pair.touches) continue;
        ++touches;
        ASSERT_EQ(pair.began, touching.count(pair.id) == 0);
        touching[pair.id] = {pair.a, pair.b};
      }
      ASSERT_EQ(touching.size(), touches) << "a touch has neither stayed nor ended";
      for (const auto& a : crowd.things)
        for (const auto& b : crowd.things) {
          if (!(a->id.place < b->id.place)) continue;
          const ScenePair* pair = scene.find(b->id, a->id);
          if (!crowd.may_meet(*a, *b)) {
            ASSERT_EQ(pair, nullptr);
            continue;
          }
          for (const Crossed& crossing : test::crossings_by_force(a->collider, b->collider)) {
            ++crossed;
            ASSERT_NE(pair, nullptr) << "seed " << seed << ", step " << step;
            ASSERT_TRUE(is_within(crossing, *pair, a->collider, b->collider)) << "seed " << seed << ", step " << step;
          }
        }
    }
  }
  EXPECT_GT(crossed, 20000u);
  EXPECT_GT(interrupted, 50u);
}

std::vector<NodePair> nodes_of(std::span<const Contact> contacts) {
  std::vector<NodePair> nodes;
  for (const Contact& c : contacts) nodes.push_back({c.node_a, c.node_b});
  std::sort(nodes.begin(), nodes.end(),
            [](NodePair x, NodePair y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  return nodes;
}

TEST(Scene, finished_contacts_are_those_of_every_two_bodies_alone) {
  std::size_t compared = 0;
  for (const double margin : {0.0, 0.15})
    for (const bool limited : {false, true}) {
      Crowd crowd(31);
      SceneOptions options{.margin = margin, .surfaces = true, .find_crossings = true};
      if (limited) options.budget = 1000000;
      Scene scene(options);
      for (int step = 0; step < 60; ++step) {
        crowd.step(scene, true);
        const SceneStatus status = scene.update();
        ASSERT_TRUE(status && status.finished) << message(status);
        ASSERT_EQ(status.open_pairs, 0u);
        for (const auto& a : crowd.things)
          for (const auto& b : crowd.things) {
            if (!(a->id.place < b->id.place) || !crowd.may_meet(*a, *b)) continue;
            const ScenePair* pair = scene.find(a->id, b->id);
            const Contacts alone =
                collide(a->collider, b->collider, {.margin = margin, .surfaces = true, .find_crossings = true});
            ASSERT_EQ(pair == nullptr, alone.contacts.empty());
            if (pair == nullptr) continue;
            ++compared;
            ASSERT_TRUE(pair->finished);
            ASSERT_EQ(nodes_of(pair->contacts), nodes_of(alone.contacts));
            ASSERT_EQ(pair->surfaces.size(), alone.contacts.size());
            ASSERT_TRUE(std::equal(pair->crossings.begin(), pair->crossings.end(), alone.crossings.begin(),
                                   alone.crossings.end()));
          }
      }
    }
  EXPECT_GT(compared, 500u);
}

std::vector<double> digits(const Scene& scene) {
  std::vector<double> all;
  for (const ScenePair& pair : scene.pairs()) {
    for (const double x :
         {static_cast<double>(pair.a.place), static_cast<double>(pair.b.place), static_cast<double>(pair.id),
          pair.touches ? 1.0 : 0.0, pair.confirmed ? 1.0 : 0.0, pair.began ? 1.0 : 0.0, pair.finished ? 1.0 : 0.0})
      all.push_back(x);
    for (const Contact& c : pair.contacts)
      all.insert(all.end(), {static_cast<double>(c.node_a), static_cast<double>(c.node_b), c.point.x, c.depth,
                             c.error_bound, c.finished ? 1.0 : 0.0});
    for (const ContactSurface& s : pair.surfaces) all.insert(all.end(), {s.depth, s.normal.x, s.on_a.point.z});
  }
  for (const EndedPair& pair : scene.ended()) all.push_back(static_cast<double>(pair.id));
  return all;
}

TEST(Scene, has_the_same_bits_for_any_number_of_workers) {
  std::vector<std::vector<double>> first;
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    Workers workers(threads);
    Crowd crowd(5);
    Scene scene({.budget = 2000, .surfaces = true});
    for (std::size_t step = 0; step < 50; ++step) {
      crowd.step(scene, true);
      ASSERT_TRUE(scene.update(workers));
      if (threads == 1) {
        first.push_back(digits(scene));
      } else {
        ASSERT_EQ(digits(scene), first[step]) << threads << " workers, step " << step;
      }
    }
  }
}

TEST(Scene, tells_what_it_refuses_and_changes_nothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double margin : {-1.0, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(Scene({.margin = margin}), std::invalid_argument);
  EXPECT_THROW(Scene({.budget = -1}), std::invalid_argument);
  Thing a(test::icosphere(1)), b(test::icosphere(1)), c(test::icosphere(1));
  b.collider.set_transform({.translation = {0.5, 0, 0}});
  Scene scene;
  EXPECT_THROW(scene.set_options({.margin = -1}), std::invalid_argument);
  EXPECT_THROW(scene.add(a.collider, {.category = 0}), std::invalid_argument);
  EXPECT_THROW(scene.add(a.collider, {.weight = -1}), std::invalid_argument);
  EXPECT_THROW(scene.add(a.collider, {.weight = nan}), std::invalid_argument);
  EXPECT_EQ(scene.size(), 0u);
  const BodyId id_a = scene.add(a.collider), id_b = scene.add(b.collider);
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 1u);
  const std::uint64_t touch = scene.pairs()[0].id;

  // A step that is not finite.
  b.positions[7].y = nan;
  EXPECT_FALSE(b.body.update(b.positions));
  const SceneStatus refused = scene.update();
  EXPECT_EQ(refused.code, Status::Code::body_not_current);
  EXPECT_EQ(refused.offender, id_b);
  EXPECT_NE(message(refused).find("body 1 of generation 1"), std::string::npos) << message(refused);
  EXPECT_THROW(scene.add(b.collider), std::invalid_argument);
  ASSERT_EQ(scene.pairs().size(), 1u);
  EXPECT_EQ(scene.pairs()[0].id, touch);
  EXPECT_TRUE(scene.pairs()[0].began) << "as of the last good update";
  b.positions = b.mesh.positions;
  ASSERT_TRUE(b.body.update(b.positions));
  ASSERT_TRUE(scene.update());
  EXPECT_FALSE(scene.pairs()[0].began);

  scene.remove(id_a);
  EXPECT_THROW(scene.remove(id_a), std::invalid_argument);
  EXPECT_THROW(scene.sleep(id_a), std::invalid_argument);
  EXPECT_THROW(scene.wake(id_a), std::invalid_argument);
  EXPECT_THROW(scene.replace(id_a, c.collider), std::invalid_argument);
  EXPECT_THROW(scene.set_masks(id_a, 1, 1), std::invalid_argument);
  EXPECT_THROW(scene.set_masks(id_b, 0, 1), std::invalid_argument);
  EXPECT_FALSE(scene.has(id_a));
  EXPECT_FALSE(scene.has({.place = 99, .generation = 1}));
  const BodyId id_c = scene.add(c.collider);
  EXPECT_NE(id_c.place, id_a.place) << "the touch of the removed body has not ended";
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.ended().size(), 1u);
  EXPECT_EQ(scene.ended()[0].id, touch);
  EXPECT_EQ(scene.ended()[0].a, id_a);
  const BodyId again = scene.add(a.collider);
  EXPECT_EQ(again.place, id_a.place);
  EXPECT_NE(again, id_a);
}

TEST(Scene, the_last_move_before_sleep_counts) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Thing a(test::icosphere(1)), b(test::icosphere(1)), other(test::icosphere(1));
  Scene scene;
  scene.add(a.collider);
  const BodyId id_b = scene.add(b.collider), id_other = scene.add(other.collider);
  other.collider.set_transform({.translation = {0, 50, 0}});
  const auto place = [&](double x) { b.collider.set_transform({.translation = {x, 0, 0}}); };
  const auto touches = [&] {
    const SceneStatus status = scene.update();
    EXPECT_TRUE(status && status.finished) << message(status);
    return scene.pairs().size();
  };
  place(100);
  ASSERT_EQ(touches(), 0u);
  place(0.3), scene.sleep(id_b);
  EXPECT_EQ(scene.first_hit({{9, 0, 0}, {-1, 0, 0}}).status.code, Status::Code::other_frame) << "it has moved since";
  EXPECT_EQ(touches(), 1u);
  EXPECT_TRUE(scene.is_asleep(id_b));
  // It sleeps: what it does is not seen until it wakes or is put to sleep again.
  place(100);
  EXPECT_EQ(touches(), 1u);
  scene.sleep(id_b);
  EXPECT_EQ(touches(), 0u);
  scene.wake(id_b), place(0.2), scene.sleep(id_b), place(0.3);
  EXPECT_EQ(touches(), 1u);
  // Its vertices move, and an update is refused before the one that sees them.
  scene.wake(id_b);
  for (Vec3& p : b.positions) p = p + Vec3{40, 0, 0};
  ASSERT_TRUE(b.body.update(b.positions));
  scene.sleep(id_b);
  other.positions[0].x = nan;
  EXPECT_FALSE(other.body.update(other.positions));
  EXPECT_EQ(scene.update().offender, id_other);
  other.positions = other.mesh.positions;
  ASSERT_TRUE(other.body.update(other.positions));
  EXPECT_EQ(touches(), 0u);
  // Where it has not moved, nothing is done again, and rays are answered before the next update.
  b.positions = b.mesh.positions;
  ASSERT_TRUE(b.body.update(b.positions));
  scene.wake(id_b);
  ASSERT_EQ(touches(), 1u);
  scene.sleep(id_b);
  EXPECT_TRUE(scene.first_hit({{9, 0, 0}, {-1, 0, 0}}).first);
  const SceneStatus at_rest = scene.update();
  ASSERT_TRUE(at_rest) << message(at_rest);
  EXPECT_EQ(at_rest.pair_tests, 0u);
  EXPECT_EQ(scene.pairs().size(), 1u);
}

TEST(Scene, masks_and_filters_may_change_while_bodies_touch) {
  Thing a(test::icosphere(1)), b(test::icosphere(1));
  Scene scene;
  const BodyId id_a = scene.add(a.collider, {.category = 2, .mask = 4}),
               id_b = scene.add(b.collider, {.category = 4, .mask = 2});
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.pairs().size(), 1u);
  scene.set_masks(id_b, 4, 1);
  ASSERT_TRUE(scene.update());
  EXPECT_TRUE(scene.pairs().empty());
  EXPECT_EQ(scene.ended().size(), 1u);
  scene.set_masks(id_b, 4, 2);
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 1u);
  EXPECT_TRUE(scene.pairs()[0].began);
  EXPECT_TRUE(scene.ended().empty());
  std::size_t asked = 0;
  scene.set_options({.accepts = [&](BodyId x, BodyId y) {
    ++asked;
    EXPECT_EQ(std::pair(x, y), std::pair(id_a, id_b));
    return false;
  }});
  ASSERT_TRUE(scene.update() && scene.update());
  EXPECT_EQ(asked, 1u);
  EXPECT_TRUE(scene.pairs().empty());
}

TEST(Scene, masks_have_to_fit_on_both_sides) {
  Thing a(test::icosphere(1)), b(test::icosphere(1));
  Scene scene;
  const BodyId id_a = scene.add(a.collider), id_b = scene.add(b.collider);
  // Of group 1 or 2, with 1, 2 or both: the pair is there where both want it, whoever comes first.
  for (std::uint32_t all = 0; all < 4 * 16; ++all) {
    const std::uint32_t of_a = 1 + all % 2, of_b = 1 + all / 2 % 2, with_a = all / 4 % 4, with_b = all / 16;
    scene.set_masks(id_a, of_a, with_a);
    scene.set_masks(id_b, of_b, with_b);
    ASSERT_TRUE(scene.update());
    const bool a_wants = of_b == (of_b & with_a), b_wants = of_a == (of_a & with_b);
    EXPECT_EQ(scene.pairs().size(), a_wants && b_wants ? 1u : 0u) << of_a << with_a << of_b << with_b;
  }
}

// Whatever was kept of the pair while it was apart is about a collider that may be gone.
TEST(Scene, a_body_replaced_while_apart_comes_back_as_what_it_is_now) {
  for (const bool limited : {false, true}) {
    Thing a(test::icosphere(2, 0.6)), b(test::icosphere(2, 0.6)), ball(test::icosphere(1, 0.2));
    SceneOptions options;
    if (limited) options.budget = 400;
    Scene scene(options);
    const BodyId id_a = scene.add(a.collider), id_b = scene.add(b.collider);
    b.collider.set_transform({.translation = {0.4, 0.1, 0}});
    for (int frame = 0; frame < 20; ++frame) ASSERT_TRUE(scene.update());
    ASSERT_GT(scene.find(id_a, id_b)->contacts.size(), 10u);
    b.collider.set_transform({.translation = {50, 0, 0}});
    ASSERT_TRUE(scene.update());
    ASSERT_TRUE(scene.pairs().empty());
    ball.collider.set_transform({.translation = {50, 0, 0}});
    scene.replace(id_b, ball.collider);
    ASSERT_TRUE(scene.update());
    ball.collider.set_transform({.translation = {0.6, 0.1, 0}});
    for (int frame = 0; frame < 20; ++frame) ASSERT_TRUE(scene.update());
    const ScenePair* pair = scene.find(id_a, id_b);
    ASSERT_NE(pair, nullptr) << "the collider before is far away";
    ASSERT_TRUE(pair->finished);
    EXPECT_EQ(nodes_of(pair->contacts), nodes_of(collide(a.collider, ball.collider).contacts));
    for (const Crossed& crossing : test::crossings_by_force(a.collider, ball.collider))
      EXPECT_TRUE(is_within(crossing, *pair, a.collider, ball.collider));
  }
}

TEST(Scene, a_pair_that_a_filter_refuses_is_asked_about_once) {
  Thing a(test::icosphere(1)), b(test::icosphere(1));
  std::size_t asked = 0;
  Scene scene({.accepts = [&](BodyId, BodyId) {
    ++asked;
    return false;
  }});
  scene.add(a.collider);
  scene.add(b.collider);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(scene.update());
  EXPECT_EQ(asked, 1u);
  EXPECT_TRUE(scene.pairs().empty());
  scene.set_options({});
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.pairs().size(), 1u);
}

TEST(Scene, finds_what_rays_and_shapes_meet_of_all_bodies) {
  Crowd crowd(17);
  Scene scene;
  for (int step = 0; step < 10; ++step) crowd.step(scene, false);
  EXPECT_EQ(scene.first_hit({}).status.code, Status::Code::other_frame) << "bodies have come since the last update";
  ASSERT_TRUE(scene.update());
  std::size_t hits = 0, touched = 0;
  for (int i = 0; i < 400; ++i) {
    const Ray ray{test::random_point(crowd.random, 3), test::random_point(crowd.random, 1), crowd.random.uniform(1, 9)};
    const SceneRayHit hit = scene.first_hit(ray);
    ASSERT_TRUE(hit.status);
    double nearest = std::numeric_limits<double>::infinity();
    BodyId who{};
    for (const auto& thing : crowd.things)
      if (const RayHit alone = first_hit(thing->collider, ray);
          alone.first && (alone.first->t < nearest || (alone.first->t == nearest && thing->id < who)))
        nearest = alone.first->t, who = thing->id;
    ASSERT_EQ(hit.first.has_value(), nearest < 1e300);
    EXPECT_TRUE(hit.certified);
    if (hit.first) {
      ++hits;
      EXPECT_EQ(hit.first->t, nearest);
      EXPECT_EQ(*hit.body, who);
    }
    const Sphere ball{test::random_point(crowd.random, 2), crowd.random.uniform(0, 0.5)};
    const Capsule capsule{ball.center, test::random_point(crowd.random, 2), 0.2};
    const HalfSpace behind{test::random_point(crowd.random, 3), crowd.random.uniform(-3, 0)};
    const TouchOptions touch_options{.margin = i % 3 == 0 ? 0.2 : 0.0};
    const auto compare = [&](const auto& shape) {
      ASSERT_TRUE(scene.touch(shape, touch_options));
      std::map<BodyId, double> expected, found;
      for (const auto& thing : crowd.things)
        if (const Touch alone = touch(thing->collider, shape, touch_options); alone.touches)
          expected[thing->id] = alone.deepest->depth;
      for (const SceneTouch& t : scene.touches())
        if (t.touch->touches) found[t.body] = t.touch->deepest->depth;
      EXPECT_EQ(found, expected);
      touched += found.size();
    };
    compare(ball), compare(capsule), compare(behind);
    const Vec3 half = Vec3{0.1, 0.2, 0.1} + Vec3{1, 1, 1} * ball.radius;
    compare(ConvexHull::box({half * -1, half}, RigidTransform::from_axis(behind.normal, 0.1 * i, ball.center)));
  }
  EXPECT_GT(hits, 50u);
  EXPECT_GT(touched, 400u);
  // A half space with a normal of any length touches the same bodies.
  const auto touched_by = [&](const HalfSpace& shape) {
    EXPECT_TRUE(scene.touch(shape));
    std::vector<BodyId> bodies;
    for (const auto& [body, touch] : scene.touches()) bodies.push_back(body);
    return bodies;
  };
  const std::vector<BodyId> behind_plain = touched_by({{1, 1, 0}, 0.25});
  EXPECT_FALSE(behind_plain.empty());
  EXPECT_EQ(touched_by({{0x1p-1000, 0x1p-1000, 0}, 0x1p-1002}), behind_plain);
  EXPECT_EQ(touched_by({{0x1p1000, 0x1p1000, 0}, 0x1p998}), behind_plain);
  const std::size_t kept = scene.touches().size();
  EXPECT_EQ(scene.touch(Sphere{{}, -1}).code, Status::Code::bad_shape);
  EXPECT_EQ(scene.touch(HalfSpace{{0, 0, 0}, 1}).code, Status::Code::bad_shape);
  EXPECT_EQ(scene.touch(HalfSpace{{1e-70, 0, 0}, -1}).code, Status::Code::bad_shape) << "and no body is near it";
  EXPECT_EQ(scene.first_hit({{}, {}}).status.code, Status::Code::bad_shape);
  EXPECT_EQ(scene.first_hit({{1e6, 0, 0}, {1e-70, 0, 0}}).status.code, Status::Code::bad_shape)
      << "and no body is near it";
  EXPECT_EQ(scene.touches().size(), kept);
  crowd.things[0]->collider.set_transform({.translation = {9, 9, 9}});
  scene.wake(crowd.things[0]->id);
  const SceneStatus stale = scene.touch(Sphere{});
  EXPECT_EQ(stale.code, Status::Code::other_frame);
  EXPECT_EQ(stale.offender, crowd.things[0]->id);
  EXPECT_NE(message(stale).find("Scene::update()"), std::string::npos);
}

TEST(Scene, allocates_nothing_once_it_has_seen_the_motion) {
  std::vector<std::unique_ptr<Thing>> things;
  for (std::size_t i = 0; i < 24; ++i) things.push_back(make_thing(i));
  for (const std::size_t budget : {std::size_t{1500}, std::size_t{0}}) {
    SceneOptions options{.surfaces = true};
    Scene scene(options);
    for (const auto& thing : things) thing->id = scene.add(thing->collider);
    bool good = true;
    std::size_t contacts = 0, began = 0;
    const auto go = [&] {
      for (int step = 0; step < 24; ++step) {
        const double t = std::abs(step - 12) / 12.0;
        for (std::size_t i = 0; i < things.size(); ++i) {
          const double x = static_cast<double>(i % 6), y = static_cast<double>(i / 6);
          things[i]->collider.set_transform({.translation = Vec3{x, y, 0} * (0.7 + 0.9 * t)});
        }
        good = good && scene.update();
        for (const ScenePair& pair : scene.pairs()) contacts += pair.contacts.size(), began += pair.began;
        good = good && scene.touch(Sphere{{2, 2, 0}, 1}) && scene.first_hit({{-9, 1, 0.1}, {1, 0, 0}}).status;
      }
    };
    go();
    // Under a budget a pair is left where it was never left before, with more waiting than at the end: all such places
    // are seen once.
    for (std::size_t seen = 200; budget > 0 && seen < 200000; seen += seen / 8) {
      options.budget = seen;
      scene.set_options(options);
      go();
    }
    if (budget > 0) options.budget = budget;
    scene.set_options(options);
    go();
    began = 0;
    const std::size_t before = test::allocations;
    go();
    EXPECT_EQ(test::allocations - before, 0u) << "budget " << budget;
    EXPECT_TRUE(good);
    EXPECT_GT(contacts, 1000u);
    EXPECT_GT(began, 10u);
  }
}

}  // namespace
}  // namespace morula

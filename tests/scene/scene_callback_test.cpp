// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes whose callbacks throw or call back, at every call there is: no pair is lost, no touch, and no method slips in.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <map>
#include <morula/scene/broad_phase.hpp>
#include <new>
#include <set>
#include <support/allocations.hpp>

#include "scene_bodies.hpp"

namespace morula {
namespace {

using namespace std::chrono_literals;
using test::make_thing;
using test::Thing;

struct Bomb {};

/// Calls of one callback: the given one throws.
struct Fuse {
  std::size_t calls = 0, throws_at = 0;
  void light(std::size_t call) { calls = 0, throws_at = call; }
  void burn() {
    if (++calls == throws_at) throw Bomb{};
  }
};

/// Bodies in two poses. Between them one body leaves the scene and another comes, one falls asleep and one is replaced.
class Frames {
 public:
  Frames() {
    Random random(9);
    for (std::size_t i = 0; i < count; ++i) {
      things.push_back(make_thing(i));
      things[i]->options.user_data = i;
      things[i]->options.is_static = i == 4;
      for (std::vector<RigidTransform>& of_frame : poses) of_frame.push_back(test::random_transform(random, 1.1));
    }
    poses[1][4] = poses[0][4];
  }
  void fill(Scene& scene) {
    pose(0);
    for (std::size_t i = 0; i < count; ++i)
      if (i != comes) things[i]->id = scene.add(things[i]->collider, things[i]->options);
  }
  void change(Scene& scene) {
    pose(1);
    scene.remove(things[leaves]->id);
    things[comes]->id = scene.add(things[comes]->collider, things[comes]->options);
    scene.sleep(things[5]->id);
    scene.replace(things[6]->id, things[6]->collider);
  }
  /// The second frame alone.
  void fill_changed(Scene& scene) {
    pose(1);
    for (std::size_t i = 0; i < count; ++i)
      if (i != leaves) scene.add(things[i]->collider, things[i]->options);
  }

  static constexpr std::size_t count = 10, leaves = 1, comes = 9;
  std::vector<std::unique_ptr<Thing>> things;

 private:
  void pose(std::size_t frame) {
    for (std::size_t i = 0; i < count; ++i) things[i]->collider.set_transform(poses[frame][i]);
  }
  std::vector<RigidTransform> poses[2];
};

using Who = std::pair<std::uint64_t, std::uint64_t>;

/// All that a list of pairs says, but for places and numbers of touches.
std::map<Who, std::vector<double>> told(const Scene& scene) {
  std::map<Who, std::vector<double>> all;
  for (const ScenePair& pair : scene.pairs()) {
    std::vector<double>& of_pair = all[{scene.user_data(pair.a), scene.user_data(pair.b)}];
    of_pair.push_back(pair.finished);
    for (const Contact& c : pair.contacts)
      of_pair.insert(of_pair.end(), {1.0 * c.node_a, 1.0 * c.node_b, c.point.x, c.depth, c.finished ? 1.0 : 0.0});
    for (const ContactSurface& s : pair.surfaces) of_pair.insert(of_pair.end(), {s.depth, s.normal.x});
    for (const Crossing& c : pair.crossings) of_pair.insert(of_pair.end(), {1.0 * c.facet_a, 1.0 * c.facet_b});
  }
  return all;
}

/// The scene's last update threw: it says that it has nothing.
void expect_nothing(Scene& scene) {
  EXPECT_TRUE(scene.pairs().empty());
  EXPECT_TRUE(scene.ended().empty());
  EXPECT_EQ(scene.first_hit({{-9, 0, 0}, {1, 0, 0}}).status.code, Status::Code::other_frame);
  EXPECT_EQ(scene.touch(Sphere{}).code, Status::Code::other_frame);
}

/// The second frame's update, after any number of them threw: the pairs of a scene that was never interrupted, and what
/// became of every touch of the first.
void expect_second_frame(Scene& scene, const SceneStatus& status, const std::map<std::uint64_t, EndedPair>& first,
                         Frames& frames, const SceneOptions& options, bool is_new = true) {
  ASSERT_TRUE(status) << message(status);
  Scene fresh(options);
  frames.fill_changed(fresh);
  const SceneStatus expected = fresh.update();
  ASSERT_TRUE(expected);
  if (is_new) {
    EXPECT_EQ(told(scene), told(fresh));
    EXPECT_EQ(status.pair_tests, expected.pair_tests);
    EXPECT_EQ(status.finished, expected.finished);
  }
  std::map<std::uint64_t, EndedPair> left = first;
  for (const ScenePair& pair : scene.pairs()) {
    if (!pair.touches) continue;
    const auto before = first.find(pair.id);
    EXPECT_EQ(pair.began, before == first.end());
    if (before == first.end()) continue;
    EXPECT_EQ(std::pair(pair.a, pair.b), std::pair(before->second.a, before->second.b));
    left.erase(pair.id);
  }
  for (const EndedPair& pair : scene.ended()) {
    ASSERT_EQ(left.count(pair.id), 1u) << "ended, and never begun, or twice";
    EXPECT_EQ(std::pair(pair.a, pair.b), std::pair(left[pair.id].a, left[pair.id].b));
    left.erase(pair.id);
  }
  EXPECT_TRUE(left.empty()) << left.size() << " touches have neither stayed nor ended";
}

/// Lights the fuse of whatever update() calls, at its first call, its second, and so on as long as there is one.
/// attempt(scene) is an update. Returns how many threw.
std::size_t throw_at_every_call(Frames& frames, const std::function<SceneOptions()>& options,
                                const std::function<void(std::size_t)>& light,
                                const std::function<SceneStatus(Scene&)>& attempt) {
  std::size_t thrown = 0;
  for (std::size_t call = 1;; ++call) {
    light(0);
    Scene scene(options());
    frames.fill(scene);
    EXPECT_TRUE(attempt(scene));
    std::map<std::uint64_t, EndedPair> first;
    for (const ScenePair& pair : scene.pairs())
      if (pair.touches) first[pair.id] = {pair.a, pair.b, pair.id};
    EXPECT_GT(first.size(), 2u);
    frames.change(scene);
    light(call);
    SceneStatus status;
    bool threw = false;
    try {
      status = attempt(scene);
    } catch (const Bomb&) {
      threw = true;
    } catch (const std::bad_alloc&) {
      threw = true;
    }
    thrown += threw;
    light(0);
    if (threw) {
      expect_nothing(scene);
      status = attempt(scene);
    }
    expect_second_frame(scene, status, first, frames, options(), threw);
    if (testing::Test::HasFailure()) {
      ADD_FAILURE() << "it threw at call " << call;
      return thrown;
    }
    if (!threw) return thrown;
  }
}

SceneStatus plain_update(Scene& scene) {
  return scene.update();
}

TEST(SceneCallback, a_filter_that_throws_at_any_call_loses_no_pair_and_no_touch) {
  Frames frames;
  Fuse fuse;
  for (const Budget& budget : {Budget(), Budget(700)}) {
    const auto options = [&] {
      return SceneOptions{.budget = budget, .surfaces = true, .find_crossings = true, .accepts = [&](BodyId, BodyId) {
                            fuse.burn();
                            return true;
                          }};
    };
    const std::size_t thrown = throw_at_every_call(
        frames, options, [&](std::size_t call) { fuse.light(call); }, plain_update);
    EXPECT_GT(thrown, 4u);
  }
}

TEST(SceneCallback, a_clock_that_throws_at_any_call_loses_no_pair_and_no_touch) {
  Frames frames;
  Fuse fuse;
  for (const bool extras : {false, true}) {
    const auto options = [&] {
      return SceneOptions{
          .budget = 300us, .surfaces = extras, .find_crossings = extras, .clock = [&fuse, time = 0ns]() mutable {
            fuse.burn();
            return time += 4us;
          }};
    };
    const std::size_t thrown = throw_at_every_call(
        frames, options, [&](std::size_t call) { fuse.light(call); }, plain_update);
    EXPECT_GT(thrown, 10u);
  }
}

TEST(SceneCallback, an_executor_that_throws_at_any_chunk_loses_no_pair_and_no_touch) {
  Frames frames;
  Fuse fuse;
  Workers workers(
      [&](std::size_t count, ChunkFunction chunk) {
        for (std::size_t i = 0; i < count; ++i) {
          fuse.burn();
          chunk(i);
        }
      },
      2);
  const auto options = [] { return SceneOptions{.budget = 700, .surfaces = true}; };
  const std::size_t thrown = throw_at_every_call(
      frames, options, [&](std::size_t call) { fuse.light(call); },
      [&](Scene& scene) { return scene.update(workers); });
  EXPECT_GT(thrown, 4u);
}

TEST(SceneCallback, an_update_without_memory_at_any_place_loses_no_pair_and_no_touch) {
  Frames frames;
  for (const Budget& budget : {Budget(), Budget(700)}) {
    const auto options = [&] { return SceneOptions{.budget = budget, .surfaces = true, .find_crossings = true}; };
    std::size_t fail_at = 0;
    const std::size_t thrown = throw_at_every_call(
        frames, options, [&](std::size_t call) { fail_at = call; },
        [&](Scene& scene) {
          test::allocation_to_fail = fail_at;
          try {
            const SceneStatus status = scene.update();
            test::allocation_to_fail = 0;
            return status;
          } catch (...) {
            test::allocation_to_fail = 0;
            throw;
          }
        });
    EXPECT_GT(thrown, 20u);
  }
}

/// The call, with its n-th allocation refused, for n = 1, 2, … until it needs no more. What is checked after each.
template <class Call, class Check>
std::size_t without_memory(const Call& call, const Check& check) {
  std::size_t thrown = 0;
  for (;; ++thrown) {
    test::allocation_to_fail = thrown + 1;
    bool threw = false;
    try {
      call();
    } catch (const std::bad_alloc&) {
      threw = true;
    }
    test::allocation_to_fail = 0;
    check(threw);
    if (!threw || testing::Test::HasFailure()) return thrown;
  }
}

TEST(SceneCallback, calls_without_memory_change_nothing) {
  std::vector<std::unique_ptr<Thing>> things;
  for (std::size_t i = 0; i < 9; ++i) things.push_back(make_thing(i));
  Scene scene;
  std::size_t thrown = 0, bodies = 0;
  for (const auto& thing : things) {
    thrown += without_memory([&] { thing->id = scene.add(thing->collider); },
                             [&](bool threw) {
                               bodies += !threw;
                               EXPECT_EQ(scene.size(), bodies);
                             });
    EXPECT_EQ(thing->id.place, bodies - 1);
    EXPECT_EQ(thing->id.generation, 1u);
  }
  EXPECT_GT(thrown, 5u);
  ASSERT_TRUE(scene.update());
  const auto before = told(scene);
  EXPECT_GT(before.size(), 0u);
  const BodyId gone = things[8]->id;
  for (const auto& thing : things) {
    without_memory([&] { scene.replace(thing->id, thing->collider); }, [](bool) {});
    without_memory([&] { scene.sleep(thing->id); }, [](bool threw) { EXPECT_FALSE(threw); });
    without_memory([&] { scene.wake(thing->id); }, [](bool threw) { EXPECT_FALSE(threw); });
    without_memory([&] { scene.set_masks(thing->id, 1, 1); }, [](bool threw) { EXPECT_FALSE(threw); });
  }
  without_memory([&] { scene.remove(gone); },
                 [&](bool threw) {
                   EXPECT_FALSE(threw);
                   EXPECT_FALSE(scene.has(gone));
                 });
  EXPECT_THROW(scene.remove(gone), std::invalid_argument);
  scene.add(things[8]->collider);
  ASSERT_TRUE(scene.update());
  // All are asked for twice, in a scene that has room for none and in one that has.
  std::size_t refused = 0;
  for (const double radius : {0.5, 3.0})
    refused += without_memory(
        [&] {
          EXPECT_TRUE(scene.touch(Sphere{{}, radius}));
        },
        [&](bool threw) { EXPECT_EQ(scene.touches().empty(), threw); });
  EXPECT_GT(refused, 5u);
}

TEST(SceneCallback, a_broad_phase_without_memory_keeps_its_pairs) {
  Random random(4);
  const auto box = [&](double room) {
    const Vec3 lower = test::random_point(random, room);
    return Box{lower, lower + Vec3{1, 1, 1}};
  };
  BroadPhase broad;
  std::vector<Box> boxes;
  std::size_t thrown = 0;
  for (std::size_t round = 0; round < 12; ++round) {
    for (std::size_t i = 0; i < 5; ++i) {
      const Box added = box(2);
      std::uint32_t number = 0;
      thrown += without_memory([&] { number = broad.add(added); },
                               [&](bool threw) { EXPECT_EQ(broad.size(), boxes.size() + !threw); });
      ASSERT_EQ(number, boxes.size());
      boxes.push_back(added);
    }
    for (std::uint32_t i = 0; i < boxes.size(); i += 3) {
      boxes[i] = box(2);
      without_memory([&] { EXPECT_TRUE(broad.move(i, boxes[i])); }, [](bool threw) { EXPECT_FALSE(threw); });
    }
    const std::vector<BoxPair> before(broad.pairs().begin(), broad.pairs().end());
    thrown += without_memory(
        [&] { broad.update(); },
        [&](bool threw) {
          EXPECT_TRUE(!threw || std::equal(before.begin(), before.end(), broad.pairs().begin(), broad.pairs().end()));
        });
    std::vector<BoxPair> expected;
    for (std::uint32_t a = 0; a < boxes.size(); ++a)
      for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
        const Vec3 way = boxes[a].lower - boxes[b].lower;
        if (std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)}) <= 1) expected.push_back({a, b});
      }
    ASSERT_TRUE(std::equal(expected.begin(), expected.end(), broad.pairs().begin(), broad.pairs().end()));
  }
  EXPECT_GT(thrown, 20u);
}

/// Every method that a callback may not call, by its name.
std::vector<std::pair<const char*, std::function<void(Scene&, BodyId, const Collider&)>>> refused_methods() {
  return {
      {"update", [](Scene& s, BodyId, const Collider&) { static_cast<void>(s.update()); }},
      {"add", [](Scene& s, BodyId, const Collider& c) { s.add(c); }},
      {"remove", [](Scene& s, BodyId b, const Collider&) { s.remove(b); }},
      {"replace", [](Scene& s, BodyId b, const Collider& c) { s.replace(b, c); }},
      {"sleep", [](Scene& s, BodyId b, const Collider&) { s.sleep(b); }},
      {"wake", [](Scene& s, BodyId b, const Collider&) { s.wake(b); }},
      {"set_masks", [](Scene& s, BodyId b, const Collider&) { s.set_masks(b, 2, 1); }},
      {"set_options", [](Scene& s, BodyId, const Collider&) { s.set_options({.margin = 3}); }},
      {"reserve", [](Scene& s, BodyId, const Collider&) { s.reserve({.bodies = 9}); }},
      {"pairs", [](Scene& s, BodyId, const Collider&) { s.pairs(); }},
      {"ended", [](Scene& s, BodyId, const Collider&) { s.ended(); }},
      {"find", [](Scene& s, BodyId b, const Collider&) { s.find(b, b); }},
      {"first_hit",
       [](Scene& s, BodyId, const Collider&) {
         static_cast<void>(s.first_hit({{}, {1, 0, 0}}));
       }},
      {"all_hits",
       [](Scene& s, BodyId, const Collider&) {
         static_cast<void>(s.all_hits({{}, {1, 0, 0}}));
       }},
      {"touch", [](Scene& s, BodyId, const Collider&) { static_cast<void>(s.touch(Sphere{})); }},
      {"touch",
       [](Scene& s, BodyId, const Collider&) {
         static_cast<void>(s.touch(HalfSpace{{0, 0, 1}, 0}));
       }},
      {"touch", [](Scene& s, BodyId, const Collider&) { static_cast<void>(s.touch(Capsule{})); }},
      {"touch",
       [](Scene& s, BodyId, const Collider&) {
         static_cast<void>(s.touch(ConvexHull::box({{0, 0, 0}, {1, 1, 1}})));
       }},
      {"touches", [](Scene& s, BodyId, const Collider&) { s.touches(); }},
  };
}

TEST(SceneCallback, no_method_that_changes_or_tells_is_answered_from_inside_a_callback) {
  Frames frames;
  for (const bool by_clock : {false, true}) {
    Scene* scene = nullptr;
    BodyId body{};
    std::size_t refused = 0;
    const auto ask = [&] {
      for (const auto& [name, method] : refused_methods()) {
        try {
          method(*scene, body, frames.things[2]->collider);
          ADD_FAILURE() << name << " was answered";
        } catch (const std::logic_error& error) {
          ++refused;
          EXPECT_NE(std::string(error.what()).find("Scene::" + std::string(name) + "()"), std::string::npos)
              << error.what();
        }
      }
      EXPECT_TRUE(scene->has(body));
      EXPECT_FALSE(scene->is_asleep(body));
      EXPECT_EQ(scene->user_data(body), 3u);
      EXPECT_EQ(&scene->collider(body).sphere_state(), &frames.things[3]->collider.sphere_state());
      EXPECT_EQ(scene->size(), Frames::count - 1);
      EXPECT_EQ(scene->options().margin, 0);
    };
    SceneOptions options;
    if (by_clock) {
      options.budget = 1ms;
      options.clock = [&, time = 0ns]() mutable {
        ask();
        return time += 1us;
      };
    } else {
      options.accepts = [&](BodyId, BodyId) {
        ask();
        return true;
      };
    }
    Scene asked(options);
    scene = &asked;
    frames.fill(asked);
    body = frames.things[3]->id;
    ASSERT_TRUE(asked.update());
    EXPECT_GT(refused, 100u);
    Scene plain;
    frames.fill(plain);
    ASSERT_TRUE(plain.update());
    std::set<Who> who, expected;
    for (const auto& [pair, _] : told(asked)) who.insert(pair);
    for (const auto& [pair, _] : told(plain)) expected.insert(pair);
    EXPECT_EQ(who, expected);
    // What a callback lets out of such a call comes out of update(), and the scene answers again.
    SceneOptions careless;
    careless.accepts = [&](BodyId a, BodyId) {
      scene->remove(a);
      return true;
    };
    asked.set_options(careless);
    EXPECT_THROW(static_cast<void>(asked.update()), std::logic_error);
    expect_nothing(asked);
    asked.set_options({});
    ASSERT_TRUE(asked.update());
    EXPECT_EQ(told(asked), told(plain));
    EXPECT_TRUE(asked.ended().empty());
  }
}

// A callback that moves a body which the update reads: there and back, so that every frame looks as the one before.
TEST(SceneCallback, one_that_moves_a_body_ends_the_update) {
  Frames frames;
  for (const bool by_clock : {false, true})
    for (const bool by_update : {false, true})
      for (const std::size_t moved : {0, 4, 7}) {  // the fourth is static
        std::size_t calls = 0, moves_at = 0;
        const auto hook = [&] {
          if (++calls != moves_at) return;
          Thing& thing = *frames.things[moved];
          if (by_update) {
            EXPECT_TRUE(thing.body.update(thing.positions));
            return;
          }
          const RigidTransform before = thing.collider.transform();
          thing.collider.set_transform({.translation = {50, 0, 0}});
          thing.collider.set_transform(before);
        };
        SceneOptions options{.find_crossings = true};
        options.accepts = [&](BodyId, BodyId) { return by_clock ? true : (hook(), true); };
        if (by_clock) {
          options.budget = std::chrono::hours(1);
          options.clock = [&] { return hook(), std::chrono::nanoseconds(1); };
        }
        // The clock's first reading comes before bodies are read, and two after.
        const auto update = [&](Scene& scene) {
          calls = 0;
          return scene.update();
        };
        moves_at = 0;
        Scene whole(options);
        frames.fill(whole);
        ASSERT_TRUE(update(whole).finished);
        const std::size_t all = calls;
        ASSERT_GT(all, 5u);
        std::size_t refused = 0;
        for (moves_at = 1; moves_at <= all; moves_at += 1 + moves_at / 4) {
          Scene scene(options);
          frames.fill(scene);
          const SceneStatus status = update(scene);
          if (status) {
            EXPECT_TRUE(by_clock && (moves_at == 1 || moves_at + 2 > all)) << moves_at << " of " << all;
            EXPECT_EQ(told(scene), told(whole));
            continue;
          }
          ++refused;
          EXPECT_EQ(status.code, Status::Code::changed_during_call);
          ASSERT_TRUE(status.offender);
          EXPECT_EQ(*status.offender, frames.things[moved]->id);
          EXPECT_EQ(message(status).find("body " + std::to_string(status.offender->place)), 0u) << message(status);
          EXPECT_FALSE(status.finished);
          expect_nothing(scene);
          const std::size_t at = std::exchange(moves_at, 0);
          const SceneStatus next = update(scene);
          EXPECT_TRUE(next.finished);
          EXPECT_EQ(told(scene), told(whole)) << at;
          moves_at = at;
        }
        EXPECT_GE(refused, 3u);
      }
}

}  // namespace
}  // namespace morula
